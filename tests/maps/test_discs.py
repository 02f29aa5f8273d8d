"""Obstacle discs uniform in a square."""

import numpy as np
import pytest
from scipy.stats import kstest

from usvjax.maps.discs import discs_for_share, outside_circles, uniform_discs

JOBS = np.arange(200)
ENDS = ((0.0, 0.0), (10.0, 10.0))


def test_counts_of_discs_are_nested():
    few, many = (uniform_discs(3, JOBS, n, 0.0, 10.0, ENDS, 0.5) for n in (10, 40))
    for mine, theirs in zip(few, many, strict=True):
        np.testing.assert_array_equal(mine, theirs[:, :10])
    assert 0 < (~many[1]).sum() < 0.1 * many[1].size


def test_discs_are_uniform():
    centres, valid = uniform_discs(0, JOBS, 50, -5.0, 5.0, ((-9.0, 0.0), (9.0, 0.0)), 0.1)
    assert centres.dtype == np.float32
    assert valid.all()
    inside = centres.reshape(-1, 2)
    assert inside.min() >= -5.0
    assert inside.max() <= 5.0
    for axis in (0, 1):
        assert kstest(inside[:, axis], "uniform", args=(-5.0, 10.0)).pvalue > 1e-6


def test_a_circle_through_an_end_holds_it():
    points = np.array([[3.0, 4.0], [3.0, 4.001]])
    assert outside_circles(points, ((0.0, 0.0),), 5.0).tolist() == [False, True]


def test_discs_add_up_to_the_share():
    assert discs_for_share(0.2, 0.0, 10.0, 0.5) == round(20 / (np.pi * 0.25))
    assert np.pi * 0.01**2 * discs_for_share(0.2, 0.0, 10.0, 0.01) == pytest.approx(20, rel=1e-4)
