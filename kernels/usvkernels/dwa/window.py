"""The dynamic window of Tan et al. 2022 opened up: which commands it holds and where they lead.

Lanes (independent episodes) lie on the LAST axis of every array, so that each operation runs
over contiguous lanes whatever the candidate or obstacle. A decision costs two sines per lane;
the eleven headings and chords of the window follow by rotations.
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.dwa.clearance import Scalar
from usvkernels.dwa.params import Sampling, Vessel
from usvkernels.trig import sincos
from usvkernels.vessel import Complex, complex_product, geometric_sum
from usvkernels.xla.stage import stage

Commands = tuple[Array, Array, Array, Array]
"""Speeds [n_v, lanes] (m/s) and whether inside the window, yaw rates [n_w, lanes] likewise."""

SLACK = 1e-3
"""Share of a candidate's step by which rounding may carry it past an edge."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Motion:
    """Poses and rates in one array: five would each be copied on their way into a stage."""

    rows: Array  # float[5 or more, lanes]

    @property
    def place(self) -> Array:
        """X and y, float[2, lanes] (m)."""
        return self.rows[:2]

    @property
    def x(self) -> Array:
        """East (m)."""
        return self.rows[0]

    @property
    def y(self) -> Array:
        """North (m)."""
        return self.rows[1]

    @property
    def psi(self) -> Array:
        """Heading (rad)."""
        return self.rows[2]

    @property
    def v(self) -> Array:
        """Speed (m/s)."""
        return self.rows[3]

    @property
    def w(self) -> Array:
        """Yaw rate (rad/s)."""
        return self.rows[4]


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Fan:
    """Predicted ends of the window, relative to the vessel, per unit of speed."""

    chord: Complex  # [n_w, lanes], displacement at 1 m/s
    heading: Complex  # [n_w, lanes], unit vector at the end
    first: Complex  # [n_w, lanes], unit vector of the first step
    turn: Complex  # [n_w, lanes], rotation of one step


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Resolution:
    """What the parameters alone say about every window; leaves scalar, or [lanes] as these.

    Whether a compiler fuses a product with the sum that it goes into, and so rounds once or
    twice, differs between one parameter for all lanes and one for each. These products are
    operands of the window, which leaves it only sums.
    """

    v_loss: Array  # m/s that the speed can lose in a control period
    v_gain: Array
    w_loss: Array  # rad/s
    w_gain: Array
    v_offset: Array  # [n_v, 1 or lanes], m/s above the lowest candidate
    w_offset: Array  # [n_w, 1 or lanes], rad/s
    v_slack: Array  # m/s past the window's edge that rounding may explain
    w_slack: Array
    turn: Complex  # [n_w, 1 or lanes], rotation of one step at w_offset


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Window:
    """The window opened up: its commands, where they lead, and the obstacles as seen from here."""

    v: Array  # float[n_v, lanes], m/s
    inside_v: Array  # bool[n_v, lanes], False past the window's edge
    w: Array  # float[n_w, lanes], rad/s
    inside_w: Array  # bool[n_w, lanes]
    fan: Fan
    obstacles: Array  # float[2, K, lanes], centres relative to the vessel (m)


def resolution(vessel: Vessel, sampling: Sampling, dtype: jnp.dtype) -> Resolution:
    """The window's resolution, in the arithmetic of `dtype`."""
    can, by = jax.tree.map(partial(jnp.asarray, dtype=dtype), (vessel, sampling))
    w_offset = jnp.arange(by.n_w, dtype=dtype)[:, None]
    sin, cos = sincos(w_offset * (by.w_step * can.dt))
    return Resolution(
        v_loss=can.v_dec * can.dt,
        v_gain=can.v_acc * can.dt,
        w_loss=can.w_dec * can.dt,
        w_gain=can.w_acc * can.dt,
        v_offset=jnp.arange(by.n_v, dtype=dtype)[:, None] * by.v_step,
        w_offset=w_offset * by.w_step,
        v_slack=SLACK * by.v_step,
        w_slack=SLACK * by.w_step,
        turn=(cos, sin),
    )


