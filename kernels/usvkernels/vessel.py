"""Kinematics of a vessel that follows speed and yaw-rate commands.

The pose is (x, y, psi): metres east, metres north, heading in rad counter-clockwise from x.
"""

import jax.numpy as jnp
from jax import Array

from usvkernels.trig import sincos, wrap_angle

Complex = tuple[Array, Array]
"""Real and imaginary part; XLA's own complex numbers do not vectorise on a CPU."""


def unicycle_step(
    x: Array, y: Array, psi: Array, v: Array, w: Array, dt: Array | float
) -> tuple[Array, Array, Array]:
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


def body_step(
    x: Array, y: Array, psi: Array, surge: Array, sway: Array, yaw_rate: Array, dt: Array | float
) -> tuple[Array, Array, Array]:
    """One Euler step of Chen et al. 2023, Eq. 3: body-frame velocities turned into the world.

    Args:
      x, y, psi: pose before the step (m, m, rad), any common shape.
      surge, sway: speed ahead and to port (m/s).
      yaw_rate: rad/s.
      dt: length of the step (s).

    Returns:
      The pose after the step, the heading wrapped to [-pi, pi).
    """
    sin, cos = sincos(psi)
    return (
        x + (surge * cos - sway * sin) * dt,
        y + (surge * sin + sway * cos) * dt,
        wrap_angle(psi + yaw_rate * dt),
    )


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


def constant_command_rollout(
    x: Array, y: Array, psi: Array, v: Array, w: Array, dt: Array | float, n: int
) -> tuple[Array, Array, Array]:
    """Pose after n Euler steps (Tan et al. 2022, Eq. 1) under one constant command.

    The headings of the n steps are psi, psi + w dt, ...: the displacement is v dt e^(i psi)
    times a geometric sum, which needs two sines however large n is.

    Args:
      x, y, psi: pose before (m, m, rad), any common shape.
      v, w: constant speed (m/s) and yaw rate (rad/s).
      dt: length of one step (s).
      n: number of steps, static, at least 1.

    Returns:
      The pose after n steps, the heading wrapped to [-pi, pi).
    """
    sin, cos = sincos(psi)
    turn_sin, turn_cos = sincos(w * dt)
    total, _ = geometric_sum((turn_cos, turn_sin), n)
    east, north = complex_product((cos, sin), total)
    return x + v * dt * east, y + v * dt * north, wrap_angle(psi + n * (w * dt))
