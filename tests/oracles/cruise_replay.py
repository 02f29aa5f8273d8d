"""Cruises walked again step by step in plain NumPy, from the seeds and nothing else of the product.

Of the package only the numbers drawn from counters are taken; which cells flip, what the vessel
knows, where it may go and whether it is cut off is worked out anew.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import dstar_reference as plain
import jax
import numpy as np

from usvkernels.draws import words
from usvkernels.status import Status

_words = jax.jit(words)

GIVEN_UP = (Status.UNREACHABLE, Status.OUT_OF_BUDGET)
"""How legs end whose stop is left out: there was no way, or none was found."""


@dataclass
class Options:
    """How the cells flip and the vessel behaves, as the arguments of `cruise` have it."""

    rate: float = 0.03
    scope: str = "window"
    window: tuple[int, int] = (5, 5)
    corner_cutting: bool = False
    max_wait: int = 100
    max_steps: int = 192  # 8 times height plus width
    certain: bool = True  # the vessel finds a way where there is one
    shortest: bool = True  # every move is along a shortest path on the map as known


@dataclass
class Walked:
    """What a replay found."""

    maps: list[np.ndarray] = field(default_factory=list)  # bool[H, W], the true one at each step
    known: np.ndarray = field(default_factory=lambda: np.zeros(0, bool))
    visit_step: dict[int, int] = field(default_factory=dict)  # by station
    home: bool = False
    waits: int = 0


def tape(seed: np.ndarray, steps: int, shape: tuple[int, int], rate: float) -> np.ndarray:
    """Which cells would flip at each step, bool[steps, H, W]."""
    cells = np.arange(shape[0] * shape[1])
    wide = 512 * (steps // 512 + 1)  # few sizes to compile
    word = np.asarray(_words(seed[:, None, None], np.arange(wide)[:, None], cells)[0])[:steps]
    return ((word >> 8) < round(rate * 2**24)).reshape(steps, *shape)


def window_of(here: np.ndarray, window: tuple[int, int], shape: tuple[int, int]) -> np.ndarray:
    """The cells that a vessel sees, bool[H, W]."""
    y, x = np.indices(shape)
    return (abs(x - here[0]) <= window[1] // 2) & (abs(y - here[1]) <= window[0] // 2)


def walk(
    blocked: np.ndarray,
    stops: np.ndarray,
    seed: np.ndarray,
    track: np.ndarray,
    leg_status: np.ndarray,
    leg_step: np.ndarray,
    options: Options,
) -> Walked:
    """Replay a cruise and assert that every step of it is right.

    Args:
      blocked: bool[H, W], the first map.
      stops: int[d + 1, 2], cells in the order of the cruise, home first and last.
      seed: uint32[2].
      track: int[steps + 1, 2].
      leg_status, leg_step: int[d].
      options: of the cruise.
    """
    walked, steps = Walked(), len(track) - 1
    flips = tape(seed, steps + 1, blocked.shape, options.rate)
    flips[:, stops[:, 1], stops[:, 0]] = False
    truth, known = blocked.copy(), blocked.copy()
    legs = _legs(leg_status, leg_step)
    leg = next(legs, None)
    waited = begun = 0
    assert np.array_equal(track[0], stops[0])
    for step in range(steps + 1):
        here = track[step]
        while leg is not None and leg[1:] == (Status.REACHED, step):
            assert np.array_equal(here, stops[leg[0] + 1]), f"step {step}: not at its stop"
            walked.visit_step[leg[0] + 1] = step
            leg, waited, begun = next(legs, None), 0, step
        if leg is None or leg[1:] == (Status.TIMED_OUT, step):
            assert step == steps, f"step {step}: sails on without a stop"
            assert leg is None or step - begun == options.max_steps
            leg = None
            break
        window = window_of(here, options.window, blocked.shape)
        flips[step, here[1], here[0]] = False
        truth ^= flips[step] & window if options.scope == "window" else flips[step]
        known[window] = truth[window]
        walked.maps.append(truth.copy())
        while leg is not None and leg[1] in GIVEN_UP and leg[2] == step:
            assert waited >= options.max_wait, f"step {step}: gave up after {waited} steps"
            left = _distance(known, stops[leg[0] + 1], options)
            proven = leg[1] == Status.UNREACHABLE
            assert np.isinf(left[here[1], here[0]]) if proven else not options.certain
            leg, waited, begun = next(legs, None), 0, step
            while leg is not None and leg[1:] == (Status.REACHED, step):
                assert np.array_equal(here, stops[leg[0] + 1])
                walked.visit_step[leg[0] + 1] = step
                leg = next(legs, None)
        if step == steps:
            break
        assert leg is not None, f"step {step}: sails on without a stop"
        waited = _checked_step(known, track[step : step + 2], stops[leg[0] + 1], waited, options)
        assert not truth[track[step + 1, 1], track[step + 1, 0]]
        walked.waits += waited > 0
    assert leg is None, f"leg {leg} is left"
    walked.known = known
    walked.home = leg_status[-1] == Status.REACHED
    return walked


def _legs(leg_status: np.ndarray, leg_step: np.ndarray) -> Iterator[tuple[int, int, int]]:
    for number, (status, step) in enumerate(zip(leg_status, leg_step, strict=True)):
        if status != Status.RUNNING:
            yield number, int(status), int(step)


def _distance(known: np.ndarray, goal: np.ndarray, options: Options) -> np.ndarray:
    return plain.distances(known, (int(goal[0]), int(goal[1])), options.corner_cutting)


def _checked_step(
    known: np.ndarray, ends: np.ndarray, goal: np.ndarray, waited: int, options: Options
) -> int:
    """Assert that a step is allowed and sensible; returns the steps waited in a row."""
    (x, y), there = ends.tolist()
    left = _distance(known, goal, options)
    if [x, y] == there:
        assert not options.certain or np.isinf(left[y, x]), f"waits at {there} with a way ahead"
        return waited + 1
    moves = dict(plain.steps_from(known, (x, y), options.corner_cutting))
    assert tuple(there) in moves, f"no move from {(x, y)} to {there}"
    assert np.isfinite(left[y, x])
    if options.shortest:
        assert left[y, x] == moves[tuple(there)] + left[there[1], there[0]], "not a shortest way"
    return 0


def chord_cells(a: np.ndarray, b: np.ndarray, corner_cutting: bool) -> set[tuple[int, int]]:
    """Cells, as closed squares, that the segment between two cells' centres meets.

    With corner cutting, those of which it meets more than a corner. By clipping the segment to
    every cell of its bounding box, in whole numbers.
    """
    (ax, ay), (bx, by) = a.tolist(), b.tolist()
    found = set()
    for x in range(min(ax, bx), max(ax, bx) + 1):
        for y in range(min(ay, by), max(ay, by) + 1):
            # Corners of the cell on both sides of the line, or on it; in half cells.
            sides = [
                (bx - ax) * (2 * (y - ay) + v) - (by - ay) * (2 * (x - ax) + u)
                for u in (-1, 1)
                for v in (-1, 1)
            ]
            meets = min(sides) <= 0 <= max(sides)
            if meets and (not corner_cutting or min(sides) < 0 < max(sides)):
                found.add((x, y))
    return found


def assert_chords_clear(
    way: np.ndarray, at: np.ndarray, track: np.ndarray, walked: Walked, corner_cutting: bool
) -> None:
    """Every chord between way points is clear on every map of the steps that it replaces.

    Args:
      way: int[Q, 2], cells; at: int[Q], their steps.
      track: int[steps + 1, 2].
      walked: of `walk`.
      corner_cutting: of the cruise.
    """
    assert at[0] == 0
    assert at[-1] == len(track) - 1
    assert np.all(np.diff(at) > 0)
    assert np.array_equal(track[at], way)
    for first, last in pairwise(at):
        assert _clear(track, first, last, walked, corner_cutting), f"steps {first} to {last}"


def assert_no_needless_point(
    at: np.ndarray, track: np.ndarray, walked: Walked, visits: np.ndarray, corner_cutting: bool
) -> None:
    """From each way point on, the next is a stop or the last cell before one out of sight."""
    assert set(visits[visits >= 0].tolist()) <= set(at.tolist())
    for first, last in pairwise(at):
        between = visits[(visits > first) & (visits < last)]
        assert not len(between)
        for step in range(first + 1, last):
            assert _clear(track, first, step, walked, corner_cutting)
        if last not in visits and last != at[-1]:
            assert not _clear(track, first, last + 1, walked, corner_cutting)


def _clear(track: np.ndarray, first: int, last: int, walked: Walked, corner_cutting: bool) -> bool:
    """Whether a chord meets no cell that was blocked at a step from `first` to before `last`."""
    blocked = np.logical_or.reduce(walked.maps[first:last])
    return not any(blocked[y, x] for x, y in chord_cells(track[first], track[last], corner_cutting))
