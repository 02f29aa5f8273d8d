"""`usvjax route`: find one route on a map."""

import json
import math
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
import tyro

from usvjax.checks import one_of, shown
from usvjax.cli.console import show, show_line
from usvjax.cli.figures import Dpi
from usvjax.errors import BadInputError
from usvjax.maps import GridMap, find_map
from usvjax.pictures import DPI, check_dpi, check_suffix
from usvjax.report.sheets import Sheet

if TYPE_CHECKING:
    from usvjax.missions.route.run import Routes

MapName = Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="MAP")]
Place = Annotated[str, tyro.conf.arg(metavar="X,Y")]
Metres = Annotated[float | None, tyro.conf.arg(metavar="METRES")]
Number = Annotated[int | None, tyro.conf.arg(metavar="N")]
OutFile = Annotated[Path | None, tyro.conf.arg(metavar="FILE")]
Flag = Annotated[bool, tyro.conf.FlagCreatePairsOff]
EXIT_NO_ROUTE = 1


def route(
    map_name: MapName,
    start: Annotated[Place, tyro.conf.arg(name="from")],
    goal: Annotated[Place, tyro.conf.arg(name="to")],
    method: Annotated[str | None, tyro.conf.arg(metavar="NAME")] = None,
    turning_radius: Metres = None,
    turn_cost: float = 0.5,
    weight: float = 1.5,
    corner_cutting: Flag = False,
    connectivity: Literal[8, 4] = 8,
    max_expansions: Number = None,
    inflate: float = 0.0,
    metres: Flag = False,
    cell_size: Metres = None,
    plot: OutFile = None,
    dpi: Dpi = DPI,
    csv: OutFile = None,
    as_json: Annotated[Flag, tyro.conf.arg(name="json")] = False,
) -> int:
    """Find a route between two places on a map; exit code 1 where there is none.

    Methods:
    - astar: the shortest route on the grid.
    - manhattan: A* with Manhattan distance, which overestimates diagonal moves.
    - weighted: A* with its heuristic times --weight.
    - turning: the least sum of length and turning cost.
    - turning_parent: turning cost in the choice of the next cell (Zhang et al. 2019, Eq. 7).
    - shortened: A*, pulled straight by line of sight (Yu et al. 2022).
    - key_points: A*, reduced to points that do not see each other (Wei & Zhang 2023).
    - smoothed: A*, pulled straight, corners as arcs of the turning radius (Chen et al. 2023).
    - bspline: A*, as a cubic B-spline, which knows no obstacles.

    Example: usvjax route hongze-250 --from 289,320 --to 45,88 --turning-radius 500 --plot r.png

    Args:
        map_name: A packaged map such as hongze-250, or a map file.
        start: Cell to start from, column and row from the south-west corner; see --metres. Write
            --from=-5,3 for a negative number.
        goal: Cell to go to.
        method: One of the above; by default smoothed where a turning radius is given, otherwise
            astar.
        turning_radius: Least turning radius of the vessel, m; for smoothed, and to count turns
            that are too sharp. One cell by default.
        turn_cost: Cells of length per 45 degrees of turning.
        weight: On the heuristic, of weighted.
        corner_cutting: Let diagonal steps pass blocked cells beside them.
        connectivity: Neighbours of a cell.
        max_expansions: Give up after so many cells.
        inflate: Keep off cells whose centre is so near, m, to a blocked one's.
        metres: Read --from and --to as x and y in metres, not as cells.
        cell_size: Edge of a cell, m; needed for a plain image.
        plot: Draw the route on the map into this file: .png, .pdf or .svg.
        dpi: Dots per inch of a .png, 20 to 1200.
        csv: Write the points of the route into this file.
        as_json: Print JSON for scripts.
    """
    from usvjax.devices import use_compilation_cache
    from usvjax.missions.route.run import METHODS, SearchOptions, SmoothingOptions

    grid = find_map(map_name, cell_size=cell_size)
    if not 0.0 <= inflate < float("inf"):
        raise BadInputError(f"--inflate: got {inflate:g}; wanted 0 or more (m)")
    water = grid.inflated(inflate) if inflate else grid
    ends = tuple(
        _free_cell(option, text, metres, grid, water)
        for option, text in (("--from", start), ("--to", goal))
    )
    if ends[0] == ends[1]:
        raise BadInputError(f"--to: {goal} is the cell of --from; wanted another")
    chosen = method or ("astar" if turning_radius is None else "smoothed")
    one_of("--method", chosen, METHODS)
    search = SearchOptions(corner_cutting, connectivity, turn_cost, weight, max_expansions)
    query = _Query(grid, water, ends[0], ends[1], search, SmoothingOptions(turning_radius))
    query.check()
    if plot is not None:
        check_suffix(plot)
        check_dpi("--dpi", dpi)
    use_compilation_cache()
    found, seconds = query.solve(chosen)
    there = int(found.counts[0]) > 0
    if there and csv is not None:
        _write_csv(csv, grid, found)
    if there and plot is not None:
        _draw(plot, dpi, query, chosen, found)
    rows = _rows(query, chosen, found, seconds)
    if as_json:
        files = {"csv": csv, "plot": plot}
        written = {k: str(v) if there and v is not None else None for k, v in files.items()}
        print(json.dumps({"map": map_name, **{r.key: r.value for r in rows}, **written}))
    else:
        _show(rows, [f for f in (csv, plot) if there and f is not None])
    return 0 if there else EXIT_NO_ROUTE


