"""A* on grids, thousands of queries at once."""

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import jax
import numpy as np

from usvjax.batches import Batch, bucket, deal, sized
from usvjax.checks import not_negative, one_of, shown, whole_number
from usvjax.devices import COMPILER_OPTIONS, chosen_devices
from usvjax.errors import BadInputError
from usvjax.memory import check_memory
from usvjax.public import public
from usvjax.search import sweeping
from usvjax.search.inputs import SearchScene, check_connectivity, search_scene
from usvjax.search.paths import TracedPaths, check_paths, trace, turning_of
from usvkernels.lanes import LEAST_LANES, run
from usvkernels.search import astar_costs, astar_lanes, pqueue
from usvkernels.search.astar import AstarQueries
from usvkernels.search.astar_costs import HEURISTICS, STRAIGHT, AstarStatic
from usvkernels.status import Status

MOST_LANES = 256
MOST_ROWS = 8192  # queries per call of a device
MOST_STATES = 2**27  # of the queries of a call together, a byte each or two
MOST_KEYS = 2**26  # of the lanes together, four bytes each
JOBS_PER_LANE = 4  # at least, or lanes idle for want of a next query
CHUNK = 16  # expansions between two refills
SWEPT_CELLS = 2**16  # of a map on which sweeps are faster
MOST_TURN_COST = 1000.0  # cells per 45 degrees
LEAST_TURN_COST = 0.5 / STRAIGHT  # what is no more than that rounds to nothing
REOPENINGS = 100  # expansions of a cell, on average, after which a search with reopening ends

_SWEPT = {8: "octile", 4: "manhattan"}
_CONSISTENT = {8: ("octile", "euclidean", "chebyshev", "zero"), 4: HEURISTICS}


@dataclass(frozen=True)
class AstarResult:
    """How B queries ended; numpy arrays, in the order of the arguments.

    Attributes:
        status: int32[B], `Status`: FOUND, UNREACHABLE (proven), OUT_OF_BUDGET or BLOCKED.
        cost: float64[B], length of the path in cells, plus its turning cost where one was asked
            for; inf without a path.
        path: int32[B, P, 2], cells (x, y) from start to goal, the goal repeated up to the longest
            path; -1 throughout without a path.
        path_cells: int32[B], cells of the path, start and goal included; 0 without a path.
        turning: float64[B], turning angles along the path added up (rad).
        expanded: int32[B], cells (turning costs taken exactly: states) taken off the open list,
            the goal included. By sweeps, those that A* must expand, however it breaks ties.
        engine: "queue" or "sweep", which answered.
    """

    status: np.ndarray
    cost: np.ndarray
    path: np.ndarray
    path_cells: np.ndarray
    turning: np.ndarray
    expanded: np.ndarray
    engine: str


