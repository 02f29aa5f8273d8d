"""Paths from the notes that a search leaves in its cells."""

from dataclasses import dataclass

import numpy as np

from usvjax.memory import check_memory
from usvkernels.search.astar import NO_HEADING
from usvkernels.search.astar_costs import DIRECTIONS, AstarStatic

_ANGLE = np.full((3, 3), -1)
"""Direction by dy + 1 and dx + 1; -1 where there is no step."""
for _direction, (_dx, _dy) in enumerate(DIRECTIONS):
    _ANGLE[_dy + 1, _dx + 1] = _direction


@dataclass(frozen=True)
class TracedPaths:
    """The paths of n queries, all of which arrived.

    Attributes:
        cells: int32[n, P, 2], (x, y) from start to goal, the goal repeated.
        count: int32[n], cells of each path.
        length: float64[n], in cells.
        turns: int64[n], turning angles added up, in multiples of 45 degrees.
    """

    cells: np.ndarray
    count: np.ndarray
    length: np.ndarray
    turns: np.ndarray


def check_paths(count: int, longest: int) -> None:
    """Refuse to make an array of paths, int32[count, longest, 2], that memory cannot hold.

    Raises:
        BadInputError: naming both figures.
    """
    check_memory(8 * count * longest, f"starts: {count:,} paths of up to {longest:,} cells")


def trace(static: AstarStatic, steps: np.ndarray, rows: np.ndarray, end: np.ndarray) -> TracedPaths:
    """Follow the parents back from the goals.

    Args:
        static: of the search.
        steps: uint8[B, size], how each state was entered.
        rows: int[n], the queries that arrived.
        end: int[n], their goals' states.
    """
    stride, size = static.stride, steps.shape[1]
    back = np.array([dy * stride + dx for dx, dy in DIRECTIONS])
    flat = steps.reshape(-1)
    straight, diagonal, turns = (np.zeros(len(rows), np.int64) for _ in range(3))
    after = np.full(len(rows), -1)
    track: list[tuple[np.ndarray, np.ndarray]] = []
    path, state = np.arange(len(rows)), end.astype(np.int64)
    while True:
        track.append((path, state // static.headings))
        entered = flat[rows[path] * size + state].astype(np.int64)
        going = np.flatnonzero(entered != NO_HEADING)
        if not len(going):
            break
        path, state, entered = path[going], state[going], entered[going]
        if static.headings == 1:
            direction = entered & 7
            state = state - back[direction]
        else:
            direction = state & 7
            state = ((state >> 3) - back[direction]) * 8 + entered
        diagonal[path] += direction & 1
        straight[path] += ~direction & 1
        apart = (after[path] - direction) & 7
        turns[path] += np.where(after[path] < 0, 0, np.minimum(apart, 8 - apart))
        after[path] = direction
    count = straight + diagonal + 1
    return TracedPaths(
        cells=_cells(static, track, count, end // static.headings),
        count=count.astype(np.int32),
        length=straight + diagonal * np.sqrt(2.0),
        turns=turns,
    )


def _cells(
    static: AstarStatic,
    track: list[tuple[np.ndarray, np.ndarray]],
    count: np.ndarray,
    goal: np.ndarray,
) -> np.ndarray:
    """Cells (x, y) of paths that were followed from the goal."""
    places = np.repeat(goal.astype(np.int32)[:, None], len(track), axis=1)
    for back, (path, place) in enumerate(track):
        places[path, count[path] - 1 - back] = place
    y, x = np.divmod(places, np.int32(static.stride))
    return np.stack([x - 1, y - 1], axis=-1)


def turning_of(path: np.ndarray) -> np.ndarray:
    """Turning angles along paths of cells added up, in multiples of 45 degrees.

    Args:
        path: int[n, P, 2], the last cell repeated.

    Returns:
        int64[n].
    """
    dx, dy = np.moveaxis(np.diff(path, axis=1), 2, 0)
    angle = _ANGLE[dy + 1, dx + 1]
    apart = (angle[:, 1:] - angle[:, :-1]) & 7
    turns = np.where(angle[:, 1:] < 0, 0, np.minimum(apart, 8 - apart))
    return turns.sum(axis=1, dtype=np.int64)
