"""The dynamic window approach of Tan et al. 2022, traditional and with an obstacle search angle.

Lanes (independent episodes) lie on the LAST axis of every array, so that each operation runs
over contiguous lanes whatever the candidate or obstacle. A decision costs two sines per lane;
the eleven headings and chords of the window follow by rotations.
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.clearance import (
    FAR,
    Scalar,
    Sector,
    centres,
    fold_blocks,
    in_sector,
    nearest_squared,
    sector_of,
)
from usvkernels.dwa_params import DwaParams, DwaStatic
from usvkernels.trig import angle_between, sincos
from usvkernels.vessel import Complex, complex_product, geometric_sum
from usvkernels.xla.single import single
from usvkernels.xla.stage import stage

_at = partial(jax.lax.dynamic_index_in_dim, keepdims=False, allow_negative_indices=False)

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
class Candidates:
    """The window opened up: what each candidate command leads to and how it scores."""

    v: Array  # float[n_v, lanes], m/s
    w: Array  # float[n_w, lanes], rad/s
    end_x: Array  # float[n_v, n_w, lanes], m, predicted position
    end_y: Array  # float[n_v, n_w, lanes], m
    heading_error: Array  # float[n_v, n_w, lanes], rad, against the goal, at the end
    clearance: Array  # float[n_v, n_w, lanes], m, capped
    admissible: Array  # bool[n_v, n_w, lanes]
    score: Array  # float[n_v, n_w, lanes], -inf where not admissible


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Fan:
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
    sector: Sector


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Window:
    """The window opened up: its commands, where they lead, and the obstacles as seen from here."""

    v: Array  # float[n_v, lanes], m/s
    inside_v: Array  # bool[n_v, lanes], False past the window's edge
    w: Array  # float[n_w, lanes], rad/s
    inside_w: Array  # bool[n_w, lanes]
    fan: _Fan
    obstacles: Array  # float[2, K, lanes], centres relative to the vessel (m)
    sector: Sector


def resolution(params: DwaParams, static: DwaStatic, dtype: jnp.dtype) -> Resolution:
    """The window's resolution, in the arithmetic of `dtype`."""
    p = jax.tree.map(partial(jnp.asarray, dtype=dtype), params)
    w_offset = jnp.arange(static.n_w, dtype=dtype)[:, None]
    sin, cos = sincos(w_offset * (p.w_step * p.dt))
    return Resolution(
        v_loss=p.v_dec * p.dt,
        v_gain=p.v_acc * p.dt,
        w_loss=p.w_dec * p.dt,
        w_gain=p.w_acc * p.dt,
        v_offset=jnp.arange(static.n_v, dtype=dtype)[:, None] * p.v_step,
        w_offset=w_offset * p.w_step,
        v_slack=SLACK * p.v_step,
        w_slack=SLACK * p.w_step,
        turn=(cos, sin),
        sector=sector_of(p.search_angle, p.radius),
    )


def window(params: DwaParams, of: Resolution, v: Array, w: Array) -> Commands:
    """Candidate commands: V_s and V_d (Tan et al. 2022, Eqs. 2, 3) at the given resolution.

    Args:
      params: of the method.
      of: what `resolution` makes of the same parameters.
      v, w: present speed (m/s) and yaw rate (rad/s), float[lanes].

    Returns:
      (v_i, inside_v, w_j, inside_w), the first two [n_v, lanes], the others [n_w, lanes]; a
      candidate past the window's upper edge is not inside.
    """
    v_low = jnp.maximum(params.v_min, v - of.v_loss)
    w_low = jnp.maximum(params.w_min, w - of.w_loss)
    v_high = jnp.minimum(params.v_max, v + of.v_gain)
    w_high = jnp.minimum(params.w_max, w + of.w_gain)
    v_i, w_j = v_low + of.v_offset, w_low + of.w_offset
    return v_i, v_i <= v_high + of.v_slack, w_j, w_j <= w_high + of.w_slack


def _predict(
    static: DwaStatic, params: DwaParams, of: Resolution, bow: Complex, base: Complex
) -> _Fan:
    """Closed form of `horizon` Euler steps for all yaw rates of the window.

    Args:
      static, params, of: of the method.
      bow: unit vector of the present heading.
      base: rotation of one step at the window's lowest yaw rate.
    """
    dt = params.dt
    turn = complex_product(base, of.turn)
    total, end = geometric_sum(turn, static.horizon)
    shape = turn[0].shape
    first: Complex = (jnp.broadcast_to(bow[0], shape), jnp.broadcast_to(bow[1], shape))
    heading = complex_product(first, end)
    if static.heading_first:
        first = complex_product(first, turn)
    chord = complex_product((first[0] * dt, first[1] * dt), total)
    return _Fan(chord, heading, first, turn)