@public("usvkernels.search")
def astar(
    blocked: Any,
    starts: Any,
    goals: Any,
    *,
    turn_cost: float = 0.0,
    heuristic: str = "octile",
    corner_cutting: bool = False,
    connectivity: int = 8,
    weight: float = 1.0,
    turn_mode: str = "exact",
    max_expansions: int | None = None,
    on_blocked: str = "raise",
    engine: str = "auto",
    max_lanes: int | None = None,
) -> AstarResult:
    """Find shortest paths on grids.

    Two engines give paths of the same cost, of which there are often several. "queue" is A* as
    in the books, best first: of open cells the one with the least f = g + h is expanded; then
    that with the least h (in steps of 0.4 to 2 cells, by the map's size); then that which comes
    first row by row. Lengths are whole numbers of 1/2378 cell inside: a diagonal step is 6e-8
    longer than the square root of 2, which can only matter between two paths that differ by
    2,378 diagonal steps or more. A path longer than 7,000 cells (on maps of more than 16,384
    cells: 28,000), less the heuristic at the start, is OUT_OF_BUDGET. For "sweep" see
    `sweeping.sweep_paths`.

    Runs on all devices, or on that of an enclosing `jax.default_device`; results do not depend
    on the other queries or on the devices.

    Args:
        blocked: bool[H, W] shared by all, bool[B, H, W], or a `GridMap` (shared).
        starts: int[B, 2], cells (x, y); or int[2], shared.
        goals: int[B, 2], cells (x, y); or int[2], shared.
        turn_cost: gamma of Zhang et al. 2019, Eq. 6, in cells per 45 degrees of turning, to the
            nearest 1/2378, in the search and in `cost`; the first move turns from nowhere. The
            paper's is 0.5.
        heuristic: "octile", "euclidean", "chebyshev", "manhattan" or "zero" (Dijkstra). Manhattan
            overestimates with diagonal moves (Zhang et al. 2019, Eq. 5): paths may be longer than
            the shortest.
        corner_cutting: whether a diagonal step may pass a blocked cell beside it; by default both
            must be free.
        connectivity: 8, or 4 for straight moves only.
        weight: factor on the heuristic; above 1, paths are at most that much longer.
        turn_mode: with a turn cost, "exact" for the least sum of length and turning cost (search
            over cell and heading); "parent" for Eq. 7 as printed, F = g + h + e, where e depends on
            the cell's parent and counts in the choice of the next cell only, closed cells staying
            closed; "accumulated" for the other reading of it, where e counts in g from there on.
        max_expansions: of a query, after which it is OUT_OF_BUDGET; by default there is no bound
            but that of cells, or of 100 times as many where cells are opened again: with a weight
            above 1 or Manhattan with diagonals, when a shorter way to them is found.
        on_blocked: "raise" refuses a start or goal on a blocked cell, "status" marks such rows.
        engine: "queue", "sweep" (only without turn cost, weight, `max_expansions` and with a
            heuristic that is consistent), or "auto": sweeps for the octile heuristic, or 4
            neighbours and Manhattan, where they can answer and the map has at most 65,536 cells.
        max_lanes: most searches under way at once on a device; for measurements.

    Returns:
        The paths, in the order of the arguments.

    Raises:
        BadTypeError: an argument of the wrong type or dtype.
        BadInputError: cells outside the map or (by default) blocked, wrong or unequal shapes, an
            option that does not exist, more memory wanted than there is.
    """
    options = _options(turn_cost, heuristic, corner_cutting, connectivity, weight, turn_mode)
    if max_expansions is not None:
        max_expansions = whole_number("max_expansions", max_expansions, 1)
    if max_lanes is not None:
        max_lanes = whole_number("max_lanes", max_lanes, 1)
    sweepable = options.consistent and not options.turning and weight == 1
    sweepable &= max_expansions is None
    _check_engine(engine, sweepable)
    scene = search_scene(blocked, starts, goals, on_blocked)
    height, width = scene.shape
    small = height * width <= SWEPT_CELLS and heuristic == _SWEPT[connectivity]
    if engine == "sweep" or (engine == "auto" and sweepable and small):
        lanes = sweeping.MOST_LANES if max_lanes is None else max_lanes
        return _swept(scene, bool(corner_cutting), connectivity, lanes)
    static = replace(options, height=height, width=width, shared=scene.shared)
    table = np.zeros(1, np.int32)
    if static.heuristic == "table":
        table = astar_costs.distance_table(static, heuristic, float(weight))
    operands = _Operands(table, round(turn_cost * STRAIGHT), _budget(static, max_expansions))
    plan = _plan(scene, static, max_lanes or MOST_LANES)
    return _search(scene, static, operands, plan, rounded_turn_cost(turn_cost))


def rounded_turn_cost(turn_cost: Any) -> float:
    """The turning cost that a search counts with, in cells per 45 degrees.

    Raises:
        BadTypeError: not a number.
        BadInputError: below 0, above MOST_TURN_COST, or so small that it would count for nothing.
    """
    wanted = not_negative("turn_cost", turn_cost)
    if wanted > MOST_TURN_COST:
        raise BadInputError(f"turn_cost: got {shown(turn_cost)}; wanted at most {MOST_TURN_COST}")
    if 0 < wanted <= LEAST_TURN_COST:
        raise BadInputError(
            f"turn_cost: got {turn_cost:g}; wanted 0, or more than 1/{2 * STRAIGHT} of a cell, "
            "since costs are whole numbers of 1/2378"
        )
    return round(wanted * STRAIGHT) / STRAIGHT


@dataclass(frozen=True)
class _Operands:
    table: np.ndarray
    turn_cost: int
    budget: int


@dataclass(frozen=True)
class _Calls:
    """How queries are shared out."""

    batch: Batch  # the queries that are searched
    lanes: int
    size: int  # places of a queue


def _options(
    turn_cost: float,
    heuristic: str,
    corner_cutting: bool,
    connectivity: int,
    weight: float,
    turn_mode: str,
) -> AstarStatic:
    """The choices of method, on a map of no size yet."""
    one_of("heuristic", heuristic, HEURISTICS)
    one_of("turn_mode", turn_mode, ("exact", "parent", "accumulated"))
    check_connectivity(connectivity)
    turns = rounded_turn_cost(turn_cost)
    factor = not_negative("weight", weight)
    mode = turn_mode if turns else "none"
    consistent = factor <= 1 and heuristic in _CONSISTENT[connectivity]
    tabled = factor != 1 or heuristic == "euclidean"
    return AstarStatic(
        height=0,
        width=0,
        connectivity=connectivity,
        corner_cutting=bool(corner_cutting),
        heuristic="table" if tabled else heuristic,
        consistent=consistent,
        reopen=not consistent and mode != "parent",
        turn_mode=mode,
    )


def _check_engine(engine: str, sweepable: bool) -> None:
    one_of("engine", engine, ("auto", "queue", "sweep"))
    if engine == "sweep" and not sweepable:
        raise BadInputError(
            "engine: got 'sweep' with a turn cost, a weight, max_expansions or a heuristic that "
            "is not consistent; wanted 'queue'"
        )


