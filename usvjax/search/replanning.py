"""Sailing to a goal while the map changes, D* Lite replanning, thousands of episodes at once."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import numpy as np

from usvjax.batches import Batch, bucket, deal, sized
from usvjax.checks import whole_number
from usvjax.devices import COMPILER_OPTIONS, chosen_devices
from usvjax.memory import check_memory
from usvjax.public import public
from usvjax.search.inputs import SearchScene, search_scene
from usvjax.search.replan_inputs import (
    check_method,
    check_sizes,
    clipped_window,
    flip_table,
    repeated,
)
from usvkernels.lanes import LEAST_LANES, Usage, run
from usvkernels.search import dstar_lanes
from usvkernels.search.dstar_layout import INFINITE, Layout, ReplanStatic
from usvkernels.search.dstar_lite import GAVE_UP, Episodes
from usvkernels.search.steps import cells
from usvkernels.status import Status

MOST_LANES = 64  # planes of small maps stay within the second-level cache
MOST_ROWS = 4096  # episodes per call of a device
MOST_NUMBERS = 2**24  # of an array of a call
LEAST_NUMBERS = 2**10  # room there is at least, so that small calls share a program
JOBS_PER_LANE = 1  # few lanes cost nearly as much as many: better some of them idle at the end
CHUNK = 32  # iterations between two refills
EXPANSIONS_PER_CELL = 16  # of one replanning; without overestimating it takes two at most
MOST_EXPANSIONS = 2**28


@dataclass(frozen=True)
class DstarLiteResult:
    """How B episodes of T steps went; numpy arrays, in the order of the arguments.

    Attributes:
        status: int32[B], `Status`: REACHED; FOUND, under way with a path when the steps ran out;
            UNREACHABLE, cut off then; BLOCKED; OUT_OF_BUDGET.
        position: int32[B, T + 1, 2], cells (x, y); index 0 is the start, index t + 1 follows move
            t.
        cost_to_go: float64[B, T + 1], length in cells of the path ahead on the map then known; inf
            where there is none, nan from where an episode ran out of budget.
        expanded: int32[B, T + 1], cells expanded in the replanning that led to each.
        occupancy: share of lane-iterations that advanced an episode, in (0, 1].
    """

    status: np.ndarray
    position: np.ndarray
    cost_to_go: np.ndarray
    expanded: np.ndarray
    occupancy: float


@public("usvkernels.search")
def dstar_lite(
    blocked: Any,
    starts: Any,
    goals: Any,
    flips: Any,
    *,
    heuristic: str = "octile",
    weight: float | None = None,
    corner_cutting: bool = False,
    sensing: tuple[int, int] | None = None,
    on_blocked: str = "raise",
    max_expansions: int | None = None,
    max_lanes: int = MOST_LANES,
) -> DstarLiteResult:
    """Sail B episodes of T moves on maps that change, replanning incrementally.

    Step t: the cells flips[:, t] change state, the vessel replans and makes one move along a
    shortest path: none while it is cut off, none after arrival. Then cost_to_go[:, t + 1] is the
    length of the shortest path from where it now is, on the map as it now knows it. Of equally
    good moves (dx, dy) it takes the first of (-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0),
    (-1, 1), (0, 1), (1, 1). Source:
    Koenig and Likhachev 2002; Yu et al. 2022, section 4.2. Runs on all devices, or on that of an
    enclosing `jax.default_device`; an episode does not depend on the others.

    Args:
        blocked: bool[B, H, W] (True = not navigable), bool[H, W] shared, or a shared `GridMap`.
        starts: int[B, 2], cells (x, y); or int[2], shared.
        goals: int[B, 2], cells (x, y); or int[2], shared.
        flips: int[B, T, C, 2], cells (x, y) that become blocked if they are free and free if they
            are blocked, (-1, -1) for none; or int[T, C, 2], shared. A flip of the cell in which the
            vessel is then, or of the goal, is ignored. A cell named twice in a step changes twice.
        heuristic: "octile" or "chebyshev": exact. "weighted": Eq. 17 as printed, which
            overestimates even on an empty map; its w is held within [1, 2], the range given for it.
            "weighted_octile": w times the octile distance. With these two, cost_to_go is the length
            that the search has found for its path; the path sailed is valid and, if nothing
            changes, no longer than that, but may be longer than the shortest.
        weight: of "weighted_octile", 1 or more; by default w of Eq. 17.
        corner_cutting: whether a diagonal step needs only its target free; otherwise both cells
            beside it as well.
        sensing: (h, w), odd and at least 3: what changes is noticed only within a window of h rows
            and w columns about the vessel; elsewhere when it comes into the window, before a move
            or after. The first map is known. None: all changes are known at once.
        on_blocked: "raise", or "status": start or goal on a blocked cell gives BLOCKED, and the
            episode does not begin.
        max_expansions: in one replanning, before it is given up (OUT_OF_BUDGET); by default 16 per
            cell of the map. Paths beyond 13,000 cells give the same status.
        max_lanes: most episodes under way at once on a device; for measurements.

    Raises:
        BadTypeError: an argument of the wrong type or dtype.
        BadInputError: a wrong shape, a cell outside the map or blocked, an impossible option; the
            message names the argument and the first bad row.
    """
    max_lanes = whole_number("max_lanes", max_lanes, 1)
    sensing = check_method(heuristic, weight, sensing)
    scene = search_scene(blocked, starts, goals, on_blocked)
    table = flip_table(flips, scene.shape, len(scene))
    scene = repeated(scene, len(table))
    height, width = scene.shape
    check_sizes(scene.shape, table.shape[1], heuristic, weight)
    if max_expansions is None:
        max_expansions = EXPANSIONS_PER_CELL * height * width
    max_expansions = min(whole_number("max_expansions", max_expansions, 1), MOST_EXPANSIONS)
    static = ReplanStatic(
        layout=Layout(height, width),
        heuristic=heuristic,
        weight=None if weight is None else float(weight),
        corner_cutting=corner_cutting,
        sensing=clipped_window(sensing, scene.shape),
    )
    return _sail(_Task(scene, table, static, max_expansions, max_lanes))


@dataclass(frozen=True)
class _Task:
    """The arguments, checked."""

    scene: SearchScene
    flips: np.ndarray  # int32[B, T, C], places in a plane, -1 after the last
    static: ReplanStatic
    max_expansions: int
    max_lanes: int


@dataclass(frozen=True)
class _Room:
    """Sizes of a call's arrays: powers of two, so that few programs are compiled."""

    rows: int
    records: int
    flips: int
    lanes: int


