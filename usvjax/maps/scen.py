"""Scenario files of the MovingAI benchmark: starts, goals and published optima.

A scenario file (``.scen``) has one query a line: bucket, map, width, height, start x and y, goal
x and y, length of the shortest route (Sturtevant, Benchmarks for Grid-Based Pathfinding, 2012).
Its lengths are in cells, 8-connected, a diagonal step only where both side cells are free; a length
of 0 between two cells, as some public files have it throughout, says that it is not known.
"""

import math
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath

import jax
import numpy as np

from usvjax.checks import file_path, shown
from usvjax.errors import BadInputError, saying_where
from usvjax.keys import seed_key
from usvjax.maps.disk import MOST_QUERIES, read_text
from usvjax.maps.files import load_map
from usvjax.maps.grid_map import GridMap

_FIELDS = 9

ROUNDING = 1e-3
"""By what share a published length may be off: some files give four digits."""


@dataclass(frozen=True, eq=False)
class Scen:
    """A scenario file with its map.

    Attributes:
        name: of the file, for messages.
        chart: the map.
        starts, goals: int32[N, 2], cells (x, y).
        lengths: float64[N], of the shortest routes as published, cells; 0 where none was.
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


def read_scen(name: str, map_name: str | None, cell_size: float, folder: Path, where: str) -> Scen:
    """Read a scenario file and its map.

    Args:
        name: of the scenario file.
        map_name: of the map file; by default the one that the scenario file names, beside it.
        cell_size: m.
        folder: what relative paths are relative to.
        where: the study file and table, for the messages.

    Raises:
        BadInputError: a file is missing or malformed, they do not belong together, or a query
            has an end on no free cell or a length that no shortest route between its ends has.
    """
    if not 0.0 < cell_size < math.inf:
        raise BadInputError(f"{where}: 'cell_size' must be above 0, got {cell_size:g}")
    with saying_where(where):
        path = folder / file_path("scen", name)
        rows = _rows(path)
        named = path.parent / _map_name(rows[0][1])
        chart = load_map(folder / map_name if map_name else named, cell_size=cell_size)
        for number, row in rows:
            if not map_name and _map_name(row) != named.name:
                raise BadInputError(
                    f"{path} line {number} is for the map {shown(_map_name(row))}, line "
                    f"{rows[0][0]} for {shown(named.name)}; wanted one map, or 'map' to say which"
                )
        table = np.asarray([_query(row, chart, f"{path} line {number}") for number, row in rows])
    starts, goals = table[:, :2].astype(np.int32), table[:, 2:4].astype(np.int32)
    return Scen(name, chart, starts, goals, table[:, 4])


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    """The number and the words of every line of a scenario file that holds a query."""
    lines = read_text(path, MOST_QUERIES).splitlines()
    if not lines or not lines[0].lower().startswith("version"):
        raise BadInputError(f"{path} is no MovingAI scenario file: no 'version' in line 1")
    # Between tabs, the name of a map may have spaces.
    rows = [
        (number, [word.strip() for word in line.split("\t" if "\t" in line else None)])
        for number, line in enumerate(lines[1:], start=2)
        if line.strip()
    ]
    if not rows:
        raise BadInputError(f"{path} holds no query")
    for number, row in rows:
        if len(row) != _FIELDS:
            raise BadInputError(
                f"{path} line {number} has {len(row)} fields; wanted bucket, map, width, height, "
                "start x, start y, goal x, goal y, length"
            )
    return rows


def _map_name(row: list[str]) -> str:
    """The map that a line names, without the folder that it was in on somebody's machine."""
    return PureWindowsPath(row[1]).name


def _query(row: list[str], chart: GridMap, where: str) -> tuple[float, ...]:
    """Start x and y, goal x and y, length of one line."""
    try:
        width, height, *ends = (int(word) for word in row[2:8])
        length = float(row[8])
    except ValueError:
        raise BadInputError(f"{where} is no query: {shown(' '.join(row))}") from None
    if (height, width) != chart.shape:
        raise BadInputError(
            f"{where} is for a map of {shown(width)} x {shown(height)} cells, the map has "
            f"{chart.shape[1]} x {chart.shape[0]}"
        )
    start, goal = ends[:2], ends[2:]
    for end, (x, y) in (("start", start), ("goal", goal)):
        if not (0 <= x < width and 0 <= y < height) or chart.blocked[y, x]:
            raise BadInputError(
                f"{where}: the {end} [{shown(x)}, {shown(y)}] is no free cell of the map of "
                f"{width} x {height} cells"
            )
    _check_length(length, abs(start[0] - goal[0]), abs(start[1] - goal[1]), where)
    return (*ends, length)


def _check_length(length: float, dx: int, dy: int, where: str) -> None:
    """Refuse what no shortest route to a cell `dx` and `dy` away is long; 0 leaves it open."""
    least = max(dx, dy) + (math.sqrt(2.0) - 1.0) * min(dx, dy)
    if not 0.0 <= length < math.inf:
        raise BadInputError(f"{where}: the length is {length}; wanted 0 or more")
    if length > 0.0 and least == 0.0:
        raise BadInputError(f"{where}: the length is {length:g} from a cell to itself; wanted 0")
    if 0.0 < length < least * (1.0 - ROUNDING):
        raise BadInputError(
            f"{where}: the length is {length:g}, but the goal is {least:.6g} cells away; wanted "
            f"that at least, or 0 where it is not known"
        )
