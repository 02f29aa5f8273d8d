"""Whole cruises against an independent replay, step by step, and the replay against mistakes."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import cruise_replay as replay
import jax
import numpy as np
import pytest
from cruise_scenes import CRUISES, STATIONS, Scenes, assert_right, random_scenes, walked
from hypothesis import given
from hypothesis import strategies as st
from property_draws import examples

from usvjax import memory, planners
from usvjax.errors import BadInputError
from usvjax.missions.cruise import CruiseResult, rounds
from usvjax.search.astar import astar
from usvkernels.status import Status

WAIT = 20
CASES: dict[str, tuple[int, dict[str, Any]]] = {
    "window": (CRUISES, {"flip_rate": 0.03}),
    "one in five": (CRUISES, {"flip_rate": 0.2, "max_wait": 5}),
    "every cell": (CRUISES, {"flip_rate": 1.0, "max_wait": 3}),
    "weighted": (16, {"flip_rate": 0.05, "heuristic": "weighted"}),
    "map": (
        16,
        {
            "flip_rate": 0.01,
            "flip_scope": "map",
            "sensing": (7, 9),
            "corner_cutting": True,
            "max_wait": 7,
            "max_steps": 30,
        },
    ),
    "A*": (8, {"flip_rate": 0.05, "method": "astar", "walled_in": "skip"}),
    "A*, map": (8, {"flip_rate": 0.02, "flip_scope": "map", "method": "astar", "max_wait": 5}),
}


@pytest.fixture(autouse=True)
def _one_device() -> Iterator[None]:
    """Programs are compiled per device; one of these tests takes them all."""
    with jax.default_device(jax.devices()[0]):
        yield


@pytest.fixture(scope="module")
def scenes() -> Scenes:
    return random_scenes(1)


@pytest.fixture(scope="module")
def window(scenes: Scenes) -> CruiseResult:
    with jax.default_device(jax.devices()[0]):
        return scenes.sail(max_wait=WAIT, **CASES["window"][1])


def options_of(given: dict[str, Any]) -> replay.Options:
    """The options of the replay that go with arguments of `cruise`."""
    exact = given.get("heuristic", "octile") == "octile" and "method" not in given
    return replay.Options(
        rate=given.get("flip_rate", 0.03),
        scope=given.get("flip_scope", "window"),
        window=given.get("sensing", (5, 5)),
        corner_cutting=given.get("corner_cutting", False),
        max_wait=0 if given.get("walled_in") in ("skip", "fail") else given.get("max_wait", WAIT),
        max_steps=given.get("max_steps", 192),
        shortest=exact,
    )


@pytest.mark.parametrize("name", CASES)
def test_every_step_is_right(name: str, scenes: Scenes) -> None:
    count, given = CASES[name]
    rows = np.linspace(0, CRUISES - 1, count).astype(int)
    some = Scenes(scenes.blocked[rows], scenes.stations[rows], scenes.order[rows])
    result = some.sail(**{"max_wait": WAIT, **given})
    for row in range(0, count, 1 + count // 32):
        assert_right(some, result, row, options_of(given))
    assert len({int(s) for s in result.status}) > 1  # not all of them have it easy
    assert np.all(result.replanned > 0)
    assert np.all(result.expanded > 0)


@examples(6)
@given(
    seed=st.integers(0, 2**32 - 1),
    most=st.floats(0.0, 0.6),
    rate=st.one_of(st.just(0.0), st.floats(0.0, 1.0)),
    wait=st.integers(0, 9),
)
def test_any_small_map(seed: int, most: float, rate: float, wait: int) -> None:
    some = random_scenes(seed, CRUISES, most)
    given = {"flip_rate": rate, "max_wait": wait, "max_steps": 120}
    result = some.sail(seed, **given)
    for row in range(0, CRUISES, 8):
        assert_right(some, result, row, options_of(given))


def test_nothing_flips(scenes: Scenes) -> None:
    """Then every leg is a shortest path on the first map."""
    result = scenes.sail(flip_rate=0.0, max_wait=1)
    whole = np.flatnonzero(result.status == Status.REACHED)
    assert len(whole) > CRUISES // 4
    for row in whole:
        stops, left = scenes.stops(row), 0.0
        for a, b in pairwise(stops):
            left += replay.plain.distances(scenes.blocked[row], tuple(b), False)[a[1], a[0]]
        assert np.isclose(result.length[row], 10.0 * left / replay.plain.STRAIGHT, rtol=1e-9)
        assert result.replanned[row] == STATIONS


# --- the replay notices ---------------------------------------------------------------------


def test_replay_notices_another_seed(scenes: Scenes, window: CruiseResult) -> None:
    other = replace(window, seeds=window.seeds + np.uint32(1))
    failures = 0
    for row in range(CRUISES):
        try:
            walked(scenes, other, row, replay.Options(max_wait=WAIT))
        except AssertionError:
            failures += 1
    assert failures > CRUISES * 3 // 4


@pytest.mark.parametrize("name", ["track", "leg_step", "seen"])
def test_replay_notices(name: str, scenes: Scenes, window: CruiseResult) -> None:
    row = int(np.argmax((window.status == Status.REACHED) & (window.waits > 0)))
    options = replay.Options(max_wait=WAIT)
    walked(scenes, window, row, options)
    wrong = window
    if name == "track":  # one step early
        track = window.track.copy()
        track[row, 2:] = window.track[row, 1:-1]
        wrong = replace(window, track=track)
    elif name == "leg_step":
        wrong = replace(window, leg_step=window.leg_step - 1)
    else:
        options = replace(options, window=(3, 3))
    with pytest.raises(AssertionError):
        walked(scenes, wrong, row, options)


def test_replay_notices_a_chord_that_hits(scenes: Scenes, window: CruiseResult) -> None:
    """Way points left out at random: chords hit something, or were not needed to be kept."""
    hits = 0
    for row in np.flatnonzero(window.smoothed_count > 4)[:20]:
        at = window.smoothed_step[row, : window.smoothed_count[row]]
        seen = walked(scenes, window, row, replay.Options(max_wait=WAIT))
        fewer, track = np.delete(at, 2), window.track[row, : window.steps[row] + 1]
        try:
            replay.assert_chords_clear(track[fewer], fewer, track, seen, False)
        except AssertionError:
            hits += 1
    assert hits > 10


# --- a cruise depends on nothing else ----------------------------------------------------------


def fields_of(result: CruiseResult, count: int) -> dict[str, np.ndarray]:
    names = ("status", "steps", "leg_step", "expanded", "smooth_length", "visit_step", "seeds")
    found = {name: getattr(result, name)[:count] for name in names}
    width = int(result.steps[:count].max()) + 1
    return found | {"track": result.track[:count, :width]}


def test_lanes_batch_and_devices_do_not_matter(scenes: Scenes, window: CruiseResult) -> None:
    some = scenes.first(24)
    with jax.default_device(None):
        got = some.sail(max_wait=WAIT, max_lanes=16, **CASES["window"][1])
    want = fields_of(window, 24)
    for name, value in fields_of(got, 24).items():
        assert np.array_equal(value, want[name]), name
    assert 0 < got.occupancy <= 1


@pytest.mark.parametrize("shared", [False, True])
def test_blocks_of_rounds_do_not_matter(
    shared: bool, scenes: Scenes, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows: Any = 16 if shared else np.arange(0, CRUISES, 8)
    some = Scenes(scenes.blocked[rows], scenes.stations[rows], scenes.order[rows])
    given = {"method": "astar", "max_wait": 5, "flip_rate": 0.05, "first": 3, "runs": 8}
    want = fields_of(some.sail(**given), 8)
    monkeypatch.setattr(rounds, "MOST_CELLS", 3 * scenes.blocked[0].size)
    got = fields_of(some.sail(**given), 8)
    for name, value in got.items():
        assert np.array_equal(value, want[name]), name


def test_rounds_of_too_large_maps(scenes: Scenes, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "free_memory", lambda: 2**16)
    with pytest.raises(BadInputError, match=r"blocked: 64 cruises at once on 13 x 11 cells needs"):
        scenes.sail(method="astar")


def test_methods_meet_the_same_flips(scenes: Scenes, window: CruiseResult) -> None:
    other = scenes.first(8).sail(method="astar", max_wait=WAIT, flip_rate=0.03)
    assert np.array_equal(other.seeds, window.seeds[:8])
    assert len(np.unique(window.seeds, axis=0)) == CRUISES


# --- planners that start anew ------------------------------------------------------------------


@pytest.fixture
def planned(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Keys that `plan_paths` was given; it finds a shortest path, or for every fourth key none."""
    keys: list[Any] = []

    def plan_paths(blocked: Any, starts: Any, goals: Any, key: Any, **options: Any) -> Any:
        assert options == {"algorithm": "ga", "iterations": 3}
        words = np.asarray(jax.random.key_data(key))
        if blocked.size > 1:  # else the options are checked
            keys.append(words)
        found = astar(blocked, starts, goals)
        fails = (words[:, 1] % 4 == 0) & (found.status == Status.FOUND)
        status = np.where(fails, int(Status.OUT_OF_BUDGET), found.status)
        return SimpleNamespace(status=status, path=found.path, path_cells=found.path_cells)

    monkeypatch.setattr(planners, "plan_paths", plan_paths)
    return keys


def test_planner_that_fails_is_asked_again(
    scenes: Scenes, planned: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = np.arange(0, CRUISES, 8)
    some = Scenes(scenes.blocked[rows], scenes.stations[rows], scenes.order[rows])
    given = {"method": "ga", "planner_options": {"iterations": 3}, "flip_rate": 0.05}
    result = some.sail(max_wait=4, **given)
    for row in range(8):
        options = replace(options_of(given), max_wait=4, certain=False)
        assert_right(some, result, row, options)
    every = np.concatenate(planned)
    assert len(np.unique(every, axis=0)) == len(every) == result.replanned.sum()
    assert result.waits[0] > 0  # in open water it waits for nothing but a plan
    assert result.status[0] == Status.REACHED
    planned.clear()
    monkeypatch.setattr(rounds, "MOST_CELLS", scenes.blocked[0].size)
    again = some.first(3).sail(max_wait=4, **given)
    assert np.array_equal(again.leg_step, result.leg_step[:3])