def _swept(scene: SearchScene, corner_cutting: bool, connectivity: int, lanes: int) -> AstarResult:
    found = sweeping.sweep_paths(
        scene, corner_cutting=corner_cutting, connectivity=connectivity, max_lanes=lanes
    )
    return AstarResult(
        status=found.status,
        cost=found.cost,
        path=found.path,
        path_cells=found.path_cells,
        turning=turning_of(found.path) * (np.pi / 4),
        expanded=found.expanded,
        engine="sweep",
    )


def _budget(static: AstarStatic, max_expansions: int | None) -> int:
    bound = static.states * (REOPENINGS if static.reopen else 1)
    return min(bound if max_expansions is None else max_expansions, 2**31 - 1)


def _plan(scene: SearchScene, static: AstarStatic, max_lanes: int) -> _Calls:
    """Sizes of the calls; refuses what does not fit into memory."""
    rows = np.flatnonzero(scene.open_ends)
    devices = chosen_devices()
    size = pqueue.layout(1, static.states).size
    most = max(1, min(MOST_ROWS, MOST_STATES // size))
    blocks = deal(rows, most, len(devices), least=LEAST_LANES)
    capacity = bucket(max([LEAST_LANES, *map(len, blocks)]))
    lanes = max(1, min(max_lanes, capacity // JOBS_PER_LANE, MOST_KEYS // size))
    needed = len(devices) * size * (4 * lanes + capacity * (1 if scene.shared else 2))
    height, width = scene.shape
    what = f"blocked: a search on {width} x {height} cells"
    check_memory(needed, what)
    if size >= 2**31:
        raise BadInputError(f"{what} has {size:,} states; wanted less than 2^31")
    return _Calls(Batch(blocks, capacity, devices), lanes, size)


def _search(
    scene: SearchScene, static: AstarStatic, operands: _Operands, plan: _Calls, turn_cost: float
) -> AstarResult:
    capacity = plan.batch.size
    shared = astar_costs.walled(static, scene.blocked, plan.size) if scene.shared else None

    def work(rows: np.ndarray, count: int, device: jax.Device) -> _Block:
        maps = shared
        if maps is None:
            own = astar_costs.walled(static, scene.blocked[rows[:count]], plan.size)
            maps = sized(own, capacity, fill=True)
        arrays = {
            "maps": maps,
            "starts": scene.starts[rows],
            "goals": scene.goals[rows],
            "table": operands.table,
            "turn_cost": np.int32(operands.turn_cost),
            "budget": np.int32(operands.budget),
            "count": np.int32(count),
            "go": np.bool_(True),
        }
        queries = AstarQueries(**jax.device_put(arrays, device))
        found, entered = _run(queries, static, plan.lanes)
        status, expanded, end = (
            np.asarray(leaf)[:count] for leaf in (found.status, found.expanded, found.end)
        )
        arrived = np.flatnonzero(status == Status.FOUND)
        steps = np.asarray(entered).reshape(capacity, plan.size)
        paths = trace(static, steps, arrived, end[arrived])
        return _Block(rows[:count], status, expanded, paths)

    return _collected(scene, plan.batch.run(work), turn_cost)


@partial(jax.jit, static_argnames=("static", "lanes"), compiler_options=COMPILER_OPTIONS)
def _run(
    queries: AstarQueries, static: AstarStatic, lanes: int
) -> tuple[astar_lanes.Found, jax.Array]:
    rows = queries.starts.shape[0]
    program = astar_lanes.program(static, queries)
    return run(program, queries.count, capacity=rows, lanes=lanes, chunk=CHUNK)[0]


@dataclass(frozen=True)
class _Block:
    """What one call of a device found."""

    rows: np.ndarray
    status: np.ndarray
    expanded: np.ndarray
    paths: TracedPaths  # of those that arrived


def _collected(scene: SearchScene, done: list[_Block], turn_cost: float) -> AstarResult:
    count = len(scene)
    longest = max([1, *(block.paths.cells.shape[1] for block in done)])
    check_paths(count, longest)
    status = np.full(count, int(Status.BLOCKED), np.int32)
    expanded, path_cells = np.zeros(count, np.int32), np.zeros(count, np.int32)
    cost, turning = np.full(count, np.inf), np.zeros(count)
    path = np.full((count, longest, 2), -1, np.int32)
    for block in done:
        status[block.rows], expanded[block.rows] = block.status, block.expanded
        arrived = block.rows[block.status == Status.FOUND]
        paths = block.paths
        path[arrived, : paths.cells.shape[1]] = paths.cells
        path[arrived, paths.cells.shape[1] :] = scene.goals[arrived, None]
        path_cells[arrived] = paths.count
        turning[arrived] = paths.turns * (np.pi / 4)
        cost[arrived] = paths.length + turn_cost * paths.turns
    return AstarResult(status, cost, path, path_cells, turning, expanded, "queue")
