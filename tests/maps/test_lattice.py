"""Obstacles on lattice points."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from property_draws import examples
from scipy.stats import binomtest

from usvjax.maps import lattice

JOBS = np.arange(200)
ENDS = ((0.0, 0.0), (10.0, 10.0))


def draw(seed=0, jobs=JOBS, radius=0.5, *, rate=0.3, meaning="bernoulli"):
    return lattice.lattice_obstacles(seed, jobs, rate, meaning, 0, 10, ENDS, radius)


def points_of(drawn, row):
    centres, valid = drawn
    return {tuple(map(float, p)) for p in centres[row][valid[row]]}


def test_points_are_integers_without_the_ends():
    everything = {(float(x), float(y)) for x in range(11) for y in range(11)}
    assert points_of(draw(jobs=JOBS[:3], rate=1.0), 0) == everything - set(ENDS)


def test_empty_lattice():
    assert not draw(rate=0.0)[1].any()


def test_bernoulli_rate_is_met_at_every_point():
    drawn = draw(1, np.arange(2000), 0.2)
    count = int(drawn[1].sum())
    interval = binomtest(count, 2000 * 119).proportion_ci(0.9999)
    assert interval.low < 0.3 < interval.high
    hits = sum((5.0, 5.0) in points_of(drawn, i) for i in range(2000))
    assert binomtest(hits, 2000, 0.3).pvalue > 1e-6


@given(rate=st.floats(0, 1), seed=st.integers(0, 2**32 - 1))
@examples(25)
def test_count_is_exact(rate, seed):
    _, valid = draw(seed, JOBS[:20], rate=rate, meaning="count")
    assert (valid.sum(axis=1) == round(rate * 119)).all()


def test_area_counts_circles():
    _, valid = draw(radius=0.7, meaning="area")
    assert (valid.sum(axis=1) == round(30 / (math.pi * 0.49))).all()
    _, full = draw(radius=0.2, rate=0.9, meaning="area")
    assert (full.sum(axis=1) == 119).all()


@pytest.mark.parametrize("meaning", ["bernoulli", "count"])
def test_rates_are_nested_and_radii_share_the_map(meaning):
    low = draw(3, radius=0.5, rate=0.1, meaning=meaning)
    high, same = (draw(3, radius=r, meaning=meaning) for r in (0.2, 0.7))
    for row in range(20):
        assert points_of(low, row) <= points_of(high, row) == points_of(same, row)


def test_a_map_fuller_than_expected_keeps_all_its_obstacles(monkeypatch):
    roomy = draw(9)
    monkeypatch.setattr(lattice, "_OVERFLOW", 0.5)
    monkeypatch.setattr(lattice, "_ROWS", 8)
    tight = draw(9)
    assert tight[0].shape[1] == 121 > roomy[0].shape[1]
    for row in range(len(JOBS)):
        assert points_of(tight, row) == points_of(roomy, row)


def test_rows_are_few_and_fixed():
    assert {draw(seed)[0].shape for seed in range(5)} == {(200, 64, 2)}
