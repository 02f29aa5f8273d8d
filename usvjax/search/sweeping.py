"""Shortest paths by sweeps over whole maps: the engine for many queries on small maps."""

from dataclasses import dataclass
from functools import partial

import jax
import numpy as np

from usvjax.batches import Batch, bucket, deal_groups, sized
from usvjax.devices import COMPILER_OPTIONS, chosen_devices
from usvjax.memory import check_memory
from usvjax.search.inputs import SearchScene
from usvjax.search.paths import check_paths
from usvkernels.search.steps import SMALL_UNITS, UNITS, Units, cells, counts, manhattan, octile
from usvkernels.search.sweep import Sweep, choose_block
from usvkernels.search.sweep_search import Routes, SweepQueries, solve
from usvkernels.status import Status

MOST_LANES = 64
CACHE = 1 << 21  # bytes; a plane of a group of large maps stays within about this
MOST_ROWS = 2048  # queries per call of a device; memory does not grow past it
DETOURS = 0.9  # a greater distance, as a share of what 16 bits hold, goes to 32 bits at once
COPIES = 1  # of what goes to a device or comes from it, here
PLANES = 3  # of a group at once: lengths, those to the goal, and what is made of them
LEFT_OVER = 16  # a group stops when a lane in so many is not done; these are regrouped
LEAST_GROUPS = 4  # per device; with fewer, regrouping gains nothing


@dataclass(frozen=True)
class SweepPaths:
    """Shortest paths of B queries; numpy arrays, in the order of the queries.

    Attributes:
        status: int32[B], `Status`: FOUND, UNREACHABLE, BLOCKED, or OUT_OF_BUDGET (no path of
            less than 26,582 cells, and perhaps a longer one).
        cost: float64[B], n_straight + n_diagonal * sqrt(2) along the path; inf where not found.
        path: int32[B, P, 2], cells (x, y) from start to goal, then the goal repeated; -1
            throughout where not found.
        path_cells: int32[B], cells in the path, start and goal included; 0 where not found.
        expanded: int32[B], cells that A* with the octile (or, with 4 neighbours, Manhattan)
            distance h expands at least: those with g + h < cost, and of those with g + h = cost
            the ones on the path (the best tie-breaking there is). Where there is no path, the
            cells that can be reached from the start.
        passes: int32[B], sweeps over the map until the path was proven shortest.
    """

    status: np.ndarray
    cost: np.ndarray
    path: np.ndarray
    path_cells: np.ndarray
    expanded: np.ndarray
    passes: np.ndarray


