"""Starts and goals on water."""

import math

import numpy as np
import pytest
from route_ponds import pond
from scipy import ndimage
from scipy.stats import chisquare

from usvjax.errors import BadInputError
from usvjax.maps.chart import cells_where, off_shore
from usvjax.maps.ends import draw_ends, draw_pairs, end_groups, facing, fixed_ends

JOBS, MANY = np.arange(40), np.arange(3200)


pytestmark = pytest.mark.usefixtures("one_device")


def pairs(seed, jobs, distance):
    """Pairs on the pond, 100 m or more off the shore."""
    wet = off_shore(pond(), 100.0)
    bodies = np.where(wet, pond().components(), 0)
    where = (pond(), bodies, cells_where(bodies > 0), distance)
    return draw_pairs(seed, jobs, *where, "the pond", "water off the shore")


def ends_of(blocked, jobs, seed=2, kind="free", least=0.0):
    return draw_ends(seed, jobs, end_groups(blocked[None], kind), least, "the map")


def test_a_fixed_end_is_every_jobs():
    starts, goals = fixed_ends((1.0, 2.0), (4.0, 6.0), None, 3)
    assert (starts == [1.0, 2.0, math.atan2(4.0, 3.0)]).all()
    assert starts.shape == (3, 3)
    assert (goals == [[4.0, 6.0]] * 3).all()
    assert (fixed_ends((1.0, 2.0), (4.0, 6.0), 0.5, 3)[0][:, 2] == 0.5).all()


def test_a_start_faces_its_goal():
    starts = facing(np.array([[0.0, 0.0], [5.0, 5.0]]), np.array([[0.0, 2.0], [4.0, 5.0]]))
    np.testing.assert_allclose(starts, [[0.0, 0.0, math.pi / 2], [5.0, 5.0, math.pi]])


def test_pairs_lie_within_the_range_on_one_body_of_water():
    starts, goals = pairs(0, np.arange(300), (120.0, 300.0))
    body, clear = pond().components(), pond().clearance()
    cells = [pond().cells_of(ends) for ends in (starts, goals)]
    bodies = [body[c[:, 1], c[:, 0]] for c in cells]
    assert (bodies[0] == bodies[1]).all()
    assert set(bodies[0]) == {1, 2}
    for c in cells:
        assert clear[c[:, 1], c[:, 0]].min() >= 100.0
    distance = np.hypot(*(goals - starts).T)
    assert distance.min() >= 120.0
    assert distance.max() <= 300.0
    assert np.std(distance) > 30.0


@pytest.mark.parametrize("distance", [(120.0, 300.0), (520.0, 560.0)], ids=["easy", "hard"])
def test_a_pair_is_the_same_alone_as_among_others(distance):
    # 520 m is nearly the length of the larger body, so most starts have no goal at first.
    among, alone = pairs(8, JOBS, distance), pairs(8, np.asarray([31, 7]), distance)
    for many, few in zip(among, alone, strict=True):
        np.testing.assert_array_equal(many[[31, 7]], few)


def test_no_pair_is_a_clear_message(monkeypatch):
    monkeypatch.setattr("usvjax.maps.ends.PAIR_ROUNDS", 5)
    words = r"the pond has no start and goal 900 to 950 m apart on connected water off the shore "
    with pytest.raises(BadInputError, match=words + r"\(job 3 found none in 5 rounds\)"):
        pairs(0, np.asarray([3, 4]), (900.0, 950.0))


def test_harbours_lie_at_the_shore_of_the_largest_water():
    grid = pond().blocked
    drawn = ends_of(grid, MANY, 1, "harbours", 4.0)
    near = ndimage.binary_dilation(grid, np.ones((3, 3), bool)) & ~grid
    wanted = {(x, y) for y, x in np.argwhere(near) if x < 12}
    assert {tuple(c) for c in np.concatenate(drawn).tolist()} == wanted


def test_connected_ends_share_their_body_and_both_bodies_occur():
    starts, goals = ends_of(pond().blocked, MANY, 1, "connected", 4.0)
    east = starts[:, 0] > 12
    np.testing.assert_array_equal(east, goals[:, 0] > 12)
    assert 0 < east.mean() < 0.5


def test_bodies_of_different_maps_are_not_joined():
    open_maps = np.zeros((3, 4, 5), bool)
    assert len(np.unique(end_groups(open_maps, "connected"))) == 3


def test_starts_and_goals_are_uniform():
    starts, goals = ends_of(np.zeros((4, 4), bool), MANY)
    for cells in (starts, goals):
        counts = np.bincount(cells[:, 1] * 4 + cells[:, 0], minlength=16)
        assert chisquare(counts).pvalue > 1e-4
    assert (starts != goals).any(axis=1).all()


def test_a_least_distance_of_whole_cells_is_kept_despite_rounding():
    starts, goals = ends_of(np.zeros((1, 4), bool), JOBS, least=0.3 / 0.1)
    assert {tuple(sorted(p)) for p in zip(starts[:, 0], goals[:, 0], strict=True)} == {(0, 3)}


def test_no_ends_are_a_clear_message(monkeypatch):
    monkeypatch.setattr("usvjax.maps.ends.CELL_ROUNDS", 3)
    with pytest.raises(BadInputError, match=r"the map has no start and goal 4 cells apart.*job 5"):
        ends_of(np.zeros((1, 4), bool), np.asarray([5, 6]), least=4.0)


def test_the_last_round_may_serve_the_last_job(monkeypatch):
    monkeypatch.setattr("usvjax.maps.ends.CELL_ROUNDS", 1)
    starts, _ = ends_of(np.zeros((4, 4), bool), JOBS)
    assert len(starts) == len(JOBS)
