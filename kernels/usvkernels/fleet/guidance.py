"""Where a vessel on its route steers for: a point of the path ahead, which never runs back."""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.fleet.approach import dot
from usvkernels.fleet.params import Passage
from usvkernels.fleet.sight import minus
from usvkernels.vessel import Complex


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Routes:
    """Paths of the vessels of some episodes, at the unit length, padded by repeating the goal."""

    points: Array  # float[rows, n, P, 2], m
    ahead: Array  # int32[rows, n, P], the point to steer for from each
    last: Array  # int32[rows, n], the goal's
    gate: Array  # int32[rows, n], the first from which the goal may be reached
    bow: Array  # float[rows, n, 2], unit vector of the heading to arrive on; 0 where any will do


def point(routes: Routes, job: Array, index: Array) -> Complex:
    """The points at `index` int32[n, lanes] of the routes of jobs int32[lanes]; m."""
    found = routes.points[job, _vessel(index), index]
    return found[..., 0], found[..., 1]


NEAR = 0.5
"""Of the way along the path to its guidance point, within which a vessel that cut a corner may be
of it, before the point moves on: else it would circle about it."""


def advanced(
    routes: Routes,
    job: Array,
    place: Complex,
    index: Array,
    held: Array,
    passage: Passage,
) -> Array:
    """The path point that each vessel has come to.

    It goes on to the next as long as that is nearer, or the guidance point is too near.

    Args:
        routes: of the fleet.
        job: int32[lanes].
        place: where the vessels are, [n, lanes] (m).
        index: int32[n, lanes], the point before.
        held: bool[n, lanes], who stays at it.
        passage: how many points may be passed in a step, and their distance.
    """
    last = routes.last[job].T
    here = _square_to(point(routes, job, index), place)
    for _ in range(passage.strides):
        further = jnp.minimum(index + 1, last)
        there = _square_to(point(routes, job, further), place)
        ahead = routes.ahead[job, _vessel(index), index]
        near = NEAR * passage.unit_length * (ahead - index).astype(here.dtype)
        close = _square_to(point(routes, job, ahead), place) < near * near
        moves = ((there <= here) | close) & ~held
        index, here = jnp.where(moves, further, index), jnp.where(moves, there, here)
    return index


def bow(routes: Routes, job: Array) -> Complex:
    """Unit vectors of the headings to arrive on, [n, lanes] each; 0 where any will do."""
    return routes.bow[job, :, 0].T, routes.bow[job, :, 1].T


def guide(routes: Routes, job: Array, index: Array) -> Complex:
    """The guidance points of vessels at path points `index` int32[n, lanes]; m."""
    return point(routes, job, routes.ahead[job, _vessel(index), index])


def _vessel(index: Array) -> Array:
    return jnp.arange(index.shape[0])[:, None]


def _square_to(at: Complex, place: Complex) -> Array:
    off = minus(at, place)
    return dot(off, off)