@jax.jit  # traced once for all branches of a stage
def _commands(
    params: DwaParams, of: Resolution, motion: Motion
) -> tuple[Commands, Complex, Complex]:
    """The window, and the last two arguments of `_predict`."""
    commands = window(params, of, motion.v, motion.w)
    sin, cos = sincos(motion.psi)
    base_sin, base_cos = sincos(commands[2][0] * params.dt)
    return commands, (cos, sin), (base_cos, base_sin)


@partial(jax.jit, static_argnums=0)  # as `_commands`
def _survey(
    static: DwaStatic,
    params: DwaParams,
    of: Resolution,
    bow: Complex,
    base: Complex,
    motion: Motion,
    obstacles: Array,
) -> tuple[_Fan, Array]:
    """The prediction, and the obstacles relative to the vessel."""
    return _predict(static, params, of, bow, base), obstacles - motion.place[:, None]


def unknown_true(params: DwaParams) -> Array:
    """True, which the compiler cannot know: what makes a `stage` of these parameters one."""
    return jnp.any(jnp.asarray(params.dt) > 0.0)


def _open_window(params: DwaParams, static: DwaStatic, motion: Motion, obstacles: Array) -> _Window:
    """The window and its prediction, in stages apart from what uses them.

    Otherwise XLA takes a vessel's sines anew for each yaw rate, and predicts anew for each of a
    yaw rate's speeds, in each use of the prediction.
    """
    go = unknown_true(params)
    of = resolution(params, static, motion.rows.dtype)
    commands, bow, base = stage(go, _commands, params, of, motion)
    survey = partial(_survey, static)
    fan, relative = stage(go, survey, params, of, bow, base, motion, obstacles)
    v, inside_v, w, inside_w = commands
    return _Window(v, inside_v, w, inside_w, fan, relative, of.sector)


def _nearest_along(
    obstacles: Array,
    v_i: Array,
    fan: _Fan,
    counted: list[Array] | None,
    static: DwaStatic,
    dt: Scalar,
    least: Array,
) -> Array:
    """As `nearest_squared`, over all positions of the predicted trajectory instead of its end."""
    if static.clearance == "trajectory_and_start":
        still = jnp.zeros_like(v_i[:, None] * fan.chord[0])
        least = nearest_squared(obstacles, (still, still), counted, least)

    def advance(_: int, carry: tuple[Complex, Complex, Array]) -> tuple[Complex, Complex, Array]:
        chord, direction, least = carry
        chord = (chord[0] + dt * direction[0], chord[1] + dt * direction[1])
        point = (v_i[:, None] * chord[0], v_i[:, None] * chord[1])
        return (
            chord,
            complex_product(direction, fan.turn),
            nearest_squared(obstacles, point, counted, least),
        )

    origin = (jnp.zeros_like(fan.first[0]), jnp.zeros_like(fan.first[1]))
    return jax.lax.fori_loop(0, static.horizon, advance, (origin, fan.first, least))[2]


def _clearance(params: DwaParams, static: DwaStatic, window: _Window) -> Array:
    """dist(v, w): from the predicted trajectory to the nearest circle that counts, capped.

    Returns:
      float[n_v, n_w, lanes] (m), negative inside a circle.
    """
    v_i, fan = window.v, window.fan
    end = (v_i[:, None] * fan.chord[0], v_i[:, None] * fan.chord[1])
    # Standing still is not going astern, whatever rounding makes of 0.
    astern = (v_i < -SLACK * params.v_step)[:, None]
    ahead = (
        jnp.where(astern, -fan.heading[0], fan.heading[0]),
        jnp.where(astern, -fan.heading[1], fan.heading[1]),
    )

    def fold(block: Array, least: Array) -> Array:
        counted = None
        if static.method == "improved":
            counted = [
                in_sector(centre, end, ahead, window.sector, params.radius)
                for centre in centres(block)
            ]
        if static.clearance == "endpoint":
            return nearest_squared(block, end, counted, least)
        return _nearest_along(block, v_i, fan, counted, static, params.dt, least)

    nearest = fold_blocks(fold, window.obstacles, jnp.full_like(end[0], jnp.inf))
    dist = jnp.where(nearest < FAR / 2, nearest - params.radius, params.clear_distance)
    return jnp.where(dist > params.clearance_cap, params.clearance_cap, dist)