def sweep_paths(
    scene: SearchScene,
    *,
    corner_cutting: bool = False,
    connectivity: int = 8,
    max_lanes: int = MOST_LANES,
) -> SweepPaths:
    """Find a shortest path for every query of a checked scene.

    Of several shortest paths: walking back from the goal, the first step in the order of
    `usvkernels.search.steps.moves` that lies on one, on a map mirrored where needed so that the
    goal's x and y are not below the start's. A result depends on nothing but its query.

    Args:
        scene: of `search_scene`.
        corner_cutting: whether a diagonal step may pass a blocked side cell.
        connectivity: 4 or 8.
        max_lanes: most maps side by side; for measurements.
    """
    table = _Table.empty(len(scene))
    table.status[~scene.open_ends] = Status.BLOCKED
    height, width = scene.shape
    rows = np.flatnonzero(scene.open_ends)
    apart = np.abs(scene.starts - scene.goals)[rows]
    least = (octile if connectivity == 8 else manhattan)(apart[:, 0], apart[:, 1], SMALL_UNITS)
    later = rows[least > DETOURS * SMALL_UNITS.cap]
    path_cells = bucket(max(16, max(width, height) * 5 // 4 + 1))

    def solve_in(units: Units, rows: np.ndarray) -> None:
        lanes = lanes_for(width, height, units, len(rows), max_lanes)
        block = choose_block(width, lanes)
        sweep = Sweep(width, height, lanes, block, units, connectivity, corner_cutting)
        _solve_rows(scene, sweep, path_cells, rows, table)

    if greatest_h(width, height, SMALL_UNITS, connectivity) <= SMALL_UNITS.cap:
        solve_in(SMALL_UNITS, np.setdiff1d(rows, later, assume_unique=True))
        rows = np.union1d(later, np.flatnonzero(table.status == Status.OUT_OF_BUDGET))
    solve_in(UNITS, rows)
    return table.paths(scene)


@dataclass(frozen=True)
class _Table:
    """Results as they come in."""

    status: np.ndarray
    cost: np.ndarray
    path_cells: np.ndarray
    expanded: np.ndarray
    passes: np.ndarray
    pieces: list[tuple[np.ndarray, np.ndarray]]  # rows and their paths

    @classmethod
    def empty(cls, count: int) -> "_Table":
        zeros = partial(np.zeros, count, np.int32)
        return cls(zeros(), np.full(count, np.inf), zeros(), zeros(), zeros(), [])

    def take(self, rows: np.ndarray, routes: Routes, units: Units) -> int:
        """Enter routes (leaves [rows, ...]) that are whole; the most cells of one cut short."""
        straight, diagonal = counts(
            np.where(routes.status == Status.FOUND, routes.length, 0), units
        )
        fits = straight + diagonal < routes.path.shape[1]
        ended = (routes.status != Status.RUNNING) & fits
        chosen = rows[ended]
        found = routes.status[ended] == Status.FOUND
        steps = (straight + diagonal)[ended]
        self.status[chosen] = routes.status[ended]
        self.cost[chosen] = np.where(found, cells(routes.length[ended], units), np.inf)
        self.path_cells[chosen] = np.where(found, steps + 1, 0)
        self.expanded[chosen] = routes.expanded[ended]
        self.passes[chosen] = routes.passes[ended]
        keep = int(steps.max(initial=0)) + 1
        self.pieces.append((chosen[found], np.asarray(routes.path)[ended][found, :keep]))
        return int((straight + diagonal)[~fits].max(initial=0)) + 1

    def paths(self, scene: SearchScene) -> SweepPaths:
        longest = max(1, int(self.path_cells.max(initial=1)))
        check_paths(len(scene), longest)
        found = (self.status == Status.FOUND)[:, None]
        path = np.empty((len(scene), longest, 2), np.int32)
        path[:] = np.where(found, scene.goals, -1)[:, None]
        for rows, piece in self.pieces:
            path[rows, : piece.shape[1]] = piece
        return SweepPaths(self.status, self.cost, path, self.path_cells, self.expanded, self.passes)


def greatest_h(width: int, height: int, units: Units, connectivity: int) -> int:
    """Greatest h on a map."""
    distance = octile if connectivity == 8 else manhattan
    return int(distance(width - 1, height - 1, units))


def lanes_for(width: int, height: int, units: Units, queries: int, most: int) -> int:
    """Maps side by side: 64 small ones, fewer large ones so that a group stays in the cache."""
    plane = width * height * units.bits // 8
    lanes = 64 if units is SMALL_UNITS else max(2, min(64, CACHE // plane))
    # Few widths, for each is compiled anew; narrow ones for those who ask query by query.
    fewest = next(width for width in (1, 8, 64) if width >= min(queries, 64))
    return min(1 << (lanes.bit_length() - 1), fewest, most)


def _solve_rows(
    scene: SearchScene, sweep: Sweep, path_cells: int, rows: np.ndarray, table: _Table
) -> None:
    """Solve the rows in rounds: those left over by one, and those with longer paths, go again."""
    table.status[rows] = Status.RUNNING
    while len(rows):
        devices = chosen_devices()
        groups = -(-len(rows) // sweep.lanes)
        _check_room(scene, sweep, path_cells, groups, len(devices))
        leave = sweep.lanes // LEFT_OVER if groups >= LEAST_GROUPS * len(devices) else 0
        batch = grouped_batch(rows, sweep.lanes, MOST_ROWS // sweep.lanes, devices)
        work = partial(_solve_block, scene, sweep, path_cells, leave)
        for block, routes in zip(batch.blocks, batch.each(work), strict=True):
            path_cells = max(path_cells, bucket(table.take(block, routes, sweep.units)))
        rows = rows[table.status[rows] == Status.RUNNING]


def _check_room(
    scene: SearchScene, sweep: Sweep, path_cells: int, groups: int, devices: int
) -> None:
    """Refuse calls, one on each device, that memory cannot hold."""
    rows = capacity_for(groups, MOST_ROWS // sweep.lanes) * sweep.lanes
    paths = 8 * rows * path_cells * (1 + COPIES)
    maps = sweep.words * (1 if scene.shared else rows) * (1 + COPIES)
    planes = (sweep.units.bits // 8) * sweep.size * PLANES
    height, width = scene.shape
    what = f"blocked: searches of {len(scene):,} queries on {width} x {height} cells"
    check_memory(min(devices, groups) * (paths + maps + planes), what)


def grouped_batch(rows: np.ndarray, lanes: int, most: int, devices: list[jax.Device]) -> Batch:
    """Rows in blocks of whole groups of lanes, at most so many of them."""
    blocks = deal_groups(rows, lanes, most, len(devices))
    longest = max(-(-len(block) // lanes) for block in blocks)
    return Batch(blocks, capacity_for(longest, most) * lanes, devices)


def _solve_block(
    scene: SearchScene,
    sweep: Sweep,
    path_cells: int,
    leave: int,
    padded: np.ndarray,
    count: int,
    device: jax.Device,
) -> Routes:
    lanes, size, rows = sweep.lanes, len(padded), padded[:count]
    capacity = size // lanes

    def grouped(values: np.ndarray) -> np.ndarray:
        """Rows of the queries, then zeros."""
        return sized(values, size).reshape(capacity, lanes, *values.shape[1:])

    maps = scene.blocked if scene.shared else take_rows(scene.blocked, rows)
    arrays = (
        pack_maps(maps, lanes, capacity),
        grouped(scene.starts[rows]),
        grouped(scene.goals[rows]),
        grouped(np.ones(count, bool)),
    )
    queries = SweepQueries(*jax.device_put(arrays, device))
    groups = np.int32(-(-count // lanes))
    routes = _solve(sweep, path_cells, queries, groups, np.int32(leave))
    return jax.tree.map(lambda a: np.asarray(a).reshape(size, *a.shape[2:])[:count], routes)


def capacity_for(groups: int, most: int) -> int:
    """Groups that a call is compiled for: one or the most, for every size is compiled anew."""
    return 1 if groups == 1 else most


def take_rows(array: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """array[rows], a view where they are consecutive."""
    first, last = int(rows[0]), int(rows[-1])
    return array[first : last + 1] if last - first == len(rows) - 1 else array[rows]


_solve = partial(jax.jit, static_argnames=("sweep", "cells"), compiler_options=COMPILER_OPTIONS)(
    solve
)


def pack_maps(blocked: np.ndarray, lanes: int, groups: int) -> np.ndarray:
    """Maps bool[B, H, W] as `usvkernels.search.sweep` wants them: uint8[groups, words, lanes].

    One map is shared by all lanes of all groups, uint8[1, words, 1]. Lanes past the last map
    have no cells blocked.
    """
    bits = np.packbits(blocked.reshape(len(blocked), -1), axis=-1, bitorder="little")
    if len(bits) == 1:
        return bits[:, :, None]
    missing = lanes * groups - len(bits)
    if missing:
        bits = np.concatenate([bits, np.zeros((missing, bits.shape[1]), np.uint8)])
    return np.ascontiguousarray(bits.reshape(groups, lanes, bits.shape[1]).swapaxes(1, 2))