@dataclass(frozen=True)
class _Row:
    """A line of the answer: its key for scripts, its words and value for people."""

    key: str
    words: str
    value: Any
    text: str


@dataclass(frozen=True)
class _Query:
    """One query, checked."""

    grid: GridMap
    water: GridMap
    start: tuple[int, int]
    goal: tuple[int, int]
    search: Any
    smoothing: Any

    def check(self) -> None:
        """Raise BadInputError when a setting cannot be used."""
        from usvjax.missions.route.run import check_options

        longest = self.grid.cell_size * max(self.grid.shape)
        check_options(self.search, self.smoothing, longest, _as_option)

    def solve(self, method: str) -> "tuple[Routes, float]":
        """Return the route of a method, and the seconds that it took once compiled."""
        from usvjax.missions.route.run import Area, find_paths, finish_routes
        from usvjax.missions.route.scenes import RouteScenes

        ends = np.array([[self.start], [self.goal]], np.int32)
        scenes = RouteScenes(self.water.blocked, self.grid.blocked, ends[0], ends[1])
        area = Area(scenes, self.grid.cell_size, self.grid.origin)
        for _ in range(2):
            began = time.perf_counter()
            paths = find_paths(scenes, self.search, method)
            found = finish_routes(paths, area, method, self.search, self.smoothing)
            seconds = time.perf_counter() - began
        return found, seconds


def _as_option(_: str, key: str) -> str:
    """What a key of a study's tables is called on the command line."""
    return f"--{key.replace('_', '-')}"


def _free_cell(
    option: str, text: str, metres: bool, grid: GridMap, water: GridMap
) -> tuple[int, int]:
    """Read "X,Y" as a free cell of the map, or say what is wrong with it.

    Raises:
        BadInputError: naming the option.
    """
    numbers = _two_numbers(option, text, metres)
    height, width = grid.shape
    # Compared as Python's numbers, which have no largest.
    west, east, south, north = grid.extent if metres else (0, width, 0, height)
    if not (west <= numbers[0] < east and south <= numbers[1] < north):
        wanted = f"{west:g} <= X < {east:g} and {south:g} <= Y < {north:g}"
        raise BadInputError(f"{option}: {shown(text)} lies outside the map; wanted {wanted}")
    cell = grid.cells_of(numbers) if metres else numbers
    # A point just below an edge may be rounded up to it.
    x, y = min(int(cell[0]), width - 1), min(int(cell[1]), height - 1)
    if water.blocked[y, x]:
        raise BadInputError(f"{option}: {text} is blocked; {_nearest(x, y, metres, water)}")
    return x, y


