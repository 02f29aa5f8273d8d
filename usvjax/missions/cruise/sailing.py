"""Whole cruises with D* Lite, each in a lane of a device."""

from dataclasses import dataclass, field
from functools import partial

import jax
import numpy as np

from usvjax.batches import Batch, bucket, deal
from usvjax.devices import COMPILER_OPTIONS, chosen_devices
from usvjax.memory import check_memory
from usvjax.missions.cruise.inputs import Expedition
from usvjax.missions.cruise.voyages import Voyages, joined_moves, voyages_of
from usvkernels.cruise import lanes as cruise_lanes
from usvkernels.cruise.sailing import Cruises, SailingStatic
from usvkernels.lanes import LEAST_LANES, Usage, run
from usvkernels.search.dstar_layout import Layout, ReplanStatic

MOST_LANES = 64  # planes of small maps stay within the second-level cache
MOST_ROWS = 4096  # cruises per call of a device
MOST_NUMBERS = 2**26  # of an array of a call
LEAST_MOVES = 2**16  # there is room for at least, so that small calls share a program
CHUNK = 16  # iterations between two refills


@dataclass(frozen=True)
class Replanning:
    """How the vessels replan.

    Attributes:
        heuristic: of `replan_heuristics.HEURISTICS`.
        weight: of "weighted_octile".
        max_expansions: in one step.
        max_lanes: cruises under way at once on a device.
    """

    heuristic: str
    weight: float | None
    max_expansions: int
    max_lanes: int = MOST_LANES


@dataclass(frozen=True)
class _Task:
    expedition: Expedition
    order: np.ndarray  # int32[B, d]
    seeds: np.ndarray  # uint32[B, 2]
    replanning: Replanning
    static: SailingStatic = field(init=False)

    def __post_init__(self) -> None:
        expedition, replanning = self.expedition, self.replanning
        search = ReplanStatic(
            layout=Layout(*expedition.shape),
            heuristic=replanning.heuristic,
            weight=None if replanning.weight is None else float(replanning.weight),
            corner_cutting=expedition.corner_cutting,
            sensing=expedition.window,
        )
        object.__setattr__(self, "static", SailingStatic(search=search, scope=expedition.scope))


@dataclass(frozen=True)
class _Room:
    """Sizes of a call's arrays: powers of two, so that few programs are compiled."""

    rows: int
    moves: int
    lanes: int


def sail_in_lanes(
    expedition: Expedition, order: np.ndarray, seeds: np.ndarray, replanning: Replanning
) -> Voyages:
    """Sail all cruises.

    Args:
        expedition: the cruises.
        order: int32[B, d], of their stations.
        seeds: uint32[B, 2], of their flips.
        replanning: how the vessels replan.
    """
    task = _Task(expedition, order, seeds, replanning)
    devices = chosen_devices()
    layout = task.static.search.layout
    each = max(
        expedition.legs * expedition.max_steps, layout.size if len(expedition.blocked) > 1 else 1
    )
    most = max(1, min(MOST_ROWS, MOST_NUMBERS // each))
    parts = deal(np.arange(len(expedition)), most, len(devices))
    room = _room(task, len(parts[0]), len(devices))
    found = Batch(parts, room.rows, devices).run(partial(_sail_part, task, room))
    busy, total = sum(logs[2] for logs in found), sum(logs[3] for logs in found)
    moves = joined_moves([logs[0] for logs in found])
    legs = np.concatenate([logs[1] for logs in found])
    return voyages_of(expedition.stations[:, 0], moves, legs, busy / total)


def _room(task: _Task, longest: int, devices: int) -> _Room:
    """What a part of `longest` cruises needs; refuses what the machine cannot hold."""
    expedition, layout = task.expedition, task.static.search.layout
    rows = bucket(max(longest, LEAST_LANES))
    lanes = min(rows, task.replanning.max_lanes, max(1, 2**30 // layout.size))
    room = _Room(
        rows, bucket(max(longest * expedition.legs * expedition.max_steps, LEAST_MOVES)), lanes
    )
    maps = layout.size * (1 if len(expedition.blocked) == 1 else rows)
    needed = devices * (9 * lanes * layout.size + 2 * maps + 3 * room.moves)
    what = f"blocked: {devices * lanes} cruises at once on {layout.width} x {layout.height} cells"
    check_memory(needed, what)
    return room


def _sail_part(
    task: _Task, room: _Room, rows: np.ndarray, count: int, device: jax.Device
) -> tuple[np.ndarray, np.ndarray, float, float]:
    """Moves uint8[rows, d * max_steps], legs int32[rows, d, 4], lane-iterations busy and total."""
    expedition = task.expedition
    cruises = Cruises(**jax.device_put(_arrays(task, room, rows), device))
    log, usage = jax.device_get(_run(cruises, task.static, np.int32(count), room.moves, room.lanes))
    each = expedition.legs * expedition.max_steps
    legs = log.legs.reshape(-1, expedition.legs, 4)[:count]
    used = max(int(legs[:, :, 1].max()), 1)  # most of the room for moves is never used
    moves = log.moves[: count * each].reshape(count, each)[:, :used]
    return moves, legs, float(usage.busy), float(usage.total)


def _arrays(task: _Task, room: _Room, rows: np.ndarray) -> dict[str, np.ndarray]:
    """The fields of `Cruises` for some of the rows."""
    expedition, layout = task.expedition, task.static.search.layout
    shared = len(expedition.blocked) == 1
    order = task.order[rows]
    round_trip = np.concatenate([order, order[:, :1]], axis=1)
    stops = np.take_along_axis(expedition.stations[rows], round_trip[..., None], axis=1)
    own = np.zeros(room.rows) if shared else np.arange(room.rows)
    return {
        "blocked": layout.plane(expedition.blocked if shared else expedition.blocked[rows]),
        "map_of": own.astype(np.int32),
        "stops": layout.index(stops).T,
        "seed": task.seeds[rows].T,
        "rate": expedition.rate[rows],
        "max_steps": np.asarray(expedition.max_steps, np.int32),
        "max_wait": np.asarray(expedition.max_wait, np.int32),
        "gives_up": np.asarray(expedition.gives_up),
        "max_expansions": np.asarray(task.replanning.max_expansions, np.int32),
    }


@partial(
    jax.jit, static_argnames=("static", "capacity", "lanes"), compiler_options=COMPILER_OPTIONS
)
def _run(
    cruises: Cruises, static: SailingStatic, count: jax.Array, capacity: int, lanes: int
) -> tuple[cruise_lanes.Log, Usage]:
    program = cruise_lanes.program(static, cruises, capacity)
    rows = cruises.rate.shape[0]
    (_, log), usage = run(program, count, capacity=rows, lanes=lanes, chunk=CHUNK)
    return log, usage
