"""Aggregation: vessels sail to the slots of a formation and hold them on a common heading."""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from usvjax.checks import any_array, float_array, not_negative, one_of
from usvjax.missions.aggregate.formations import (
    assigned,
    check_spacing,
    check_tight,
    placed,
    slots_of,
)
from usvjax.missions.aggregate.params import AggregateParams, AggregateStatic
from usvjax.missions.aggregate.rounding import ways_round
from usvjax.missions.fleet.environment import Environment
from usvjax.missions.fleet.inputs import Voyage, pack, presence, start_places
from usvjax.missions.fleet.params import STRATEGIES, FleetParams, FleetStatic, check_params
from usvjax.missions.fleet.run import FleetResult, sail
from usvjax.paths.inputs import MOST_COORDINATE
from usvjax.public import public
from usvkernels.fleet.state import ABSENT
from usvkernels.status import Status

ROOM = 1.5
"""Default spacing, in distances at which hulls pass each other."""


@dataclass(frozen=True)
class AggregateResult(FleetResult):
    """How B aggregations ended, beside what `FleetResult` says.

    Attributes:
        formed: bool[B], whether every vessel holds its slot, within the tolerances of `params`.
        formed_time: float32[B], when they had all held it for the hold time (s); inf if not.
        slot: int32[B, n], the slot that each vessel was given.
        formation_error: float32[B], largest distance of a vessel from its slot at the end (m).
        slots: float64[B, n, 2], the places of those slots (m).
    """

    formed: np.ndarray
    formed_time: np.ndarray
    slot: np.ndarray
    formation_error: np.ndarray
    slots: np.ndarray


@public("usvkernels.fleet")
def aggregate(
    scene: Any,
    starts: Any,
    centre: Any,
    heading: Any,
    *,
    formation: Any = "wedge",
    spacing: float | None = None,
    assignment: str = "hungarian",
    encounters: str = "rules",
    hold_time: float = 10.0,
    valid: Any = None,
    environment: Environment | None = None,
    params: FleetParams | None = None,
    static: FleetStatic | None = None,
    record: bool = False,
) -> AggregateResult:
    """Gather B fleets of n vessels in a formation, all on one heading.

    Each vessel navigates (`navigate`) to a slot by a guide segment on the heading (Wei & Zhang
    2023, section 2.3.2), stops there and holds it. Who comes from ahead of the formation sails
    round it first, where there is a way, so that nobody crosses the slots of others.

    Args:
        scene, starts, encounters, valid, environment, record: as of `navigate`.
        centre: float[B, 2] or float[2], of the formation (m).
        heading: float[B] or one number (rad).
        formation: "wedge", "line" (abreast), "column", "circle", or float[S, 2], slots of one's
            own: m ahead of the centre and to port.
        spacing: between neighbouring slots (m); None: one and a half times the distance at which
            a fleet's largest hulls pass each other.
        assignment: "hungarian" (the least sum of distances), "nearest" (pair by pair) or "given".
        hold_time: that every vessel is to hold its slot for (s).
        params: numbers; by default those of `navigate`, with a goal tolerance of 10 m and 1,800 s
            to come further along a route in.
        static: choices of method; by default those of `navigate`, with up to 7,200 steps.

    Returns:
        The outcomes, in the order of `starts`.

    Raises:
        BadTypeError, BadInputError: as `navigate`; a formation tighter than the hulls, with fewer
            slots than vessels, or with a slot in an obstacle.
    """
    static = AggregateStatic() if static is None else static
    one_of("encounters", encounters, STRATEGIES)
    mustered = muster(
        scene,
        starts,
        centre,
        heading,
        formation,
        spacing,
        assignment,
        hold_time,
        valid,
        environment,
        AggregateParams() if params is None else params,
        static,
    )
    return gather(mustered, static, encounters, record)


@dataclass(frozen=True)
class Muster:
    """Checked fleets that are to gather.

    Attributes:
        voyage: their ways to the slots.
        slot: int32[B, n], which each vessel takes.
        slots: float64[B, n, 2], the places of those (m).
        hold_time: that every vessel is to hold its slot for (s).
    """

    voyage: Voyage
    slot: np.ndarray
    slots: np.ndarray
    hold_time: float


