"""Studies of kind "aggregate": what they draw, what they measure, what they show and refuse."""

import math
from functools import partial

import numpy as np
import pytest
from figure_kinds import check_figure
from scipy import ndimage

import usvjax as uj
from usvjax.errors import BadInputError
from usvjax.mission import Replayed
from usvjax.missions.aggregate.figures import draw_slots, plot_errors
from usvjax.missions.aggregate.measures import formation_errors, heading_errors
from usvjax.missions.aggregate.mission import MISSION
from usvjax.missions.aggregate.params import AggregateParams, AggregateStatic
from usvjax.missions.fleet.panels import plot_fleets
from usvjax.study import parse_spec
from usvkernels.status import Status

pytestmark = pytest.mark.usefixtures("one_device")

JOBS = np.arange(80)
PARAMS = {"hull_radius": 20.0, "obstacle_radius": 150.0}
SQUARE = {"vessels": 3, "size": 5000.0, "least_distance": 1500.0, "circles": 5}
LAKE = {"source": "grid", "map": "hongze-500", "size": 9000.0, "least_distance": 2500.0}


def study(scenes, **changes):
    given = {"name": "met", "kind": "aggregate", "seed": 5, "episodes": 6, "scenes": scenes}
    return parse_spec({"params": PARAMS, **given, **changes})


def posed(scenes, jobs=JOBS, **changes):
    spec = study(scenes, **changes)
    return MISSION.pose(spec.conditions[0].case, spec.seed, jobs)


def along(scenes, length=1852.0):
    """Points of the guide segments, float[J, n, 200, 2], in plain NumPy."""
    bow = np.stack([np.cos(scenes.headings), np.sin(scenes.headings)], axis=-1)
    back = length * np.linspace(0.0, 1.0, 200)[:, None]
    return scenes.goals[:, :, None] - back * bow[:, None, None]


def assert_apart(scenes):
    n = scenes.starts.shape[1]
    apart = np.linalg.norm(scenes.starts[:, :, None, :2] - scenes.starts[:, None, :, :2], axis=-1)
    assert apart[:, ~np.eye(n, dtype=bool)].min() >= 2 * 20.0 + uj.FleetParams().passing
    turned = np.concatenate([scenes.starts[..., 2].ravel(), scenes.headings])
    assert np.abs(turned).max() <= np.pi
    assert np.histogram(turned, 4, (-np.pi, np.pi))[0].min() > 0.15 * turned.size


def test_fleets_begin_anywhere_in_a_square_with_room():
    scenes = posed(SQUARE).scenes
    assert_apart(scenes)
    away = np.linalg.norm(scenes.starts[..., :2], axis=-1)
    assert 1500.0 <= away.min() < 1700.0
    assert 2300.0 < np.abs(scenes.starts[..., :2]).max() <= 2500.0
    assert scenes.water.shape == (80, 5, 2)
    assert 2300.0 < np.abs(scenes.water).max() <= 2500.0
    least = 170.0 + uj.FleetParams().passing
    for places in (scenes.starts[..., :2][:, :, None], along(scenes)):
        off = np.linalg.norm(places[:, :, :, None] - scenes.water[:, None, None], axis=-1)
        assert least - 0.01 <= off.min() < 1.2 * least
    # Slots of a wedge at the default spacing, about the middle.
    assert np.abs(scenes.goals.mean(axis=1)).max() < 1e-9
    spacing = 1.5 * (40.0 + uj.FleetParams().passing)
    assert np.linalg.norm(scenes.goals[:, 1] - scenes.goals[:, 0], axis=-1) == pytest.approx(
        spacing
    )


def test_a_formation_is_as_the_table_has_it():
    given = {"formation": "column", "spacing": 300.0, "heading_deg": 60.0, "assignment": "given"}
    scene = posed({**SQUARE, "circles": 0}, np.arange(3), formation=given)
    assert scene.scenes.water is None
    bow = np.array([0.5, math.sqrt(0.75)])
    places = np.array([300.0, 0.0, -300.0])[:, None] * bow
    assert scene.scenes.goals == pytest.approx(np.broadcast_to(places, (3, 3, 2)))
    assert (scene.musters[0].slot == np.arange(3)).all()
    assert scene.musters[0].slots == pytest.approx(scene.scenes.goals)


