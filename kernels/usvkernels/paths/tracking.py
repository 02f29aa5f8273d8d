"""A vessel of constant speed and bounded yaw rate that follows a path; many at once."""

from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.paths.arcs import near_blocked
from usvkernels.paths.charts import Charts
from usvkernels.trig import sincos, wrap_angle


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class TrackParams:
    """The vessel and its helmsman; each a number or float[B]. Defaults: Chen 2023, Table 1."""

    speed: Array | float = 15.0  # u, m/s
    yaw_rate: Array | float = 1.0  # r, rad/s, the greatest; u / r is the least turning radius
    recovery: Array | float = 7.5  # m, length over which a small error from the path dies out
    dt: Array | float = 0.05  # s, control period


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Reference:
    """Paths to follow as samples, N a path, at a roughly even spacing."""

    points: Array  # float[B, N, 2], m
    curvature: Array  # float[B, N], 1/m, signed
    counts: Array  # int32[B], samples of each path, the rest is padding; 0: no path


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Vessel:
    """State of each vessel; [B]."""

    x: Array
    y: Array
    psi: Array
    abeam: Array  # int32, the segment abeam, by its first sample; never goes back
    arrived: Array  # bool
    collided: Array  # bool, at any time
    worst: Array  # m, largest distance to the path so far


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Track:
    """How the vessels fared."""

    poses: Array  # float[T + 1, B, 3], x, y (m), psi (rad); stays at its last after arrival
    error: Array  # float[T + 1, B], distance to the path (m)
    worst: Array  # float[B], the largest of it (m)
    arrived: Array  # bool[B], whether the vessel came abeam of the path's end
    collided: Array  # bool[B], whether it was on a blocked cell or off the map at any step
    steps: Array  # int32[B], control periods under way


