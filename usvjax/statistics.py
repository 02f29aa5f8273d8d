"""Intervals and tests for episodes: rates, averages, paired differences.

Whatever a sample cannot tell (no successes, one value, all equal) comes back as None, never
as NaN. Intervals and tests come from scipy where it has them; the bootstrap of three averages
of many columns at once, Holm's correction and the Agresti-Min interval are written out here.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

RESAMPLES = 999

# Resampled counts held at a time, so that memory does not grow with the number of episodes.
_BLOCK = 200_000

_TRIM = 0.25

_MOST_FLIPPED = 13
"""Differences of which all patterns of signs are tried, as scipy does."""


@dataclass(frozen=True)
class Estimate:
    """A figure with its interval.

    Attributes:
        value: None where the sample has no such figure.
        low, high: None where the sample gives no interval.
    """

    value: float | None
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True)
class Averages:
    """What a sample's values are like.

    Attributes:
        n: how many values.
        mean, median, iqm: with bootstrap intervals; `iqm` is the interquartile mean.
    """

    n: int
    mean: Estimate
    median: Estimate
    iqm: Estimate


@dataclass(frozen=True)
class PairedDifference:
    """Differences, method minus baseline, over episodes that both finished.

    Attributes:
        n: how many episodes.
        mean: mean difference with its t interval.
        relative: mean difference as a share of the baseline's mean; None where that is 0, or a
            value is negative: a ratio says nothing of what has a sign.
        p_t: of the paired t-test.
        p_wilcoxon: of Wilcoxon's signed-rank test.
    """

    n: int
    mean: Estimate
    relative: float | None
    p_t: float | None
    p_wilcoxon: float | None


@dataclass(frozen=True)
class PairedRates:
    """Difference of two success rates over the same episodes.

    Attributes:
        n: how many episodes.
        both, method_only, baseline_only, neither: how many of them which succeeded in.
        difference: method minus baseline, with the Agresti-Min interval.
        p_mcnemar: of McNemar's exact test.
    """

    n: int
    both: int
    method_only: int
    baseline_only: int
    neither: int
    difference: Estimate
    p_mcnemar: float | None


def wilson(successes: int, n: int, level: float) -> Estimate:
    """Share of successes with Wilson's score interval.

    Args:
        successes: how many of `n`.
        n: how many episodes; 0 gives no figure at all.
        level: coverage.

    Returns:
        The share, in [0, 1], and its interval.
    """
    if n == 0:
        return Estimate(None)
    interval = scipy.stats.binomtest(successes, n).proportion_ci(level, method="wilson")
    return Estimate(successes / n, float(interval.low), float(interval.high))


def averages(columns: np.ndarray, level: float, seed: Sequence[int]) -> list[Averages]:
    """Mean, median and interquartile mean of each column, with percentile bootstrap intervals.

    BCa intervals would need a jackknife and, for these averages at the sample sizes of a
    study, move the ends by far less than their width; the percentile interval it is. The
    columns share their resamples: a resample is a count for each rank, so sorting the data
    once replaces sorting every resample.

    Args:
        columns: float[n, M], one column per metric.
        level: coverage.
        seed: of the resamples; integers.

    Returns:
        M results. A column with an infinite or missing value has no averages; fewer than two
        values, or all equal, have no interval.
    """
    n, count = columns.shape
    usable = [bool(n) and bool(np.isfinite(columns[:, m]).all()) for m in range(count)]
    data = np.sort(columns[:, usable].astype(np.float64), axis=0)
    values = np.stack([data.mean(axis=0), np.median(data, axis=0), _iqm(data)]) if n else data
    ends = _bootstrap(data, level, seed) if n >= 2 and data.size else None
    results = []
    for m in range(count):
        if not usable[m]:
            results.append(Averages(n, Estimate(None), Estimate(None), Estimate(None)))
            continue
        column = sum(usable[:m])
        spread = data[-1, column] > data[0, column]
        figures = [
            Estimate(float(values[k, column]), *map(float, ends[:, k, column]))
            if ends is not None and spread
            else Estimate(float(values[k, column]))
            for k in range(3)
        ]
        results.append(Averages(n, *figures))
    return results


def paired_difference(method: np.ndarray, baseline: np.ndarray, level: float) -> PairedDifference:
    """Compare two methods' values on the same episodes.

    Args:
        method: float[n], finite.
        baseline: float[n], finite, in the same order.
        level: coverage of the t interval.

    Returns:
        Mean difference, interval and p-values; None where n < 2 or where all differences are
        equal, since neither test is defined then.
    """
    a, b = method.astype(np.float64), baseline.astype(np.float64)
    n = len(a)
    if n == 0 or not (np.isfinite(a).all() and np.isfinite(b).all()):
        return PairedDifference(n, Estimate(None), None, None, None)
    difference = a - b
    mean = float(difference.mean())
    has_ratio = min(a.min(), b.min()) >= 0.0 and b.mean() > 0.0
    relative = mean / float(b.mean()) if has_ratio else None
    if n < 2 or difference.max() == difference.min():
        return PairedDifference(n, Estimate(mean), relative, None, None)
    test = scipy.stats.ttest_rel(a, b)
    interval = test.confidence_interval(level)
    return PairedDifference(
        n,
        Estimate(mean, float(interval.low), float(interval.high)),
        relative,
        float(test.pvalue),
        _wilcoxon(difference),
    )


def _wilcoxon(difference: np.ndarray) -> float:
    """P of the signed-rank test, exact where there are few differences.

    With ties or zeros among these, scipy calls its statistic once for each pattern of signs, half
    a second in all; the sums of ranks of all patterns are the same numbers at once.
    """
    kept = difference[difference != 0.0]
    ranks = scipy.stats.rankdata(np.abs(kept))
    alike = len(kept) < len(difference) or len(np.unique(ranks)) < len(kept)
    if len(difference) > _MOST_FLIPPED or not alike:
        return float(scipy.stats.wilcoxon(difference).pvalue)
    sums = np.zeros(1)
    for rank in ranks:
        sums = np.concatenate([sums, sums + rank])
    own = ranks[kept > 0.0].sum()
    return min(1.0, 2.0 * float(min((sums <= own).mean(), (sums >= own).mean())))


def paired_rates(method: np.ndarray, baseline: np.ndarray, level: float) -> PairedRates:
    """Compare two methods' successes on the same episodes.

    The interval is that of Agresti and Min (2005): half an episode is added to each of the
    four cells, which keeps its coverage with few discordant episodes or none.

    Args:
        method: bool[n], which episodes succeeded.
        baseline: bool[n], in the same order.
        level: coverage.

    Returns:
        Counts, difference, interval and p-value; without episodes no figures.
    """
    n = len(method)
    both = int((method & baseline).sum())
    gained, lost = int((method & ~baseline).sum()), int((~method & baseline).sum())
    counts = (n, both, gained, lost, n - both - gained - lost)
    if n == 0:
        return PairedRates(*counts, Estimate(None), None)
    z = float(scipy.stats.norm.ppf(0.5 + level / 2.0))
    total, b, c = n + 2.0, gained + 0.5, lost + 0.5
    centre = (b - c) / total
    half = z * math.sqrt((b + c) - (b - c) ** 2 / total) / total
    discordant = gained + lost
    p = float(scipy.stats.binomtest(gained, discordant).pvalue) if discordant else 1.0
    difference = Estimate((gained - lost) / n, max(centre - half, -1.0), min(centre + half, 1.0))
    return PairedRates(*counts, difference, p)


def holm(p_values: Sequence[float | None], looks: int = 1) -> list[float | None]:
    """Adjust p-values for a family of tests (Holm 1979), and for looking several times.

    Args:
        p_values: of the whole family; None stays None and counts for nothing.
        looks: how many times the data may be looked at before stopping; Bonferroni.

    Returns:
        Adjusted p-values in the same order, at most 1.
    """
    known = [i for i, p in enumerate(p_values) if p is not None]
    known.sort(key=lambda i: p_values[i] or 0.0)
    adjusted: list[float | None] = [None] * len(p_values)
    largest = 0.0
    for rank, i in enumerate(known):
        largest = max(largest, (len(known) - rank) * looks * (p_values[i] or 0.0))
        adjusted[i] = min(1.0, largest)
    return adjusted


def _iqm(data: np.ndarray) -> np.ndarray:
    """Interquartile mean of each column."""
    trimmed: np.ndarray = scipy.stats.trim_mean(data, _TRIM, axis=0)
    return trimmed


def _bootstrap(data: np.ndarray, level: float, seed: Sequence[int]) -> np.ndarray:
    """Ends of the intervals, float[2, 3, M], for sorted columns float[n, M], n >= 2."""
    n = len(data)
    rng = np.random.default_rng(list(seed))
    block = max(1, _BLOCK // n)
    sizes = [min(block, RESAMPLES - first) for first in range(0, RESAMPLES, block)]
    figures = np.concatenate([_resampled(data, size, rng) for size in sizes])
    tail = (1.0 - level) / 2.0
    return np.quantile(figures, [tail, 1.0 - tail], axis=0)


def _resampled(data: np.ndarray, resamples: int, rng: np.random.Generator) -> np.ndarray:
    """Mean, median and interquartile mean of resamples, float[resamples, 3, M]."""
    n = len(data)
    drawn = rng.integers(0, n, size=(resamples, n), dtype=np.int32)
    drawn += np.arange(resamples, dtype=np.int32)[:, None] * n
    counts = np.bincount(drawn.ravel(), minlength=resamples * n).reshape(resamples, n)
    upto = counts.cumsum(axis=1)
    cut = int(_TRIM * n)
    kept = np.diff(upto.clip(cut, n - cut), axis=1, prepend=cut)
    middle = [(upto < k).sum(axis=1) for k in ((n - 1) // 2 + 1, n // 2 + 1)]
    # einsum, unlike a BLAS product, adds in one fixed order: the same bits on every run.
    return np.stack(
        [
            np.einsum("rn,nm->rm", counts.astype(np.float64), data) / n,
            data[np.stack(middle, axis=1)].mean(axis=1),
            np.einsum("rn,nm->rm", kept.astype(np.float64), data) / (n - 2 * cut),
        ],
        axis=1,
    )
