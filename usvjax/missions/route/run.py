"""Ways to find a route, by name: a search on the grid, then what is done to its path.

Studies, the command line and figures share these names, and `find_routes`, which runs one.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from usvjax.batches import filled
from usvjax.errors import BadInputError
from usvjax.missions.route.finish import FINISHES, Sailing
from usvjax.missions.route.scenes import RouteScenes
from usvjax.paths.metrics import path_metrics
from usvjax.search.astar import (
    LEAST_TURN_COST,
    MOST_TURN_COST,
    AstarResult,
    astar,
    rounded_turn_cost,
)
from usvkernels.status import Status

ENDINGS = (Status.FOUND, Status.UNREACHABLE, Status.OUT_OF_BUDGET, Status.COLLIDED)
"""How a route may end; starts and goals of a study are never blocked."""


@dataclass(frozen=True)
class RouteMethod:
    """A way to find a route.

    Attributes:
        words: what it is, for tables and help.
        heuristic: of `usvjax.search.astar`.
        weighted: whether the heuristic is weighted.
        turn_mode: how turning counts, as in `usvjax.search.astar`; None where it does not.
        finish: what is done to the path: None, "shorten", "key_points", "arcs" or "bspline".
    """

    words: str
    heuristic: str = "octile"
    weighted: bool = False
    turn_mode: str | None = None
    finish: str | None = None

    @property
    def is_plain(self) -> bool:
        """Whether the search is that for the shortest route."""
        return self.heuristic == "octile" and not self.weighted and self.turn_mode is None


METHODS: dict[str, RouteMethod] = {
    "astar": RouteMethod("A*: the shortest route on the grid"),
    "manhattan": RouteMethod(
        "A* with Manhattan distance, which overestimates diagonal moves (Zhang et al. 2019)",
        heuristic="manhattan",
    ),
    "weighted": RouteMethod("A* with its heuristic times a weight", weighted=True),
    "turning": RouteMethod("the least sum of length and turning cost", turn_mode="exact"),
    "turning_parent": RouteMethod(
        "A* with turning cost in the choice of the next cell (Zhang et al. 2019, Eq. 7)",
        turn_mode="parent",
    ),
    "shortened": RouteMethod(
        "A*, pulled straight by line of sight (Yu et al. 2022)", finish="shorten"
    ),
    "key_points": RouteMethod("A*, reduced to key points (Wei & Zhang 2023)", finish="key_points"),
    "smoothed": RouteMethod(
        "A*, pulled straight, corners as arcs of the turning radius (Chen et al. 2023)",
        finish="arcs",
    ),
    "bspline": RouteMethod("A*, as a cubic B-spline, which knows no obstacles", finish="bspline"),
}


@dataclass(frozen=True)
class SearchOptions:
    """The `[search]` table of a study.

    Attributes:
        corner_cutting: whether a diagonal step may pass a blocked cell beside it.
        connectivity: 8, or 4 for straight moves only.
        turn_cost: cells per 45 degrees of turning (Zhang et al. 2019, Eq. 6: 0.5); also weighs
            the column "cost" of every method.
        weight: on the heuristic, of "weighted".
        max_expansions: of a query, after which it is out of budget; None for no bound.
    """

    corner_cutting: bool = False
    connectivity: int = 8
    turn_cost: float = 0.5
    weight: float = 1.5
    max_expansions: int | None = None


@dataclass(frozen=True)
class SmoothingOptions:
    """The `[smoothing]` table of a study.

    Attributes:
        turning_radius: R, m, of "smoothed"; also decides which turns count as sharp.
        safety_range: R_s, m, how far from a corner its arc begins where there is room; 2 R when
            None (Chen et al. 2023, Table 1).
        repair: rounds of moving corners that cannot be sailed.
    """

    turning_radius: float | None = None
    safety_range: float | None = None
    repair: int = 2


@dataclass(frozen=True)
class Area:
    """Queries and where they are in the world.

    Attributes:
        scenes: maps, starts and goals.
        cell_size: m.
        origin: (x, y) of the south-west corner, m.
    """

    scenes: RouteScenes
    cell_size: float
    origin: tuple[float, float]


@dataclass(frozen=True)
class Routes:
    """Routes of J queries; numpy arrays, in their order. NaN where there is no route.

    Attributes:
        status: int32[J], `Status`: FOUND, UNREACHABLE, OUT_OF_BUDGET, BLOCKED, or COLLIDED where
            a B-spline meets a blocked cell.
        points: float64[J, P, 2], m, the last repeated; along arcs and splines samples.
        counts: int32[J], points of each route, 0 without one.
        curvature: float32[J, P], 1/m, along arcs and splines; None of routes with corners.
        path_length: float64[J], m.
        turns: int32[J], corners of the route, rounded or not.
        sharp_turns: int32[J], how many of them are sharper than the turning radius allows.
        turning: float64[J], changes of course added up, rad.
        cost: float64[J], m, the length and the turning cost of the search.
        min_clearance: float64[J], m, from the route to the nearest blocked cell.
        expanded: int32[J], cells (with exact turning cost, states) that the search expanded.
        left: float64[J, L, 2], m, corners that stayed where others were rounded, NaN as padding;
            None where none is to be.
    """

    status: np.ndarray
    points: np.ndarray
    counts: np.ndarray
    curvature: np.ndarray | None
    path_length: np.ndarray
    turns: np.ndarray
    sharp_turns: np.ndarray
    turning: np.ndarray
    cost: np.ndarray
    min_clearance: np.ndarray
    expanded: np.ndarray
    left: np.ndarray | None = None

    @property
    def sailable(self) -> np.ndarray:
        """int32[J], 1 where there is a route and no turn on it is too sharp, else 0."""
        return ((self.counts > 0) & (self.sharp_turns == 0)).astype(np.int32)


def check_options(
    search: SearchOptions,
    smoothing: SmoothingOptions,
    longest: float,
    named: Callable[[str, str], str],
) -> None:
    """Refuse settings that cannot be used.

    Args:
        search: the `[search]` table.
        smoothing: the `[smoothing]` table.
        longest: m, the longer side of the map.
        named: gives what a user calls a table's key, which begins the message.

    Raises:
        BadInputError: naming the key as the user knows it.
    """

    def refuse(table: str, key: str, wanted: str, value: float) -> NoReturn:
        raise BadInputError(f"{named(table, key)} must be {wanted}, got {value:g}")

    if search.connectivity not in (4, 8):
        refuse("search", "connectivity", "4 or 8", search.connectivity)
    cost = search.turn_cost
    if not (cost == 0.0 or LEAST_TURN_COST < cost <= MOST_TURN_COST):
        wanted = f"0, or above {LEAST_TURN_COST:.2g} and at most {MOST_TURN_COST:g}"
        refuse("search", "turn_cost", wanted, cost)
    if not 1.0 <= search.weight < math.inf:
        refuse("search", "weight", "at least 1", search.weight)
    if search.max_expansions is not None and search.max_expansions < 1:
        refuse("search", "max_expansions", "at least 1", search.max_expansions)
    if smoothing.repair < 0:
        refuse("smoothing", "repair", "0 or more", smoothing.repair)
    for key in ("turning_radius", "safety_range"):
        value = getattr(smoothing, key)
        if value is not None and not 0.0 < value <= longest:
            wanted = f"above 0 and at most {longest:g} m, the longer side of the map"
            refuse("smoothing", key, wanted, value)


def find_paths(scenes: RouteScenes, options: SearchOptions, method: str) -> AstarResult:
    """Run the search of a method.

    Args:
        scenes: maps, starts and goals.
        options: of the search.
        method: a key of `METHODS`.

    Raises:
        BadTypeError, BadInputError: as `usvjax.search.astar`.
    """
    chosen = METHODS[method]
    found: AstarResult = astar(
        scenes.blocked,
        scenes.starts,
        scenes.goals,
        heuristic=chosen.heuristic,
        weight=options.weight if chosen.weighted else 1.0,
        turn_cost=0.0 if chosen.turn_mode is None else options.turn_cost,
        turn_mode=chosen.turn_mode or "exact",
        corner_cutting=options.corner_cutting,
        connectivity=options.connectivity,
        max_expansions=options.max_expansions,
        # The other engine breaks ties, and counts what it expands, in another way.
        engine="queue",
    )
    return found


def finish_routes(
    found: AstarResult,
    area: Area,
    method: str,
    search: SearchOptions,
    smoothing: SmoothingOptions,
) -> Routes:
    """Do to the paths of a search what a method does, and measure what comes out.

    Args:
        found: of `find_paths` with this method, or another of the same search.
        area: what was searched.
        method: a key of `METHODS`.
        search, smoothing: settings.

    Raises:
        BadInputError: as `usvjax.smooth_turns`.
    """
    sailing = Sailing(
        blocked=area.scenes.blocked,
        cell_size=area.cell_size,
        origin=area.origin,
        corner_cutting=search.corner_cutting,
        turning_radius=smoothing.turning_radius or area.cell_size,
        safety_range=smoothing.safety_range,
        repair=smoothing.repair,
    )
    cells = filled(found.path, 2, axis=1)
    line = FINISHES[METHODS[method].finish](cells, found.path_cells, sailing)
    status = found.status.copy()
    clearance = path_metrics(
        line.points,
        line.counts,
        area.scenes.land,
        cell_size=area.cell_size,
        origin=area.origin,
    ).clearance
    assert clearance is not None
    if METHODS[method].finish == "bspline":
        status[(status == Status.FOUND) & (clearance <= 0.0)] = Status.COLLIDED
    there = line.counts > 0
    length, turning, room = (
        np.where(there, a, np.nan) for a in (line.length, line.turning, clearance)
    )
    return Routes(
        status=status,
        points=line.points,
        counts=line.counts,
        curvature=line.curvature,
        path_length=length,
        turns=line.corners,
        sharp_turns=line.sharp,
        turning=turning,
        cost=length + rounded_turn_cost(search.turn_cost) * area.cell_size * turning / (np.pi / 4),
        min_clearance=room,
        expanded=found.expanded,
        left=line.left,
    )
