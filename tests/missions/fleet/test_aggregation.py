"""Formations, who takes which slot, and fleets that gather; what an observer notes of meetings."""

from itertools import permutations

import jax
import numpy as np
import pytest
from property_draws import FUZZ

import usvjax as uj
from usvjax.missions.fleet.aggregation import aggregate
from usvjax.missions.fleet.formations import FORMATIONS, assigned, placed, slots_of
from usvjax.missions.fleet.measures import CROSSING, HEAD_ON, OVERTAKING, meetings
from usvjax.missions.fleet.run import navigate
from usvkernels.status import Status


@pytest.fixture(autouse=True, scope="module")
def one_device():
    """Each device compiles for itself."""
    with jax.default_device(jax.devices()[0]):
        yield


@pytest.mark.parametrize("formation", FORMATIONS)
@pytest.mark.parametrize("n", [1, 2, 3, 7])
def test_slots_are_apart_and_about_their_centre(formation, n):
    slots = slots_of(formation, n, 50.0)
    assert slots.shape == (n, 2)
    assert np.abs(slots.mean(axis=0)).max() < 1e-9
    apart = [np.hypot(*(slots[i] - slots[j])) for i in range(n) for j in range(i)]
    assert min(apart, default=50.0) == pytest.approx(50.0)


def test_slots_turn_with_the_heading():
    there = placed(
        np.array([[10.0, 0.0], [0.0, 5.0]]), np.array([[1.0, 2.0]]), np.array([np.pi / 2])
    )
    assert there[0] == pytest.approx(np.array([[1.0, 12.0], [-4.0, 2.0]]))


def test_the_least_sum_of_distances_is_that_of_all_permutations():
    rng = np.random.default_rng(0)
    start, slots = rng.normal(size=(30, 5, 2)), rng.normal(size=(30, 5, 2))
    apart = np.linalg.norm(start[:, :, None] - slots[:, None], axis=-1)
    best = np.min([apart[:, np.arange(5), p].sum(axis=1) for p in permutations(range(5))], axis=0)
    total = {
        how: np.take_along_axis(apart, assigned(how, start, slots)[..., None], axis=2).sum((1, 2))
        for how in ("hungarian", "nearest", "given")
    }
    assert total["hungarian"] == pytest.approx(best)
    assert (total["nearest"] >= best - 1e-12).all()
    assert total["nearest"].mean() < total["given"].mean()
    for how in ("nearest", "hungarian"):
        assert (np.sort(assigned(how, start, slots), axis=1) == np.arange(5)).all()


PARAMS = uj.FleetParams(hull_radius=20.0, goal_tolerance=10.0)


def test_three_vessels_gather_on_a_heading():
    starts = np.array([[[-5000, -3000, 0.0], [-6000, 0, 1.0], [-5000, 3000, 2.0]]] * 3)
    headings = np.radians([0.0, 60.0, 90.0])
    found = aggregate(None, starts, np.zeros(2), headings, params=PARAMS, record=True)
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
        ({"formation": np.zeros((2, 2))}, "2 slots; wanted 3"),
        ({"spacing": 30.0}, "slots 0 and 1 are 30 m apart; wanted at least 40"),
        ({"assignment": "best"}, "assignment"),
        ({"heading": np.nan}, "heading"),
    ],
)
def test_what_is_refused(given, says):
    starts = np.array([[[-5000, -3000, 0.0], [-6000, 0, 1.0], [-5000, 3000, 2.0]]])
    wanted = {"centre": np.zeros(2), "heading": 0.0, "params": PARAMS} | given
    with pytest.raises((uj.BadInputError, uj.BadTypeError), match=says):
        aggregate(None, starts, **wanted)


def test_a_hundred_vessels_do_not_fit_on_a_spot():
    starts = np.zeros((1, 100, 3))
    starts[0, :, :2] = np.stack(np.meshgrid(np.arange(10) * 0.2, np.arange(10) * 0.2), -1).reshape(
        100, 2
    )
    with pytest.raises(uj.BadInputError, match=r"vessels 0 and 1 of fleet 0 are 0\.2 m apart"):
        navigate(None, starts, starts[..., :2] + 5000.0)


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
    seen = meetings(np.array(tracks).swapaxes(1, 2), np.full((1, 2), 15.0), 90.0, 1.0)
    assert list(seen.kind[:, 0, 1]) == [HEAD_ON, CROSSING, OVERTAKING, 0]
    assert seen.gives_way[:3, 0, 1].all()
    assert list(seen.gives_way[:3, 1, 0]) == [True, False, False]
    assert seen.tcpa[:2, 0, 1] == pytest.approx(300.0)
    assert seen.dcpa[0, 0, 1] == pytest.approx(10.0, abs=1e-6)
    # Nobody acted: those that had to broke the rules, the others did not.
    assert not seen.kept[:3, 0, 1].any()
    assert np.isinf(seen.action_time).all()
    assert seen.kept[3].all()


@pytest.mark.skipif(not FUZZ, reason="by `make fuzz`: programs of its own")
def test_who_turns_to_starboard_in_time_keeps_the_rules():
    start = np.array([[[0.0, -1500.0, np.pi / 2], [1500.0, 0.0, np.pi]]])
    goal = np.array([[[0.0, 2500.0], [-2500.0, 0.0]]])
    speeds = np.full((1, 2), 5.0)
    params = uj.FleetParams(hull_radius=15.0, v_max=5.0)
    found = navigate(None, start, goal, speeds=speeds, params=params, record=True)
    seen = meetings(found.trajectory, np.full((1, 2), 15.0), 92.6, 1.0)
    assert seen.kind[0, 0, 1] == CROSSING
    assert seen.gives_way[0, 0, 1]
    assert seen.kept[0].all()
    assert np.degrees(seen.to_starboard[0, 0, 1]) >= 25.0
    assert np.degrees(seen.to_starboard[0, 1, 0]) < 5.0
    assert found.status[0] == Status.REACHED