def test_fleets_on_a_lake_are_afloat_with_their_guide_segments():
    scenes = posed(LAKE, np.arange(40)).scenes
    assert_apart(scenes)
    lake = uj.hongze_lake(500)
    off = 500.0 * ndimage.distance_transform_edt(~lake.blocked)
    water = ndimage.label(off >= 20.0 + 500 * math.sqrt(0.5))[0]
    away = np.linalg.norm(scenes.starts[..., :2] - scenes.centres[:, None], axis=-1)
    assert 2500.0 <= away.min() < 2800.0
    places = np.concatenate([scenes.starts[:, :, None, :2], along(scenes)], axis=2)
    x, y = np.moveaxis(lake.cells_of(places), -1, 0)
    assert (off[y, x][:, :, 0] >= 20.0 + 500 * math.sqrt(2)).all()
    bodies = water[y, x].reshape(40, -1)
    assert (bodies > 0).all()
    assert (bodies == bodies[:, :1]).all()
    assert len(np.unique(scenes.centres, axis=0)) > 30


@pytest.mark.parametrize("scenes", [SQUARE, LAKE])
def test_scenes_do_not_depend_on_their_company(scenes):
    spec = study(scenes)
    pose = partial(MISSION.pose, spec.conditions[0].case, spec.seed)
    some, alone = pose(np.array([7, 2])).scenes, pose(np.array([2])).scenes
    for name in ("starts", "goals", "centres", "headings"):
        assert np.array_equal(getattr(alone, name)[0], getattr(some, name)[1]), name
    assert np.array_equal(alone.circles(0), some.circles(1))


@pytest.fixture(scope="module")
def gathered():
    scene = posed(SQUARE, np.arange(4))
    return scene, MISSION.run(scene, "none", record=True)


def test_columns_are_what_aggregate_returns(gathered):
    scene, outcome = gathered
    scenes, columns = scene.scenes, outcome.columns
    found = uj.aggregate(
        scenes.water,
        scenes.starts,
        scenes.centres,
        scenes.headings,
        encounters="none",
        params=AggregateParams(**PARAMS),
        static=AggregateStatic(),
        record=True,
    )
    assert np.array_equal(columns["status"], found.status)
    formed = found.status == Status.REACHED
    assert formed.any()
    assert np.array_equal(columns["formed"], formed)
    for name in ("formed_time", "formation_error", "min_separation", "time"):
        assert np.array_equal(columns[name], getattr(found, name)), name
    assert columns["heading_error"] == pytest.approx(
        np.degrees(found.heading_error.max(axis=1)), nan_ok=True
    )
    assert columns["min_clearance"] == pytest.approx(found.min_clearance.min(axis=1))
    assert columns["path_length"] == pytest.approx(found.path_length.mean(axis=1), rel=1e-6)
    for row, (track, ground) in enumerate(
        zip(outcome.recording.tracks, outcome.recording.grounds, strict=True)
    ):
        steps = found.steps[row] + 1
        assert np.array_equal(track.places, found.trajectory[row, :steps, :, :2])
        assert np.array_equal(ground.marks["slot"], found.slots[row])
    # Of the last step of each record: what the result says of its end.
    last = formation_errors(found.trajectory, found.slots)[:, -1]
    assert last == pytest.approx(found.formation_error, abs=2e-3)
    askew = heading_errors(found.trajectory, scenes.headings)[:, -1]
    assert askew[formed] == pytest.approx(found.heading_error.max(axis=1)[formed], abs=1e-5)


def test_errors_over_time_are_the_largest_of_who_is_there():
    rng = np.random.default_rng(3)
    track = rng.uniform(-1, 1, (4, 7, 3, 5)) * [900.0, 900.0, np.pi, 5.0, 1.0]
    slots, heading = rng.uniform(-900, 900, (4, 3, 2)), rng.uniform(-np.pi, np.pi, 4)
    valid = np.array([[True, True, True], [True, False, True], [False, True, True], [True] * 3])
    off, askew = formation_errors(track, slots, valid), heading_errors(track, heading, valid)
    assert off.shape == askew.shape == (4, 7)
    for b in range(4):
        for t in range(7):
            there = [i for i in range(3) if valid[b, i]]
            far = [math.dist(track[b, t, i, :2], slots[b, i]) for i in there]
            turned = [
                math.acos(max(-1.0, min(1.0, math.cos(track[b, t, i, 2] - heading[b]))))
                for i in there
            ]
            assert off[b, t] == pytest.approx(max(far))
            assert askew[b, t] == pytest.approx(max(turned), abs=1e-6)
    assert heading_errors(track, 0.5) == pytest.approx(heading_errors(track, np.full(4, 0.5)))


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda t: formation_errors(t[0], np.zeros((2, 3, 2))), r"^trajectory: got shape"),
        (lambda t: formation_errors(t, np.zeros((3, 3, 2))), r"^slots: got shape \(3, 3, 2\)"),
        (lambda t: heading_errors(t, np.zeros(3)), r"^heading: got shape \(3,\)"),
        (lambda t: heading_errors(t * np.nan, 0.0), r"^trajectory: nan"),
    ],
)
def test_records_of_other_shapes_are_refused(call, says):
    with pytest.raises(BadInputError, match=says):
        call(np.zeros((2, 4, 3, 5)))