def window(vessel: Vessel, of: Resolution, v: Array, w: Array) -> Commands:
    """Candidate commands: V_s and V_d (Tan et al. 2022, Eqs. 2, 3) at the given resolution.

    Args:
        vessel: its limits.
        of: what `resolution` makes of them.
        v, w: present speed (m/s) and yaw rate (rad/s), float[lanes].

    Returns:
        (v_i, inside_v, w_j, inside_w), the first two [n_v, lanes], the others [n_w, lanes]; a
        candidate past the window's upper edge is not inside.
    """
    v_low = jnp.maximum(vessel.v_min, v - of.v_loss)
    w_low = jnp.maximum(vessel.w_min, w - of.w_loss)
    v_high = jnp.minimum(vessel.v_max, v + of.v_gain)
    w_high = jnp.minimum(vessel.w_max, w + of.w_gain)
    v_i, w_j = v_low + of.v_offset, w_low + of.w_offset
    return v_i, v_i <= v_high + of.v_slack, w_j, w_j <= w_high + of.w_slack


def _predict(
    vessel: Vessel, sampling: Sampling, of: Resolution, bow: Complex, base: Complex
) -> Fan:
    """Closed form of `horizon` Euler steps for all yaw rates of the window.

    A plant other than "heading_first" is predicted as a unicycle.

    Args:
        vessel, sampling: what is predicted, and how far.
        of: what `resolution` makes of them.
        bow: unit vector of the present heading.
        base: rotation of one step at the window's lowest yaw rate.
    """
    dt = vessel.dt
    turn = complex_product(base, of.turn)
    total, end = geometric_sum(turn, sampling.horizon)
    shape = turn[0].shape
    first: Complex = (jnp.broadcast_to(bow[0], shape), jnp.broadcast_to(bow[1], shape))
    heading = complex_product(first, end)
    if vessel.plant == "heading_first":
        first = complex_product(first, turn)
    chord = complex_product((first[0] * dt, first[1] * dt), total)
    return Fan(chord, heading, first, turn)


@jax.jit  # traced once for all branches of a stage
def _commands(vessel: Vessel, of: Resolution, motion: Motion) -> tuple[Commands, Complex, Complex]:
    """The window, and the last two arguments of `_predict`."""
    commands = window(vessel, of, motion.v, motion.w)
    sin, cos = sincos(motion.psi)
    base_sin, base_cos = sincos(commands[2][0] * vessel.dt)
    return commands, (cos, sin), (base_cos, base_sin)


@jax.jit  # as `_commands`
def _survey(
    vessel: Vessel,
    sampling: Sampling,
    of: Resolution,
    bow: Complex,
    base: Complex,
    motion: Motion,
    obstacles: Array,
) -> tuple[Fan, Array]:
    """The prediction, and the obstacles relative to the vessel."""
    return _predict(vessel, sampling, of, bow, base), obstacles - motion.place[:, None]


def unknown_true(dt: Scalar) -> Array:
    """True, which the compiler cannot know: what makes a `stage` one; dt is a control period."""
    return jnp.any(jnp.asarray(dt) > 0.0)


def open_window(vessel: Vessel, sampling: Sampling, motion: Motion, obstacles: Array) -> Window:
    """The window and its prediction, in stages apart from what uses them.

    Otherwise XLA takes a vessel's sines anew for each yaw rate, and predicts anew for each of a
    yaw rate's speeds, in each use of the prediction.
    """
    go = unknown_true(vessel.dt)
    of = resolution(vessel, sampling, motion.rows.dtype)
    commands, bow, base = stage(go, _commands, vessel, of, motion)
    fan, relative = stage(go, _survey, vessel, sampling, of, bow, base, motion, obstacles)
    v, inside_v, w, inside_w = commands
    return Window(v, inside_v, w, inside_w, fan, relative)


def predicted_paths(vessel: Vessel, sampling: Sampling, motion: Motion) -> Array:
    """Every predicted trajectory of the window, start included.

    Args:
        vessel, sampling: what is predicted, and how far.
        motion: the vessels.

    Returns:
        float[n_v, n_w, horizon + 1, lanes, 2] (m).
    """
    nothing = jnp.zeros((2, 0, motion.rows.shape[1]), motion.rows.dtype)
    window = open_window(vessel, sampling, motion, nothing)
    v_i, w_j, fan = window.v, window.w, window.fan
    origin = jnp.zeros((*w_j.shape, 2), w_j.dtype)
    dt = jnp.asarray(vessel.dt, w_j.dtype)[..., None]

    def advance(carry: tuple[Array, Complex], _: None) -> tuple[tuple[Array, Complex], Array]:
        chord, direction = carry
        chord = chord + dt * jnp.stack(direction, axis=-1)
        return (chord, complex_product(direction, fan.turn)), chord

    _, chords = jax.lax.scan(advance, (origin, fan.first), None, length=sampling.horizon)
    relative = jnp.concatenate([origin[None], chords]).swapaxes(0, 1)
    return motion.place.T + v_i[:, None, None, :, None] * relative
