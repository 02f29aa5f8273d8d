"""Stopping early: the schedule, and the coverage that survives it."""

import numpy as np
import pytest
from scipy.stats import binomtest, norm

from usvjax.statistics import Estimate, wilson
from usvjax.study.looks import look_level, look_schedule, narrow_enough, width


def test_looks_double_from_one_shard():
    assert look_schedule(10_000, 2_000, 0.01) == (2_000, 4_000, 8_000, 10_000)
    assert look_schedule(8_000, 2_000, 0.01) == (2_000, 4_000, 8_000)
    assert look_schedule(500, 2_000, 0.01) == (500,)


def test_without_until_there_is_one_look():
    assert look_schedule(10_000, 2_000, None) == (10_000,)
    assert look_level(0.95, 1) == pytest.approx(0.95)


def test_the_level_is_shared_by_the_looks():
    assert look_level(0.95, 5) == pytest.approx(0.99)


def test_every_method_must_be_narrow():
    assert narrow_enough([990, 985], 1000, 0.95, 0.03)
    assert not narrow_enough([990, 500], 1000, 0.95, 0.03)


def test_no_interval_is_infinitely_wide():
    assert width(Estimate(None)) == float("inf")


UNTIL, SHARD, EPISODES, STUDIES = 0.06, 50, 3200, 40_000


def intervals(k: np.ndarray, n: np.ndarray, level: float) -> tuple[np.ndarray, np.ndarray]:
    """Wilson's interval by its formula, for arrays."""
    z = norm.ppf(0.5 + level / 2)
    centre = (k + z * z / 2) / (n + z * z)
    half = z / (n + z * z) * np.sqrt(k * (n - k) / n + z * z / 4)
    return centre - half, centre + half


def stopped_coverage(rate: float, level: float) -> int:
    """How many of the simulated studies stop with an interval that holds the truth."""
    looks = np.asarray(look_schedule(EPISODES, SHARD, UNTIL))
    steps = np.diff(looks, prepend=0)
    rng = np.random.default_rng(1)
    successes = rng.binomial(steps, rate, size=(STUDIES, len(looks))).cumsum(axis=1)
    low, high = intervals(successes, looks, level)
    stops = high - low <= UNTIL
    stops[:, -1] = True
    rows, at = np.arange(STUDIES), stops.argmax(axis=1)
    for row in range(5):
        k, n = int(successes[row, at[row]]), int(looks[at[row]])
        assert wilson(k, n, level).low == pytest.approx(low[row, at[row]], abs=1e-12)
        assert narrow_enough([k], n, level, UNTIL) == (high - low <= UNTIL)[row, at[row]]
    return int(((low <= rate) & (rate <= high))[rows, at].sum())


@pytest.mark.parametrize("rate", [0.005, 0.02, 0.055, 0.065, 0.1, 0.5, 0.85, 0.97])
def test_coverage_holds_where_the_study_stops(rate):
    level = look_level(0.95, len(look_schedule(EPISODES, SHARD, UNTIL)))
    covered = stopped_coverage(rate, level)
    # Not significantly below 95 % (one-sided, at one in a million).
    assert binomtest(covered, STUDIES, 0.95, alternative="less").pvalue > 1e-6


def test_the_correction_is_needed():
    covered = stopped_coverage(0.055, 0.95)
    assert covered / STUDIES < 0.935