def _sail(task: _Task) -> DstarLiteResult:
    """Sail the episodes that begin, and put them among those that do not."""
    scene, layout = task.scene, task.static.layout
    records = np.full((len(task.flips), task.flips.shape[1] + 1, 3), -1, np.int32)
    records[:, 0, 0] = layout.index(scene.starts)
    records[:, 0, 1] = np.where(scene.open_ends, 0, INFINITE)
    records[:, 0, 2] = 0
    busy = total = 0.0
    rows = np.flatnonzero(scene.open_ends & np.any(scene.starts != scene.goals, axis=1))
    if len(rows):
        devices = chosen_devices()
        parts = _parts(task, rows, len(devices))
        room = _room(task, len(parts[0]), len(devices))
        found = Batch(parts, room.rows, devices).each(partial(_sail_part, task, room))
        for part, (part_records, part_busy, part_total) in zip(parts, found, strict=True):
            records[part] = part_records
            busy, total = busy + part_busy, total + part_total
    return _collected(records, scene, layout, busy / total if total else 1.0)


def _parts(task: _Task, rows: np.ndarray, devices: int) -> list[np.ndarray]:
    """Parts of the rows that a call can hold."""
    _, steps, width = task.flips.shape
    per_map = 1 if task.scene.shared else task.static.layout.size
    most = min(MOST_ROWS, MOST_NUMBERS // max(steps * width, 3 * (steps + 1), per_map))
    return deal(rows, max(1, most), devices)


def _room(task: _Task, longest: int, devices: int) -> _Room:
    """What a part of `longest` rows needs; refuses what the machine cannot hold."""
    _, steps, width = task.flips.shape
    layout = task.static.layout
    rows = bucket(max(longest, LEAST_LANES))
    lanes = min(max(LEAST_LANES, rows // JOBS_PER_LANE), task.max_lanes, 2**30 // layout.size)
    room = _Room(
        rows=rows,
        records=bucket(max(longest * (steps + 1), LEAST_NUMBERS)),
        flips=bucket(max(longest * steps * width, LEAST_NUMBERS)),
        lanes=lanes,
    )
    maps = layout.size * (1 if task.scene.shared else rows)
    needed = devices * (9 * lanes * layout.size + 2 * maps + 12 * room.records + 8 * room.flips)
    what = f"blocked: {devices * lanes} episodes at once on {layout.width} x {layout.height} cells"
    check_memory(needed, what)
    return room


def _sail_part(
    task: _Task, room: _Room, rows: np.ndarray, count: int, device: jax.Device
) -> tuple[np.ndarray, float, float]:
    """Sail some of the rows on one device; int32[rows, T + 1, 3] and lane-iterations."""
    steps = task.flips.shape[1]
    episodes = Episodes(**jax.device_put(_arrays(task, room, rows, count), device))
    records, usage = jax.device_get(
        _run(episodes, task.static, np.int32(count), room.records, room.lanes)
    )
    records = records[: count * (steps + 1)]
    return records.reshape(count, steps + 1, 3), float(usage.busy), float(usage.total)


def _arrays(task: _Task, room: _Room, rows: np.ndarray, count: int) -> dict[str, np.ndarray]:
    """The fields of `Episodes` for some of the rows, of which `count` are no padding."""
    scene, layout = task.scene, task.static.layout
    own = np.zeros(room.rows) if scene.shared else np.arange(room.rows)
    return {
        "blocked": layout.plane(scene.blocked if scene.shared else scene.blocked[rows]),
        "map_of": own.astype(np.int32),
        "start": layout.index(scene.starts[rows]),
        "goal": layout.index(scene.goals[rows]),
        "flips": sized(task.flips[rows[:count]].reshape(-1), room.flips, fill=-1),
        "steps": np.asarray(task.flips.shape[1], np.int32),
        "width": np.asarray(task.flips.shape[2], np.int32),
        "max_expansions": np.asarray(task.max_expansions, np.int32),
    }


@partial(
    jax.jit, static_argnames=("static", "capacity", "lanes"), compiler_options=COMPILER_OPTIONS
)
def _run(
    episodes: Episodes, static: ReplanStatic, count: jax.Array, capacity: int, lanes: int
) -> tuple[jax.Array, Usage]:
    program = dstar_lanes.program(static, episodes, capacity)
    rows = episodes.start.shape[0]
    (_, records), usage = run(program, count, capacity=rows, lanes=lanes, chunk=CHUNK)
    return records, usage


def _collected(
    records: np.ndarray, scene: SearchScene, layout: Layout, occupancy: float
) -> DstarLiteResult:
    """Complete the records of episodes that ended early: there the vessel stays."""
    ran = records[..., 0] >= 0
    last = np.count_nonzero(ran, axis=1) - 1
    held = records[np.arange(len(records)), last]
    index = np.where(ran, records[..., 0], held[:, None, 0])
    length = np.where(ran, records[..., 1], held[:, None, 1])
    cost = np.where(length >= INFINITE, np.inf, cells(np.clip(length, 0, INFINITE)))
    gave_up = held[:, 1] == GAVE_UP
    cost[length == GAVE_UP] = np.nan
    position = layout.cells(index)
    status = np.where(np.isinf(cost[:, -1]), int(Status.UNREACHABLE), int(Status.FOUND))
    there = np.all(position[:, -1] == scene.goals, axis=1)
    status = np.where(there, int(Status.REACHED), status)
    status = np.where(gave_up, int(Status.OUT_OF_BUDGET), status)
    status = np.where(scene.open_ends, status, int(Status.BLOCKED))
    return DstarLiteResult(
        status=status.astype(np.int32),
        position=position,
        cost_to_go=cost,
        expanded=np.where(ran, records[..., 2], 0),
        occupancy=occupancy,
    )
