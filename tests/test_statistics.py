"""Statistics against independent formulas, and their answers to samples that tell nothing."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from property_draws import examples
from scipy import stats

from usvjax.statistics import (
    RESAMPLES,
    Estimate,
    averages,
    holm,
    paired_difference,
    paired_rates,
    wilson,
)


@given(n=st.integers(1, 5000), share=st.floats(0, 1), level=st.floats(0.5, 0.999))
@examples(60)
def test_wilson_by_its_formula(n, share, level):
    k = round(share * n)
    found = wilson(k, n, level)
    z = stats.norm.ppf(0.5 + level / 2)
    centre = (k + z**2 / 2) / (n + z**2)
    half = z / (n + z**2) * math.sqrt(k * (n - k) / n + z**2 / 4)
    assert found.value == k / n
    assert found.low == pytest.approx(max(centre - half, 0), abs=1e-12)
    assert found.high == pytest.approx(min(centre + half, 1), abs=1e-12)


def test_wilson_without_episodes():
    assert wilson(0, 0, 0.95) == Estimate(None)


def test_averages_are_those_of_numpy_and_scipy():
    data = np.random.default_rng(0).gamma(2.0, size=(397, 3))
    for column, found in enumerate(averages(data, 0.95, (1, 2))):
        values = data[:, column]
        assert found.n == 397
        assert found.mean.value == pytest.approx(values.mean())
        assert found.median.value == pytest.approx(np.median(values))
        assert found.iqm.value == pytest.approx(stats.trim_mean(values, 0.25))
        for figure in (found.mean, found.median, found.iqm):
            assert figure.low is not None
            assert figure.low < figure.value < figure.high


@pytest.mark.parametrize("n", [40, 401])
def test_bootstrap_intervals_agree_with_scipy(n):
    values = np.random.default_rng(1).exponential(size=n)
    (found,) = averages(values[:, None], 0.9, (3,))
    kinds = (
        (found.mean, np.mean),
        (found.median, np.median),
        (found.iqm, lambda x, axis: stats.trim_mean(x, 0.25, axis=axis)),
    )
    for figure, statistic in kinds:
        theirs = stats.bootstrap(
            (values,),
            statistic,
            n_resamples=4000,
            method="percentile",
            confidence_level=0.9,
            rng=np.random.default_rng(5),
            vectorized=True,
        )
        # Both are of resamples: a quantile of 5 % of R of them has, where they are normal, a
        # standard deviation of sqrt(0.05 * 0.95 / R) / 0.103 standard errors. Six of those of the
        # two together: they are skew, and the median's lie on the values of the sample.
        noise = math.sqrt(0.05 * 0.95 * (1 / RESAMPLES + 1 / 4000)) / 0.103
        noise *= 6.0 * theirs.standard_error
        assert figure.low == pytest.approx(theirs.confidence_interval.low, abs=noise)
        assert figure.high == pytest.approx(theirs.confidence_interval.high, abs=noise)


def test_resampled_figures_are_those_of_sorted_resamples(monkeypatch):
    # One resample, written out the slow way from the same random ranks.
    from usvjax import statistics

    data = np.sort(np.random.default_rng(2).normal(size=(21, 2)), axis=0)
    figures = statistics._resampled(data, 3, np.random.default_rng(9))
    rng = np.random.default_rng(9)
    for resample in range(3):
        values = data[rng.integers(0, 21, size=21, dtype=np.int32)]
        for column in range(2):
            expected = [
                values[:, column].mean(),
                np.median(values[:, column]),
                stats.trim_mean(values[:, column], 0.25),
            ]
            assert figures[resample, :, column] == pytest.approx(expected)


def test_bootstrap_covers():
    rng = np.random.default_rng(3)
    samples = rng.exponential(size=(60, 400))
    truth = (1.0, math.log(2.0))
    found = averages(samples, 0.9, (4,))
    for figure, true in zip(("mean", "median"), truth, strict=True):
        hits = sum(getattr(f, figure).low <= true <= getattr(f, figure).high for f in found)
        # Four standard deviations (0.015) of the share about 0.9; less two hundredths, by which
        # percentiles of skew samples of 60 fall short.
        assert 0.82 < hits / 400 < 0.96


def test_averages_depend_on_nothing_but_data_and_seed():
    data = np.random.default_rng(0).normal(size=(5000, 2))
    assert averages(data, 0.95, (1,)) == averages(data.copy(), 0.95, (1,))
    shuffled = data[np.random.default_rng(1).permutation(5000)]
    assert averages(shuffled, 0.95, (1,))[0].iqm == averages(data, 0.95, (1,))[0].iqm
    assert averages(data, 0.95, (1,)) != averages(data, 0.95, (2,))


def test_averages_of_samples_that_tell_nothing():
    assert [a.mean for a in averages(np.zeros((0, 2)), 0.95, (0,))] == [Estimate(None)] * 2
    (one,) = averages(np.asarray([[3.0]]), 0.95, (0,))
    assert one.mean == one.median == one.iqm == Estimate(3.0)
    (equal,) = averages(np.full((50, 1), 2.0), 0.95, (0,))
    assert equal.mean == Estimate(2.0)
    infinite, fine = averages(np.asarray([[np.inf, 1.0], [1.0, 2.0], [2.0, 4.0]]), 0.95, (0,))
    assert infinite.n == 3
    assert infinite.mean == infinite.median == infinite.iqm == Estimate(None)
    assert fine.median.value == 2.0
    assert fine.median.low is not None


def test_paired_difference_by_its_formulas():
    rng = np.random.default_rng(4)
    baseline = rng.normal(10.0, 2.0, size=80)
    method = baseline - 1.0 + rng.normal(0.0, 1.0, size=80)
    found = paired_difference(method, baseline, 0.95)
    d = method - baseline
    half = stats.t.ppf(0.975, 79) * d.std(ddof=1) / math.sqrt(80)
    assert found.n == 80
    assert found.mean.value == pytest.approx(d.mean())
    assert found.mean.low == pytest.approx(d.mean() - half)
    assert found.mean.high == pytest.approx(d.mean() + half)
    assert found.relative == pytest.approx(d.mean() / baseline.mean())
    t = d.mean() / d.std(ddof=1) * math.sqrt(80)
    assert found.p_t == pytest.approx(2 * stats.t.sf(abs(t), 79))
    assert found.p_wilcoxon == pytest.approx(signed_rank_p(d))


def signed_rank_p(d: np.ndarray) -> float:
    """Normal approximation of Wilcoxon's signed-rank test, without ties."""
    ranks = stats.rankdata(np.abs(d))
    n, plus = len(d), ranks[d > 0].sum()
    z = (plus - n * (n + 1) / 4) / math.sqrt(n * (n + 1) * (2 * n + 1) / 24)
    return float(2 * stats.norm.sf(abs(z)))


