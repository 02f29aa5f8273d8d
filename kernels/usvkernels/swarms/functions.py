"""Test functions of Yu et al. 2022, Table 8: float[dim] -> float, least value 0 at the origin."""

from dataclasses import dataclass

import jax.numpy as jnp
from jax import Array

from usvkernels.swarms.pack import Objective


def sphere(x: Array) -> Array:
    """The sum of squares (f1)."""
    return jnp.sum(x * x)


def schwefel_2_21(x: Array) -> Array:
    """Schwefel's problem 2.21, the largest coordinate (f2)."""
    return jnp.max(jnp.abs(x))


def rastrigin(x: Array) -> Array:
    """Rastrigin's function (f3), as printed.

    Near the origin 10 - 10 cos loses its digits: the value is rounded to multiples of 2e-15 in
    float64, 1e-6 in float32, and is 0 wherever |x| < 1e-8, or 2e-4.
    """
    return jnp.sum(x * x - 10 * jnp.cos(2 * jnp.pi * x) + 10)


def alpine(x: Array) -> Array:
    """Alpine's first function (f4)."""
    return jnp.sum(jnp.abs(x * jnp.sin(x) + 0.1 * x))


@dataclass(frozen=True)
class TestFunction:
    """A function of Table 8 with its range.

    Attributes:
        name: as the paper has it.
        fn: float[dim] -> float.
        bounds: (low, high), the same for every coordinate.
    """

    name: str
    fn: Objective
    bounds: tuple[float, float]


TABLE_8 = {
    "f1": TestFunction("Sphere", sphere, (-100.0, 100.0)),
    "f2": TestFunction("Schwefel's 2.21", schwefel_2_21, (-100.0, 100.0)),
    "f3": TestFunction("Rastrigin", rastrigin, (-5.12, 5.12)),
    "f4": TestFunction("Alpine", alpine, (-10.0, 10.0)),
}


@dataclass(frozen=True)
class Shifted:
    """A function with its origin moved to `shift`; equal ones share a compiled program.

    Attributes:
        fn: float[dim] -> float.
        shift: one per coordinate, or one for all.
    """

    fn: Objective
    shift: tuple[float, ...] | float

    def __call__(self, x: Array) -> Array:
        """The value at x float[dim]."""
        return self.fn(x - jnp.asarray(self.shift, x.dtype))


def shifted(fn: Objective, shift: Array | tuple[float, ...] | float) -> Shifted:
    """The function x -> fn(x - shift), whose optimum is not at the origin.

    Args:
        fn: float[dim] -> float.
        shift: a number, or one for each coordinate.
    """
    if isinstance(shift, int | float):
        return Shifted(fn, float(shift))
    return Shifted(fn, tuple(float(part) for part in shift))
