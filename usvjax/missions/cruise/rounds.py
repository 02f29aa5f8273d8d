"""Cruises with planners that start anew: all that need a plan get it in one call, then all sail."""

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import jax
import numpy as np

from usvjax.batches import bucket, filled, split
from usvjax.memory import check_memory
from usvjax.missions.cruise.following import Followers, follow_paths
from usvjax.missions.cruise.inputs import Expedition
from usvjax.missions.cruise.voyages import Voyages, joined_moves, voyages_of
from usvjax.search.astar import astar
from usvkernels.cruise.following import Halt
from usvkernels.cruise.sailing import STAY
from usvkernels.status import Status

SWARMS = ("aco", "ga", "cmpso")
"""Algorithms of `plan_paths`."""

PLANNERS = ("astar", *SWARMS)

PLANNER_OPTIONS = ("iterations", "population", "params", "on_blocked")
"""Keywords of `plan_paths` that a user may choose; the algorithm is the method's."""

MOST_CELLS = 2**28  # of the maps of cruises under way at once
_PLANES = 8  # of one byte a cell, held of each of these maps at once: truth, known, in and out

_ENDINGS = {
    Halt.ARRIVED: Status.REACHED,
    Halt.LATE: Status.TIMED_OUT,
}


@dataclass(frozen=True)
class LegPlanner:
    """What finds a path from where a vessel is to its stop, on the map as it is known.

    Attributes:
        method: of PLANNERS.
        options: keyword arguments of `plan_paths`.
        key: of its random numbers; of cruise j, plan k the parts (first + j, k).
        first: number of the first cruise.
    """

    method: str
    options: dict[str, Any]
    key: jax.Array
    first: int = 0

    def check(self) -> None:
        """Refuse what `plan_paths` would, which has nothing to do on a map of one cell."""
        cells = np.zeros((1, 2), np.int32)
        keys = jax.random.split(self.key, 1)
        self.paths(np.zeros((1, 1, 1), bool), cells, cells, keys, False)

    def paths(
        self,
        blocked: np.ndarray,
        starts: np.ndarray,
        goals: np.ndarray,
        keys: jax.Array,
        corner_cutting: bool,
    ) -> Any:
        """Plan on bool[n, H, W] from int32[n, 2] to int32[n, 2], with keys[n].

        Returns:
            A result that has status, path, path_cells and, where cells are expanded, expanded.
        """
        if self.method == "astar":
            return astar(blocked, starts, goals, corner_cutting=corner_cutting)
        from usvjax.planners import plan_paths  # not loaded where it is not needed

        return plan_paths(blocked, starts, goals, keys, algorithm=self.method, **self.options)

    def keys(self, rows: np.ndarray, planned: np.ndarray) -> jax.Array:
        """A key for each row's next plan, whatever the other rows are.

        Args:
            rows: int[n], cruises.
            planned: int32[B], plans of each so far.
        """
        padded = filled(rows, bucket(len(rows)))  # few sizes to compile
        return _folded(self.key, padded + self.first, planned[padded])[: len(rows)]


@jax.jit
@partial(jax.vmap, in_axes=(None, 0, 0))
def _folded(key: jax.Array, cruise: jax.Array, plan: jax.Array) -> jax.Array:
    return jax.random.fold_in(jax.random.fold_in(key, cruise), plan)


@dataclass
class _Fleet:
    """Where the cruises are; first axis B."""

    truth: np.ndarray  # bool[B, H, W]
    known: np.ndarray  # bool[B, H, W]
    here: np.ndarray  # int32[B, 2]
    step: np.ndarray  # int32[B], of the cruise
    first: np.ndarray  # int32[B], step at which the leg began
    waited: np.ndarray  # int32[B], steps in a row
    drawn: np.ndarray  # bool[B], whether the flips of this step are
    leg: np.ndarray  # int32[B], from 1
    over: np.ndarray  # bool[B]
    planned: np.ndarray  # int32[B], plans of the cruise
    moves: np.ndarray  # uint8[B, T], grows
    legs: np.ndarray  # int32[B, d, 4], as `voyages_of` takes them