@pytest.mark.parametrize(
    ("method", "baseline", "mean"),
    [
        ([], [], None),
        ([2.0], [1.0], 1.0),
        ([2.0, 3.0], [1.0, 2.0], 1.0),
        ([1.0] * 9, [1.0] * 9, 0.0),
    ],
)
def test_differences_that_cannot_be_tested(method, baseline, mean):
    found = paired_difference(np.asarray(method), np.asarray(baseline), 0.95)
    assert found.mean == Estimate(mean)
    assert found.p_t is None
    assert found.p_wilcoxon is None


def test_a_baseline_of_zero_has_no_relative_change():
    assert paired_difference(np.asarray([1.0, 2.0]), np.zeros(2), 0.95).relative is None


@pytest.mark.parametrize(
    ("method", "baseline"),
    [([1.0, 2.0], [-3.0, -4.0]), ([-1.0, 2.0], [3.0, 4.0]), ([1.0, 3.0], [-0.1, 9.0])],
)
def test_what_has_a_sign_has_no_relative_change(method, baseline):
    found = paired_difference(np.asarray(method), np.asarray(baseline), 0.95)
    assert found.mean.value == pytest.approx(np.mean(method) - np.mean(baseline))
    assert found.relative is None


@pytest.mark.parametrize(
    "d",
    [
        [1, 2, 2, 3, -1],
        [0, 0, 1, 5, -2, 3, 4],
        [1, 1, 1, 1, -1, 1, 1, -2],
        [0.5, 0.5, -0.25, 0, 7, 7, 7, -7, 1, 2, 3, 4, 5],
        [-3, -3, 1],
    ],
)
def test_few_differences_with_ties_have_the_p_of_all_patterns_of_signs(d):
    difference = np.asarray(d, float)
    found = paired_difference(difference + 10.0, np.full(len(d), 10.0), 0.95)
    assert found.p_wilcoxon == pytest.approx(stats.wilcoxon(difference).pvalue, rel=1e-12)


