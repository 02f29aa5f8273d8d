"""What paths on grids consist of, and what they cost by the paper's prices."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import sqrt

import numpy as np

from experiments.zhang2019.published import DIAGONAL, GAMMA
from usvkernels.status import Status

EXACT_DIAGONAL = sqrt(2.0)


@dataclass(frozen=True)
class Paths:
    """What n paths consist of; arrays in the order of the maps.

    Attributes:
        found: bool[n].
        straight, diagonal: int[n], steps.
        turns: int[n], changes of course added up, in multiples of 45 degrees.
        bends: int[n], places where the course changes.
        expanded: int[n], cells.
    """

    found: np.ndarray
    straight: np.ndarray
    diagonal: np.ndarray
    turns: np.ndarray
    bends: np.ndarray
    expanded: np.ndarray

    def length(self, diagonal: float = DIAGONAL) -> np.ndarray:
        """Length in squares; float[n]."""
        length: np.ndarray = self.straight + diagonal * self.diagonal
        return length

    @property
    def turning(self) -> np.ndarray:
        """Turning cost in squares; float[n]."""
        turning: np.ndarray = GAMMA * self.turns
        return turning

    def total(self, diagonal: float = DIAGONAL) -> np.ndarray:
        """Length and turning cost; float[n]."""
        return self.length(diagonal) + self.turning

    def some(self, chosen: np.ndarray) -> "Paths":
        """Return those that a mask or an index names."""
        return Paths(**{f.name: getattr(self, f.name)[chosen] for f in fields(self)})


def paths_of(columns: Mapping[str, np.ndarray]) -> Paths:
    """The paths of one method of a study, from its columns."""
    names = [f.name for f in fields(Paths) if f.name != "found"]
    return Paths(columns["status"] == Status.FOUND, *(columns[name] for name in names))


def counted(cells: np.ndarray) -> dict[str, np.ndarray]:
    """Count steps and turns.

    Args:
        cells: int[n, P, 2], cells of each path, the last one repeated.

    Returns:
        int32[n] each: "straight", "diagonal", "turns" and "bends", as in `Paths`.
    """
    step = np.diff(cells, axis=1)
    moved = np.abs(step).sum(axis=2)
    direction = np.round(np.arctan2(step[..., 1], step[..., 0]) / (np.pi / 4)).astype(int)
    apart = np.abs(np.diff(direction, axis=1)) % 8
    turns = np.where(moved[:, 1:] > 0, np.minimum(apart, 8 - apart), 0)
    found = {
        "straight": (moved == 1).sum(axis=1),
        "diagonal": (moved == 2).sum(axis=1),
        "turns": turns.sum(axis=1),
        "bends": (turns > 0).sum(axis=1),
    }
    return {name: count.astype(np.int32) for name, count in found.items()}
