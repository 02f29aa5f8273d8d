"""Corners turned into arcs: sailable, on course, clear of blocked cells, and as short as Dubins."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from path_cases import islands, packed, routes, shortest_path
from property_draws import examples

from benchmarks.turning_corners import (
    BOUNDS,
    RADIUS,
    CornerScenes,
    check,
    random_corners,
    smooth,
)
from usvjax.errors import BadInputError
from usvjax.paths.smoothing import key_points
from usvjax.paths.turns import SmoothTurns, smooth_turns
from usvkernels.paths.turning import Turn

OPEN = np.zeros((128, 128), bool)
SPACING = 0.5  # m, of `smooth`


def wrapped(angle: np.ndarray | float) -> np.ndarray:
    return (np.asarray(angle) + np.pi) % (2 * np.pi) - np.pi


def one_turn(angle: float, blocked: np.ndarray = OPEN, **options: object) -> SmoothTurns:
    """A corner at (64, 64) with 50 m before and after it, coming from the west."""
    corner = np.array([64.0, 64.0])
    ahead = np.array([np.cos(angle), np.sin(angle)])
    path = np.stack([corner - [50, 0], corner, corner + 50 * ahead])
    options = {"turning_radius": 5.0, **options}
    return smooth_turns(path[None], None, blocked, **options)  # type: ignore[arg-type]


def wall(*boxes: tuple[float, float, float, float]) -> np.ndarray:
    """A map with blocked boxes (x0, x1, y0, y1), in cells from the corner at (64, 64)."""
    y, x = np.mgrid[:128, :128] + 0.5 - 64
    blocked = np.zeros((128, 128), bool)
    for x0, x1, y0, y1 in boxes:
        blocked |= (x > x0) & (x < x1) & (y > y0) & (y < y1)
    return blocked


# --- many random corners ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def corners() -> tuple[CornerScenes, SmoothTurns]:
    """500 random corners, smoothed."""
    scenes = random_corners(500, seed=1)
    return scenes, smooth(scenes)


def test_random_corners_are_sailable(corners: tuple[CornerScenes, SmoothTurns]) -> None:
    scenes, found = corners
    worst = check(scenes, found)
    assert worst["curvature"] <= 1
    assert worst["hits"] == 0
    for name, bound in BOUNDS.items():
        assert worst[name] <= bound, name
    cases = {turn: int((found.turns == turn).sum()) for turn in Turn}
    assert cases[Turn.NONE] == 0
    assert all(cases[turn] >= 10 for turn in (Turn.INSIDE, Turn.LATE, Turn.EARLY))
    assert cases[Turn.INSIDE] > 150
    assert (found.fitted == (found.turns != Turn.UNFITTED).all(axis=1)).all()


def test_samples_lie_on_the_pieces_and_bend_no_more(
    corners: tuple[CornerScenes, SmoothTurns],
) -> None:
    _, found = corners
    for row in np.flatnonzero(found.fitted):
        points = found.points[row, : found.counts[row]]
        steps = np.diff(points, axis=0)
        length = np.linalg.norm(steps, axis=1)
        assert length.sum() == pytest.approx(found.length[row], rel=1e-4)
        assert (length[:-1] <= SPACING + 1e-3).all()
        course = np.arctan2(steps[:-1, 1], steps[:-1, 0])
        # Single precision moves a sample by some 1e-5 m, and with it the chord's course.
        assert np.abs(wrapped(np.diff(course))).max() <= SPACING / RADIUS + 2e-4
        heading = found.heading[row, : len(course)]
        assert np.abs(wrapped(course - heading)).max() <= SPACING / RADIUS / 2 + 1e-4
        assert np.abs(found.curvature[row]).max() * RADIUS <= 1


def test_pieces_add_up(corners: tuple[CornerScenes, SmoothTurns]) -> None:
    _, found = corners
    pieces = found.pieces
    assert np.allclose(pieces.length.sum(axis=1), found.length, rtol=1e-6)
    arcs = pieces.curvature != 0
    assert (pieces.radius[arcs & pieces.valid] >= RADIUS).all()
    bearing = pieces.heading - np.sign(pieces.curvature) * np.pi / 2
    out = np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)
    from_centre = pieces.centre + pieces.radius[..., None] * out
    assert np.allclose(from_centre[arcs], pieces.start[arcs], rtol=1e-5, atol=1e-2)
    swept = np.abs(np.where(pieces.valid, pieces.sweep, 0)).sum(axis=1)
    assert np.allclose(swept[found.fitted], found.turning[found.fitted], atol=1e-4)


# --- against OMPL -----------------------------------------------------------------------------


def test_arcs_are_as_long_as_ompl_s_dubins_paths(
    corners: tuple[CornerScenes, SmoothTurns],
) -> None:
    base = pytest.importorskip("ompl.base")
    _, found = corners
    pieces, ends = found.pieces, found.pieces.end
    longer: dict[Turn, list[float]] = {turn: [] for turn in Turn}
    for row in np.flatnonzero(found.fitted):
        (places,) = np.nonzero(pieces.curvature[row])
        # A hair tighter: at R itself, rounding may put the end out of reach of the same arcs. That
        # changes a length by 1e-4 of tangents and arcs, which together are 200 m at most: by 2e-2.
        space = base.DubinsStateSpace(float(pieces.radius[row, places[0]]) * (1 - 1e-4))
        course = pieces.heading[row] + pieces.sweep[row]
        first, last = places[0], places[-1]
        states = []
        for place, yaw in (
            (pieces.start[row, first], pieces.heading[row, first]),
            (ends[row, last], course[last]),
        ):
            state = space.allocState()
            state.setX(float(place[0]))
            state.setY(float(place[1]))
            state.setYaw(float(wrapped(yaw)))
            states.append(state)
        length = float(pieces.length[row, places].sum())
        longer[Turn(found.turns[row, 0])].append(length - space.distance(*states))
    inside, late, early = (np.array(longer[t]) for t in (Turn.INSIDE, Turn.LATE, Turn.EARLY))
    assert len(inside) > 150
    assert np.abs(inside).max() < 5e-2
    for excess in (late, early):  # never shorter than the shortest, and most often no longer
        assert len(excess) >= 10
        assert excess.min() > -5e-2
        assert (excess < 5e-2).mean() > 0.5


# --- the three templates ----------------------------------------------------------------------


def test_inside_leaves_and_meets_the_path_at_the_safety_range() -> None:
    found = one_turn(np.pi / 2, turning_radius=5.0, safety_range=12.0)
    assert found.turns.ravel()[0] == Turn.INSIDE
    pieces = found.pieces
    np.testing.assert_allclose(pieces.length[0, :3], [38, 12 * np.pi / 2, 38], rtol=1e-5)
    np.testing.assert_allclose(pieces.start[0, :3], [[14, 64], [52, 64], [64, 76]], atol=1e-4)
    np.testing.assert_allclose(pieces.centre[0, 1], [52, 76], atol=1e-4)


def test_inside_falls_back_to_the_tightest_arc() -> None:
    inner = wall((-9, -4, 3, 9))  # in the way of the arc of 12 m, not of that of 5 m
    found = one_turn(np.pi / 2, inner, turning_radius=5.0, safety_range=12.0)
    assert found.turns.ravel()[0] == Turn.INSIDE
    assert found.pieces.radius[0, 1] == pytest.approx(5.0, rel=1e-5)
    sharp = one_turn(3.0, turning_radius=2.0, safety_range=1.0)  # R_s leaves no room for R
    assert sharp.turns.ravel()[0] == Turn.INSIDE
    assert sharp.pieces.radius[0, 1] == pytest.approx(2.0, rel=1e-5)


def test_late_is_the_chords_of_45_and_30_degrees() -> None:
    inner = wall((-60, -1, 1, 60))  # the whole inside of the corner
    found = one_turn(np.pi / 2, inner, turning_radius=5.0)
    assert found.turns.ravel()[0] == Turn.LATE
    pieces = found.pieces
    np.testing.assert_allclose(pieces.start[0, 1], [64, 64], atol=1e-4)
    np.testing.assert_allclose(pieces.sweep[0, 1:3], np.deg2rad([150, -60]), atol=1e-5)
    np.testing.assert_allclose(pieces.end[0, 2], [64, 64 + 5 + 10 * np.sin(np.pi / 3)], atol=1e-3)
    # Eq. 8: from the corner at 45 degrees over sqrt(2) R; Eq. 9: at 30 degrees over R.
    node3 = np.array([64, 64]) + np.sqrt(2) * 5 * np.array([np.cos(np.pi / 4), np.sin(np.pi / 4)])
    chord = np.deg2rad(90 + 30)
    node4 = node3 + 5 * np.array([np.cos(chord), np.sin(chord)])
    for node in (node3, node4):
        assert np.linalg.norm(found.points[0, : found.counts[0]] - node, axis=1).min() < 0.6


def test_early_is_late_reversed() -> None:
    inner = wall((-60, -1, 1, 60), (1, 60, 0, 60))  # and the water east of the outgoing leg
    found = one_turn(np.pi / 2, inner, turning_radius=5.0)
    assert found.turns.ravel()[0] == Turn.EARLY
    pieces = found.pieces
    np.testing.assert_allclose(pieces.sweep[0, 1:3], np.deg2rad([-60, 150]), atol=1e-5)
    np.testing.assert_allclose(pieces.end[0, 2], [64, 64], atol=1e-3)
    assert found.heading[0, -1] == pytest.approx(np.pi / 2, abs=1e-5)


def test_a_corner_that_nothing_fits_is_reported_and_left() -> None:
    tight = wall((-60, -1, 1, 60), (1, 60, -60, 60), (-60, 60, -60, -1))
    found = one_turn(np.pi / 2, tight, turning_radius=5.0)
    assert found.turns.ravel()[0] == Turn.UNFITTED
    assert not found.fitted[0]
    assert found.curvature_bound[0] == np.inf
    assert found.length[0] == pytest.approx(100, rel=1e-6)
    assert found.turning[0] == pytest.approx(np.pi / 2, rel=1e-5)


def test_margin_keeps_arcs_off() -> None:
    # The tightest arc of 5 m about (59, 69) comes within 2.07 m of the corner, 64 - x at y = x.
    near = wall((-3, -2, 2, 3))
    plain = one_turn(np.pi / 2, near, turning_radius=5.0)
    kept = one_turn(np.pi / 2, near, turning_radius=5.0, margin=0.2)
    for found, margin in ((plain, 0.0), (kept, 0.2)):
        # Samples see less of an arc than there is: a gap too small at one is a fault for certain.
        for x, y in found.points[0, : found.counts[0]] - 64:
            gap = np.hypot(max(-3 - x, x + 2, 0), max(2 - y, y - 3, 0))
            assert gap > margin or found.turns.ravel()[0] == Turn.UNFITTED


def test_u_turns_and_straight_paths() -> None:
    found = one_turn(np.pi, turning_radius=5.0)
    assert found.turns.ravel()[0] in (Turn.LATE, Turn.EARLY)
    assert np.abs(found.pieces.sweep[0, 1:3]).sum() == pytest.approx(2 * np.pi, rel=1e-5)
    straight = smooth_turns(
        [[[5.0, 5.0], [9.0, 5.0], [9.0, 5.0], [30.0, 5.0]]], None, OPEN, turning_radius=5.0
    )
    assert straight.fitted[0]
    assert (straight.turns == Turn.NONE).all()
    assert straight.curvature_bound[0] == 0
    assert straight.length[0] == pytest.approx(25)


# --- corners that share a segment -------------------------------------------------------------


@examples(12)
@given(st.integers(0, 2**32 - 1))
def test_neighbours_never_take_more_than_their_segment_holds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    steps = rng.uniform(4, 40, (8, 9)) * np.exp(1j * np.cumsum(rng.uniform(-2, 2, (8, 9)), axis=1))
    path = np.cumsum(steps, axis=1)
    points = np.stack([path.real, path.imag], axis=2)
    points += 300 - points.mean(axis=1, keepdims=True)
    blocked = np.zeros((600, 600), bool)
    found = smooth_turns(points, None, blocked, turning_radius=6.0)
    pieces, joints = found.pieces, found.pieces.valid[:, 1:]
    gap = np.linalg.norm(pieces.end[:, :-1] - pieces.start[:, 1:], axis=2)
    assert gap[joints].max() < 2e-3
    assert (np.abs(pieces.curvature) * 6.0 <= 1).all()
    # Only at corners that are left may the course jump.
    turned = (pieces.heading + pieces.sweep)[:, :-1] - pieces.heading[:, 1:]
    jumps = np.abs(wrapped(turned)) > 1e-5
    assert ((jumps & joints).sum(axis=1) == (found.turns == Turn.UNFITTED).sum(axis=1)).all()


def test_the_fewest_corners_are_left() -> None:
    """Two corners 8 m apart with R_s = 10 m: both are fitted, at the least tangent."""
    path = [[[10.0, 64.0], [60.0, 64.0], [60.0, 72.0], [110.0, 72.0]]]
    found = smooth_turns(path, None, OPEN, turning_radius=4.0 / 1.001, safety_range=10.0)
    assert found.turns[0, :2].tolist() == [Turn.INSIDE, Turn.INSIDE]
    assert found.pieces.radius[0, 1] == pytest.approx(4.0, rel=2e-3)


# --- whole routes -----------------------------------------------------------------------------


def test_routes_over_random_maps_and_their_repair() -> None:
    maps, paths, lengths = routes(seed=11, count=24, size=24, density=0.1, far=18)
    short = key_points(paths, lengths, maps)
    plain = smooth_turns(short.path, short.path_cells, maps, turning_radius=2.0)
    mended = smooth_turns(short.path, short.path_cells, maps, turning_radius=2.0, repair=4)
    assert 0.3 < plain.fitted.mean() < 1
    assert mended.fitted.sum() > plain.fitted.sum()
    assert (mended.fitted >= plain.fitted).all()
    assert not mended.repaired[plain.fitted].any()
    for found in (plain, mended):
        for row in range(len(maps)):
            points = found.points[row, : found.counts[row]]
            x, y = np.floor(points).astype(int).T
            assert not maps[row, y, x].any()
            ends = paths[row][[0, lengths[row] - 1]] + 0.5
            np.testing.assert_array_equal(points[[0, -1]], ends)
        assert (found.curvature_bound[found.fitted] * 2 <= 1).all()


def test_scenes_of_islands_are_nearly_always_sailable() -> None:
    maps, paths = [], []
    for seed in range(12):
        scene = islands(seed, 90, 10.0, 40)
        free = np.flatnonzero(~scene)
        path = shortest_path(scene, int(free[0]), int(free[-1]))
        if path is not None:
            maps.append(scene)
            paths.append(path)
    short = key_points(*packed(paths), np.stack(maps))
    found = smooth_turns(
        short.path, short.path_cells, np.stack(maps), turning_radius=15.0, cell_size=10.0, repair=4
    )
    assert len(paths) >= 8
    assert found.fitted.mean() >= 0.9


def test_rows_are_independent_and_origins_only_shift(
    corners: tuple[CornerScenes, SmoothTurns],
) -> None:
    scenes, together = corners
    alone = smooth_turns(
        scenes.paths[66:67] + np.array([5e5, 6e6]),
        None,
        scenes.blocked[66],
        turning_radius=[RADIUS],
        cell_size=3.0,
        origin=(5e5, 6e6),
        spacing=0.5,
    )
    n = alone.counts[0]
    assert n == together.counts[66]
    assert (alone.turns[0] == together.turns[66]).all()
    np.testing.assert_allclose(alone.points[0] - [5e5, 6e6], together.points[66, :n], atol=1e-3)


def test_rows_without_a_path() -> None:
    path = np.array(
        [[[5, 5], [9, 9], [9, 20]], [[5, 5], [0, 0], [0, 0]], [[5, 5], [9, 9], [9, 20]]]
    )
    found = smooth_turns(path, [0, 1, 3], OPEN, turning_radius=2.0)
    assert found.fitted.tolist() == [False, True, True]
    assert found.counts[0] == 0
    assert found.length[1] == 0
    assert (found.points[1] == [5.5, 5.5]).all()
    assert found.turning[1] == found.curvature_bound[1] == 0
    for name in ("length", "turning", "curvature_bound", "points", "heading", "curvature"):
        missing = np.isnan(getattr(found, name))
        assert missing[0].all(), name
        assert not missing[1:].any(), name
    assert np.isnan(found.corners[0]).all()
    assert np.isnan(found.pieces.start[~found.pieces.valid]).all()
    assert found.pieces.length[0].sum() == 0


def test_more_samples_than_there_can_be_are_refused_by_what_asked_for_them() -> None:
    path = np.array([[[5.0, 5.0], [9.0, 5.0], [9.0, 20.0]]])
    said = "^turning_radius: got 1e-09 m; samples R / 5 apart, for want of a spacing: that makes"
    with pytest.raises(BadInputError, match=said):
        smooth_turns(path, None, OPEN, turning_radius=1e-9)
    with pytest.raises(
        BadInputError, match=r"^spacing: got 1e-07 m: that makes 1\.\d+e\+08 samples"
    ):
        smooth_turns(path, None, OPEN, turning_radius=2.0, spacing=1e-7)


def test_a_path_has_two_samples_however_far_apart_they_may_be() -> None:
    path = np.array([[[5.0, 5.0], [9.0, 5.0], [9.0, 20.0]]] * 2)
    found = smooth_turns(path, [3, 1], OPEN, turning_radius=2.0, spacing=1e9)
    assert found.counts.tolist() == [2, 1]
    np.testing.assert_array_equal(found.points[0], path[0, [0, 2]])
    np.testing.assert_allclose(found.heading[0], [0, np.pi / 2], atol=1e-5)
