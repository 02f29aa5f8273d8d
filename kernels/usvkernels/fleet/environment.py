"""What moves a vessel besides itself: ocean currents, each a function of place, and wind.

A vessel's speed is through the water; its place moves over the ground, by that and the drift. All
velocities are (towards east, towards north), a wind's too: it blows where it points. Leaves are
scalars or of any shape that broadcasts with the places, as [1, lanes] does with [n, lanes].
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.dwa.clearance import Scalar
from usvkernels.fleet.approach import cross, dot
from usvkernels.vessel import Complex, complex_product

Vector = tuple[Scalar, Scalar]


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Uniform:
    """The same everywhere."""

    velocity: Vector  # m/s


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Shear:
    """A parallel flow whose speed changes linearly across it."""

    place: Vector  # m, where the speed is as given
    direction: Vector  # unit vector
    speed: Scalar  # m/s
    rate: Scalar  # 1/s, what the speed gains per metre to the left of the flow


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Vortex:
    """A Rankine vortex: turns as a solid inside its core, falls with distance outside."""

    place: Vector  # m
    speed: Scalar  # m/s at the core's edge, counter-clockwise
    radius: Scalar  # m, of the core


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Field:
    """Velocities on a grid, bilinear between the cells' centres; beyond them, the nearest edge."""

    velocity: Array  # float[2, H, W], m/s
    place: Vector  # m, the corner of cell (0, 0)
    cell_size: Scalar  # m


Current = Uniform | Shear | Vortex | Field


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Environment:
    """What vessels sail in."""

    current: Current
    wind: Vector  # m/s
    leeway: Scalar  # share of the wind's velocity at which it pushes a vessel through the water


def current_at(current: Current, place: Complex) -> Complex:
    """The current at places (m) of any shape, in m/s."""
    flow: Callable[[Any, Complex], Complex] = _FLOWS[type(current)]
    return flow(current, place)


def drift(environment: Environment, place: Complex) -> Complex:
    """Velocity over ground (m/s) of a vessel that makes no way through the water."""
    east, north = current_at(environment.current, place)
    blown = tuple(environment.leeway * part for part in environment.wind)
    return east + blown[0], north + blown[1]


def crab(
    course: Complex, speed: Array, drift: Complex, most: Scalar
) -> tuple[Complex, Array, Array]:
    """How to steer through the water so that a course over ground is made good.

    Where the drift across the course is more than the vessel can make up for, it is stemmed as far
    as can be; a vessel does not go astern to sail slower than a drift that follows.

    Args:
        course: unit vector over ground.
        speed: wanted over ground (m/s).
        drift: m/s.
        most: largest speed through the water (m/s).

    Returns:
        Unit vector of the heading, speed through the water, speed over ground along the course.
    """
    along, across = dot(course, drift), cross(course, drift)
    side = jnp.clip(-across, -most, most)
    ahead = jnp.clip(speed - along, 0.0, jnp.sqrt(jnp.maximum(most * most - side * side, 0.0)))
    through = jnp.sqrt(ahead * ahead + side * side)
    makes_way = through > 0.0
    over = jnp.where(makes_way, through, 1.0)
    heading = complex_product(course, (jnp.where(makes_way, ahead / over, 1.0), side / over))
    return heading, through, ahead + along


def _uniform(current: Uniform, place: Complex) -> Complex:
    still = jnp.zeros_like(place[0])
    return still + current.velocity[0], still + current.velocity[1]


def _shear(current: Shear, place: Complex) -> Complex:
    east, north = current.direction
    left = east * (place[1] - current.place[1]) - north * (place[0] - current.place[0])
    speed = current.speed + current.rate * left
    return speed * east, speed * north


def _vortex(current: Vortex, place: Complex) -> Complex:
    east, north = place[0] - current.place[0], place[1] - current.place[1]
    square = jnp.maximum(east * east + north * north, current.radius * current.radius)
    spin = current.speed * current.radius / square
    return -spin * north, spin * east


def _field(current: Field, place: Complex) -> Complex:
    rows, columns = current.velocity.shape[1:]
    x, west, to_east = _between_centres(place[0] - current.place[0], current.cell_size, columns)
    y, south, to_north = _between_centres(place[1] - current.place[1], current.cell_size, rows)

    def at(row: Array, column: Array) -> Array:
        return current.velocity[:, row, column]

    low = at(south, west) * (1.0 - x) + at(south, to_east) * x
    high = at(to_north, west) * (1.0 - x) + at(to_north, to_east) * x
    found = low * (1.0 - y) + high * y
    return found[0], found[1]


def _between_centres(along: Array, cell_size: Scalar, count: int) -> tuple[Array, Array, Array]:
    """How far past one cell's centre, in cells, and the numbers of it and of the next cell."""
    cells = jnp.clip(along / cell_size - 0.5, 0.0, count - 1.0)
    first = jnp.floor(cells).astype(jnp.int32)
    return cells - first, first, jnp.minimum(first + 1, count - 1)


_FLOWS: dict[type, Callable[[Any, Complex], Complex]] = {
    Uniform: _uniform,
    Shear: _shear,
    Vortex: _vortex,
    Field: _field,
}
