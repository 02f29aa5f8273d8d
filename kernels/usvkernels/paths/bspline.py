"""Clamped uniform cubic B-splines along control points: Chen et al. 2023's comparison."""

import jax
import jax.numpy as jnp
from jax import Array


def _with_four_points(points: Array, counts: Array) -> tuple[Array, Array]:
    """Paths of two or three points as the same line or parabola with four; others untouched.

    Args:
        points: float[B, P, 2], P >= 4.
        counts: int32[B].
    """
    first, second, third = points[:, 0], points[:, 1], points[:, 2]
    line = jnp.stack([first, (2 * first + second) / 3, (first + 2 * second) / 3, second], 1)
    parabola = jnp.stack([first, (first + 2 * second) / 3, (2 * second + third) / 3, third], 1)
    few = counts[:, None, None]
    head = jnp.where(few == 2, line, jnp.where(few == 3, parabola, points[:, :4]))
    raised = jnp.concatenate([head, points[:, 4:]], axis=1)
    return raised, jnp.where(counts >= 2, jnp.maximum(counts, 4), counts)


def _spline_point(parameter: Array, points: Array, count: Array) -> Array:
    """De Boor's algorithm, degree 3: float[2] at a parameter in [0, 1] of control points [P, 2]."""
    spans = jnp.maximum(count - 3, 1)
    span = jnp.clip(jnp.floor(parameter * spans).astype(jnp.int32), 0, spans - 1)
    # Knots in units of a span: 0 up to the fourth, then 1, 2, ..., and `spans` to the end.
    at = parameter * spans

    def knot(i: Array | int) -> Array:
        return jnp.clip(span + i - 3, 0, spans).astype(at.dtype)

    d = [points[jnp.minimum(span + i, count - 1)] for i in range(4)]
    for level in range(1, 4):
        for i in range(3, level - 1, -1):
            low, high = knot(i), knot(i + 4 - level)
            share = (at - low) / (high - low)
            d[i] = (1.0 - share) * d[i - 1] + share * d[i]
    return d[3]


def clamped_spline(points: Array, counts: Array, samples: int) -> tuple[Array, Array, Array]:
    """Points of the clamped uniform cubic B-spline whose control points are a path's points.

    The curve starts and ends at the path's ends, along its first and last segment, and keeps
    inside the convex hull of every four consecutive points. Two or three points give the
    spline of degree one or two.

    Args:
        points: float[B, P, 2], P >= 4, control points.
        counts: int32[B], points of each path: 0, or 2 and more.
        samples: points of a curve, at equal steps of the parameter, static, >= 2.

    Returns:
        float[B, samples, 2], points; float[B, samples], heading (rad); float[B, samples],
        signed curvature; both 0 where the curve stands still.
    """
    points, counts = _with_four_points(points, counts)
    parameter = jnp.linspace(0.0, 1.0, samples, dtype=points.dtype)

    def at(parameter: Array, points: Array, count: Array) -> tuple[Array, Array, Array]:
        def place(u: Array) -> Array:
            return _spline_point(u, points, count)

        def velocity(u: Array) -> Array:
            return jax.jvp(place, (u,), (jnp.ones_like(u),))[1]

        speed, bend = jax.jvp(velocity, (parameter,), (jnp.ones_like(parameter),))
        heading = jnp.arctan2(speed[1], speed[0])
        cubed = jnp.sum(speed * speed) ** 1.5
        across = speed[0] * bend[1] - speed[1] * bend[0]
        curvature = jnp.where(cubed > 0.0, across / jnp.where(cubed > 0.0, cubed, 1.0), 0.0)
        return place(parameter), heading, curvature

    along = jax.vmap(at, in_axes=(0, None, None))
    return jax.vmap(along, in_axes=(None, 0, 0))(parameter, points, counts)
