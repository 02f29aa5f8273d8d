"""Formations, who takes which slot, and fleets that gather."""

from dataclasses import replace
from functools import partial
from itertools import pairwise, permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import usvjax as uj
from usvjax.missions.aggregate.formations import ASSIGNMENTS, FORMATIONS, assigned, placed, slots_of
from usvjax.missions.aggregate.rounding import ways_round
from usvjax.missions.fleet.chart import Chart
from usvjax.missions.fleet.routes import _ways
from usvkernels.fleet.episodes import MOST_AROUND
from usvkernels.status import Status

pytestmark = pytest.mark.usefixtures("one_device")


@pytest.mark.parametrize("formation", FORMATIONS)
@pytest.mark.parametrize("n", [1, 2, 3, 7])
def test_slots_are_apart_and_about_their_centre(formation, n):
    slots = slots_of(formation, n, np.array([50.0]))[0]
    assert slots.shape == (n, 2)
    assert np.abs(slots.mean(axis=0)).max() < 1e-9
    apart = [np.hypot(*(slots[i] - slots[j])) for i in range(n) for j in range(i)]
    assert min(apart, default=50.0) == pytest.approx(50.0)


def test_slots_turn_with_the_heading():
    there = placed(
        np.array([[[10.0, 0.0], [0.0, 5.0]]]), np.array([[1.0, 2.0]]), np.array([np.pi / 2])
    )
    assert there[0] == pytest.approx(np.array([[1.0, 12.0], [-4.0, 2.0]]))


def test_the_least_sum_of_distances_is_that_of_all_permutations():
    rng = np.random.default_rng(0)
    start, slots = rng.normal(size=(30, 5, 2)), rng.normal(size=(30, 5, 2))
    apart = np.linalg.norm(start[:, :, None] - slots[:, None], axis=-1)
    best = np.min([apart[:, np.arange(5), p].sum(axis=1) for p in permutations(range(5))], axis=0)
    taken = {how: assigned(how, start, slots, np.ones((30, 5), bool)) for how in ASSIGNMENTS}
    total = {
        how: np.take_along_axis(apart, slot[..., None], axis=2).sum((1, 2))
        for how, slot in taken.items()
    }
    assert total["hungarian"] == pytest.approx(best)
    assert (total["nearest"] >= best - 1e-12).all()
    assert total["nearest"].mean() < total["given"].mean()
    for how in ("nearest", "hungarian"):
        assert (np.sort(taken[how], axis=1) == np.arange(5)).all()


def test_who_is_absent_takes_what_is_left():
    start = np.array([[[0.0, 0.0], [5.0, 0.0], [9.0, 0.0]]])
    slots = np.array([[[0.0, 0.0], [10.0, 0.0], [50.0, 0.0]]])
    present = np.array([[False, True, True]])
    for how in ("hungarian", "nearest"):
        assert list(assigned(how, start, slots, present)[0]) == [2, 0, 1]


PARAMS = uj.FleetParams(hull_radius=20.0, goal_tolerance=10.0)


def test_three_vessels_gather_on_a_heading():
    starts = np.array([[[-5000, -3000, 0.0], [-6000, 0, 1.0], [-5000, 3000, 2.0]]] * 3)
    headings = np.radians([0.0, 60.0, 90.0])
    found = uj.aggregate(None, starts, np.zeros(2), headings, params=PARAMS, record=True)
    assert found.formed.all()
    assert np.degrees(found.heading_error).max() < 5.0
    assert found.formation_error.max() < PARAMS.goal_tolerance
    assert found.min_separation.min() > 0.0
    assert (found.formed_time >= found.rest_time.max(axis=1) + 10.0 - 1e-3).all()
    last = found.trajectory[:, -1, :, :2] - found.slots
    assert found.formation_error == pytest.approx(np.hypot(*last.T).T.max(axis=1), abs=1e-2)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"formation": "wegde"}, "wedge"),
        ({"formation": np.zeros((2, 2))}, "2 slots; wanted at least 3"),
        ({"spacing": 30.0}, "slots 0 and 1 are 30 m apart; wanted at least 40"),
        ({"assignment": "best"}, "assignment"),
        ({"heading": np.nan}, "^heading: nan"),
        ({"centre": (np.nan, 0.0)}, "^centre: nan"),
        ({"centre": (3e5, 0.0)}, "^slots: vessel 0 of fleet 0 lies at"),
        ({"scene": [[0.0, 0.0]]}, "^slots: vessel 0 of fleet 0 at .* touches an obstacle"),
        ({"spacing": np.nan}, "^spacing: got nan"),
        ({"formation": [[0.0, 0.0], [np.nan, 0.0], [99.0, 0.0]]}, "^formation: nan"),
        ({"hold_time": np.nan}, "^hold_time: got nan"),
        ({"encounters": "orka"}, "did you mean 'orca'"),
        ({"valid": [[False, False, False]]}, "^valid: fleet 0 has no vessel"),
        (
            {"environment": uj.Environment(uj.UniformCurrent((0.0, 11.0)))},
            "^environment: vessel 0 of fleet 0 drifts at 11 m/s",
        ),
    ],
)
def test_what_is_refused(given, says):
    starts = np.array([[[-5000, -3000, 0.0], [-6000, 0, 1.0], [-5000, 3000, 2.0]]])
    usual = {"scene": None, "centre": np.zeros(2), "heading": 0.0, "params": PARAMS}
    with pytest.raises(uj.BadInputError, match=says):
        uj.aggregate(starts=starts, **(usual | given))


