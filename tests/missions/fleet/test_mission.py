"""Studies of kind "fleet": what they draw, what they measure, what they show and refuse."""

import dataclasses
import math
from functools import partial

import numpy as np
import polars as pl
import pytest
from figure_kinds import check_figure
from scipy import ndimage

import usvjax as uj
from usvjax.errors import BadInputError
from usvjax.mission import Replayed
from usvjax.missions.fleet import mission
from usvjax.missions.fleet.figures import plot_separations, separations, telling_job
from usvjax.missions.fleet.mission import MISSION
from usvjax.missions.fleet.panels import plot_fleets
from usvjax.missions.fleet.scenes import ENCOUNTERS, EncounterTable
from usvjax.study import parse_spec
from usvkernels.status import Status

JOBS = np.arange(300)
PARAMS = {"hull_radius": 20.0, "obstacle_radius": 150.0}


pytestmark = pytest.mark.usefixtures("one_device")


def study(scenes, **changes):
    given = {"name": "met", "kind": "fleet", "seed": 5, "episodes": 6, "scenes": scenes, **changes}
    return parse_spec({"params": PARAMS, **given})


def posed(scenes, jobs=JOBS):
    spec = study(scenes)
    return MISSION.pose(spec.conditions[0].case, spec.seed, jobs)


def closest(scenes):
    """Closest point of the straight courses, m and s, in plain NumPy."""
    place = scenes.starts[:, 1, :2] - scenes.starts[:, 0, :2]
    courses = scenes.starts[..., 2]
    velocity = scenes.speeds[..., None] * np.stack([np.cos(courses), np.sin(courses)], axis=-1)
    relative = velocity[:, 1] - velocity[:, 0]
    time = -(place * relative).sum(axis=1) / (relative**2).sum(axis=1)
    return np.linalg.norm(place + time[:, None] * relative, axis=1), time, relative


@pytest.mark.parametrize("encounter", [*ENCOUNTERS, "any"])
def test_encounters_are_what_they_are_called(encounter):
    table = EncounterTable(encounter=encounter)
    scenes = table.draw(3, JOBS, uj.FleetParams())
    distance, time, relative = closest(scenes)
    radii, closing = scenes.hulls.sum(axis=1), np.linalg.norm(relative, axis=1)
    stopping = (scenes.speeds**2).sum(axis=1) / (2 * uj.FleetParams().v_dec)
    least = np.maximum(table.least_tcpa, table.least_room * (radii + stopping) / closing)
    assert (time > least * (1 - 1e-9)).all()
    assert (time < least * 1.5 * (1 + 1e-9)).all()
    assert np.quantile(distance / radii, [0.25, 0.5, 0.75]) == pytest.approx(
        [0.75, 1.5, 2.25], abs=0.3
    )
    assert (distance <= table.largest_dcpa * radii * (1 + 1e-6)).all()
    for values, (low, high) in ((scenes.hulls, table.hulls), (scenes.speeds, table.speeds)):
        assert low <= values.min() < low + 0.1 * (high - low)
        assert high - 0.1 * (high - low) < values.max() <= high
    turn = np.degrees(np.diff(scenes.starts[..., 2], axis=1)[:, 0])
    off = np.abs((turn + 180) % 360 - 180)
    kinds = np.select([off > 173.9, off > 29.9, off < 15.1], [0, 1, 2], -1)
    counts = [np.count_nonzero(kinds == k) for k in range(3)]
    if encounter == "any":
        assert min(counts) > 70
    else:
        assert counts[ENCOUNTERS.index(encounter)] == len(JOBS)
    behind = kinds == 2
    assert (scenes.speeds[behind, 0] >= 1.25 * scenes.speeds[behind, 1] * (1 - 1e-9)).all()
    from_port = np.sin(np.radians(turn[kinds == 1])) > 0
    assert abs(np.count_nonzero(from_port) - 0.5 * counts[1]) <= 0.15 * counts[1]