def candidates(
    params: DwaParams, static: DwaStatic, motion: Motion, obstacles: Array, goal: Array
) -> Candidates:
    """Predict and score every command of the window (Tan et al. 2022, Eqs. 2 to 6).

    Args:
      params, static: of the method.
      motion: the vessels, leaves float[lanes].
      obstacles: float[2, K, lanes], centres (m); rows at FAR are padding.
      goal: float[2, lanes] (m).
    """
    window = _open_window(params, static, motion, obstacles)
    return _weigh(params, static, motion, goal, window)


def _weigh(
    params: DwaParams, static: DwaStatic, motion: Motion, goal: Array, window: _Window
) -> Candidates:
    v_i, w_j, fan = window.v, window.w, window.fan
    dist = _clearance(params, static, window)
    east, north = v_i[:, None] * fan.chord[0], v_i[:, None] * fan.chord[1]
    to_goal = goal - motion.place
    to_east, to_north = to_goal[0] - east, to_goal[1] - north
    error = angle_between(
        fan.heading[0] * to_north - fan.heading[1] * to_east,
        fan.heading[0] * to_east + fan.heading[1] * to_north,
    )
    admissible = window.inside_v[:, None] & window.inside_w & (dist > 0.0)
    if static.braking:
        v_square, w_square = (v_i * v_i)[:, None], w_j * w_j
        admissible &= (v_square <= 2.0 * dist * params.v_dec) & (
            w_square <= 2.0 * dist * params.w_dec
        )
    closeness = dist
    if static.clearance_score == "reciprocal":
        closeness = -1.0 / (dist + params.radius)
    parts = (jnp.pi - error, closeness, v_i[:, None])
    heading, clearance, velocity = _normalised(static, parts, admissible)
    score = (
        params.heading_weight * heading
        + params.clearance_weight * clearance
        + params.velocity_weight * velocity
    )
    return Candidates(
        v=v_i,
        w=w_j,
        end_x=motion.x + east,
        end_y=motion.y + north,
        heading_error=error,
        clearance=dist,
        admissible=admissible,
        score=jnp.where(admissible, score, -jnp.inf),
    )


def predicted_paths(params: DwaParams, static: DwaStatic, motion: Motion) -> Array:
    """Every predicted trajectory of the window, start included.

    Args:
      params, static: of the method.
      motion: the vessels, leaves float[lanes].

    Returns:
      float[n_v, n_w, horizon + 1, lanes, 2] (m).
    """
    nothing = jnp.zeros((2, 0, motion.rows.shape[1]), motion.rows.dtype)
    window = _open_window(params, static, motion, nothing)
    v_i, w_j, fan = window.v, window.w, window.fan
    origin = jnp.zeros((*w_j.shape, 2), w_j.dtype)
    dt = jnp.asarray(params.dt, w_j.dtype)[..., None]

    def advance(carry: tuple[Array, Complex], _: None) -> tuple[tuple[Array, Complex], Array]:
        chord, direction = carry
        chord = chord + dt * jnp.stack(direction, axis=-1)
        return (chord, complex_product(direction, fan.turn)), chord

    _, chords = jax.lax.scan(advance, (origin, fan.first), None, length=static.horizon)
    relative = jnp.concatenate([origin[None], chords]).swapaxes(0, 1)
    position = jnp.stack([motion.x, motion.y], axis=-1)
    return position + v_i[:, None, None, :, None] * relative


def _normalised(
    static: DwaStatic, parts: tuple[Array, ...], admissible: Array
) -> tuple[Array, ...]:
    """Scores [n_v, n_w or 1, lanes] made comparable over the admissible candidates of a lane."""
    if static.normalise == "none":
        return parts
    if static.normalise == "sum":
        scales = single(_scales, parts, admissible)
        return tuple(part * scale for part, scale in zip(parts, scales, strict=True))
    return tuple(_in_range(part, admissible) for part in parts)