def test_a_hundred_vessels_do_not_fit_on_a_spot():
    starts = np.zeros((1, 100, 3))
    starts[0, :, :2] = np.stack(np.meshgrid(np.arange(10) * 0.2, np.arange(10) * 0.2), -1).reshape(
        100, 2
    )
    with pytest.raises(uj.BadInputError, match=r"vessels 0 and 1 of fleet 0 are 0\.2 m apart"):
        uj.navigate(None, starts, starts[..., :2] + 5000.0)


@given(
    ahead=st.floats(-4000, 4000),
    abeam=st.floats(-4000, 4000),
    slot=st.integers(0, 2),
    heading=st.floats(-np.pi, np.pi),
)
def test_ways_round_a_formation_cross_no_slot_and_no_lane_of_others(ahead, abeam, slot, heading):
    """In the frame of the formation: no leg but the last comes within the room of any slot."""
    room, guide = 300.0, 1000.0
    slots = slots_of("wedge", 3, np.array([500.0]))
    centre, course = np.zeros((1, 2)), np.array([heading])
    frame = np.array([[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]])
    start = placed(np.array([[[ahead, abeam]]]), centre, course)
    ways = ways_round(start, slots, np.array([[slot]]), centre, course, np.array([room]), guide)
    front, rear = slots[0, :, 0].max() + room, slots[0, :, 0].min() - guide
    wide = np.abs(slots[0, :, 1]).max() + room
    for way in ways[:, 0, 0] @ frame:
        assert way[-1] == pytest.approx([rear, slots[0, slot, 1]], abs=1e-6)
    nearer = (ways[0, 0, 0] @ frame)[:2, 1]
    assert (nearer * np.sign(np.round(abeam, 6)) >= -1e-6).all()
    if rear < ahead < front and abs(abeam) < wide:
        return  # it begins among the slots or lanes
    for one, two in pairwise(np.concatenate([start[0], ways[0, 0, 0]]) @ frame):
        leg = one + np.linspace(0, 1, 60)[:, None] * (two - one)
        assert np.linalg.norm(leg[:, None] - slots[0], axis=-1).min() > room - 1e-6


def test_a_way_round_that_leads_off_the_map_is_not_taken():
    """The nearer side of the formation is ashore or off the map; the other is open."""
    blocked = np.zeros((60, 60), bool)
    blocked[:55, 36:42] = blocked[:30, 30:] = True
    ground = Chart(blocked[None], 100.0)
    start, goal = np.array([[3300.0, 5200.0]]), np.array([[2500.0, 1500.0]])
    sides = [[[3900.0, 3000.0]], [[6600.0, 3000.0]], [[1500.0, 3000.0]]]
    via = np.array(sides)[:, None, None]
    corners, counts, found = _ways(ground, np.zeros(1, int), start, goal, np.array([60.0]), via)
    assert found[0]
    path = corners[0, : counts[0]]
    assert np.linalg.norm(path - sides[2][0], axis=1).min() < 1e-9
    cells = (path // 100.0).astype(int)
    assert not blocked[cells[:, 1], cells[:, 0]].any()


def test_who_comes_on_another_heading_goes_around_and_not_for_ever():
    """Yaw rates are whole degrees: 0.0050 rad is the least that it can be off this heading."""
    starts, goals = np.array([[[0.0, 0.0, 1.0]]]), np.array([[[1500.0, 700.0]]])
    call = partial(uj.navigate, None, starts, goals, headings=[[1.005]])
    static = uj.FleetStatic(guide_length=500.0)
    params = replace(PARAMS, goal_tolerance=30.0)
    free = call(params=replace(params, heading_tolerance=np.pi), static=static)
    exact = call(params=replace(params, heading_tolerance=0.0045), static=static)
    assert free.status[0] == Status.REACHED
    assert 0.0045 < free.heading_error[0, 0] < np.radians(5.0)
    assert exact.status[0] == Status.STUCK
    assert exact.livelock[0, 0]
    rounds = (exact.path_length[0, 0] - free.path_length[0, 0]) / 1000.0
    assert MOST_AROUND - 2 < rounds < MOST_AROUND + 1


def test_three_of_wei_s_size_gather_among_obstacles():
    """Sailing straight for their guide segments most of them touched, or arrived askew."""
    rng = np.random.default_rng(5)
    angle = np.array([0.3, 2.2, 4.4]) + rng.uniform(-0.5, 0.5, (12, 3))
    starts = np.stack([np.cos(angle), np.sin(angle), angle], axis=-1) * [5500.0, 5500.0, 1.0]
    turned = angle + np.pi / 3
    circles = np.stack([np.cos(turned), np.sin(turned)], axis=-1) * 3200.0
    headings = np.repeat(np.radians([0.0, 60.0, 90.0]), 4)
    found = uj.aggregate(circles, starts, np.zeros(2), headings)
    clear = ~np.any(found.vessel_status == Status.NO_APPROACH, axis=1)
    assert clear.sum() > 6
    assert found.formed[clear].all()
    assert found.min_separation.min() > 0.0
    assert np.degrees(found.heading_error[clear]).max() < 5.0