def test_goals_of_an_encounter_lie_ahead_and_apart():
    scenes = EncounterTable().draw(3, JOBS, uj.FleetParams())
    _, time, _ = closest(scenes)
    way = scenes.goals - scenes.starts[..., :2]
    bearing = np.arctan2(way[..., 1], way[..., 0])
    off = (bearing - scenes.starts[..., 2] + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(off).max() < 1e-9
    sailing = np.linalg.norm(way, axis=-1) / scenes.speeds
    assert (sailing > time[:, None] + 120 - 1e-6).all()
    apart = np.linalg.norm(np.diff(scenes.goals, axis=1)[:, 0], axis=-1)
    assert (apart > 3 * scenes.hulls.sum(axis=1) + 499).all()


def test_vessels_of_a_swap_change_sides():
    scenes = posed({"source": "swap", "vessels": 5, "radius": 2000.0, "jitter": 0.02}).scenes
    assert np.linalg.norm(scenes.goals, axis=-1) == pytest.approx(2000.0)
    moved = scenes.starts[..., :2] + scenes.goals
    assert 39.0 < np.abs(moved).max() <= 40.0
    assert (scenes.speeds == 0).all()
    spec = study({"source": "swap", "jitter": 0.0}, episodes=1)
    assert spec.conditions[0].case.most_jobs == 1


CROWD = {"source": "crowd", "vessels": 5, "size": 4000.0, "least_distance": 1500.0, "circles": 6}


def assert_crowded(scenes, gap, least, size):
    ends = np.stack([scenes.starts[..., :2], scenes.goals], axis=2)
    way = np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=-1)
    assert least <= way.min() < 1.1 * least
    for k in range(2):
        apart = np.linalg.norm(ends[:, :, None, k] - ends[:, None, :, k], axis=-1)
        assert apart[:, ~np.eye(5, dtype=bool)].min() >= gap
    flat = ends.reshape(len(ends), -1, 2)
    assert (np.ptp(flat, axis=1) <= size).all()


def test_a_crowd_has_room():
    scenes = posed(CROWD).scenes
    assert_crowded(scenes, 2 * 20.0 + uj.FleetParams().passing, 1500.0, 4000.0)
    ends = np.concatenate([scenes.starts[..., :2], scenes.goals], axis=1)
    far = np.linalg.norm(ends[:, :, None] - scenes.water[:, None], axis=-1)
    assert far.min() >= 170.0 + uj.FleetParams().passing - 1e-3
    assert scenes.water.shape == (len(JOBS), 6, 2)


LAKE = {"source": "grid", "map": "hongze-500", "vessels": 5, "size": 12e3, "least_distance": 4e3}


def test_a_crowd_on_a_lake_is_afloat_and_joined():
    scenes = posed(LAKE, np.arange(60)).scenes
    lake = uj.hongze_lake(500)
    assert_crowded(scenes, 2 * 20.0 + uj.FleetParams().passing, 4e3, 12e3 + 500)
    off = 500.0 * ndimage.distance_transform_edt(~lake.blocked)
    water = ndimage.label(off >= 20.0 + 500 * math.sqrt(0.5))[0]
    ends = np.concatenate([scenes.starts[..., :2], scenes.goals], axis=1)
    x, y = np.moveaxis(lake.cells_of(ends), -1, 0)
    assert (off[y, x] >= 20.0 + 500 * math.sqrt(2)).all()
    body = water[y, x].reshape(60, 2, 5)
    assert (body > 0).all()
    assert np.array_equal(body[:, 0], body[:, 1])


@pytest.mark.parametrize("scenes", [CROWD, LAKE, {"source": "swap"}, {}])
def test_scenes_do_not_depend_on_their_company(scenes):
    spec = study(scenes)
    pose = partial(MISSION.pose, spec.conditions[0].case, spec.seed)
    some, alone = pose(np.array([7, 2])).scenes, pose(np.array([2])).scenes
    for name in ("starts", "goals", "speeds", "hulls"):
        values = getattr(some, name)
        assert values is None or np.array_equal(getattr(alone, name)[0], values[1]), name


@pytest.fixture(scope="module")
def crowd():
    return posed(CROWD, np.arange(12))


@pytest.fixture(scope="module")
def sailed(crowd):
    return MISSION.run(crowd, "none", record=True)


