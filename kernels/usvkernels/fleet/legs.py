"""How vessels would sail if they were alone, leg by leg, and how two that do so meet."""

from collections.abc import Iterator
from typing import NamedTuple

import jax.numpy as jnp
from jax import Array

from usvkernels.dwa.clearance import Scalar
from usvkernels.fleet.approach import cross, dot
from usvkernels.fleet.sight import Vessels, minus, over_ground
from usvkernels.vessel import Complex


class Legs(NamedTuple):
    """How a vessel would sail if it were alone: to its guidance point, and on to its goal."""

    first: Complex  # m/s
    then: Complex  # m/s
    turn: Array  # s, until it is at the guidance point


def legs_of(vessels: Vessels) -> Legs:
    """The legs of all vessels, [n, lanes]."""
    speed = jnp.where(vessels.under_way, vessels.speed, 0.0)
    first = over_ground(vessels, (vessels.course[0] * speed, vessels.course[1] * speed))
    east, north = _unit(minus(vessels.goal, vessels.guide), (0.0, 0.0))
    made_good = jnp.where(vessels.under_way, vessels.made_good, 0.0)
    to_guide = minus(vessels.guide, vessels.place)
    turn = jnp.sqrt(dot(to_guide, to_guide)) / jnp.maximum(made_good, 1e-3)
    return Legs(first, (made_good * east, made_good * north), turn)


def beside(vessels: Vessels) -> Complex:
    """The turn to starboard from the course to the guidance point to that on from it, unit.

    None where that lies to port, or leads back, as from a point beyond the goal.
    """
    here = _unit(minus(vessels.guide, vessels.place), (1.0, 0.0))
    onward = _unit(minus(vessels.goal, vessels.guide), here)
    turn = dot(here, onward), cross(here, onward)
    serves = (turn[0] > 0.0) & (turn[1] < 0.0)
    return jnp.where(serves, turn[0], 1.0), jnp.where(serves, turn[1], 0.0)


def pieces(
    place: Complex, own: Legs, theirs: Legs, until: Array
) -> Iterator[tuple[Complex, Complex, Array]]:
    """How two move that sail their legs, piece by piece.

    Yields:
        Place and velocity of the other relative to one's own (m, m/s), and how long (s).
    """
    sooner = own.turn < theirs.turn
    mine, yours = minus(theirs.first, own.then), minus(theirs.then, own.first)
    middle = jnp.where(sooner, mine[0], yours[0]), jnp.where(sooner, mine[1], yours[1])
    moves = minus(theirs.first, own.first), middle, minus(theirs.then, own.then)
    ends = jnp.minimum(own.turn, theirs.turn), jnp.maximum(own.turn, theirs.turn), until
    begun = jnp.zeros_like(until)
    for closing, end in zip(moves, ends, strict=True):
        lasts = jnp.clip(end, begun, until) - begun
        yield place, closing, lasts
        place = place[0] + closing[0] * lasts, place[1] + closing[1] * lasts
        begun = begun + lasts


def _unit(vector: Complex, otherwise: tuple[Scalar, Scalar]) -> Complex:
    length = jnp.sqrt(dot(vector, vector))
    known = length > 0.0
    over = jnp.where(known, length, 1.0)
    east, north = otherwise
    return jnp.where(known, vector[0] / over, east), jnp.where(known, vector[1] / over, north)
