"""Plants: how a vessel that follows speed and yaw-rate commands moves, and its predicted headings.

The pose is (x, y, psi): metres east, metres north, heading in rad counter-clockwise from x.
"""

from collections.abc import Callable

import jax.numpy as jnp
from jax import Array

from usvkernels.trig import sincos, wrap_angle

Complex = tuple[Array, Array]
"""Real and imaginary part; XLA's own complex numbers do not vectorise on a CPU."""

Pose = tuple[Array, Array, Array]
"""x, y (m), psi (rad), of any common shape."""

Plant = Callable[[Array, Array, Array, Array, Array, Array | float], Pose]
"""One control period: x, y (m), psi (rad), v (m/s), w (rad/s) and dt (s) to the pose after it."""


def unicycle_step(x: Array, y: Array, psi: Array, v: Array, w: Array, dt: Array | float) -> Pose:
    """One Euler step of Tan et al. 2022, Eq. 1: move along the old heading, then turn.

    Args:
        x, y, psi: pose before the step (m, m, rad), any common shape.
        v, w: speed (m/s) and yaw rate (rad/s) held during the step.
        dt: length of the step (s).

    Returns:
        The pose after the step, the heading wrapped to [-pi, pi).
    """
    sin, cos = sincos(psi)
    return x + v * dt * cos, y + v * dt * sin, wrap_angle(psi + w * dt)


def heading_first_step(
    x: Array, y: Array, psi: Array, v: Array, w: Array, dt: Array | float
) -> Pose:
    """One Euler step that turns first and moves along the new heading, as one known demo has it.

    Args and Returns: as `unicycle_step`.
    """
    x, y, turned = unicycle_step(x, y, psi + w * dt, v, jnp.zeros_like(w), dt)
    return x, y, turned


PLANTS: dict[str, Plant] = {"unicycle": unicycle_step, "heading_first": heading_first_step}
"""By the name that a user gives."""


def complex_product(a: Complex, b: Complex) -> Complex:
    """Product of two complex numbers, that is, a rotation by b where |b| = 1."""
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def geometric_sum(ratio: Complex, n: int) -> tuple[Complex, Complex]:
    """Sum of z^0 .. z^(n-1), and z^n, by doubling; exact at z = 1, where a quotient is not.

    Args:
        ratio: z, any shape.
        n: number of terms, at least 1.
    """
    total: Complex = (jnp.ones_like(ratio[0]), jnp.zeros_like(ratio[1]))
    power = ratio
    for bit in bin(n)[3:]:
        shifted = complex_product(total, power)
        total = (total[0] + shifted[0], total[1] + shifted[1])
        power = complex_product(power, power)
        if bit == "1":
            total = (total[0] + power[0], total[1] + power[1])
            power = complex_product(power, ratio)
    return total, power