def test_columns_are_what_navigate_returns(crowd, sailed):
    scenes, params = crowd.scenes, uj.FleetParams(**PARAMS)
    found = uj.navigate(scenes.water, scenes.starts, scenes.goals, encounters="none", params=params)
    columns = sailed.columns
    assert np.array_equal(columns["status"], found.status)
    for name in ("time", "steps", "min_separation"):
        assert np.array_equal(columns[name], getattr(found, name)), name
    reached = found.status == Status.REACHED
    assert 0 < reached.sum() < 12
    sailing = found.path_length.astype(float)
    assert columns["path_length"] == pytest.approx(sailing.mean(axis=1))
    way = found.route_length.astype(float) - params.goal_tolerance
    over = 100 * (sailing.sum(axis=1) / way.sum(axis=1) - 1)
    assert columns["extra_distance"] == pytest.approx(over, abs=1e-3)
    late = found.arrival_time - way / params.v_max
    assert columns["delay"][reached] == pytest.approx(late.mean(axis=1)[reached], rel=1e-5)
    assert np.isinf(columns["delay"][~reached]).all()
    share = (found.vessel_status == Status.REACHED).mean(axis=1)
    assert columns["arrived"] == pytest.approx(share)
    assert columns["min_clearance"] == pytest.approx(found.min_clearance.min(axis=1))


def test_a_recording_is_each_fleet_with_its_ground(crowd, sailed):
    for row, (track, ground) in enumerate(
        zip(sailed.recording.tracks, sailed.recording.grounds, strict=True)
    ):
        states = sailed.recording.detail[row]
        assert len(track.along) == sailed.columns["steps"][row] + 1
        # The record goes on until all have come to rest.
        assert 0 <= track.along[-1] - sailed.columns["time"][row] < 30
        assert np.array_equal(track.places, states[..., :2])
        assert track.places[0] == pytest.approx(crowd.scenes.starts[row, :, :2], abs=1e-3)
        assert np.array_equal(ground.circles, crowd.scenes.water[row])
        assert ground.radius == 150.0
        now, _ = separations(states, crowd.hulls[row])
        least = sailed.columns["min_separation"][row]
        assert least - 0.01 <= now.min() < least + 10.0


def test_parts_of_a_call_change_nothing(crowd, sailed, monkeypatch):
    monkeypatch.setattr(mission, "ROUTES_AT_ONCE", 5 * 7)
    again = MISSION.run(dataclasses.replace(crowd), "none")
    for name, values in sailed.columns.items():
        assert np.array_equal(again.columns[name], values), name


def test_foreseen_distances_are_those_of_straight_courses():
    rng = np.random.default_rng(1)
    states = rng.uniform(-1, 1, (30, 3, 5)) * [500.0, 500.0, np.pi, 5.0, 0.0]
    hulls = np.array([5.0, 10.0, 15.0])
    now, foreseen = separations(states, hulls)
    times = np.arange(0.0, 4000.0, 0.5)[1:]
    for t, state in enumerate(states):
        course = np.stack([np.cos(state[:, 2]), np.sin(state[:, 2])], axis=-1)
        velocity = state[:, 3, None] * course
        gaps, starts = [], []
        for i in range(3):
            for j in range(i):
                apart = state[i, :2] - state[j, :2]
                moving = apart + times[:, None] * (velocity[i] - velocity[j])
                radii = hulls[i] + hulls[j]
                starts.append(np.hypot(*apart) - radii)
                least = np.hypot(*moving.T)
                if least.argmin() > 0:
                    gaps.append(least.min() - radii)
        assert now[t] == pytest.approx(min(starts))
        assert foreseen[t] == pytest.approx(min(gaps, default=np.nan), abs=2.0, nan_ok=True)


@pytest.fixture(scope="module")
def on_lake():
    spec = study(LAKE)
    (condition,) = spec.conditions
    scene = MISSION.pose(condition.case, spec.seed, np.arange(1))
    found = MISSION.run(scene, "none", record=True)
    case = condition.case
    return Replayed("lake", np.arange(1), "none", case, scene, found.columns, found.recording)