def follow(
    reference: Reference,
    charts: Charts,
    cell_size: Array | float,
    params: TrackParams,
    *,
    steps: int,
    window: Array | int,
) -> Track:
    """Let vessels follow paths from their first sample, heading for the second.

    Helm: w = u (k - (2 / c) (h + atan(e / 2 c))), within the yaw rate, where e is the distance
    to port of the path, h the heading against it, k the path's curvature abeam and c the
    recovery length: small errors die out over c without overshoot, large ones are met at up to
    a right angle. Each period is sailed as an exact arc. A vessel that collides sails on, so
    that its error is known.

    Args:
        reference: the paths, in the frame of the map's corner.
        charts: each vessel's map as it is, not inflated.
        cell_size: m.
        params: the vessel.
        steps: control periods, static; a vessel not there by then has not arrived.
        window: samples that a vessel passes in a period at most.
    """
    lane = jnp.arange(reference.counts.shape[0])
    last = jnp.maximum(reference.counts - 1, 0)

    def sample(index: Array) -> tuple[Array, Array]:
        point = reference.points[lane, index]
        return point[:, 0], point[:, 1]

    def step(index: Array) -> tuple[Array, Array, Array]:
        """Length and direction of the segment from a sample to the next."""
        here, there = sample(index), sample(jnp.minimum(index + 1, last))
        east, north = there[0] - here[0], there[1] - here[1]
        length = jnp.sqrt(east * east + north * north)
        safe = jnp.where(length > 0.0, length, 1.0)
        return length, east / safe, north / safe

    def along(x: Array, y: Array, index: Array) -> tuple[Array, Array, Array]:
        """Distance along that segment and to port of it; how much of it is left."""
        here, (length, cos, sin) = sample(index), step(index)
        east, north = x - here[0], y - here[1]
        ahead = east * cos + north * sin
        return ahead, north * cos - east * sin, length - ahead

    def passed(x: Array, y: Array, index: Array) -> Array:
        """The segment abeam, from the given one on: one ends where its end comes abeam."""

        def on(_: Array, index: Array) -> Array:
            left = along(x, y, index)[2]
            return jnp.where((left <= 0.0) & (index < last - 1), index + 1, index)

        return jax.lax.fori_loop(0, window, on, index)

    def distance(x: Array, y: Array, index: Array) -> Array:
        """Distance to the segment abeam and the two beside it."""
        ends = [jnp.clip(index + i, 0, last) for i in (-1, 0, 1, 2)]
        corners = [sample(end) for end in ends]
        gaps = [_to_segment((x, y), a, b) for a, b in pairwise(corners)]
        return jnp.minimum(jnp.minimum(gaps[0], gaps[1]), gaps[2])

    def helm(vessel: _Vessel) -> Array:
        ahead, port, left = along(vessel.x, vessel.y, vessel.abeam)
        _, cos, sin = step(vessel.abeam)
        following = jnp.minimum(vessel.abeam + 1, last)
        # An arc between two samples bulges from the segment between them.
        ends = reference.curvature[lane, vessel.abeam], reference.curvature[lane, following]
        curvature = 0.5 * (ends[0] + ends[1])
        port = port + 0.5 * curvature * jnp.maximum(ahead, 0.0) * jnp.maximum(left, 0.0)
        course = jnp.arctan2(sin, cos) + 0.5 * curvature * (ahead - left)
        c = params.recovery
        off = wrap_angle(vessel.psi - course + jnp.arctan(port / (2.0 * c)))
        wanted = params.speed * (curvature - (2.0 / c) * off)
        return jnp.clip(wanted, -params.yaw_rate, params.yaw_rate)

    def advance(vessel: _Vessel) -> tuple[_Vessel, Array, Array]:
        turn = helm(vessel) * params.dt
        x, y, psi = _sail_arc(vessel, turn, params.speed * params.dt)
        x, y = jnp.where(vessel.arrived, vessel.x, x), jnp.where(vessel.arrived, vessel.y, y)
        psi = jnp.where(vessel.arrived, vessel.psi, psi)
        abeam = passed(x, y, vessel.abeam)
        left = along(x, y, abeam)[2]
        there = (abeam >= last - 1) & (left <= 0.5 * params.speed * params.dt)
        error = distance(x, y, abeam)
        hit = near_blocked(charts, x / cell_size, y / cell_size, jnp.zeros_like(x))
        after = _Vessel(
            x=x,
            y=y,
            psi=psi,
            abeam=abeam,
            arrived=vessel.arrived | there,
            collided=vessel.collided | (hit & (reference.counts > 0)),
            worst=jnp.where(vessel.arrived, vessel.worst, jnp.maximum(vessel.worst, error)),
        )
        return after, jnp.stack([x, y, psi], -1), error

    start = sample(jnp.zeros_like(last))
    first = _Vessel(
        x=start[0],
        y=start[1],
        psi=jnp.arctan2(*reversed(step(jnp.zeros_like(last))[1:])),
        abeam=jnp.zeros_like(last),
        arrived=reference.counts < 2,
        collided=jnp.zeros(last.shape, bool),
        worst=jnp.zeros_like(start[0]),
    )
    begin = jnp.stack([first.x, first.y, first.psi], -1)

    def unfinished(carry: tuple[_Vessel, Array, Array, Array, Array]) -> Array:
        return (carry[1] < steps) & jnp.any(~carry[0].arrived)

    def record(
        carry: tuple[_Vessel, Array, Array, Array, Array],
    ) -> tuple[_Vessel, Array, Array, Array, Array]:
        vessel, done, used, poses, error = carry
        used = used + ~vessel.arrived
        vessel, pose, off = advance(vessel)
        return vessel, done + 1, used, poses.at[done + 1].set(pose), error.at[done + 1].set(off)

    final, done, used, poses, error = jax.lax.while_loop(
        unfinished,
        record,
        (
            first,
            jnp.int32(0),
            jnp.zeros_like(last),
            jnp.broadcast_to(begin, (steps + 1, *begin.shape)),
            jnp.zeros((steps + 1, *last.shape), begin.dtype),
        ),
    )
    rest = jnp.arange(steps + 1) > done
    return Track(
        poses=jnp.where(rest[:, None, None], poses[done], poses),
        error=jnp.where(rest[:, None], error[done], error),
        worst=final.worst,
        arrived=final.arrived & (reference.counts > 0),
        collided=final.collided,
        steps=used,
    )


def _sail_arc(vessel: _Vessel, turn: Array, distance: Array | float) -> tuple[Array, Array, Array]:
    """Pose after an arc of the given length through the angle `turn`."""
    half = 0.5 * turn
    sin, _ = sincos(half)
    chord = distance * jnp.where(
        jnp.abs(half) < 1e-3, 1.0 - half * half / 6.0, sin / jnp.where(half == 0.0, 1.0, half)
    )
    sin, cos = sincos(vessel.psi + half)
    return vessel.x + chord * cos, vessel.y + chord * sin, wrap_angle(vessel.psi + turn)


def _to_segment(
    point: tuple[Array, Array], start: tuple[Array, Array], end: tuple[Array, Array]
) -> Array:
    east, north = end[0] - start[0], end[1] - start[1]
    squared = east * east + north * north
    along = (point[0] - start[0]) * east + (point[1] - start[1]) * north
    share = jnp.clip(along / jnp.where(squared > 0.0, squared, 1.0), 0.0, 1.0)
    return jnp.hypot(point[0] - start[0] - share * east, point[1] - start[1] - share * north)
