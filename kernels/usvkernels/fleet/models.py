"""How vessels move under the commands of a control period: set points of speed and yaw rate.

"unicycle" takes them on at once, and makes no way sideways. "otter" is a hull with two propellers
in surge, sway and yaw (Fossen 2021, ch. 6): M dv/dt + C(v) v + D(v) v = thrust + wind, of
velocities through the water, which a uniform current leaves as they are. Its thrust is the sum of
what the present motion takes (feed-forward of C and D) and of what brings speed and yaw rate to
their set points at the rate 1 / RESPONSE (proportional); sway is nobody's to command. It is
integrated by Runge and Kutta's method of fourth order, in substeps for which the propellers'
commands are held.

States are rows [5 or 8, ..]: x, y (m), psi (rad), v (m/s, ahead), w (rad/s), and of the otter sway
(m/s, to port) and its propellers' speeds, port and starboard (rad/s).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from usvkernels.dwa.clearance import Scalar
from usvkernels.trig import sincos, wrap_angle
from usvkernels.vessel import Complex, unicycle_step

RESPONSE = 1.0
"""Time constant of speed and yaw rate under control (s)."""

SUBSTEPS = 10
"""In a control period."""

LONGEST_SUBSTEP = 0.2
"""Twice the propellers' time constant (s): from 2.8 times on the integration is unstable."""

STAGES = ((0.0, 1.0 / 6.0), (0.5, 1.0 / 3.0), (0.5, 1.0 / 3.0), (1.0, 1.0 / 6.0))
"""Of the classical Runge-Kutta method: where in a step each is taken, and what it weighs."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Hull:
    """A hull with two propellers; the origin is amidships."""

    mass: Scalar  # kg
    centre: Scalar  # m, of gravity, ahead
    inertia: Scalar  # kg m^2, about the origin
    added: tuple[Scalar, Scalar, Scalar]  # kg, kg, kg m^2, in surge, sway and yaw
    damping: tuple[Scalar, Scalar, Scalar]  # N s/m, N s/m, N m s, linear
    yaw_damping: Scalar  # N m s^2, quadratic
    cross_flow: Scalar  # kg/m^2, half the water's density by draught and drag coefficient
    length: Scalar  # m
    windage: tuple[Scalar, Scalar]  # kg/m, half the air's density by area and drag coefficient
    thrust: tuple[Scalar, Scalar]  # N s^2, per square of a propeller's speed ahead, astern
    fastest: tuple[Scalar, Scalar]  # rad/s, of a propeller ahead, and astern (below 0)
    lever: Scalar  # m, of a propeller off the midline
    lag: Scalar  # s, time constant of a propeller


OTTER = Hull(
    mass=80.0,
    centre=12.25 / 80.0,
    inertia=42.65 - 25.67,
    added=(5.5, 82.5, 25.67),
    damping=(77.55, 162.5, 42.65),
    yaw_damping=426.5,
    cross_flow=100.4,
    length=2.0,
    windage=(0.3, 0.5),
    thrust=(0.01108, 0.006445),
    fastest=(103.9, -101.7),
    lever=0.395,
    lag=0.1,
)
"""Fossen's Otter, 2.0 m, 80 kg with its payload. Its draught is 0.195 m by that displacement, its
cross-flow drag coefficient 1.0 by Hoerner's curve; windage is not published, and ours."""


class Model(NamedTuple):
    """A way to move."""

    hull: Hull | None
    extra: int  # rows of its state besides the first five
    advance: Callable[[Hull | None, Array, Complex, Complex | None, Complex | None, Scalar], Array]


def _unicycle(
    hull: Hull | None,
    state: Array,
    command: Complex,
    drift: Complex | None,
    wind: Complex | None,
    dt: Scalar,
) -> Array:
    x, y, psi = unicycle_step(state[0], state[1], state[2], *command, dt)
    if drift is not None:
        x, y = x + drift[0] * dt, y + drift[1] * dt
    return jnp.stack([x, y, psi, *command])


def _hull(
    hull: Hull | None,
    state: Array,
    command: Complex,
    drift: Complex | None,
    wind: Complex | None,
    dt: Scalar,
) -> Array:
    assert hull is not None

    def substep(_: int, state: Array) -> Array:
        wanted = propeller_speeds(hull, state, command)
        return runge_kutta(hull, state, wanted, drift, wind, dt / SUBSTEPS)

    return lax.fori_loop(0, SUBSTEPS, substep, state)


MODELS = {"unicycle": Model(None, 0, _unicycle), "otter": Model(OTTER, 3, _hull)}
"""By the name that a user gives. `advance` takes hull, state, command, drift and wind (m/s; None
for none), both over ground and held, and the control period (s)."""


def top_speed(hull: Hull) -> float:
    """Straight ahead, at full thrust (m/s)."""
    return float(2.0 * hull.thrust[0] * np.square(hull.fastest[0]) / hull.damping[0])


def propeller_speeds(hull: Hull, state: Array, command: Complex) -> Complex:
    """What the controller asks of the propellers (rad/s), port and starboard, within limits."""
    u, r, sway = state[3], state[4], state[5]
    surge_rate, yaw_rate = (command[0] - u) / RESPONSE, (command[1] - r) / RESPONSE
    ahead, side, moment = _resistance(hull, u, sway, r)
    coupling = hull.mass * hull.centre
    sway_rate = -(side + coupling * yaw_rate) / (hull.mass + hull.added[1])
    push = ahead + (hull.mass + hull.added[0]) * surge_rate
    turn = moment + coupling * sway_rate + (hull.inertia + hull.added[2]) * yaw_rate
    per_side = turn / hull.lever
    return _speed_for(hull, 0.5 * (push - per_side)), _speed_for(hull, 0.5 * (push + per_side))