def test_infinite_values_give_no_difference():
    found = paired_difference(np.asarray([np.inf, 1.0]), np.asarray([1.0, 2.0]), 0.95)
    assert found.mean == Estimate(None)


def four_cells(both: int, gained: int, lost: int, neither: int) -> tuple[np.ndarray, np.ndarray]:
    method = np.repeat([True, True, False, False], [both, gained, lost, neither])
    baseline = np.repeat([True, False, True, False], [both, gained, lost, neither])
    return method, baseline


def test_paired_rates_by_their_formulas():
    found = paired_rates(*four_cells(50, 12, 5, 33), 0.95)
    assert (found.n, found.both, found.method_only, found.baseline_only, found.neither) == (
        100,
        50,
        12,
        5,
        33,
    )
    assert found.difference.value == pytest.approx(0.07)
    z = stats.norm.ppf(0.975)
    total, b, c = 102, 12.5, 5.5
    half = z * math.sqrt((b + c) / total - ((b - c) / total) ** 2) / math.sqrt(total)
    assert found.difference.low == pytest.approx((b - c) / total - half)
    assert found.difference.high == pytest.approx((b - c) / total + half)
    tail = sum(math.comb(17, k) for k in range(6)) / 2**17
    assert found.p_mcnemar == pytest.approx(2 * tail)


def test_paired_rates_of_samples_that_tell_little():
    nothing = paired_rates(*four_cells(0, 0, 0, 0), 0.95)
    assert nothing.difference == Estimate(None)
    assert nothing.p_mcnemar is None
    same = paired_rates(*four_cells(40, 0, 0, 0), 0.95)
    assert same.p_mcnemar == 1.0
    assert same.difference.low < 0.0 < same.difference.high


def test_coverage_of_the_paired_rate_difference():
    rng = np.random.default_rng(6)
    cells = rng.multinomial(200, [0.85, 0.08, 0.03, 0.04], size=1500)
    hits = 0
    for row in cells:
        found = paired_rates(*four_cells(*row), 0.95).difference
        hits += found.low <= 0.05 <= found.high
    assert hits / 1500 > 0.93  # 3.5 standard deviations (0.0056) of the share below 0.95


def test_holm_by_hand():
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])


def test_holm_leaves_out_what_was_not_tested():
    assert holm([None, 0.02, None, 0.03]) == [None, pytest.approx(0.04), None, pytest.approx(0.04)]
    assert holm([]) == []


@given(st.lists(st.floats(0, 1), min_size=1, max_size=20), st.integers(1, 6))
def test_holm_is_between_plain_and_bonferroni(p_values, looks):
    for p, adjusted in zip(p_values, holm(p_values, looks), strict=True):
        assert adjusted is not None
        assert p <= adjusted <= min(1.0, p * len(p_values) * looks) + 1e-12
