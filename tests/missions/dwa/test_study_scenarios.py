"""Scenario generators: what they draw, and what a job's draw may not depend on."""

import math

import jax
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import binomtest, kstest

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.missions.dwa import scenes as scenarios
from usvjax.missions.dwa.scenes import LatticeMaps, RandomMaps, Scenarios, uniform_fields
from usvjax.missions.dwa.water import GridMaps, Water

JOBS = np.arange(200)


def points_of(drawn: Scenarios, row: int) -> set[tuple[float, float]]:
    return {tuple(map(float, p)) for p in drawn.obstacles[row][drawn.valid[row]]}


def assert_same_job(one: Scenarios, i: int, other: Scenarios, j: int) -> None:
    assert points_of(one, i) == points_of(other, j)
    assert (one.starts[i] == other.starts[j]).all()
    assert (one.goals[i] == other.goals[j]).all()


SOURCES = [
    LatticeMaps(),
    LatticeMaps(rate_meaning="count"),
    LatticeMaps(rate_meaning="area", rate=0.1),
    RandomMaps(number=30),
    RandomMaps(density=0.2),
]


@pytest.mark.parametrize("source", SOURCES, ids=str)
def test_a_job_is_the_same_alone_and_among_others(source):
    among = source.draw(5, JOBS, 0.5)
    alone = source.draw(5, np.asarray([123]), 0.5)
    assert_same_job(among, 123, alone, 0)
    shuffled = source.draw(5, JOBS[::-1].copy(), 0.5)
    assert_same_job(among, 7, shuffled, len(JOBS) - 1 - 7)


@pytest.mark.parametrize("source", SOURCES, ids=str)
def test_jobs_and_seeds_differ(source):
    one, other = source.draw(5, JOBS, 0.5), source.draw(6, JOBS, 0.5)
    assert points_of(one, 0) != points_of(one, 1)
    assert points_of(one, 0) != points_of(other, 0)


def test_the_field_is_that_of_folded_keys():
    key = jax.random.fold_in(jax.random.key(2**32 - 1), 11)
    expected = np.asarray(jax.random.uniform(key, (5,)), np.float64)
    assert (uniform_fields(2**32 - 1, np.asarray([3, 11]), 5)[1] == expected).all()


def test_lattice_points_are_integers_without_start_and_goal():
    drawn = LatticeMaps(rate=1.0).draw(0, JOBS[:3], 0.5)
    everything = {(float(x), float(y)) for x in range(11) for y in range(11)}
    assert points_of(drawn, 0) == everything - {(0.0, 0.0), (10.0, 10.0)}
    assert drawn.starts[0] == pytest.approx([0.0, 0.0, math.pi / 4])
    assert (drawn.goals == [10.0, 10.0]).all()


def test_empty_lattice():
    assert not LatticeMaps(rate=0.0).draw(0, JOBS, 0.5).valid.any()


def test_bernoulli_rate_is_met_at_every_point():
    drawn = LatticeMaps(rate=0.3).draw(1, np.arange(2000), 0.2)
    count = int(drawn.valid.sum())
    interval = binomtest(count, 2000 * 119).proportion_ci(0.9999)
    assert interval.low < 0.3 < interval.high
    hits = sum((5.0, 5.0) in points_of(drawn, i) for i in range(2000))
    assert binomtest(hits, 2000, 0.3).pvalue > 1e-6


@given(rate=st.floats(0, 1), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=25, deadline=None)
def test_count_is_exact(rate, seed):
    drawn = LatticeMaps(rate=rate, rate_meaning="count").draw(seed, JOBS[:20], 0.5)
    assert (drawn.valid.sum(axis=1) == round(rate * 119)).all()


def test_area_counts_circles():
    drawn = LatticeMaps(rate=0.3, rate_meaning="area").draw(0, JOBS, 0.7)
    assert (drawn.valid.sum(axis=1) == round(30 / (math.pi * 0.49))).all()
    full = LatticeMaps(rate=0.9, rate_meaning="area").draw(0, JOBS, 0.2)
    assert (full.valid.sum(axis=1) == 119).all()


@pytest.mark.parametrize("meaning", ["bernoulli", "count"])
def test_rates_are_nested_and_radii_share_the_map(meaning):
    low = LatticeMaps(rate=0.1, rate_meaning=meaning).draw(3, JOBS, 0.5)
    high = LatticeMaps(rate=0.3, rate_meaning=meaning).draw(3, JOBS, 0.2)
    same = LatticeMaps(rate=0.3, rate_meaning=meaning).draw(3, JOBS, 0.7)
    for row in range(20):
        assert points_of(low, row) <= points_of(high, row) == points_of(same, row)


def test_counts_of_discs_are_nested():
    few, many = (RandomMaps(number=n).draw(3, JOBS, 0.5) for n in (10, 40))
    assert all(points_of(few, row) <= points_of(many, row) for row in range(20))


@pytest.mark.parametrize("source", [LatticeMaps(rate=0.5), RandomMaps(number=200)], ids=str)
def test_start_and_goal_are_outside_every_circle(source):
    drawn = source.draw(4, JOBS, 1.5)
    for end in (drawn.starts[0, :2], drawn.goals[0]):
        distance = np.hypot(*np.moveaxis(drawn.obstacles - end, -1, 0))
        assert distance[drawn.valid].min() > 1.5 - 1e-6


