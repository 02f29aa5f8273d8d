"""Sine, cosine and angle between vectors as short polynomials.

XLA calls the scalar library functions one element at a time on a CPU (about 14 ns each);
these forms vectorise and give the same bits whatever the number of lanes. They serve float32;
float64 arguments go to the library functions, so the oracles can run at full precision.
"""

import jax.numpy as jnp
from jax import Array

# pi / 2 in three parts of few bits each, so that k * part is exact for the k met here
# (Cody and Waite's reduction, Software Manual for the Elementary Functions, 1980).
_PIO2 = (1.5703125, 4.837512969970703125e-4, 7.549789948768648e-8)

# Chebyshev interpolant of atan(t) / t in t^2 on [0, 1], highest power first; error 2e-8.
_ATAN = (
    0.00276628348,
    -0.01573124904,
    0.04213762345,
    -0.07456854814,
    0.1061837063,
    -0.1419779779,
    0.1999187203,
    -0.3333303671,
    0.9999999818,
)


def wrap_angle(angle: Array) -> Array:
    """Wrap angles (rad, any shape) to [-pi, pi)."""
    two_pi = 2.0 * jnp.pi
    wrapped = angle - two_pi * jnp.floor((angle + jnp.pi) / two_pi)
    # Rounding can land on +pi itself, or just below -pi; the interval is half open.
    wrapped = jnp.where(wrapped >= jnp.pi, wrapped - two_pi, wrapped)
    return jnp.maximum(wrapped, -jnp.pi)


def sincos(angle: Array | float) -> tuple[Array, Array]:
    """Sine and cosine of angles (rad, any shape); error below 2e-7 for |angle| < 1e3."""
    angle = jnp.asarray(angle)
    if angle.dtype != jnp.float32:
        return jnp.sin(angle), jnp.cos(angle)
    quarter = jnp.round(angle * (2.0 / jnp.pi))
    x = angle
    for part in _PIO2:
        x = x - quarter * part
    x2 = x * x
    sin = x + x * x2 * (-1.6666654611e-1 + x2 * (8.3321608736e-3 - x2 * 1.9515295891e-4))
    cos = (
        1.0
        - 0.5 * x2
        + x2
        * x2
        * (4.166664568298827e-2 + x2 * (-1.388731625493765e-3 + x2 * 2.443315711809948e-5))
    )
    turn = quarter.astype(jnp.int32)
    swap = (turn & 1) == 1
    sin, cos = jnp.where(swap, cos, sin), jnp.where(swap, sin, cos)
    return (
        jnp.where((turn & 2) == 2, -sin, sin),
        jnp.where(((turn + 1) & 2) == 2, -cos, cos),
    )


def angle_between(across: Array, along: Array) -> Array:
    """Angle in [0, pi] of a vector against a direction; atan2(|across|, along).

    Args:
        across: component normal to the direction, any shape and sign.
        along: component along the direction, same shape.
    """
    if along.dtype != jnp.float32:
        return jnp.arctan2(jnp.abs(across), along)
    y, x = jnp.abs(across), jnp.abs(along)
    low, high = jnp.minimum(x, y), jnp.maximum(x, y)
    # 0 / 0 has no direction: it counts as dead ahead.
    t = low / jnp.where(high == 0.0, 1.0, high)
    t2 = t * t
    p = jnp.full_like(t2, _ATAN[0])
    for c in _ATAN[1:]:
        p = p * t2 + c
    a = t * p
    a = jnp.where(y > x, jnp.pi / 2 - a, a)
    return jnp.where(along < 0.0, jnp.pi - a, a)