def runge_kutta(
    hull: Hull,
    state: Array,
    wanted: Complex,
    drift: Complex | None,
    wind: Complex | None,
    step: Scalar,
) -> Array:
    """One step (s) of the classical method of fourth order.

    Args:
        hull: the vessel.
        state: float[8, ..].
        wanted: of the propellers, port and starboard (rad/s).
        drift, wind: over ground (m/s); None for none.
        step: s.
    """
    nodes, weights = jnp.asarray(STAGES, state.dtype).T

    def stage(k: Array, carry: tuple[Array, Array]) -> tuple[Array, Array]:
        slope, mean = carry
        slope = _rate(hull, state + (nodes[k] * step) * slope, wanted, drift, wind)
        return slope, mean + weights[k] * slope

    # A loop, since unrolled the stages take XLA minutes to fuse with each other.
    still = jnp.zeros_like(state)
    after = state + step * lax.fori_loop(0, len(STAGES), stage, (still, still))[1]
    return after.at[2].set(wrap_angle(after[2]))


def _rate(
    hull: Hull, state: Array, wanted: Complex, drift: Complex | None, wind: Complex | None
) -> Array:
    """Derivative of a state."""
    _, _, psi, u, r, sway, port, starboard = state
    sin, cos = sincos(psi)
    east, north = u * cos - sway * sin, u * sin + sway * cos
    if drift is not None:
        east, north = east + drift[0], north + drift[1]
    ahead, side, moment = _resistance(hull, u, sway, r)
    left, right = _thrust(hull, port), _thrust(hull, starboard)
    push, shove, turn = left + right - ahead, -side, hull.lever * (right - left) - moment
    if wind is not None:
        blown = _windage(hull, (wind[0] - east, wind[1] - north), (cos, sin))
        push, shove = push + blown[0], shove + blown[1]
    coupling = hull.mass * hull.centre
    heavy, stiff = hull.mass + hull.added[1], hull.inertia + hull.added[2]
    over = 1.0 / (heavy * stiff - coupling * coupling)
    return jnp.stack(
        [
            east,
            north,
            r,
            push / (hull.mass + hull.added[0]),
            (heavy * turn - coupling * shove) * over,
            (stiff * shove - coupling * turn) * over,
            (wanted[0] - port) / hull.lag,
            (wanted[1] - starboard) / hull.lag,
        ]
    )


def _resistance(hull: Hull, u: Array, sway: Array, r: Array) -> tuple[Array, Array, Array]:
    """C(v) v + D(v) v: N ahead, N to port, N m counter-clockwise."""
    swung = hull.mass * (hull.centre * r + sway) + hull.added[1] * sway
    # Rigid and added mass; the last summand is Munk's moment.
    ahead = -swung * r
    side = (hull.mass + hull.added[0]) * u * r
    moment = hull.mass * hull.centre * u * r + (hull.added[1] - hull.added[0]) * u * sway
    drag, swing = _cross_flow(hull, sway, r)
    linear = hull.damping
    return (
        ahead + linear[0] * u,
        side + linear[1] * sway + drag,
        moment + (linear[2] + hull.yaw_damping * jnp.abs(r)) * r + swing,
    )


def _cross_flow(hull: Hull, sway: Array, r: Array) -> tuple[Array, Array]:
    """Drag across the hull by strip theory, integrated in closed form: N, and N m.

    Of |sway + x r| (sway + x r) over the hull's length: one sign all along it, or a pivot inside.
    """
    half = 0.5 * hull.length
    spin, flow = jnp.abs(r), jnp.abs(sway)
    pivots = flow < half * spin
    over = 1.0 / jnp.where(pivots, spin, 1.0)
    cube = half * half * half
    along = jnp.sign(sway) * (2.0 * half * flow * flow + (2.0 / 3.0) * cube * spin * spin)
    about = sway * ((2.0 / 3.0) * sway * sway * over + 2.0 * half * half * spin)
    moment_along = (4.0 / 3.0) * cube * flow * r
    share = flow * over
    moment_about = jnp.sign(r) * (
        half * half * flow * flow
        + 0.5 * half * cube * spin * spin
        - flow * flow * share * share / 6.0
    )
    force = jnp.where(pivots, about, along)
    moment = jnp.where(pivots, moment_about, moment_along)
    return hull.cross_flow * force, hull.cross_flow * moment


def _windage(hull: Hull, air: Complex, bow: Complex) -> Complex:
    """Force (N) ahead and to port of air that moves past the hull (m/s, over ground)."""
    speed = jnp.sqrt(air[0] * air[0] + air[1] * air[1])
    ahead = air[0] * bow[0] + air[1] * bow[1]
    left = air[1] * bow[0] - air[0] * bow[1]
    return hull.windage[0] * speed * ahead, hull.windage[1] * speed * left


def _thrust(hull: Hull, speed: Array) -> Array:
    """N, of a propeller at a speed (rad/s)."""
    return jnp.where(speed > 0.0, hull.thrust[0], hull.thrust[1]) * jnp.abs(speed) * speed


def _speed_for(hull: Hull, thrust: Array) -> Array:
    """A propeller's speed (rad/s) for a thrust (N), within its limits."""
    per = jnp.where(thrust > 0.0, hull.thrust[0], hull.thrust[1])
    speed = jnp.sign(thrust) * jnp.sqrt(jnp.abs(thrust) / per)
    return jnp.clip(speed, hull.fastest[1], hull.fastest[0])