def test_figures_show_slots_headings_and_errors(gathered):
    scene, outcome = gathered
    each = Replayed("any", np.arange(4), "rules", None, scene, outcome.columns, outcome.recording)
    found = {"rules": each, "orca": each}
    panels, errors = plot_fleets(found, "gathered", draw_slots), plot_errors(found, "gathered")
    check_figure(panels)
    check_figure(errors)
    bow = np.array([np.cos(scene.scenes.headings[0]), np.sin(scene.scenes.headings[0])])
    for ax in panels.axes:
        arrows = [text for text in ax.texts if text.arrow_patch is not None]
        assert len(arrows) == 3
        for arrow, slot in zip(arrows, outcome.recording.grounds[0].marks["slot"], strict=True):
            assert arrow.xyann == pytest.approx(slot)
            way = np.array(arrow.xy) - slot
            assert way / np.hypot(*way) == pytest.approx(bow)
    off, askew = (ax.lines[0].get_ydata() for ax in errors.axes)
    assert off[-1] == pytest.approx(outcome.columns["formation_error"][0], abs=2e-3)
    assert askew[-1] == pytest.approx(outcome.columns["heading_error"][0], abs=1e-3)
    lines = [ax.lines[-1].get_ydata()[0] for ax in errors.axes]
    assert lines == pytest.approx([10.0, 5.0])


def test_a_film_shows_the_heading_of_its_own_episode(gathered):
    scene, outcome = gathered
    each = Replayed("any", np.arange(4), "none", None, scene, outcome.columns, outcome.recording)
    film = MISSION.film(each, 2)
    film.show(film.steps - 1)
    ax = film.fig.axes[0]
    arrows = [text for text in ax.texts if text.arrow_patch is not None]
    slots = outcome.recording.grounds[2].marks["slot"]
    assert np.array([arrow.xyann for arrow in arrows]) == pytest.approx(slots)
    way = np.array(arrows[0].xy) - slots[0]
    assert np.arctan2(way[1], way[0]) == pytest.approx(scene.scenes.headings[2])
    hulls = next(c for c in reversed(ax.collections) if hasattr(c, "get_widths"))
    assert hulls.get_widths() == pytest.approx(40.0)
    assert np.array_equal(hulls.get_offsets(), outcome.recording.tracks[2].places[-1])


@pytest.mark.parametrize(
    ("scenes", "formation", "words"),
    [
        ({"source": "sqare"}, {}, "unknown source 'sqare'; did you mean 'square'"),
        ({}, {"formation": "wegde"}, "'formation': got 'wegde'; did you mean 'wedge'"),
        ({}, {"assignment": "hungary"}, "'assignment': got 'hungary'"),
        ({}, {"heading_deg": 361.0}, r"'heading_deg' must lie in \[-360, 360\], got 361"),
        ({}, {"heading_deg": math.nan}, r"'heading_deg' must lie in \[-360, 360\], got nan"),
        ({}, {"hold_time": -1.0}, "hold_time: got -1"),
        ({}, {"spacing": 30.0}, r"slots 0 and 1 are 30 m apart; wanted at least 40 m"),
        ({"vessels": 1}, {}, "'vessels' must be 2 to 256, got 1"),
        ({"size": 6e3, "least_distance": 5e3}, {}, "must be below that of a corner of the square"),
        (
            {"size": 400.0, "least_distance": 100.0},
            {},
            "no room for 6 circles beside the formation",
        ),
        (
            {"vessels": 100, "size": 1600.0, "least_distance": 50.0},
            {},
            "100 vessels .* do not fit into a square",
        ),
        ({**LAKE, "shore_distance": 300.0}, {}, "'shore_distance' must be at least a hull radius"),
        ({**LAKE}, {"spacing": 9e4}, "no room for 3 vessels"),
    ],
)
def test_scenes_and_formations_that_cannot_be_are_refused(scenes, formation, words):
    with pytest.raises(BadInputError, match=words):
        study(scenes, formation=formation)
