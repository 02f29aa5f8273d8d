"""Roses of who gave way: what vessels did, and where they saw the other."""

from types import SimpleNamespace

import numpy as np
import pytest
from figure_kinds import check_figure

import usvjax as uj
from usvjax.missions.fleet.measures import CROSSING, HEAD_ON, OVERTAKING, meetings_of
from usvjax.missions.fleet.roses import ANSWERS, answers, plot_roses, tells

GAVE_WAY, LATE, STOOD_ON, COLLIDED = range(4)


def sailed(course, place, turns_at=None, steps=400):
    """float[T, 5] of a vessel at 5 m/s that may turn to starboard by 60 deg for a while."""
    turned = np.full(steps, course)
    if turns_at is not None:
        turned[turns_at : turns_at + 60] -= np.radians(60.0)
    step = 5.0 * np.stack([np.cos(turned), np.sin(turned)], axis=1)
    places = place + np.concatenate([np.zeros((1, 2)), np.cumsum(step[:-1], axis=0)])
    rest = [turned, np.full(steps, 5.0), np.zeros(steps)]
    return np.column_stack([places, *rest])


def meeting(bearing, course, *turns):
    """Two that are to meet 300 s on: the first heads north, the other comes from a bearing (deg).

    Bearings are off the first one's bow, to port positive; the course is the other's, from north.
    """
    north = np.pi / 2
    own = sailed(north, np.array([0.0, -1500.0]), turns[0])
    theirs = north + np.radians(course)
    way = 1500.0 * np.array([np.cos(theirs), np.sin(theirs)])
    other = sailed(theirs, -way, turns[1])
    off = other[0, :2] - own[0, :2]
    seen_at = np.degrees(np.arctan2(off[1], off[0]) - north)
    assert (seen_at - bearing + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=1e-6)
    return np.stack([own, other], axis=1)


@pytest.fixture(scope="module")
def found():
    """Replayed encounters: to starboard in time, head-on late, to port nobody, and nobody again."""
    states = (
        meeting(-45.0, 90.0, 100, None),
        meeting(0.0, 180.0, 270, None),
        meeting(45.0, -90.0, None, None)[:380],
        meeting(-45.0, 90.0, None, None),
    )
    scenes = SimpleNamespace(speeds=np.zeros((4, 2)), water=None)
    params = uj.FleetParams(hull_radius=10.0)
    scene = SimpleNamespace(scenes=scenes, params=params, hulls=np.full((4, 2), 10.0))
    return SimpleNamespace(scene=scene, recording=SimpleNamespace(detail=states))


def met(found):
    return meetings_of(found.recording.detail, found.scene.hulls, found.scene.params)


def test_what_vessels_did_about_another(found):
    assert tells(found)
    seen = met(found)
    assert list(seen.kind[:, 0, 1]) == [CROSSING, HEAD_ON, CROSSING, CROSSING]
    assert np.degrees(seen.bearing[:, 0, 1]) == pytest.approx([-45.0, 0.0, 45.0, -45.0], abs=1e-6)
    assert np.degrees(seen.bearing[[0, 2], 1, 0]) == pytest.approx([45.0, -45.0], abs=1e-6)
    did = answers(seen)
    assert [tuple(did[b, [0, 1], [1, 0]]) for b in range(4)] == [
        (GAVE_WAY, STOOD_ON),
        (LATE, STOOD_ON),
        (COLLIDED, COLLIDED),
        (COLLIDED, COLLIDED),
    ]


def test_it_cannot_be_told_among_obstacles_nor_of_very_large_fleets(found):
    for changed in ({"water": np.zeros((4, 1, 2))}, {"speeds": np.zeros((4, 33))}):
        scenes = SimpleNamespace(**(vars(found.scene.scenes) | changed))
        scene = SimpleNamespace(**(vars(found.scene) | {"scenes": scenes}))
        assert not tells(SimpleNamespace(scene=scene))


def test_areas_of_a_rose_are_numbers_of_vessels(found):
    seen = met(found)
    fig = plot_roses({"rules": seen, "orca": seen}, "met")
    check_figure(fig)
    assert len(fig.axes) == 6
    hues = list(ANSWERS.values())
    for ax, kind in zip(fig.axes, 2 * [HEAD_ON, CROSSING, OVERTAKING], strict=True):
        mine = seen.kind == kind
        did = answers(seen)[mine]
        for place, hue in enumerate(hues):
            petals = [p for p in ax.patches if np.allclose(p.get_facecolor()[:3], rgb(hue))]
            area = sum((p.get_y() + p.get_height()) ** 2 - p.get_y() ** 2 for p in petals)
            assert area == pytest.approx(np.count_nonzero(did == place))
    # The only one that gave way in a crossing had the other to starboard: right of the bow.
    crossing = fig.axes[1]
    blue = [p for p in crossing.patches if np.allclose(p.get_facecolor()[:3], rgb(hues[0]))]
    middles = [p.get_x() + p.get_width() / 2 for p in blue if p.get_height() > 0]
    assert middles == pytest.approx([np.radians(45.0)])
    assert crossing.get_theta_direction() == -1


def rgb(hue):
    return [int(hue[k : k + 2], 16) / 255 for k in (1, 3, 5)]
