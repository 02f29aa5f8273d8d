"""The rules of the road are kept, as two observers see it who share nothing."""

import fleet_encounters
import jax
import numpy as np
import pytest
import rules_kept

import usvjax as uj
from usvjax.missions.fleet.measures import CROSSING, HEAD_ON, NONE, OVERTAKING, meetings
from usvjax.missions.fleet.run import navigate

PASSING = uj.FleetParams().passing
KINDS = {
    "none": (NONE, False),
    "head-on": (HEAD_ON, True),
    "give way": (CROSSING, True),
    "stand on": (CROSSING, False),
    "overtaking": (OVERTAKING, True),
    "overtaken": (OVERTAKING, False),
}


@pytest.fixture(scope="module")
def watched():
    """Tracks of 128 random encounters, what each observer says, and the sums of hulls."""
    met = fleet_encounters.draw(128, seed=12)
    params = uj.FleetParams(hull_radius=met.hull, v_max=met.speed)
    with jax.default_device(jax.devices()[0]):
        found = navigate(
            None,
            met.start,
            met.goal,
            speeds=met.speed * (1 - 1e-7),
            params=params,
            record=True,
        )
    hulls = met.hull.sum(axis=1)
    own = zip(found.trajectory.astype(float), found.steps, hulls, strict=True)
    judged = [rules_kept.judge(track[: n + 1], h, PASSING, 1.0) for track, n, h in own]
    return judged, meetings(found.trajectory, met.hull, PASSING, 1.0)


def test_both_observers_see_the_same_roles(watched):
    judged, noted = watched
    for row, pair in enumerate(judged):
        for i, verdict in enumerate(pair):
            seen = noted.kind[row, i, 1 - i], noted.gives_way[row, i, 1 - i]
            assert seen == KINDS[verdict.role], (row, i)


def test_nearly_all_keep_the_rules(watched):
    judged, noted = watched
    met = np.array([pair[0].role != "none" for pair in judged])
    theirs = np.array([not (a.fault or b.fault) for a, b in judged])
    ours = noted.kept.all(axis=(1, 2))
    assert met.sum() > 100
    # Of 10,000 encounters 99.5 % are kept (99.3 at least, at 95 %); of these few, one in thirty
    # may be broken where 99 % are kept.
    assert theirs[met].mean() >= 1 - 1 / 30
    assert ours[met].mean() >= 1 - 1 / 30
    assert (ours == theirs)[met].mean() >= 1 - 1 / 30


def made(own, other, seconds=400):
    """Tracks float64[T, 2, 5] of two: place (m), then (deg, m/s) from each of some times (s)."""
    track = np.zeros((seconds + 1, 2, 5))
    for i, (place, *orders) in enumerate((own, other)):
        for begin, degrees, speed in orders:
            track[begin:, i, 2:4] = np.radians(degrees), speed
        psi, v = track[1:, i, 2], track[1:, i, 3]
        steps = v[:, None] * np.stack([np.cos(psi), np.sin(psi)], axis=1)
        track[:, i, :2] = place + np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    return track


EAST = (-1000.0, 0.0)
NORTH = (0.0, -1000.0)  # to starboard of who sails east
CASES = {
    # What the first does, what the second does, and whether each keeps the rules.
    "turns early to starboard, passes astern": (
        (EAST, (0, 0, 5), (20, -60, 5), (150, 0, 5)),
        (NORTH, (0, 90, 5)),
        (True, True),
    ),
    "slows early": ((EAST, (0, 0, 5), (20, 0, 2)), (NORTH, (0, 90, 5)), (True, True)),
    "never acts": ((EAST, (0, 0, 5)), ((0.0, -1080.0), (0, 90, 5)), (False, True)),
    "acts late": ((EAST, (0, 0, 5), (160, -90, 5)), (NORTH, (0, 90, 5)), (False, True)),
    "turns to port": ((EAST, (0, 0, 5), (20, 60, 5)), (NORTH, (0, 90, 5)), (False, True)),
    "crosses ahead": ((EAST, (0, 0, 5), (1, 0, 6)), (NORTH, (0, 90, 5)), (False, True)),
    "the other acts without need": (
        (EAST, (0, 0, 5), (20, -60, 5), (150, 0, 5)),
        (NORTH, (0, 90, 5), (30, 60, 5)),
        (True, False),
    ),
    "the other acts at last": (
        (EAST, (0, 0, 5)),
        (NORTH, (0, 90, 5), (155, -10, 5)),
        (False, True),
    ),
    "nobody meets": ((EAST, (0, 0, 5)), ((0.0, -1800.0), (0, 90, 5)), (True, True)),
}


@pytest.mark.parametrize("name", CASES)
def test_what_is_done_on_purpose_is_seen_so(name):
    own, other, kept = CASES[name]
    track = made(own, other)
    judged = rules_kept.judge(track, 40.0, PASSING, 1.0)
    assert tuple(not verdict.fault for verdict in judged) == kept, judged
    noted = meetings(track[None], np.array([[20.0, 20.0]]), PASSING, 1.0)
    assert (bool(noted.kept[0, 0, 1]), bool(noted.kept[0, 1, 0])) == kept
