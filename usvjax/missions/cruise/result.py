"""How cruises went, and their measures."""

from dataclasses import dataclass

import numpy as np

from usvjax.missions.cruise.inputs import Expedition
from usvjax.missions.cruise.straightening import WayPoints
from usvjax.missions.cruise.voyages import Voyages
from usvkernels.status import Status


@dataclass(frozen=True)
class CruiseResult:
    """How B cruises went; numpy arrays, in the order of the arguments.

    A station counts as visited when the vessel has sailed to it; passing over it earlier, on the
    way to another, does not.

    Attributes:
        status: int32[B], `Status`: REACHED (all stations visited, and home again), PARTIAL (home
            again, but stations given up), UNREACHABLE (the way home given up, or with
            walled_in="fail" that to a station: on the map as known, there was none), TIMED_OUT
            (`max_steps`), OUT_OF_BUDGET (given up likewise, but "aco", "ga" or "cmpso" only found
            no way: there may have been one; of "dstar_lite", `max_expansions`).
        order: int32[B, d], stations in the order of the cruise, home (0) first.
        visited: bool[B, d], by station; home always.
        visit_step: int32[B, d], step after which the vessel was at each station, -1 where it was
            not; of home 0.
        leg_status: int32[B, d], `Status` of the legs, the last of which leads home: REACHED,
            UNREACHABLE (its stop was given up: there was no way), OUT_OF_BUDGET (none was found, as
            above), TIMED_OUT; RUNNING where it did not begin.
        leg_step: int32[B, d], step at which each ended.
        track: int32[B, T + 1, 2], cells (x, y) after each step, home first; the last is repeated.
        steps: int32[B], moves and waits.
        waits: int32[B], steps without a move.
        length: float64[B], m, along the track.
        time: float64[B], s: length / speed, and cell_size / speed for each wait.
        inflections: int32[B], points of the track at which the course changes.
        smoothed: int32[B, Q, 2], way points (x, y) of the track pulled straight; the last is
            repeated. Home and visited stations are among them.
        smoothed_step: int32[B, Q], step at which the vessel is there.
        smoothed_count: int32[B], way points.
        smooth_length: float64[B], m.
        smooth_time: float64[B], s, as `time`.
        smooth_inflections: int32[B].
        expanded: int64[B], cells that all searches expanded; by sweeps and swarms, 0.
        replanned: int32[B], steps at which a way was planned or repaired, first plans included.
        seeds: uint32[B, 2], of the flips (`usvkernels.draws.words`).
        occupancy: share of lane-iterations that advanced a cruise, in (0, 1].
    """

    status: np.ndarray
    order: np.ndarray
    visited: np.ndarray
    visit_step: np.ndarray
    leg_status: np.ndarray
    leg_step: np.ndarray
    track: np.ndarray
    steps: np.ndarray
    waits: np.ndarray
    length: np.ndarray
    time: np.ndarray
    inflections: np.ndarray
    smoothed: np.ndarray
    smoothed_step: np.ndarray
    smoothed_count: np.ndarray
    smooth_length: np.ndarray
    smooth_time: np.ndarray
    smooth_inflections: np.ndarray
    expanded: np.ndarray
    replanned: np.ndarray
    seeds: np.ndarray
    occupancy: float


def result_of(
    expedition: Expedition, order: np.ndarray, seeds: np.ndarray, voyages: Voyages, way: WayPoints
) -> CruiseResult:
    """Measure the cruises.

    Args:
        expedition: the cruises.
        order: int32[B, d].
        seeds: uint32[B, 2].
        voyages: how they went.
        way: their way points.
    """
    visited, visit_step = _visits(order, voyages)
    waiting = voyages.waits * expedition.cell_size
    length, inflections = _measured(voyages.track, voyages.steps + 1, expedition.cell_size)
    smooth_length, smooth_inflections = _measured(way.cells, way.count, expedition.cell_size)
    return CruiseResult(
        status=_status(voyages.leg_status),
        order=order,
        visited=visited,
        visit_step=visit_step,
        leg_status=voyages.leg_status,
        leg_step=voyages.leg_step,
        track=voyages.track,
        steps=voyages.steps,
        waits=voyages.waits,
        length=length,
        time=(length + waiting) / expedition.speed,
        inflections=inflections,
        smoothed=way.cells,
        smoothed_step=way.step,
        smoothed_count=way.count,
        smooth_length=smooth_length,
        smooth_time=(smooth_length + waiting) / expedition.speed,
        smooth_inflections=smooth_inflections,
        expanded=voyages.expanded,
        replanned=voyages.plans,
        seeds=seeds,
        occupancy=voyages.occupancy,
    )


def _status(legs: np.ndarray) -> np.ndarray:
    """Status of cruises from that of their legs, int32[B, d]."""
    ended = np.count_nonzero(legs != int(Status.RUNNING), axis=1)
    last = legs[np.arange(len(legs)), ended - 1]
    skipped = np.any(legs[:, :-1] != int(Status.REACHED), axis=1)
    home = legs[:, -1] == int(Status.REACHED)
    status = np.where(home, np.where(skipped, int(Status.PARTIAL), int(Status.REACHED)), last)
    return status.astype(np.int32)


def _visits(order: np.ndarray, voyages: Voyages) -> tuple[np.ndarray, np.ndarray]:
    """By station, whether it was visited and after which step."""
    reached = voyages.leg_status[:, :-1] == int(Status.REACHED)
    step = np.where(reached, voyages.leg_step[:, :-1], -1)
    visit_step = np.zeros(order.shape, np.int32)
    np.put_along_axis(visit_step, order[:, 1:], step, axis=1)
    return visit_step >= 0, visit_step


def _measured(
    cells: np.ndarray, counts: np.ndarray, cell_size: float
) -> tuple[np.ndarray, np.ndarray]:
    """Length, m, and changes of course of paths through some cells; waits count for nothing."""
    valid = np.arange(1, cells.shape[1]) < counts[:, None]
    move = np.where(valid[..., None], np.diff(cells, axis=1), 0).astype(np.int64)
    x, y = move[..., 0], move[..., 1]
    length = np.hypot(x, y).sum(axis=1) * cell_size
    moves = (x != 0) | (y != 0)
    last = np.maximum.accumulate(np.where(moves, np.arange(moves.shape[1]), -1), axis=1)
    before = np.maximum(last[:, :-1], 0)
    old_x, old_y = (np.take_along_axis(a, before, axis=1) for a in (x, y))
    x, y = x[:, 1:], y[:, 1:]
    turns = (old_x * y != old_y * x) | (old_x * x + old_y * y < 0)
    begun = last[:, :-1] >= 0
    return length, (moves[:, 1:] & begun & turns).sum(axis=1, dtype=np.int32)
