"""What the planners hand back, and how moves become cells."""

from dataclasses import dataclass

import numpy as np

from usvkernels.planners.moves import MOVES


@dataclass(frozen=True)
class Tracks:
    """Paths of n queries.

    Attributes:
        cells: int32[n, P, 2], (x, y) from the start on; past `count` undefined.
        count: int64[n], cells of each path.
        length: float64[n], in cells; inf where there is none.
        history: float64[n, iterations], length of the best path so far.
    """

    cells: np.ndarray
    count: np.ndarray
    length: np.ndarray
    history: np.ndarray


def tracks_of_moves(
    starts: np.ndarray, move: np.ndarray, steps: np.ndarray, history: np.ndarray
) -> Tracks:
    """Follow moves from the starts.

    Args:
        starts: int[n, 2], cells (x, y).
        move: int[n, M], indices into `moves.MOVES`; past `steps` undefined.
        steps: int[n], moves of each path; 0 where there is no path.
        history: float[n, iterations].
    """
    move = move[:, : max(1, steps.max(initial=1))]
    made = np.arange(move.shape[1]) < steps[:, None]
    moved = np.where(made[..., None], np.array(MOVES)[move], 0)
    cells = np.cumsum(np.concatenate([starts[:, None], moved], axis=1), axis=1)
    diagonals = np.count_nonzero(made & (move >= 4), axis=1)
    length = (steps - diagonals) + diagonals * np.sqrt(2.0)
    return Tracks(
        cells=cells.astype(np.int32),
        count=steps + 1,
        length=np.where(steps > 0, length, np.inf),
        history=history.astype(np.float64),
    )
