"""Exact tours and lengths, against all permutations and NumPy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from property_draws import examples
from tour_cases import plain_length, shortest, straight

from usvjax.tours import optimal_tour, solve_tour, tour_length
from usvkernels.status import Status


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize("count", [2, 3, 7])
def test_exact_is_the_best_of_all_orders(count: int, closed: bool) -> None:
    tables = np.random.default_rng(count).random((5, count, count))  # not symmetric
    tables[:, range(count), range(count)] = 0
    order = optimal_tour(distances=tables, closed=closed)
    assert (order[:, 0] == 0).all()
    found = tour_length(order, distances=tables, closed=closed)
    wanted = [shortest(table, closed) for table in tables]
    np.testing.assert_allclose(found, wanted, rtol=2e-6)  # compared in single precision


@examples(25)
@given(st.integers(0, 2**31), st.booleans())
def test_lengths_leg_by_leg(seed: int, closed: bool) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(3, 6, 2)) * 10.0 ** rng.integers(-3, 4)
    order = np.argsort(rng.random((3, 6)), axis=1)
    wanted = [
        plain_length(row.tolist(), straight(p), closed)
        for row, p in zip(order, points, strict=True)
    ]
    np.testing.assert_allclose(tour_length(order, points, closed=closed), wanted, rtol=1e-12)
    one = tour_length(order[1], points[1], closed=closed)
    assert one.shape == ()
    assert one == pytest.approx(wanted[1], rel=1e-12)
    turned = np.roll(order, 2, axis=1)
    if closed:
        np.testing.assert_allclose(tour_length(turned, points), wanted, rtol=1e-12)
    shared = tour_length(order, points[0], closed=closed)
    assert shared[2] == pytest.approx(plain_length(order[2].tolist(), straight(points[0]), closed))


@examples(20)
@given(st.integers(0, 2**31), st.floats(1e-6, 1e9), st.floats(-1e3, 1e3))
def test_the_optimum_does_not_depend_on_unit_or_place(seed: int, unit: float, east: float) -> None:
    points = np.random.default_rng(seed).random((7, 2))
    length = solve_tour(points).length[0]
    moved = solve_tour(unit * (points[:, ::-1] + [east, -east]))
    # Seven legs are compared in single precision, each rounded by 6e-8 of itself: of two tours as
    # near as 1e-6, either may be taken.
    assert moved.length[0] == pytest.approx(unit * length, rel=2e-6)
    mixed = [0, *(1 + np.random.default_rng(seed).permutation(6))]
    assert solve_tour(points[mixed]).length[0] == pytest.approx(length, rel=2e-6)


def ring(count: int) -> np.ndarray:
    """Each station reaches the next only."""
    table = np.full((count, count), np.inf)
    np.fill_diagonal(table, 0)
    table[np.arange(count), (np.arange(count) + 1) % count] = 2.0
    return table


@pytest.mark.parametrize("algorithm", ["exact", "ils"])
def test_missing_legs(algorithm: str) -> None:
    count = 7
    there = solve_tour(distances=ring(count), algorithm=algorithm)
    assert there.order.tolist() == [list(range(count))]
    assert there.length.tolist() == [2.0 * count]
    assert there.status.tolist() == [Status.FOUND]
    broken = ring(count)
    broken[3, 4] = np.inf
    nowhere = solve_tour(distances=broken, algorithm=algorithm)
    assert nowhere.length.tolist() == [np.inf]
    assert (nowhere.history == np.inf).all()
    assert nowhere.status.tolist() == [Status.UNREACHABLE]
    some = optimal_tour(distances=broken)
    assert sorted(some[0]) == list(range(count))
    assert tour_length(some, distances=broken).tolist() == [np.inf]
    # Every station is reached from every other, yet no tour passes each of them once.
    star = np.full((count, count), np.inf)
    star[0, :] = star[:, 0] = 1.0
    np.fill_diagonal(star, 0)
    again = solve_tour(distances=star, algorithm=algorithm)
    assert again.length.tolist() == [np.inf]
    assert again.status.tolist() == [Status.OUT_OF_BUDGET]


@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("closed", [True, False])
def test_two_and_three_stations(count: int, closed: bool) -> None:
    points = np.array([[0.0, 0.0], [9.0, 0.0], [3.0, 4.0]])[:count]
    found = solve_tour(points, closed=closed, runs=2)
    assert found.order.dtype == np.int32
    assert found.length.tolist() == pytest.approx([shortest(straight(points), closed)] * 2)


def test_all_in_one_place_by_distances() -> None:
    found = solve_tour(distances=np.zeros((4, 4)))
    assert found.length.tolist() == [0.0]
    assert found.status.tolist() == [Status.FOUND]
