"""Corners that no template fits, moved until one does."""

from collections.abc import Callable
from math import pi
from typing import Any

import numpy as np

from usvjax.paths.corners import TurnLimits
from usvjax.paths.inputs import Frame
from usvjax.paths.water import segments_clear
from usvkernels.paths.turning import Turn

DIRECTIONS = 8
SHARES = (0.25, 0.5, 1.0)  # of the turning radius, how far a corner is moved; besides one cell


def repair_corners(
    points: np.ndarray,
    counts: np.ndarray,
    cases: np.ndarray,
    frame: Frame,
    limits: TurnLimits,
    turn: Callable[..., tuple[np.ndarray, ...]],
    rounds: int,
    corner_cutting: bool,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Move corners of paths on which some are left over.

    A round takes one corner left over on each path and tries to move it, or the one before or
    after it, by whole cells in eight directions; both new segments must be clear. Kept is the
    move that leaves the fewest corners over, then the shortest path, if these are fewer than
    before; if none is, the next corner left over has its turn in the next round.

    Args:
        points: float64[B, P, 2], from the map's corner, m.
        counts: int32[B].
        cases: int32[B, C] of `Turn`, how the corners are sailed now.
        frame: the maps.
        limits: what smoothing must respect.
        turn: `turn_corners`.
        rounds: most rounds.
        corner_cutting: let moved segments touch corners of blocked cells.

    Returns:
        The paths, points and counts, and bool[B], which of them changed.
    """
    points, cases = points.copy(), cases.copy()
    changed = np.zeros(len(points), bool)
    tried = np.zeros(len(points), int)  # corners left over that no move has helped
    for _ in range(rounds):
        left = (cases == Turn.UNFITTED).sum(axis=1)
        rows = np.flatnonzero(left > tried)
        if not len(rows):
            break
        moved, owner = _moves(points, counts, cases, rows, tried, frame, limits, corner_cutting)
        tried[rows] += 1
        if not len(moved):
            continue
        found = turn(moved, counts[owner], owner, frame, limits)
        now, length = (found[0] == Turn.UNFITTED).sum(axis=1), found[4].sum(axis=1)
        order = np.lexsort((length, now, owner))
        best = order[np.unique(owner[order], return_index=True)[1]]
        best = best[now[best] < left[owner[best]]]
        better = owner[best]
        points[better], cases[better] = moved[best], found[0][best]
        changed[better], tried[better] = True, 0
    return points, counts, changed


def _moves(
    points: np.ndarray,
    counts: np.ndarray,
    cases: np.ndarray,
    rows: np.ndarray,
    tried: np.ndarray,
    frame: Frame,
    limits: TurnLimits,
    corner_cutting: bool,
) -> tuple[np.ndarray, np.ndarray]:
    """Paths with one corner moved, float64[n, P, 2], and int[n], the row each is a form of."""
    moved: list[Any] = []
    owner: list[Any] = []
    for row in rows:
        corner = int(np.flatnonzero(cases[row] == Turn.UNFITTED)[tried[row]]) + 1
        steps = _steps(limits.radius[row] / frame.cell_size) * frame.cell_size
        for i in {max(corner - 1, 1), corner, min(corner + 1, int(counts[row]) - 2)}:
            forms = np.repeat(points[row][None], len(steps), axis=0)
            forms[:, i] += steps
            ends = (forms[:, i - 1], forms[:, i + 1])
            which = np.full(len(steps), row)
            clear = np.ones(len(steps), bool)
            for end in ends:
                clear &= segments_clear(
                    forms[:, i] / frame.cell_size,
                    end / frame.cell_size,
                    which,
                    frame,
                    corner_cutting,
                )
                clear &= np.any(forms[:, i] != end, axis=1)
            moved.append(forms[clear])
            owner.append(which[clear])
    return np.concatenate(moved), np.concatenate(owner)


def _steps(radius: float) -> np.ndarray:
    """Displacements in whole cells, float64[n, 2]."""
    distances = sorted({1, *(max(1, round(share * radius)) for share in SHARES)})
    angles = np.arange(DIRECTIONS) * (2 * pi / DIRECTIONS)
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    steps = np.concatenate([np.rint(distance * ring) for distance in distances])
    return np.unique(steps, axis=0)