@pytest.mark.parametrize(
    ("source", "radius", "words"),
    [
        (LatticeMaps(rate_meaning="area"), 0.0, "wanted a radius above 0"),
        (RandomMaps(density=0.1), 0.0, "'density' counts areas; wanted a radius above 0"),
        (LatticeMaps(rate_meaning="area"), 1e-200, "'rate_meaning' counts areas; wanted a radius"),
        (RandomMaps(density=0.1), 1e-200, "a radius above 0 in single precision, got 1e-200"),
        (RandomMaps(density=1.0), 1e-160, "a radius above 0 in single precision, got 1e-160"),
        (RandomMaps(density=1.0), 1e-40, r"discs are possible, got 3.1831e\+81 of radius 1e-40 m"),
    ],
    ids=str,
)
def test_circles_too_small_to_count_are_refused(source, radius, words):
    with pytest.raises(BadInputError, match=words):
        source.check(radius, "study.toml")


def test_all_points_are_the_most_that_an_area_can_want():
    tiny = LatticeMaps(rate_meaning="area")
    tiny.check(1e-40, "study.toml")
    assert (tiny.draw(0, JOBS[:2], 1e-40).valid.sum(axis=1) == 119).all()


def test_a_map_fuller_than_expected_keeps_all_its_obstacles(monkeypatch):
    roomy = LatticeMaps(rate=0.3).draw(9, JOBS, 0.5)
    monkeypatch.setattr(scenarios, "_OVERFLOW", 0.5)
    monkeypatch.setattr(scenarios, "_ROWS", 8)
    tight = LatticeMaps(rate=0.3).draw(9, JOBS, 0.5)
    assert tight.obstacles.shape[1] == 121 > roomy.obstacles.shape[1]
    for row in range(len(JOBS)):
        assert points_of(tight, row) == points_of(roomy, row)


def test_rows_are_few_and_fixed():
    shapes = {LatticeMaps(rate=0.3).draw(s, JOBS, 0.5).obstacles.shape for s in range(5)}
    assert shapes == {(200, 64, 2)}


def test_discs_are_uniform():
    drawn = RandomMaps(number=50, lo=-5.0, hi=5.0, start=(-9, 0), goal=(9, 0)).draw(0, JOBS, 0.1)
    inside = drawn.obstacles.reshape(-1, 2)
    assert inside.min() >= -5.0
    assert inside.max() <= 5.0
    for axis in (0, 1):
        assert kstest(inside[:, axis], "uniform", args=(-5.0, 10.0)).pvalue > 1e-6


def pond() -> GridMap:
    """Two basins with a wall of three columns between them."""
    blocked = np.zeros((60, 83), bool)
    blocked[[0, -1], :] = blocked[:, [0, -1]] = True
    blocked[:, 40:43] = True
    return GridMap(blocked, cell_size=50.0, origin=(1000.0, -500.0))


POND = GridMaps(map="pond", min_clearance=120.0, distance=(500.0, 1200.0))


def test_ends_lie_on_connected_water_off_the_shore():
    water = Water(pond(), POND)
    drawn = water.draw(0, np.arange(300), 50.0)
    assert drawn.obstacles is water.grid
    body, clear = water.grid.components(), water.grid.clearance()
    cells = [water.grid.cells_of(ends) for ends in (drawn.starts[:, :2], drawn.goals)]
    bodies = [body[c[:, 1], c[:, 0]] for c in cells]
    assert (bodies[0] == bodies[1]).all()
    assert set(bodies[0]) == {1, 2}
    for c in cells:
        assert clear[c[:, 1], c[:, 0]].min() >= 120.0
    along = drawn.goals - drawn.starts[:, :2]
    distance = np.hypot(*along.T)
    assert distance.min() >= 500.0
    assert distance.max() <= 1200.0
    assert np.std(distance) > 100.0
    assert np.cos(drawn.starts[:, 2]) == pytest.approx(along[:, 0] / distance)
    assert np.sin(drawn.starts[:, 2]) == pytest.approx(along[:, 1] / distance)


def test_a_job_on_water_is_the_same_alone():
    water = Water(pond(), POND)
    among, alone = water.draw(8, np.arange(200), 50.0), water.draw(8, np.asarray([150]), 50.0)
    assert (among.starts[150] == alone.starts[0]).all()
    assert (among.goals[150] == alone.goals[0]).all()


def test_a_job_that_needs_many_rounds_is_the_same_alone():
    # Only the length of a basin is this great, so most starts have no goal and are drawn again.
    tight = GridMaps(map="pond", min_clearance=120.0, distance=(2400.0, 2500.0))
    water = Water(pond(), tight)
    among, alone = water.draw(8, np.arange(50), 50.0), water.draw(8, np.asarray([31]), 50.0)
    assert (among.starts[31] == alone.starts[0]).all()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"distance": (0.0, 100.0)}, "'distance' must be"),
        ({"distance": (300.0, 200.0)}, "'distance' must be"),
        ({"distance": (100.0, math.inf)}, "'distance' must be"),
        ({"min_clearance": 40.0}, "must exceed the radius"),
        ({"radius": 30.0}, "leave gaps between blocked cells of 50 m"),
        ({"min_clearance": math.nan}, "must exceed the radius"),
        ({"min_clearance": 5000.0}, "no water of 'pond' is 5000 m"),
        ({"distance": (9000.0, 9100.0)}, "no start and goal 9000 to 9100 m apart"),
    ],
)
def test_impossible_water_is_refused(change, words, monkeypatch):
    monkeypatch.setattr("usvjax.missions.dwa.water.ROUNDS", 5)
    radius = change.pop("radius", 50.0)
    spec = GridMaps(**{"map": "pond", "min_clearance": 120.0, "distance": (500.0, 900.0), **change})
    with pytest.raises(BadInputError, match=words):
        Water(pond(), spec).check(radius, "study.toml")
