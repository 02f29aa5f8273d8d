"""Scenario files of the MovingAI benchmark: starts, goals and published optima.

A scenario file (``.scen``) has one query a line: bucket, map, width, height, start x and y, goal
x and y, length of the shortest route (Sturtevant, Benchmarks for Grid-Based Pathfinding, 2012).
Its lengths are in cells, 8-connected, a diagonal step only where both side cells are free.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import jax
import numpy as np

from usvjax.errors import BadInputError, saying_where
from usvjax.keys import seed_key
from usvjax.maps.disk import read_bytes
from usvjax.maps.files import load_map
from usvjax.maps.grid_map import GridMap

_FIELDS = 9


@dataclass(frozen=True, eq=False)
class Scen:
    """A scenario file with its map.

    Attributes:
        name: of the file, for messages.
        chart: the map.
        starts, goals: int32[N, 2], cells (x, y).
        lengths: float64[N], of the shortest routes as published, cells.
    """

    name: str
    chart: GridMap
    starts: np.ndarray
    goals: np.ndarray
    lengths: np.ndarray

    def __len__(self) -> int:
        return len(self.starts)

    def rows_of(self, seed: int, jobs: np.ndarray) -> np.ndarray:
        """The lines that int64[J] jobs take, int64[J] from 0.

        The file sorts its lines by length, so a study of its first hundred would be one of the
        shortest; job j takes the j-th of a random order of all lines instead.
        """
        numbers = jax.random.bits(seed_key(seed), (len(self),), np.uint32)
        rows: np.ndarray = np.argsort(np.asarray(numbers), kind="stable")[jobs]
        return rows

    def check(self, where: str) -> None:
        """Raise BadInputError when a query starts or ends off the map or on a blocked cell."""
        height, width = self.chart.shape
        for end, cells in (("start", self.starts), ("goal", self.goals)):
            outside = ((cells < 0) | (cells >= (width, height))).any(axis=1)
            x, y = np.where(outside, 0, cells.T)
            bad = outside | self.chart.blocked[y, x]
            if bad.any():
                row = int(bad.argmax())
                raise BadInputError(
                    f"{where}: {self.name} line {row + 2}: the {end} {cells[row].tolist()} "
                    f"is no free cell of the map of {width} x {height} cells"
                )


def read_scen(name: str, map_name: str | None, cell_size: float, folder: Path, where: str) -> Scen:
    """Read a scenario file and its map.

    Args:
        name: of the scenario file.
        map_name: of the map file; by default the one that the scenario file names, beside it.
        cell_size: m.
        folder: what relative paths are relative to.
        where: the study file and table, for the messages.

    Raises:
        BadInputError: a file is missing or malformed, or they do not belong together.
    """
    if not 0.0 < cell_size < math.inf:
        raise BadInputError(f"{where}: 'cell_size' must be above 0, got {cell_size:g}")
    path = folder / name
    with saying_where(where):
        rows = _rows(path, where)
        named = path.parent / Path(rows[0][1]).name
        chart = load_map(folder / map_name if map_name else named, cell_size=cell_size)
    height, width = chart.shape
    table = np.asarray(
        [
            _query(row, (width, height), f"{where}: {path} line {line}")
            for line, row in enumerate(rows, start=2)
        ]
    )
    starts, goals = table[:, :2].astype(np.int32), table[:, 2:4].astype(np.int32)
    return Scen(name, chart, starts, goals, table[:, 4])


def _query(row: list[str], size: tuple[int, int], where: str) -> tuple[float, ...]:
    """Start x and y, goal x and y, length of one line."""
    try:
        width, height, *ends = (int(word) for word in row[2:8])
        length = float(row[8])
    except ValueError:
        raise BadInputError(f"{where} is no query: {' '.join(row)!r}") from None
    if (width, height) != size:
        raise BadInputError(
            f"{where} is for a map of {width} x {height} cells, the map has {size[0]} x {size[1]}"
        )
    if not 0.0 <= length < math.inf:
        raise BadInputError(f"{where}: the length is {length}; wanted 0 or more")
    return (*ends, length)


def _rows(path: Path, where: str) -> list[list[str]]:
    """The words of every line of a scenario file after its first."""
    lines = read_bytes(path).decode(errors="replace").rstrip().splitlines()
    rows = [line.split() for line in lines[1:]]
    if not lines or not lines[0].startswith("version"):
        raise BadInputError(f"{where}: {path} is no MovingAI scenario file: no 'version' in line 1")
    if not rows:
        raise BadInputError(f"{where}: {path} holds no query")
    for line, row in enumerate(rows, start=2):
        if len(row) != _FIELDS:
            raise BadInputError(
                f"{where}: {path} line {line} has {len(row)} fields; wanted bucket, map, width, "
                "height, start x, start y, goal x, goal y, length"
            )
    return rows
