"""Figures with intervals, as reports write them."""

from dataclasses import asdict
from typing import Any

import numpy as np
from scipy import stats

from usvjax.statistics import Estimate, wilson

LEVEL = 0.95


def mean(values: np.ndarray) -> dict[str, Any]:
    """Mean with its t interval; none where there are fewer than two values, or all equal."""
    if not len(values):
        return asdict(Estimate(None))
    value = float(values.mean())
    if len(values) < 2 or values.max() == values.min():
        return asdict(Estimate(value))
    half = float(stats.t.ppf(0.5 + LEVEL / 2, len(values) - 1) * stats.sem(values))
    return asdict(Estimate(value, value - half, value + half))


def difference(values: np.ndarray) -> dict[str, Any]:
    """Mean of paired differences as `mean`, with "p" of their t-test; None where there is none."""
    found = mean(values)
    known = found["low"] is not None
    return {**found, "p": float(stats.ttest_1samp(values, 0.0).pvalue) if known else None}


def ratio(new: np.ndarray, old: np.ndarray) -> dict[str, Any]:
    """Geometric mean of ratios, pair by pair, with its t interval."""
    found = mean(np.log(new / old))
    return {key: None if log is None else float(np.exp(log)) for key, log in found.items()}


def share(which: np.ndarray) -> dict[str, Any]:
    """Share of the true ones with Wilson's interval."""
    return asdict(wilson(int(which.sum()), len(which), LEVEL))


def rank_p(values: np.ndarray, printed: float, alike: float = 0.0) -> float:
    """Two-sided p of the place that a printed value takes among ours, as one value more.

    If it were drawn as ours were, p would be that small with a probability of p at most, whatever
    the distribution.

    Args:
        values: float[n].
        printed: the value.
        alike: values so near to it count as equal.
    """
    sides = (values <= printed + alike, values >= printed - alike)
    return min(1.0, 2.0 * min(1 + int(side.sum()) for side in sides) / (len(values) + 1))


def least_rank_p(n: int) -> float:
    """The smallest p that `rank_p` can give among n values."""
    return min(1.0, 2.0 / (n + 1))


def spread(values: np.ndarray) -> dict[str, float | None]:
    """Mean, 2.5 and 97.5 % quantiles of values."""
    if not len(values):
        return {"value": None, "low": None, "high": None}
    low, high = np.quantile(values, [0.025, 0.975])
    return {"value": float(values.mean()), "low": float(low), "high": float(high)}
