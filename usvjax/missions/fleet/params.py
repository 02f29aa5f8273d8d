"""What a fleet's navigation leaves to choose: numbers that may be swept, and choices of method."""

from dataclasses import dataclass, fields
from functools import partial
from typing import Any

import jax
import numpy as np

from usvjax.checks import (
    LEAST_SINGLE,
    MOST_SINGLE,
    any_array,
    one_of,
    positive,
    shown,
    whole_number,
)
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps.sensed import MOST_REMOTE
from usvjax.units import KNOT, NAUTICAL_MILE
from usvkernels.dwa.params import Sampling, Vessel
from usvkernels.fleet import wei2023
from usvkernels.fleet.environment import Environment
from usvkernels.fleet.models import LONGEST_SUBSTEP, MODELS, SUBSTEPS, top_speed
from usvkernels.fleet.params import Encounters, Objective, Passage, Settings
from usvkernels.fleet.steering import CLEARANCES

DEGREE = np.pi / 180  # rad

Scalar = float | Any
"""One number, or float[B or 1, n], one per vessel."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class FleetParams:
    """Numbers of a fleet; each one number, or float[B or 1, n], one per vessel.

    Defaults are Wei & Zhang 2023, Tables 1 and 2, at a control period of 1 s; what the paper does
    not print is said so.

    Attributes:
        v_max: largest speed (m/s). Table 1.
        w_max: largest yaw rate, to either side (rad/s). Table 1.
        v_acc, v_dec: what a vessel gains and loses of its speed (m/s^2). Table 1.
        w_acc: what the yaw rate changes by (rad/s^2). Table 1.
        v_step, w_step: resolution of the dynamic window (m/s, rad/s). Table 2.
        heading_weight, clearance_weight, velocity_weight: of the score. Table 2.
        dt: control period (s). Table 2 prints 0.01 h, see docs/equations.md.
        clearance_cap: distance to obstacles from which more scores no better (m). Not printed.
        hull_radius: of a vessel's circle (m). Table 2's collision radius is a pair's, so half.
        leeway: share of the wind's velocity at which it pushes a vessel through the water.
        obstacle_radius: of the circles about obstacles (m), in a scene of circles. Half of
            Table 2's likewise.
        goal_tolerance: distance from the goal at which it is reached (m). Not printed.
        heading_tolerance: to either side of the heading to arrive on (rad); who comes to its goal
            on another goes around, back to its way point. pi: any will do. Not printed.
        passing: wanted between hulls that pass each other (m). Not printed.
        sight_time: how long before the closest point a vessel acts (s). Not printed.
        act_time: how long before contact a vessel that stands on acts as well (s). Not printed.
        threshold: between guidance points of vessels that meet, for "wei2023" (m). Not printed.
        stuck_distance, stuck_time: a vessel that stays within the first (m) for the second (s) is
            stuck: a deadlock. Not printed.
        livelock_time: a vessel that comes no further along its route for this (s) is stuck as well,
            though it moves. Not printed.
    """

    v_max: Scalar = 20 * KNOT
    w_max: Scalar = 15 * DEGREE
    v_acc: Scalar = 2 * KNOT
    v_dec: Scalar = 2 * KNOT
    w_acc: Scalar = 5 * DEGREE
    v_step: Scalar = 0.1 * KNOT
    w_step: Scalar = DEGREE
    heading_weight: Scalar = 0.1
    clearance_weight: Scalar = 0.1
    velocity_weight: Scalar = 0.7
    dt: Scalar = 1.0
    clearance_cap: Scalar = 0.5 * NAUTICAL_MILE
    hull_radius: Scalar = 0.125 * NAUTICAL_MILE
    leeway: Scalar = 0.0
    obstacle_radius: Scalar = 0.125 * NAUTICAL_MILE
    goal_tolerance: Scalar = 0.05 * NAUTICAL_MILE
    heading_tolerance: Scalar = 5 * DEGREE
    passing: Scalar = 0.05 * NAUTICAL_MILE
    sight_time: Scalar = 300.0
    act_time: Scalar = 60.0
    threshold: Scalar = 0.5 * NAUTICAL_MILE
    stuck_distance: Scalar = 5.0
    stuck_time: Scalar = 120.0
    livelock_time: Scalar = 900.0


@dataclass(frozen=True)
class FleetStatic:
    """Choices of method, sizes, and how routes are laid; hashable.

    Attributes:
        n_v, n_w: candidates along speed and yaw rate (at least what the window can hold).
        horizon: control periods for which a candidate is held; its course is kept from there on.
            Not printed: with the rate held for all of Table 2's 120 s, the least turn is 120 deg.
        max_steps: bound on the steps of an episode.
        unit_length: between the points of a route (m). Table 2.
        look_ahead: along the route from the vessel to its guidance point (m). Not printed.
        guide_length: of the guide segment, on which a vessel with a heading to arrive at comes to
            its goal (m). Not printed.
        cell_size: of the grid on which a route is searched among circles (m); None: a quarter of
            the distance that a vessel keeps from a centre, and at most unit_length.
        model: of the vessels' motion: "unicycle", which takes commands on at once, or "otter"
            (surge, sway and yaw; Fossen's Otter), which has them for set points; see
            `usvkernels.fleet.models`. Wind moves the first by its leeway, the other by its force.
        clearance: how much of it scores: "guide", up to what the guidance point itself is clear of
            obstacles at rest by, with a course that is looked along less, the more that point is
            off the bow; or "printed", up to `clearance_cap`, looked along all the way.
        equal: for "wei2023", who goes first at equal outboard angles ("first": of the fleet;
            "both_yield").
        ring: for "wei2023", who goes where each yields to another ("all_yield": nobody;
            "largest_goes": the largest angle).
    """

    n_v: int = 41
    n_w: int = 11
    horizon: int = 3
    max_steps: int = 3600
    unit_length: float = 0.05 * NAUTICAL_MILE
    look_ahead: float = 0.25 * NAUTICAL_MILE
    guide_length: float = 1.0 * NAUTICAL_MILE
    cell_size: float | None = None
    model: str = "unicycle"
    clearance: str = "guide"
    equal: str = "first"
    ring: str = "all_yield"

    def __post_init__(self) -> None:
        for field in fields(self):
            if isinstance(value := getattr(self, field.name), np.number):
                object.__setattr__(self, field.name, value.item())  # NumPy's overflow in products


MOST_SPEED = 1e4
"""Of vessels, circles, currents and wind (m/s): what single precision follows for an episode."""

STRATEGIES = ("rules", "wei2023", "orca", "none")


def split(
    params: FleetParams, static: FleetStatic, strategy: str, environment: Environment | None
) -> Settings:
    """Parameters and choices apart by what they are about, as the kernels take them."""
    p = params
    still: Any = jax.tree.map(np.zeros_like, p.v_max)
    vessel = Vessel(
        v_min=still,
        v_max=p.v_max,
        w_min=jax.tree.map(np.negative, p.w_max),
        w_max=p.w_max,
        v_acc=p.v_acc,
        v_dec=p.v_dec,
        w_acc=p.w_acc,
        w_dec=p.w_acc,
        dt=p.dt,
        plant="unicycle",
    )
    objective = Objective(
        heading_weight=p.heading_weight,
        clearance_weight=p.clearance_weight,
        velocity_weight=p.velocity_weight,
        clearance_cap=p.clearance_cap,
    )
    passage = Passage(
        hull_radius=p.hull_radius,
        obstacle_radius=p.obstacle_radius,
        goal_tolerance=p.goal_tolerance,
        heading_tolerance=p.heading_tolerance,
        stuck_distance=p.stuck_distance,
        stuck_time=p.stuck_time,
        livelock_time=p.livelock_time,
        unit_length=static.unit_length,
        model=static.model,
        clearance=static.clearance,
        max_steps=static.max_steps,
        strides=strides(params, static),
    )
    encounters = Encounters(
        passing=p.passing,
        sight_time=p.sight_time,
        act_time=p.act_time,
        threshold=p.threshold,
        strategy=strategy,
        equal=static.equal,
        ring=static.ring,
    )
    sampling = Sampling(p.v_step, p.w_step, static.n_v, static.n_w, static.horizon)
    return Settings(vessel, sampling, objective, passage, encounters, environment)


def strides(params: FleetParams, static: FleetStatic) -> int:
    """Points of a route that the fastest vessel may pass in a step, rounded up to a power of 2."""
    passed = np.max(np.asarray(params.v_max) * np.asarray(params.dt)) / static.unit_length
    return 1 << max(0, int(np.ceil(np.log2(max(passed, 1.0)))))


_CHOICES = {
    "model": tuple(MODELS),
    "clearance": CLEARANCES,
    "equal": tuple(wei2023.EQUAL),
    "ring": tuple(wei2023.RING),
}
_NOT_NEGATIVE = ("passing", "stuck_distance", "hull_radius", "leeway", "obstacle_radius")
_ANY = ("heading_weight", "clearance_weight", "velocity_weight")
_AT_MOST = {"v_max": MOST_SPEED, "hull_radius": MOST_REMOTE, "obstacle_radius": MOST_REMOTE}
_MOST = {"n_v": 1000, "n_w": 1000, "horizon": 100, "max_steps": 10_000_000}
_LENGTHS = ("unit_length", "look_ahead", "guide_length")
# Of a decision: with more, a program takes minutes to compile and a step of it seconds.
_MOST_COMMANDS = 20_000
# Points of a route in a step, each of which is compiled, and in a look-ahead.
_MOST_STRIDES, _MOST_AHEAD = 16, 1024


def check_params(params: FleetParams, static: FleetStatic, shape: tuple[int, int]) -> FleetParams:
    """Refuse parameters that make no sense, before anything is compiled.

    Args:
        params: leaves one number, or float[B or 1, n].
        static: choices of method.
        shape: (B, n).

    Returns:
        The same in double precision.

    Raises:
        BadTypeError: a leaf that is not a number, or of the wrong class.
        BadInputError: naming the parameter, what it is and what was wanted.
    """
    if not isinstance(params, FleetParams):
        raise BadTypeError(f"params: got {type(params).__name__}; wanted FleetParams")
    if not isinstance(static, FleetStatic):
        raise BadTypeError(f"static: got {type(static).__name__}; wanted FleetStatic")
    leaves = {f.name: _leaf(f.name, getattr(params, f.name), shape) for f in fields(params)}
    params = FleetParams(**leaves)
    _check_static(static)
    _check_window(params, static)
    _check_route(params, static)
    _check_model(params, static)
    return params


def _leaf(name: str, value: Any, shape: tuple[int, int]) -> Any:
    """A parameter in double precision: a number, or float64[B or 1, n]."""
    array = any_array(f"params.{name}", value, "numbers")
    if array.dtype.kind not in "iuf":
        raise BadTypeError(f"params.{name}: got {shown(value)}; wanted a number")
    if array.ndim and array.shape not in (shape, (1, shape[1])):
        raise BadInputError(
            f"params.{name}: got shape {array.shape}; wanted one number, {shape} or {(1, shape[1])}"
        )
    array = array.astype(np.float64)
    _demand(name, array, np.isfinite(array), "a finite number")
    _demand(name, array, np.abs(array) <= MOST_SINGLE, "a number that single precision holds")
    if name in _NOT_NEGATIVE:
        _demand(name, array, array >= 0, "0 or more")
    elif name not in _ANY:
        _demand(name, array, array >= LEAST_SINGLE, "more than 0 in single precision")
    if name in _AT_MOST:
        _demand(name, array, array <= _AT_MOST[name], f"at most {_AT_MOST[name]:g}")
    return array if array.ndim else float(array)


def _demand(name: str, value: np.ndarray, holds: np.ndarray, wanted: str) -> None:
    if not np.all(holds):
        raise BadInputError(f"params.{name}: got {value[~holds].flat[0]:g}; wanted {wanted}")


def _check_static(static: FleetStatic) -> None:
    for name, allowed in _CHOICES.items():
        one_of(f"static.{name}", getattr(static, name), allowed)
    for name, most in _MOST.items():
        if whole_number(f"static.{name}", getattr(static, name), 1) > most:
            raise BadInputError(
                f"static.{name}: got {getattr(static, name)}; wanted at most {most:,}"
            )
    if static.n_v * static.n_w > _MOST_COMMANDS:
        raise BadInputError(
            f"static: {static.n_v} x {static.n_w} candidates; wanted at most {_MOST_COMMANDS:,}"
        )
    for name in _LENGTHS + (("cell_size",) if static.cell_size is not None else ()):
        length = positive(f"static.{name}", getattr(static, name))
        if length > MOST_REMOTE:
            raise BadInputError(
                f"static.{name}: got {length:g} m; wanted at most {MOST_REMOTE:g} m"
            )


def _check_route(params: FleetParams, static: FleetStatic) -> None:
    """Bound what goes through a route's points one by one."""
    passed = strides(params, static)
    if passed > _MOST_STRIDES:
        raise BadInputError(
            f"static.unit_length: got {static.unit_length:g} m, of which a vessel sails about "
            f"{passed:.3g} in a control period; wanted at most {_MOST_STRIDES}"
        )
    if static.look_ahead > _MOST_AHEAD * static.unit_length:
        raise BadInputError(
            f"static.look_ahead: got {static.look_ahead:g} m, of {static.unit_length:g} m from "
            f"point to point; wanted at most {_MOST_AHEAD:,} points"
        )


def _check_window(params: FleetParams, static: FleetStatic) -> None:
    dt, w_max = np.asarray(params.dt), np.asarray(params.w_max)
    turn = float(np.max(w_max * dt)) * static.horizon
    if turn > np.pi:
        raise BadInputError(
            f"static.horizon: in {static.horizon} control periods a vessel turns by "
            f"{np.degrees(turn):.4g} deg; wanted at most 180"
        )
    for name, count, gain, span, step in (
        ("n_v", static.n_v, np.add(params.v_acc, params.v_dec), params.v_max, params.v_step),
        ("n_w", static.n_w, 2 * np.asarray(params.w_acc), 2 * w_max, params.w_step),
    ):
        held = np.minimum(gain * dt, span) / np.asarray(step)
        needed = np.floor(np.max(held) + 1e-3) + 1
        if count < needed:
            raise BadInputError(
                f"static.{name}: {count} candidates; the window of these parameters holds "
                f"{needed:.9g}"
            )


def _check_model(params: FleetParams, static: FleetStatic) -> None:
    hull = MODELS[static.model].hull
    if hull is None:
        return
    most, fastest = top_speed(hull), float(np.max(params.v_max))
    if fastest > most:
        raise BadInputError(
            f"params.v_max: got {fastest:g} m/s; the {static.model} makes at most {most:.2f} m/s"
        )
    longest = SUBSTEPS * LONGEST_SUBSTEP
    if np.max(params.dt) > longest:
        raise BadInputError(
            f"params.dt: got {np.max(params.dt):g} s; the {static.model} is integrated in "
            f"{SUBSTEPS} substeps, which hold for at most {longest:g} s"
        )
