"""Queries of route studies: random maps, charts, and what a job's query may not depend on."""

import jax
import numpy as np
import pytest
from route_ponds import CELL, SHAPE, pond
from scipy import ndimage
from scipy.stats import chisquare

from usvjax.maps import GridMap, random_maps
from usvjax.missions.route.scenes import Chart, GridQueries, RandomQueries

JOBS, MANY = np.arange(40), np.arange(3200)


@pytest.fixture(scope="module", autouse=True)
def one_device():
    """As in a study; every device would compile for itself."""
    with jax.default_device(jax.local_devices()[0]):
        yield


def pond_queries(**changes):
    return Chart(pond(), GridQueries(**{"map": "pond", "min_distance": 200.0, **changes}))


def whole(blocked, cell_size=1.0, **changes):
    """Queries between any free cells of a map."""
    return Chart(GridMap(blocked, cell_size), GridQueries("map", ends="free", **changes))


SOURCES = {
    "free": RandomQueries(SHAPE, 0.3, CELL, "free", 50.0),
    "connected": RandomQueries(SHAPE, 0.45, CELL, "connected", 30.0),
    "harbours": pond_queries(),
    "bodies": pond_queries(ends="connected"),
    "inflated": pond_queries(ends="free", inflate=50.0),
}


def at(queries, row, cell):
    grid = queries.blocked if queries.blocked.ndim == 2 else queries.blocked[row]
    return bool(grid[cell[1], cell[0]])


@pytest.mark.parametrize("name", SOURCES)
def test_queries_end_on_free_cells_that_are_far_enough(name):
    source = SOURCES[name]
    drawn = source.draw(3, JOBS)
    least = (source.spec if isinstance(source, Chart) else source).min_distance
    away = drawn.goals - drawn.starts
    assert (np.hypot(*away.T) * source.cell_size >= least).all()
    for row in JOBS:
        assert not at(drawn, row, drawn.starts[row])
        assert not at(drawn, row, drawn.goals[row])
    assert len({tuple(s) for s in drawn.starts.tolist()}) > 20


@pytest.mark.parametrize("name", SOURCES)
def test_a_query_is_the_same_alone_as_among_others(name):
    among, alone = (SOURCES[name].draw(8, np.asarray(jobs)) for jobs in (JOBS, [31, 7]))
    for field in ("starts", "goals"):
        np.testing.assert_array_equal(getattr(among, field)[[31, 7]], getattr(alone, field))
    if among.blocked.ndim == 3:
        np.testing.assert_array_equal(among.blocked[[31, 7]], alone.blocked)
    again = SOURCES[name].draw(9, np.asarray([31, 7]))
    assert (again.starts != alone.starts).any()


def test_connected_ends_are_joined_and_free_ones_need_not_be():
    for ends, share in (("connected", 1.0), ("free", None)):
        drawn = RandomQueries(SHAPE, 0.45, CELL, ends).draw(0, JOBS)
        joined = []
        for row in JOBS:
            labels = ndimage.label(~drawn.blocked[row])[0]
            (sx, sy), (gx, gy) = drawn.starts[row], drawn.goals[row]
            joined.append(labels[sy, sx] == labels[gy, gx])
        assert np.mean(joined) == share if share else 0.1 < np.mean(joined) < 0.9


def test_harbours_lie_at_the_shore_of_the_largest_water():
    drawn = pond_queries().draw(1, MANY)
    grid = pond().blocked
    near = ndimage.binary_dilation(grid, np.ones((3, 3), bool)) & ~grid
    wanted = {(x, y) for y, x in np.argwhere(near) if x < 12}
    seen = {tuple(c) for c in np.concatenate([drawn.starts, drawn.goals]).tolist()}
    assert seen == wanted


def test_ends_of_bodies_share_their_body_and_both_bodies_occur():
    drawn = SOURCES["bodies"].draw(1, MANY)
    east = drawn.starts[:, 0] > 12
    np.testing.assert_array_equal(east, drawn.goals[:, 0] > 12)
    assert 0 < east.mean() < 0.5


def test_inflated_water_is_narrower_and_land_stays():
    drawn = SOURCES["inflated"].draw(1, JOBS)
    np.testing.assert_array_equal(drawn.land, pond().blocked)
    np.testing.assert_array_equal(drawn.blocked, pond().inflated(50.0).blocked)
    assert drawn.blocked.sum() > drawn.land.sum()


def test_maps_are_those_of_random_maps_and_denser_ones_contain_them():
    thin, thick = (RandomQueries(SHAPE, d).draw(5, JOBS).blocked for d in (0.1, 0.4))
    np.testing.assert_array_equal(thin, random_maps(5, 40, SHAPE, 0.1))
    assert (thick | ~thin).all()


def test_starts_and_goals_are_uniform():
    open_water = whole(np.zeros((4, 4), bool)).draw(2, MANY)
    for cells in (open_water.starts, open_water.goals):
        counts = np.bincount(cells[:, 1] * 4 + cells[:, 0], minlength=16)
        assert chisquare(counts).pvalue > 1e-4
    assert (open_water.starts != open_water.goals).any(axis=1).all()


def test_a_least_distance_of_whole_cells_is_kept_despite_rounding():
    drawn = whole(np.zeros((1, 4), bool), 0.1, min_distance=0.3).draw(0, JOBS)
    assert {tuple(sorted(p)) for p in zip(drawn.starts[:, 0], drawn.goals[:, 0], strict=True)} == {
        (0, 3)
    }