def _in_range(part: Array, admissible: Array) -> Array:
    low = jnp.min(jnp.where(admissible, part, jnp.inf), axis=(0, 1))
    high = jnp.max(jnp.where(admissible, part, -jnp.inf), axis=(0, 1))
    return (part - low) * jnp.where(high > low, 1.0 / (high - low), 0.0)


@jax.jit
def _scales(parts: tuple[Array, ...], admissible: Array) -> list[Array]:
    """One over the sum of each part's magnitudes; the sum is always taken in the same order.

    XLA's reduction picks its order by the number of lanes, and one job in a thousand then ends
    another way in 1,024 lanes than in 256.
    """

    def add(j: Array, totals: tuple[Array, ...]) -> tuple[Array, ...]:
        among = _at(admissible, j, axis=1)
        columns = [_at(part, j if part.shape[1] > 1 else 0, axis=1) for part in parts]
        for i in range(admissible.shape[0]):
            counted = (jnp.where(among[i], jnp.abs(column[i]), 0.0) for column in columns)
            totals = tuple(map(jnp.add, totals, counted))
        return totals

    zero = jnp.zeros_like(parts[0][0, 0])
    totals = jax.lax.fori_loop(0, admissible.shape[1], add, (zero,) * len(parts))
    return [jnp.where(total > 0.0, 1.0 / total, 0.0) for total in totals]


def choose(found: Candidates) -> tuple[Array, Array, Array]:
    """Row and column of the best candidate, the first of equals, and whether there is one."""
    return single(_best, found.score)


@jax.jit
def _best(score: Array) -> tuple[Array, Array, Array]:
    n_v, n_w, lanes = score.shape

    def better(i: Array, best: tuple[Array, Array]) -> tuple[Array, Array]:
        row = _at(score, i, axis=0)
        for j in range(n_w):
            higher = row[j] > best[0]
            best = jnp.where(higher, row[j], best[0]), jnp.where(higher, i * n_w + j, best[1])
        return best

    first = (jnp.full(lanes, -jnp.inf, score.dtype), jnp.zeros(lanes, jnp.int32))
    best, index = jax.lax.fori_loop(0, n_v, better, first)
    return index // n_w, index % n_w, jnp.isfinite(best)


def decide(
    params: DwaParams, static: DwaStatic, motion: Motion, obstacles: Array, goal: Array
) -> tuple[Array, Array]:
    """Speed and yaw rate to execute next (m/s, rad/s), float[lanes]; arguments as `candidates`."""
    window = _open_window(params, static, motion, obstacles)
    chosen = partial(_decide, static)
    return stage(unknown_true(params), chosen, params, motion, goal, window)


@partial(jax.jit, static_argnums=0)  # as `_commands`
def _decide(
    static: DwaStatic, params: DwaParams, motion: Motion, goal: Array, window: _Window
) -> tuple[Array, Array]:
    found = _weigh(params, static, motion, goal, window)
    return single(partial(_command, static), params, motion, goal, found.v, found.w, found.score)


@partial(jax.jit, static_argnums=0)
def _command(
    static: DwaStatic,
    params: DwaParams,
    motion: Motion,
    goal: Array,
    v_i: Array,
    w_j: Array,
    score: Array,
) -> tuple[Array, Array]:
    """The best candidate's command, or that of a vessel without an admissible one."""
    row, column, any_admissible = _best(score)
    v = v_i[0] + row.astype(score.dtype) * params.v_step
    w = w_j[0] + column.astype(score.dtype) * params.w_step
    blocked_v, blocked_w = _when_blocked(params, static, motion, goal)
    return jnp.where(any_admissible, v, blocked_v), jnp.where(any_admissible, w, blocked_w)


def _when_blocked(
    params: DwaParams, static: DwaStatic, motion: Motion, goal: Array
) -> tuple[Array, Array]:
    v = _towards_zero(motion.v, params.v_dec * params.dt)
    if static.when_blocked == "brake":
        return v, _towards_zero(motion.w, params.w_dec * params.dt)
    sin, cos = sincos(motion.psi)
    side = cos * (goal[1] - motion.y) - sin * (goal[0] - motion.x)
    change = jnp.where(side >= 0.0, params.w_acc, -params.w_dec) * params.dt
    return v, jnp.clip(motion.w + change, params.w_min, params.w_max)


def _towards_zero(rate: Array, change: Scalar) -> Array:
    return jnp.sign(rate) * jnp.maximum(jnp.abs(rate) - change, 0.0)
