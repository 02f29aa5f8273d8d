"""A vessel that follows paths: close to smooth ones, wide of sharp corners."""

import numpy as np
import pytest

from usvjax.errors import BadInputError
from usvjax.paths.tracking import track_paths
from usvjax.paths.turns import smooth_turns
from usvkernels.paths.tracking import TrackParams

OPEN = np.zeros((100, 100), bool)
CELL = 3.0
SHARP = np.array([[[30.0, 60.0], [150.0, 60.0], [150.0, 240.0]]])
ZIGZAG = np.array([[[30.0, 60.0], [120.0, 60.0], [150.0, 150.0], [60.0, 200.0], [200.0, 250.0]]])
RADIUS = 15.0


def smoothed_track(path: np.ndarray, blocked: np.ndarray, params: TrackParams | None = None):
    turns = smooth_turns(path, None, OPEN, turning_radius=RADIUS, cell_size=CELL, spacing=0.5)
    assert turns.fitted.all()
    return track_paths(
        turns.points,
        turns.counts,
        blocked,
        curvature=turns.curvature,
        cell_size=CELL,
        params=params,
    )


def test_a_smooth_path_is_followed_and_a_sharp_corner_is_not() -> None:
    for path in (SHARP, ZIGZAG):
        smooth = smoothed_track(path, OPEN)
        sharp = track_paths(path, None, OPEN, cell_size=CELL)
        assert smooth.arrived.all()
        assert sharp.arrived.all()
        assert smooth.error[0] < 1.0
        assert sharp.error[0] > 4.0


def test_overshoot_at_a_right_angle_is_the_turning_radius() -> None:
    """Sailing a circle of 15 m from the corner on, the vessel gets 15 m past the new course."""
    sharp = track_paths(SHARP, None, OPEN, cell_size=CELL)
    east = sharp.poses[0, :, 0].max() - 150
    assert 10 < east < RADIUS + 1
    assert sharp.distance[0].max() == sharp.error[0]


def test_collision_is_with_the_map_as_it_is() -> None:
    blocked = OPEN.copy()
    blocked[15:30, 53:58] = True  # 9 to 24 m east of the outgoing leg
    assert not smoothed_track(SHARP, blocked).collided[0]
    assert track_paths(SHARP, None, blocked, cell_size=CELL).collided[0]
    slow = TrackParams(speed=3.0)
    assert not track_paths(SHARP, None, blocked, cell_size=CELL, params=slow).collided[0]


def test_yaw_rate_and_speed_are_kept() -> None:
    params = TrackParams(speed=10.0, yaw_rate=0.5, dt=0.1)
    track = track_paths(ZIGZAG, None, OPEN, cell_size=CELL, params=params)
    steps = round(float(track.time[0]) / 0.1)
    turn = np.diff(track.poses[0, : steps + 1, 2])
    turn = (turn + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(turn).max() <= 0.05 + 1e-5
    assert np.abs(turn).max() == pytest.approx(0.05, abs=1e-5)  # it does turn as hard as it can
    chord = np.linalg.norm(np.diff(track.poses[0, : steps + 1, :2], axis=0), axis=1)
    half = turn / 2
    # Places of 250 m are rounded by 1.5e-5 m: chords of 1 m, in two coordinates, by 4e-5.
    np.testing.assert_allclose(chord, np.sinc(half / np.pi), rtol=1e-4)


def test_a_smaller_error_with_a_shorter_period() -> None:
    coarse = smoothed_track(ZIGZAG, OPEN, TrackParams(dt=0.1)).error[0]
    fine = smoothed_track(ZIGZAG, OPEN, TrackParams(dt=0.01)).error[0]
    assert fine < coarse


def test_rows_without_a_path_and_leaving_the_map() -> None:
    edge = np.array([[[30.0, 150.0], [299.0, 150.0], [299.0, 30.0]]] * 2)
    track = track_paths(edge, [3, 0], OPEN, cell_size=CELL)
    assert track.collided.tolist() == [True, False]
    assert track.arrived.tolist() == [True, False]
    assert track.time[1] == 0


def test_smoothed_rows_without_a_path_can_be_tracked() -> None:
    """Their samples and curvatures are nan, which counts for nothing."""
    path = np.repeat(SHARP, 2, axis=0)
    turns = smooth_turns(path, [3, 0], OPEN, turning_radius=RADIUS, cell_size=CELL, spacing=0.5)
    assert np.isnan(turns.curvature[1]).all()
    track = track_paths(turns.points, turns.counts, OPEN, curvature=turns.curvature, cell_size=CELL)
    assert track.arrived.tolist() == [True, False]
    wrong = np.where([[False], [True]], 0.0, turns.curvature * np.nan)
    with pytest.raises(BadInputError, match="curvature: nan at index"):
        track_paths(turns.points, turns.counts, OPEN, curvature=wrong, cell_size=CELL)
