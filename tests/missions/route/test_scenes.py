"""Scenes of route studies: what they draw, and what a job's query may not depend on."""

import pickle

import numpy as np
import pytest
from grid_oracle import lengths
from route_ponds import CELL, SHAPE, pond, route_study
from scipy import ndimage
from study_fake import study_rows

from usvjax.errors import BadInputError
from usvjax.maps import random_maps, save_map
from usvjax.missions.route.scenes import CellTable, ChartSource, ChartTable
from usvjax.study import parse_spec

JOBS = np.arange(40)


pytestmark = pytest.mark.usefixtures("one_device")


def pond_queries(**changes):
    return ChartSource(pond(), ChartTable(**{"map": "pond", "min_distance": 200.0, **changes}))


SOURCES = {
    "free": CellTable(SHAPE, 0.3, CELL, "free", 50.0),
    "connected": CellTable(SHAPE, 0.45, CELL, "connected", 30.0),
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
    least = (source.table if isinstance(source, ChartSource) else source).min_distance
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
        drawn = CellTable(SHAPE, 0.45, CELL, ends).draw(0, JOBS)
        joined = []
        for row in JOBS:
            labels = ndimage.label(~drawn.blocked[row])[0]
            (sx, sy), (gx, gy) = drawn.starts[row], drawn.goals[row]
            joined.append(labels[sy, sx] == labels[gy, gx])
        assert np.mean(joined) == share if share else 0.1 < np.mean(joined) < 0.9


def test_inflated_water_is_narrower_and_land_stays():
    drawn = SOURCES["inflated"].draw(1, JOBS)
    np.testing.assert_array_equal(drawn.land, pond().blocked)
    np.testing.assert_array_equal(drawn.blocked, pond().inflated(50.0).blocked)
    assert drawn.blocked.sum() > drawn.land.sum()


def test_maps_are_those_of_random_maps_and_denser_ones_contain_them():
    thin, thick = (CellTable(SHAPE, d).draw(5, JOBS).blocked for d in (0.1, 0.4))
    np.testing.assert_array_equal(thin, random_maps(5, 40, SHAPE, 0.1))
    assert (thick | ~thin).all()


@pytest.mark.parametrize("name", SOURCES)
def test_a_source_draws_the_same_in_another_process(name):
    drawn = SOURCES[name].draw(7, JOBS[:3])
    again = pickle.loads(pickle.dumps(SOURCES[name]))
    assert again == SOURCES[name]
    sent = pickle.loads(pickle.dumps(drawn))
    for scenes in (again.draw(7, JOBS[:3]), sent):
        for field in ("blocked", "land", "starts", "goals"):
            np.testing.assert_array_equal(getattr(scenes, field), getattr(drawn, field))


# --- a start and a goal of one's own on a map ---------------------------------------------------

GIVEN = {"map": "pond", "start": (200.0, -100.0), "goal": (500.0, 300.0)}


def test_a_study_between_given_ends_has_one_query(tmp_path):
    save_map(pond(), tmp_path / "pond.map")
    given = {**GIVEN, "source": "grid", "map": "pond.map", "start": [200.0, -100.0]}
    study = route_study(episodes=1, maps={**given, "goal": [500.0, 300.0]})
    row = study_rows(parse_spec(study, folder=tmp_path), "astar", np.arange(1))
    assert row["ratio"].tolist() == [1.0]
    (start, goal), blocked = pond().cells_of([GIVEN["start"], GIVEN["goal"]]), pond().blocked
    shortest = 50.0 * lengths(blocked, goal[None])[start[1], start[0]]
    assert row["path_length"][0] == pytest.approx(shortest, rel=1e-6)
    with pytest.raises(BadInputError, match="'episodes' must be at most 1, as many different ones"):
        parse_spec({**study, "episodes": 2}, folder=tmp_path)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"goal": None}, "'start' is given without 'goal'; wanted both or none"),
        ({"start": None}, "'goal' is given without 'start'"),
        ({"start": (110.0, -190.0)}, r"'start' \(110, -190\) is not on the map's water"),
        ({"start": (160.0, -140.0), "inflate": 50.0}, r"'start' \(160, -140\) is not on the map's"),
        ({"goal": (-1e300, 0.0)}, r"'goal' \(-1e\+300, 0\) is no place in metres"),
        ({"goal": (float("nan"), 0.0)}, "is no place in metres"),
        ({"goal": (210.0, -90.0)}, r"'start' .* and 'goal' \[210\.0, -90\.0\] lie in one cell"),
        ({"ends": "free"}, "'ends' is of what is drawn, but 'start' is given"),
        ({"min_distance": 5.0}, "'min_distance' is of what is drawn"),
    ],
)
def test_given_ends_that_do_not_serve_are_refused(change, words):
    with pytest.raises(BadInputError, match=rf"s\.toml: .*{words}"):
        ChartSource(pond(), ChartTable(**{**GIVEN, **change})).check("s.toml")
