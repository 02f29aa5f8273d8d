"""Where D* Lite keeps what: grids within a margin, flat, and the choices of method."""

import math
from dataclasses import dataclass

import numpy as np

from usvkernels.search.steps import DIAGONAL

INFINITE = 2**30
"""rhs and g where no path is known; lengths stay below, 13,291 cells."""

BLOCKED = INFINITE + 1  # g of a cell that is not navigable
NONE = 2**31 - 1  # key of a cell that is not queued
LENGTH_LIMIT = INFINITE - 2 * DIAGONAL  # expanding past this might hide a path behind INFINITE

TOP = 4  # blocked rows above the map, the inner of which idle lanes touch
_SIDE = 2  # blocked columns to the right; to the left lie those of the row before
_BOTTOM = 2


@dataclass(frozen=True)
class Layout:
    """A map of height x width cells within its margin, flat."""

    height: int
    width: int

    @property
    def rows(self) -> int:
        """Rows, margin included."""
        return self.height + TOP + _BOTTOM

    @property
    def stride(self) -> int:
        """Columns, margin included."""
        return self.width + _SIDE

    @property
    def block(self) -> int:
        """Cells of which one bound is kept: reading one costs about ten times a bound's."""
        return max(16, 1 << round(math.log2(self.rows * self.stride / 10) / 2))

    @property
    def blocks(self) -> int:
        """Blocks of a plane."""
        return -(-self.rows * self.stride // self.block)

    @property
    def size(self) -> int:
        """Cells of a plane, whole blocks."""
        return self.blocks * self.block

    @property
    def void(self) -> int:
        """A cell of the margin whose neighbours are all of the margin, for idle lanes."""
        return 2 * self.stride + 2

    def index(self, cells: np.ndarray) -> np.ndarray:
        """Where cells int[..., 2], as (x, y), are in a plane; int32[...]."""
        return ((cells[..., 1] + TOP) * self.stride + cells[..., 0]).astype(np.int32)

    def cells(self, index: np.ndarray) -> np.ndarray:
        """The inverse of `index`: int32[..., 2], as (x, y)."""
        y, x = np.divmod(index, self.stride)
        return np.stack([x, y - TOP], axis=-1).astype(np.int32)

    def plane(self, blocked: np.ndarray) -> np.ndarray:
        """Maps bool[..., H, W] with their margin, bool[..., size]."""
        plane = np.ones((*blocked.shape[:-2], self.size), bool)
        inner = plane[..., : self.rows * self.stride].reshape(
            *blocked.shape[:-2], self.rows, self.stride
        )
        inner[..., TOP : TOP + self.height, : self.width] = blocked
        return plane


@dataclass(frozen=True)
class ReplanStatic:
    """Choices of method; hashable.

    Attributes:
        layout: size of the maps.
        heuristic: of `replan_heuristics.HEURISTICS`.
        weight: of "weighted_octile"; None takes that of Yu's Eq. 17.
        corner_cutting: whether a diagonal step needs only its target free, not both sides.
        sensing: (h, w) of the window about the vessel in which changes are noticed; None: all are.
    """

    layout: Layout
    heuristic: str = "octile"
    weight: float | None = None
    corner_cutting: bool = False
    sensing: tuple[int, int] | None = None
