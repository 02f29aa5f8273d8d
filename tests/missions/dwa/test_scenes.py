"""Scenes of DWA episodes: what they draw, and what a job's draw may not depend on."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from usvjax.errors import BadInputError
from usvjax.maps import GridMap, save_map
from usvjax.missions.dwa.scenes import ChartSource, ChartTable, DiscTable, DwaScenes, LatticeTable
from usvjax.study import parse_spec

JOBS = np.arange(200)


def points_of(drawn: DwaScenes, row: int) -> set[tuple[float, float]]:
    return {tuple(map(float, p)) for p in drawn.obstacles[row][drawn.valid[row]]}


def assert_same_job(one: DwaScenes, i: int, other: DwaScenes, j: int) -> None:
    assert points_of(one, i) == points_of(other, j)
    assert (one.starts[i] == other.starts[j]).all()
    assert (one.goals[i] == other.goals[j]).all()


SOURCES = [
    LatticeTable(),
    LatticeTable(rate_meaning="count"),
    LatticeTable(rate_meaning="area", rate=0.1),
    DiscTable(number=30),
    DiscTable(density=0.2),
    LatticeTable(start_jitter=0.001),
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


def test_a_start_heads_for_the_goal():
    drawn = LatticeTable().draw(0, JOBS[:3], 0.5)
    assert drawn.starts[0] == pytest.approx([0.0, 0.0, math.pi / 4])
    assert (drawn.goals == [10.0, 10.0]).all()


@pytest.mark.parametrize("source", [LatticeTable(rate=0.5), DiscTable(number=200)], ids=str)
def test_start_and_goal_are_outside_every_circle(source):
    drawn = source.draw(4, JOBS, 1.5)
    for end in (drawn.starts[0, :2], drawn.goals[0]):
        distance = np.hypot(*np.moveaxis(drawn.obstacles - end, -1, 0))
        assert distance[drawn.valid].min() > 1.5 - 1e-6


@pytest.mark.parametrize(
    ("source", "radius", "words"),
    [
        (LatticeTable(rate_meaning="area"), 0.0, "wanted a radius above 0"),
        (DiscTable(density=0.1), 0.0, "'density' counts areas; wanted a radius above 0"),
        (LatticeTable(rate_meaning="area"), 1e-200, "'rate_meaning' counts areas; wanted a radius"),
        (DiscTable(density=0.1), 1e-200, "a radius above 0 in single precision, got 1e-200"),
        (DiscTable(density=1.0), 1e-160, "a radius above 0 in single precision, got 1e-160"),
        (DiscTable(density=1.0), 1e-40, r"discs are possible, got 3.1831e\+81 of radius 1e-40 m"),
    ],
    ids=str,
)
def test_circles_too_small_to_count_are_refused(source, radius, words):
    with pytest.raises(BadInputError, match=words):
        source.check(radius, "study.toml")


def test_all_points_are_the_most_that_an_area_can_want():
    tiny = LatticeTable(rate_meaning="area")
    tiny.check(1e-40, "study.toml")
    assert (tiny.draw(0, JOBS[:2], 1e-40).valid.sum(axis=1) == 119).all()


def pond() -> GridMap:
    """Two basins with a wall of three columns between them."""
    blocked = np.zeros((60, 83), bool)
    blocked[[0, -1], :] = blocked[:, [0, -1]] = True
    blocked[:, 40:43] = True
    return GridMap(blocked, cell_size=50.0, origin=(1000.0, -500.0))


POND = ChartTable(map="pond", shore_distance=120.0, distance=(500.0, 1200.0))


def test_ends_lie_on_connected_water_off_the_shore():
    water = ChartSource(pond(), POND)
    drawn = water.draw(0, np.arange(300), 50.0)
    assert drawn.obstacles is water.chart
    body, clear = water.chart.components(), water.chart.clearance()
    cells = [water.chart.cells_of(ends) for ends in (drawn.starts[:, :2], drawn.goals)]
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
    water = ChartSource(pond(), POND)
    among, alone = water.draw(8, np.arange(200), 50.0), water.draw(8, np.asarray([150]), 50.0)
    assert (among.starts[150] == alone.starts[0]).all()
    assert (among.goals[150] == alone.goals[0]).all()


def test_a_job_that_needs_many_rounds_is_the_same_alone():
    # Only the length of a basin is this great, so most starts have no goal and are drawn again.
    tight = ChartTable(map="pond", shore_distance=120.0, distance=(2400.0, 2500.0))
    water = ChartSource(pond(), tight)
    among, alone = water.draw(8, np.arange(50), 50.0), water.draw(8, np.asarray([31]), 50.0)
    assert (among.starts[31] == alone.starts[0]).all()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"distance": (0.0, 100.0)}, "'distance' must be"),
        ({"distance": (300.0, 200.0)}, "'distance' must be"),
        ({"distance": (100.0, math.inf)}, "'distance' must be"),
        ({"shore_distance": 40.0}, "must exceed the radius"),
        ({"radius": 30.0}, "leave gaps between blocked cells of 50 m"),
        ({"shore_distance": math.nan}, "must exceed the radius"),
        ({"shore_distance": 5000.0}, "no water of 'pond' is 5000 m"),
        ({"distance": (9000.0, 9100.0)}, "no start and goal 9000 to 9100 m apart"),
    ],
)
def test_impossible_water_is_refused(change, words, monkeypatch):
    monkeypatch.setattr("usvjax.maps.ends.PAIR_ROUNDS", 5)
    radius = change.pop("radius", 50.0)
    given = {"map": "pond", "shore_distance": 120.0, "distance": (500.0, 900.0), **change}
    with pytest.raises(BadInputError, match=words):
        ChartSource(pond(), ChartTable(**given)).check(radius, "study.toml")


@pytest.mark.parametrize("source", [*SOURCES, ChartSource(pond(), POND)], ids=str)
def test_a_source_draws_the_same_in_another_process(source):
    drawn = source.draw(7, JOBS[:5], 50.0)
    again = pickle.loads(pickle.dumps(source))
    assert again == source
    sent = pickle.loads(pickle.dumps(drawn))
    for scenes in (again.draw(7, JOBS[:5], 50.0), sent):
        np.testing.assert_array_equal(scenes.starts, drawn.starts)
        np.testing.assert_array_equal(scenes.goals, drawn.goals)
        np.testing.assert_array_equal(scenes.valid, drawn.valid)
        assert np.all(scenes.obstacles == drawn.obstacles)


# --- a start and a goal of one's own on a map ---------------------------------------------------

GIVEN = {"map": "pond", "start": (1200.0, -300.0), "goal": (2200.0, 900.0)}


def given(**changes) -> ChartSource:
    return ChartSource(pond(), ChartTable(**{**GIVEN, **changes}))


def test_given_ends_are_those_of_the_only_job():
    source = given()
    source.check(50.0, "s.toml")
    source.check_outside_goal(1500.0, "s.toml")
    assert source.most_jobs == 1
    drawn = source.draw(3, np.arange(1), 50.0)
    assert drawn.obstacles is source.chart
    assert drawn.starts.tolist() == [[1200.0, -300.0, math.atan2(1200.0, 1000.0)]]
    assert drawn.goals.tolist() == [[2200.0, 900.0]]
    turned = given(start_heading=-1.0).draw(3, np.arange(1), 50.0)
    assert turned.starts.tolist() == [[1200.0, -300.0, -1.0]]
    assert ChartSource(pond(), POND).most_jobs is None


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"goal": None}, "'start' is given without 'goal'; wanted both or none"),
        ({"start": None}, "'goal' is given without 'start'"),
        ({"start": None, "goal": None, "start_heading": 1.0}, "'start_heading' goes with 'start'"),
        ({"start": (1010.0, -190.0)}, r"'start' \(1010, -190\) is not on the map's water"),
        ({"goal": (3050.0, 100.0)}, r"'goal' \(3050, 100\) is not on the map's water"),
        ({"goal": (-5e3, 0.0)}, r"'goal' \(-5000, 0\) is not on the map's water"),
        ({"goal": (1e300, 0.0)}, r"'goal' \(1e\+300, 0\) is no place in metres"),
        ({"goal": (math.nan, 0.0)}, "must be finite"),
        ({"start_heading": math.inf}, "must be finite"),
        ({"goal": (1200.0, -300.0)}, "are the same point"),
        (
            {"goal": (4000.0, 300.0)},
            r"no water joins 'goal' \(4000, 300\) to 'start' \(1200, -300\)",
        ),
        ({"distance": (1.0, 2.0)}, "'distance' is of what is drawn, but 'start' is given"),
        ({"shore_distance": 120.0}, "'shore_distance' is of what is drawn"),
    ],
)
def test_given_ends_that_do_not_serve_are_refused(change, words):
    with pytest.raises(BadInputError, match=rf"s\.toml: .*{words}"):
        given(**change).check(50.0, "s.toml")


def test_a_given_start_within_the_tolerance_of_its_goal_is_refused():
    with pytest.raises(BadInputError, match=r"'start' .* lies 1562\.05 m from 'goal'"):
        given().check_outside_goal(1563.0, "s.toml")


def test_a_study_between_given_ends_is_checked_before_it_runs(tmp_path):
    save_map(pond(), tmp_path / "pond.map")
    maps = {"source": "grid", "map": "pond.map", "start": [1200.0, -300.0], "goal": [2200.0, 900.0]}
    study = {
        "name": "mine",
        "kind": "dwa",
        "episodes": 1,
        "maps": maps,
        "params": {"preset": "lake", "radius": 40.0},
    }
    spec = parse_spec(study, folder=tmp_path)
    assert spec.conditions[0].case.settings["maps"]["distance"] is None
    with pytest.raises(BadInputError, match="'episodes' must be at most 1, as many different ones"):
        parse_spec({**study, "episodes": 2}, folder=tmp_path)
    inside = {**study, "maps": {**maps, "start": [1055.0, -300.0]}}
    with pytest.raises(BadInputError, match=r"\[maps\]: starts: .* inside the obstacle at"):
        parse_spec(inside, folder=tmp_path)


KINDS = {
    "lattice": lambda jitter: LatticeTable(start_jitter=jitter),
    "discs": lambda jitter: DiscTable(number=5, start_heading=3.0, start_jitter=jitter),
    "drawn": lambda jitter: ChartSource(pond(), replace(POND, start_jitter=jitter)),
    "given": lambda jitter: given(start_jitter=jitter),
}


@pytest.mark.parametrize("jittered", KINDS.values(), ids=KINDS)
def test_jitter_turns_each_heading_by_a_draw_of_its_own_and_moves_nothing(jittered):
    straight, turned = (jittered(by).draw(3, JOBS, 50.0) for by in (0.0, 0.2))
    turns = turned.starts[:, 2] - straight.starts[:, 2]
    assert np.abs(turns).max() <= 0.2
    assert len(np.unique(turns)) == len(JOBS)
    # Of 200 uniform draws; the bounds are five standard errors off.
    assert abs(turns.mean()) < 0.04
    assert turns.std() == pytest.approx(0.2 / math.sqrt(3), rel=0.2)
    np.testing.assert_array_equal(turned.starts[:, :2], straight.starts[:, :2])
    np.testing.assert_array_equal(turned.goals, straight.goals)
    if turned.valid is not None:
        np.testing.assert_array_equal(turned.obstacles, straight.obstacles)
    half = jittered(0.1).draw(3, JOBS, 50.0).starts[:, 2] - straight.starts[:, 2]
    np.testing.assert_allclose(half, turns / 2, atol=1e-12)
    others = [jittered(by).draw(4, JOBS, 50.0).starts[:, 2] for by in (0.0, 0.2)]
    assert (np.abs(others[1] - others[0] - turns) > 1e-9).all()


@pytest.mark.parametrize("jittered", KINDS.values(), ids=KINDS)
@pytest.mark.parametrize("jitter", [-0.1, 3.2, math.nan, math.inf])
def test_a_jitter_that_is_no_angle_is_refused(jittered, jitter):
    words = r"^s.toml: 'start_jitter' must lie in \[0, pi\] rad, got"
    with pytest.raises(BadInputError, match=words):
        jittered(jitter).check(50.0, "s.toml")


def test_jitter_makes_many_episodes_of_two_given_ends():
    assert given(start_jitter=0.1).most_jobs is None