def _two_numbers(option: str, text: str, metres: bool) -> list[Any]:
    """Read "X,Y": finite floats of metres, or whole numbers of any size."""
    try:
        numbers = [float(part) if metres else int(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != 2 or not all(isinstance(n, int) or math.isfinite(n) for n in numbers):
        wanted = "two numbers X,Y (m)" if metres else "two whole numbers X,Y (a cell); or --metres"
        raise BadInputError(f"{option}: got {text!r}; wanted {wanted}")
    return numbers


def _nearest(x: int, y: int, metres: bool, water: GridMap) -> str:
    """Name the free cell that is nearest to a blocked one."""
    rows, columns = np.nonzero(~water.blocked)
    if not len(rows):
        return "the map has no free cell"
    best = np.hypot(columns - x, rows - y).argmin()
    cell = (int(columns[best]), int(rows[best]))
    place = water.points_of(cell) if metres else cell
    return f"the nearest free cell is {place[0]:g},{place[1]:g}"


def _write_csv(path: Path, grid: GridMap, found: "Routes") -> None:
    """Write points in m and in cells, where a cell's centre is a whole number."""
    from usvjax.maps import disk

    points = found.points[0, : found.counts[0]]
    cells = (points - np.asarray(grid.origin)) / grid.cell_size - 0.5
    lines = ["x_m,y_m,x_cell,y_cell"]
    for (x, y), (column, row) in zip(points, np.round(cells, 6) + 0.0, strict=True):
        lines.append(f"{x:.10g},{y:.10g},{column:.10g},{row:.10g}")
    disk.write_all({path: ("\n".join(lines) + "\n").encode()})


def _draw(path: Path, dpi: int, query: _Query, method: str, found: "Routes") -> None:
    """Draw the route, below it that of A* where the method does something to it."""
    import usvjax.missions.route.looks  # noqa: F401
    from usvjax.plots import style
    from usvjax.plots.route import closeup_width, plot_routes

    lines = {method: found.points[0, : found.counts[0]]}
    if method != "astar":
        plain, _ = query.solve("astar")
        lines = {"astar": plain.points[0, : plain.counts[0]], **lines}
    lines = {name: line for name, line in lines.items() if len(line) > 1}
    radius = query.smoothing.turning_radius
    closeup = closeup_width(query.grid, list(lines.values()), radius)
    figure = plot_routes(
        query.grid,
        lines,
        closeup=None if method == "astar" else closeup,
        turning_radius=radius,
        title=f"{query.grid.name}: {query.start} to {query.goal}".lstrip(": "),
    )
    style.save(figure, path, dpi=dpi)


def _rows(query: _Query, method: str, found: "Routes", seconds: float) -> list[_Row]:
    """What there is to say about a route."""
    from usvkernels.status import Status

    status = Status(int(found.status[0]))
    there = int(found.counts[0]) > 0
    rows = [
        _Row("method", "method", method, method),
        _Row("status", "status", status.name, status.name.lower().replace("_", " ")),
    ]
    if there:
        length = float(found.path_length[0])
        cells = length / query.grid.cell_size
        room = float(found.min_clearance[0])
        turning = float(found.turning[0])
        radius = query.smoothing.turning_radius or query.grid.cell_size
        sharp = int(found.sharp_turns[0])
        rows += [
            _Row("length_m", "length", length, f"{length:,.1f} m"),
            _Row("length_cells", "", cells, f"{cells:,.4f} cells"),
            _Row("turns", "turns", int(found.turns[0]), f"{int(found.turns[0]):,}"),
            _Row("sharp_turns", f"sharper than R = {radius:g} m", sharp, f"{sharp:,}"),
            _Row("sailable", "sailable", sharp == 0, "no" if sharp else "yes"),
            _Row("turning_rad", "turning", turning, f"{turning:.4g} rad"),
            _Row(
                "min_clearance_m",
                "least clearance",
                room if np.isfinite(room) else None,
                f"{room:,.1f} m" if np.isfinite(room) else "no blocked cell near",
            ),
        ]
    expanded = int(found.expanded[0])
    return [
        *rows,
        _Row("expanded", "cells expanded", expanded, f"{expanded:,}"),
        _Row("seconds", "time", seconds, f"{1000 * seconds:,.3g} ms (compiled)"),
    ]


def _show(rows: list[_Row], files: list[Path]) -> None:
    show(Sheet("", (), [(row.words, row.text) for row in rows]))
    for file in files:
        show_line(f"wrote {file}")
