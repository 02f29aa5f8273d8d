"""What an observer notes of meetings."""

import numpy as np
import pytest
from property_draws import FUZZ

import usvjax as uj
from usvjax.missions.fleet.measures import CROSSING, HEAD_ON, OVERTAKING
from usvkernels.status import Status

pytestmark = pytest.mark.usefixtures("one_device")


def straight(course: float, speed: float, through: tuple[float, float], at: int) -> np.ndarray:
    """float[T, 5] of a vessel that is at a point in step `at`; course in rad from east."""
    time = np.arange(401) - at
    x, y = through[0] + speed * np.cos(course) * time, through[1] + speed * np.sin(course) * time
    return np.stack([x, y, np.full(401, course), np.full(401, speed), np.zeros(401)], axis=1)


def test_meetings_are_told_apart_and_judged():
    north, south, west = np.pi / 2, -np.pi / 2, np.pi
    tracks = [
        [straight(north, 5, (0, 0), 300), straight(south, 5, (10, 0), 300)],
        [straight(north, 5, (0, 0), 300), straight(west, 5, (0, 0), 300)],
        [straight(north, 8, (0, 0), 300), straight(north, 5, (5, 0), 300)],
        [straight(north, 5, (0, 0), 300), straight(south, 5, (900, 0), 300)],
    ]
    seen = uj.meetings(np.array(tracks).swapaxes(1, 2), np.full((1, 2), 15.0), 90.0, 1.0)
    assert list(seen.kind[:, 0, 1]) == [HEAD_ON, CROSSING, OVERTAKING, 0]
    assert seen.gives_way[:3, 0, 1].all()
    assert list(seen.gives_way[:3, 1, 0]) == [True, False, False]
    assert seen.tcpa[:2, 0, 1] == pytest.approx(300.0)
    assert seen.dcpa[0, 0, 1] == pytest.approx(10.0, abs=1e-6)
    # Nobody acted: those that had to broke the rules, the others did not.
    assert not seen.kept[:3, 0, 1].any()
    assert np.isinf(seen.action_time).all()
    assert seen.kept[3].all()


@pytest.mark.parametrize(
    ("shape", "hull", "says"),
    [
        ((0, 9, 2, 5), (1, 2), r"^trajectory: got shape \(0, 9, 2, 5\); wanted at least one step"),
        ((1, 0, 2, 5), (1, 2), r"^trajectory: got shape \(1, 0, 2, 5\)"),
        ((1, 9, 0, 5), (1, 0), r"^trajectory: got shape \(1, 9, 0, 5\)"),
        ((1, 9, 257, 5), (1, 257), "^trajectory: .* of 1 to 256 vessels"),
        ((3, 9, 2, 5), (2, 2), r"^hull_radius: got shape \(2, 2\); wanted shape \(3, 2\)"),
        ((3, 9, 2, 5), (0, 2), r"^hull_radius: got shape \(0, 2\)"),
        ((3, 9, 2, 5), (2,), r"^hull_radius: got shape \(2,\)"),
    ],
)
def test_records_and_hulls_of_other_shapes_are_refused(shape, hull, says):
    with pytest.raises(uj.BadInputError, match=says):
        uj.meetings(np.zeros(shape), np.ones(hull), 90.0, 1.0)


def test_hulls_below_nothing_are_refused():
    with pytest.raises(uj.BadInputError, match=r"^hull_radius: got -1 m; wanted 0 m or more"):
        uj.meetings(np.zeros((1, 9, 2, 5)), [[1.0, -1.0]], 90.0, 1.0)


@pytest.mark.skipif(not FUZZ, reason="by `make fuzz`: programs of its own")
def test_who_turns_to_starboard_in_time_keeps_the_rules():
    start = np.array([[[0.0, -1500.0, np.pi / 2], [1500.0, 0.0, np.pi]]])
    goal = np.array([[[0.0, 2500.0], [-2500.0, 0.0]]])
    speeds = np.full((1, 2), 5.0)
    params = uj.FleetParams(hull_radius=15.0, v_max=5.0)
    found = uj.navigate(None, start, goal, speeds=speeds, params=params, record=True)
    seen = uj.meetings(found.trajectory, np.full((1, 2), 15.0), 92.6, 1.0)
    assert seen.kind[0, 0, 1] == CROSSING
    assert seen.gives_way[0, 0, 1]
    assert seen.kept[0].all()
    assert np.degrees(seen.to_starboard[0, 0, 1]) >= 25.0
    assert np.degrees(seen.to_starboard[0, 1, 0]) < 5.0
    assert found.status[0] == Status.REACHED