def muster(
    scene: Any,
    starts: Any,
    centre: Any,
    heading: Any,
    formation: Any,
    spacing: float | None,
    assignment: str,
    hold_time: float,
    valid: Any,
    environment: Environment | None,
    params: FleetParams,
    static: FleetStatic,
) -> Muster:
    """Check and pack the fleets of `aggregate`, whose docstring says what is what."""
    start = start_places(starts)
    fleets, n = start.shape[:2]
    present = presence(valid, (fleets, n))
    params = check_params(params, static, (fleets, n))
    centres = of_fleets("centre", centre, fleets, (2,))
    headings = of_fleets("heading", heading, fleets, ())
    hold_time = not_negative("hold_time", hold_time)
    slots, room = local_slots(formation, spacing, params, (fleets, n))
    there = placed(slots, centres, headings)
    slot = assigned(assignment, start[..., :2], there, present)
    goals = np.take_along_axis(there, slot[..., None].astype(np.int64), axis=1)
    voyage = pack(
        scene,
        start,
        goals,
        np.repeat(headings[:, None], n, axis=1),
        present,
        None,
        None,
        environment,
        params,
        static,
        ends="slots",
        via=ways_round(start[..., :2], slots, slot, centres, headings, room, static.guide_length),
    )
    return Muster(voyage, slot, goals, hold_time)


def local_slots(
    formation: Any, spacing: float | None, params: FleetParams, shape: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray]:
    """Slots that hulls fit into, and the room that passing vessels keep.

    Args:
        formation, spacing: as of `aggregate`.
        params: of the fleets, checked.
        shape: (B, n).

    Returns:
        float64[B, S, 2], m ahead of the centre and to port; float64[B], between centres (m).
    """
    fleets, n = shape
    hull = np.broadcast_to(params.hull_radius, shape)
    room = 2 * hull.max(axis=1) + np.broadcast_to(params.passing, shape).max(axis=1)
    spacings = ROOM * room if spacing is None else np.full(fleets, check_spacing(spacing))
    slots = slots_of(formation, n, spacings)
    check_tight(slots, hull)
    return slots, room


def gather(
    mustered: Muster, static: FleetStatic, encounters: str, record: bool = False
) -> AggregateResult:
    """Let fleets gather that were checked.

    Args:
        mustered, static: what `muster` was given, and made of it.
        encounters, record: as of `aggregate`.
    """
    found = sail(mustered.voyage, static, encounters, record)
    absent = found.vessel_status == ABSENT
    aligned = found.heading_error <= mustered.voyage.params.heading_tolerance
    holds = (found.vessel_status == int(Status.REACHED)) & aligned
    off = np.linalg.norm(found.final[..., :2] - mustered.slots, axis=-1)
    holds &= off <= mustered.voyage.params.goal_tolerance
    formed = np.all(holds | absent, axis=1)
    # Who has arrived brakes: it holds its slot from the step in which it stops.
    at_rest = np.where(absent, 0.0, found.rest_time).max(axis=1)
    own = {f.name: getattr(found, f.name) for f in fields(FleetResult)}
    return AggregateResult(
        **own,
        formed=formed,
        formed_time=np.where(formed, at_rest + mustered.hold_time, np.inf).astype(np.float32),
        slot=mustered.slot,
        formation_error=np.where(absent, 0.0, off).max(axis=1).astype(np.float32),
        slots=mustered.slots,
    )


def of_fleets(name: str, value: Any, fleets: int, shape: tuple[int, ...]) -> np.ndarray:
    """One of a kind for each fleet, [B, ...]; given once, or for each."""
    array = any_array(name, value, f"numbers for all {fleets} fleets, or for each")
    each = () if array.ndim == len(shape) else (fleets,)
    checked = float_array(name, array, (*each, *shape), MOST_COORDINATE)
    return np.broadcast_to(checked, (fleets, *shape))