def test_figures_on_a_lake_show_all(on_lake):
    found = dict.fromkeys(("none", "rules", "orca"), on_lake)
    tracks, over_time = plot_fleets(found, "on a lake"), plot_separations(found, "on a lake")
    check_figure(tracks)
    check_figure(over_time)
    assert [ax.get_title().split(":")[0] for ax in tracks.axes] == list(found)
    for ax in tracks.axes:
        assert ax.collections[-1].get_widths() == pytest.approx(40.0)
        assert np.array_equal(
            ax.collections[-1].get_offsets(), on_lake.recording.tracks[0].places[-1]
        )
    least = on_lake.columns["min_separation"][0]
    above = over_time.axes[0].lines[0].get_ydata()
    assert least - 0.1 <= above.min() < least + 10.0


def test_a_film_moves_the_hulls(on_lake):
    film = MISSION.film(on_lake, 0)
    places = on_lake.recording.tracks[0].places
    hulls = film.fig.axes[0].collections[-1]
    for step in (film.steps - 1, 3):
        film.show(step)
        assert np.array_equal(hulls.get_offsets(), places[step])


def test_the_fleet_shown_is_chosen_by_a_rule():
    hit, home = int(Status.COLLIDED), int(Status.REACHED)
    rows = [
        (job, method, status, length)
        for job, ends in enumerate([(hit, home, 9), (hit, hit, 1), (hit, home, 5), (home, home, 2)])
        for method, status, length in (("none", ends[0], 3.0), ("rules", ends[1], float(ends[2])))
    ]
    table = pl.DataFrame(rows, schema=["job", "method", "status", "path_length"], orient="row")
    table = table.with_columns(condition=pl.lit(0))
    assert telling_job(table, ["none", "rules"])[0] == 2
    assert telling_job(table.filter(pl.col("job") > 2), ["none", "rules"])[0] == 3
    assert telling_job(table.filter(pl.col("job") == 1), ["none", "rules"])[0] == 1


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"source": "crwd"}, "unknown source 'crwd'; did you mean 'crowd'"),
        ({"encounter": "crosing"}, "'encounter': got 'crosing'"),
        ({"speeds": [9.0, 3.0]}, "'speeds' must be two numbers above 0"),
        ({"speeds": [9.0, 10.0]}, "'speeds' must reach 1.25 times"),
        ({"hulls": [0.0, 3.0]}, "'hulls' must be two numbers above 0"),
        ({"least_room": 1.0}, "'least_room' must be at least 2"),
        ({"least_tcpa": math.nan}, "'least_tcpa' must be above 0"),
        ({"source": "swap", "vessels": 1}, "'vessels' must be 2 to 256, got 1"),
        ({"source": "swap", "vessels": 200, "radius": 900.0}, "200 starts on a circle of 900 m"),
        ({"source": "swap", "jitter": -0.1}, "'jitter' must be at least 0"),
        ({**CROWD, "vessels": 100, "size": 1600.0}, "100 vessels .* do not fit into a square"),
        ({**CROWD, "size": 1e3}, "'least_distance' of 1500 m must be below 'size'"),
        ({**CROWD, "least_distance": 50.0}, "'least_distance' must exceed 'goal_tolerance'"),
        ({**CROWD, "circles": -1}, "between 0 and 10000 discs"),
        ({**LAKE, "shore_distance": 300.0}, "'shore_distance' must be at least a hull radius"),
        ({**LAKE, "shore_distance": 1e6}, "no water of 'hongze-500' is that far off shore"),
        ({**LAKE, "map": "hongse-500"}, "hongse-500"),
    ],
)
def test_scenes_that_cannot_be_are_refused(changes, words):
    with pytest.raises(BadInputError, match=words):
        study(changes)


def test_parameters_that_cannot_be_are_refused():
    for params, words in (
        ({"hull_radius": -1.0}, "params.hull_radius: got -1; wanted 0 or more"),
        ({"goal_tolerance": 1e6}, "within 'goal_tolerance' of 1e\\+06 m"),
    ):
        with pytest.raises(BadInputError, match=words):
            study({}, params=params)
    with pytest.raises(BadInputError, match=r"static\.horizon"):
        study({}, static={"horizon": 13})
