"""One map that all jobs of a study share: found, refined, inflated, and what its water is."""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Protocol, TypeVar

import numpy as np

from usvjax.checks import file_path
from usvjax.errors import BadInputError, saying_where
from usvjax.maps.grid_map import GridMap, check_size
from usvjax.maps.hongze import find_map
from usvjax.maps.tables import Opened


class ChartOptions(Protocol):
    """What a `[maps]` table says of the one map that all jobs share."""

    @property
    def map(self) -> str:
        """A packaged map's name, or a map file."""

    @property
    def cell_size(self) -> float | None:
        """Edge of a cell of a plain image, m."""

    @property
    def refine(self) -> int:
        """Into how many parts the edge of a cell is divided."""


S = TypeVar("S")
T = TypeVar("T", bound=ChartOptions)


def on_chart(
    options: T, source_of: Callable[[GridMap, T], S], folder: Path, where: str
) -> Opened[S]:
    """Read the map that options name; `source_of` map and options is what draws on it."""
    grid, digest = read_chart(options.map, options.cell_size, options.refine, folder, where)
    return Opened(options, source_of(grid, options), {options.map: digest})


def read_chart(
    name: str, cell_size: float | None, refine: int, folder: Path, where: str
) -> tuple[GridMap, str]:
    """Find the map that a `[maps]` table names.

    Args:
        name: of a packaged map, or a file; one beside the study comes first.
        cell_size: m, for a plain image.
        refine: into how many parts the edge of a cell is divided.
        folder: what a relative path is relative to.
        where: the study file and table, for the messages.

    Returns:
        The map, and the SHA-256 of what its cells mean, whatever file they came from.

    Raises:
        BadInputError: there is no such map, or it cannot be read.
    """
    if refine < 1:
        raise BadInputError(f"{where}: 'refine' must be at least 1, got {refine}")
    with saying_where(where):
        beside = folder / file_path("map", name)
        is_beside = os.path.exists(beside) and not os.path.isdir(beside)
        grid = find_map(str(beside) if is_beside else name, cell_size=cell_size)
        height, width = (refine * side for side in grid.shape)
        check_size(height, width, f"{name!r} with 'refine' of {refine}")
        grid = grid.refined(refine)
    return grid, map_digest(grid)


def map_digest(grid: GridMap) -> str:
    """SHA-256 of what a map's cells mean, whatever file they came from."""
    header = f"{grid.shape} {grid.cell_size!r} {grid.origin!r} ".encode()
    return hashlib.sha256(header + grid.blocked.tobytes()).hexdigest()


def inflated(chart: GridMap, radius: float) -> GridMap:
    """The map with what lies within a radius (m) of the shore blocked as well; itself for 0."""
    return chart.inflated(radius) if radius else chart


def off_shore(chart: GridMap, distance: float) -> np.ndarray:
    """Cells whose centre is `distance` (m) or more from any blocked one's, bool[H, W]."""
    return chart.clearance() >= distance


def cells_where(allowed: np.ndarray) -> np.ndarray:
    """(x, y) of the cells that bool[H, W] allows, int64[N, 2], row by row."""
    return np.argwhere(allowed)[:, ::-1]


class OnChart:
    """What a source of scenes says where all jobs share a map.

    Attributes:
        chart: the map, before it was inflated.
    """

    chart: GridMap

    @property
    def shape(self) -> tuple[int, int]:
        """(H, W): rows and columns."""
        return self.chart.shape

    @property
    def cell_size(self) -> float:
        """Edge of a cell, m."""
        return self.chart.cell_size

    @property
    def origin(self) -> tuple[float, float]:
        """South-west corner of cell (0, 0), m."""
        return self.chart.origin

    @property
    def most_jobs(self) -> int | None:
        """How many jobs there can be; None where any number can be drawn."""
        return None
