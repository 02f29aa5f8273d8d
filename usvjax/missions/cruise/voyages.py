"""What came of cruises, whatever the method: the track and how each leg ended."""

from dataclasses import dataclass

import numpy as np

from usvkernels.cruise.sailing import STAY


@dataclass(frozen=True)
class Voyages:
    """How B cruises of d legs went.

    Attributes:
        track: int32[B, T + 1, 2], cells (x, y) after each step, home first; the last is repeated.
        steps: int32[B], moves and waits.
        waits: int32[B], steps without a move.
        leg_status: int32[B, d], `Status`: REACHED; UNREACHABLE where the stop was given up for
            there was no way, OUT_OF_BUDGET where none was found within a budget; TIMED_OUT; RUNNING
            where the leg did not begin.
        leg_step: int32[B, d], step of the cruise at which it ended.
        expanded: int64[B], cells.
        plans: int32[B], steps at which the way was planned or changed.
        occupancy: share of lane-iterations that advanced a cruise.
    """

    track: np.ndarray
    steps: np.ndarray
    waits: np.ndarray
    leg_status: np.ndarray
    leg_step: np.ndarray
    expanded: np.ndarray
    plans: np.ndarray
    occupancy: float


def joined_moves(parts: list[np.ndarray]) -> np.ndarray:
    """Moves uint8[n, T] of cruises that follow one another, filled up with STAY; uint8[B, T]."""
    longest = max(part.shape[1] for part in parts)
    joined = np.full((sum(map(len, parts)), longest), STAY, np.uint8)
    first = 0
    for part in parts:
        joined[first : first + len(part), : part.shape[1]] = part
        first += len(part)
    return joined


def voyages_of(home: np.ndarray, moves: np.ndarray, legs: np.ndarray, occupancy: float) -> Voyages:
    """Put together what the kernels log.

    Args:
        home: int32[B, 2], cells (x, y).
        moves: uint8[B, T], codes of the moves.
        legs: int32[B, d, 4]: status, step at the end, cells expanded, plans.
        occupancy: of the lanes.
    """
    steps = legs[:, :, 1].max(axis=1).astype(np.int32)
    moves = moves[:, : max(int(steps.max()), 1)]
    move = np.stack([moves % 3, moves // 3], axis=-1).astype(np.int32) - 1
    made = np.arange(moves.shape[1]) < steps[:, None]
    move[~made] = 0
    track = np.concatenate([home[:, None], move], axis=1).cumsum(axis=1, dtype=np.int32)
    return Voyages(
        track=track,
        steps=steps,
        waits=(made & ~move.any(axis=-1)).sum(axis=1, dtype=np.int32),
        leg_status=legs[:, :, 0],
        leg_step=legs[:, :, 1],
        expanded=legs[:, :, 2].sum(axis=1, dtype=np.int64),
        plans=legs[:, :, 3].sum(axis=1, dtype=np.int32),
        occupancy=occupancy,
    )