def sail_in_rounds(
    expedition: Expedition, order: np.ndarray, seeds: np.ndarray, planner: LegPlanner
) -> Voyages:
    """Sail all cruises, in blocks whose maps fit in memory.

    Args:
        expedition: the cruises.
        order: int32[B, d], of their stations.
        seeds: uint32[B, 2], of their flips.
        planner: what plans their paths.
    """
    height, width = expedition.shape
    most = max(1, MOST_CELLS // (height * width))
    blocks = split(np.arange(len(expedition)), most)
    longest = len(blocks[0])
    what = f"blocked: {longest} cruises at once on {width} x {height} cells"
    check_memory(_PLANES * longest * height * width, what)
    moves, legs = [], []
    for rows in blocks:
        part = expedition.part(rows)
        their = replace(planner, first=planner.first + int(rows[0]))
        fleet = _sailed(part, order[rows], seeds[rows], their)
        used = max(int(fleet.step.max()), 1)
        moves.append(fleet.moves[:, :used])
        legs.append(fleet.legs)
    home = expedition.stations[:, 0]
    return voyages_of(home, joined_moves(moves), np.concatenate(legs), 1.0)


def _sailed(
    expedition: Expedition, order: np.ndarray, seeds: np.ndarray, planner: LegPlanner
) -> _Fleet:
    """The cruises when all are over; arguments as of `sail_in_rounds`."""
    fleet = _begun(expedition)
    round_trip = np.concatenate([order, order[:, :1]], axis=1)
    stops = np.take_along_axis(expedition.stations, round_trip[..., None], axis=1)
    # Of two rounds, one makes a step or ends a leg: a plan on the map as seen is not blocked.
    while True:
        _arrive(expedition, fleet, stops)
        rows = np.flatnonzero(~fleet.over)
        if not len(rows):
            break
        goals = stops[rows, fleet.leg[rows]]
        keys = planner.keys(rows, fleet.planned)
        known = fleet.known[rows]
        plans = planner.paths(known, fleet.here[rows], goals, keys, expedition.corner_cutting)
        _count_plans(fleet, rows, plans)
        _sail_on(expedition, fleet, seeds, rows, plans)
    return fleet


def _begun(expedition: Expedition) -> _Fleet:
    count, legs = len(expedition), expedition.legs
    truth = expedition.blocked[expedition.layers(np.arange(count))].copy()
    zero = np.zeros(count, np.int32)
    return _Fleet(
        truth=truth,
        known=truth.copy(),
        here=expedition.stations[:, 0].copy(),
        step=zero.copy(),
        first=zero.copy(),
        waited=zero.copy(),
        drawn=np.zeros(count, bool),
        leg=zero + 1,
        over=np.zeros(count, bool),
        planned=zero.copy(),
        moves=np.full((count, 256), STAY, np.uint8),
        legs=np.zeros((count, legs, 4), np.int32),
    )


def _count_plans(fleet: _Fleet, rows: np.ndarray, plans: Any) -> None:
    fleet.planned[rows] += 1
    leg = fleet.leg[rows] - 1
    fleet.legs[rows, leg, 2] += getattr(plans, "expanded", 0)
    fleet.legs[rows, leg, 3] += 1


def _sail_on(
    expedition: Expedition, fleet: _Fleet, seeds: np.ndarray, rows: np.ndarray, plans: Any
) -> None:
    """Sail the rows along their plans until each halts, and end legs."""
    found = plans.status == int(Status.FOUND)
    path = np.where(found[:, None, None], plans.path, fleet.here[rows, None])
    followers = Followers(
        path=path,
        length=np.where(found, plans.path_cells, 0).astype(np.int32),
        proven=plans.status == int(Status.UNREACHABLE),
        left=expedition.max_steps - (fleet.step - fleet.first)[rows],
        truth=fleet.truth[rows],
        known=fleet.known[rows],
        step=fleet.step[rows],
        waited=fleet.waited[rows],
        drawn=fleet.drawn[rows],
    )
    sailed = follow_paths(expedition, rows, seeds, followers)
    fleet.truth[rows], fleet.known[rows] = sailed.truth, sailed.known
    fleet.waited[rows], fleet.drawn[rows] = sailed.waited, sailed.drawn
    fleet.here[rows] = path[np.arange(len(rows)), sailed.at]
    _log_moves(fleet, rows, sailed.moves, sailed.made)
    fleet.step[rows] += sailed.made
    for halt, status in _ENDINGS.items():
        _end_legs(expedition, fleet, rows[sailed.halt == halt], status)
    # No cell in view came free since this plan: what it has proven holds, and nothing else does.
    dropped = sailed.halt == Halt.DROPPED
    _end_legs(expedition, fleet, rows[dropped & followers.proven], Status.UNREACHABLE)
    _end_legs(expedition, fleet, rows[dropped & ~followers.proven], Status.OUT_OF_BUDGET)


def _log_moves(fleet: _Fleet, rows: np.ndarray, moves: np.ndarray, made: np.ndarray) -> None:
    """Write moves uint8[n, K] of which `made` int32[n] were made."""
    needed = int((fleet.step[rows] + made).max())
    while fleet.moves.shape[1] < needed:
        fleet.moves = np.concatenate([fleet.moves, np.full_like(fleet.moves, STAY)], axis=1)
    row, slot = np.nonzero(np.arange(moves.shape[1]) < made[:, None])
    fleet.moves[rows[row], fleet.step[rows[row]] + slot] = moves[row, slot]


def _arrive(expedition: Expedition, fleet: _Fleet, stops: np.ndarray) -> None:
    """End the legs of vessels that are at their stop already, as one that passed over it may be."""
    row = np.arange(len(expedition))
    while True:
        there = ~fleet.over & np.all(fleet.here == stops[row, fleet.leg], axis=1)
        if not there.any():
            return
        _end_legs(expedition, fleet, np.flatnonzero(there), Status.REACHED)


def _end_legs(expedition: Expedition, fleet: _Fleet, rows: np.ndarray, status: Status) -> None:
    fleet.legs[rows, fleet.leg[rows] - 1, 0] = int(status)
    fleet.legs[rows, fleet.leg[rows] - 1, 1] = fleet.step[rows]
    last = fleet.leg[rows] == expedition.legs
    given_up = status in (Status.UNREACHABLE, Status.OUT_OF_BUDGET)
    ends = status == Status.TIMED_OUT or (given_up and expedition.gives_up)
    fleet.over[rows] = last | ends
    fleet.leg[rows] = np.where(fleet.over[rows], fleet.leg[rows], fleet.leg[rows] + 1)
    fleet.first[rows] = fleet.step[rows]
    fleet.waited[rows] = 0
