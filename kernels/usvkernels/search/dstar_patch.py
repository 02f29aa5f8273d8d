"""The one operation of D* Lite: a cell gets a new g, those about it the rhs and key that follow.

A cell affects the 3 x 3 cells about it and no others: the steps to and from it, and the diagonals
past its corners. Their rhs takes the g of 5 x 5 cells.
"""

from dataclasses import dataclass
from functools import partial, reduce

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from usvkernels.search.dstar_layout import (
    BLOCKED,
    INFINITE,
    LENGTH_LIMIT,
    NONE,
    Layout,
    ReplanStatic,
)
from usvkernels.search.replan_heuristics import bound, guide
from usvkernels.search.steps import DIAGONAL, STRAIGHT

AROUND = [(x, y) for y in (-1, 0, 1) for x in (-1, 0, 1) if x or y]
"""Neighbours of a cell, (x, y); of two equally good ones the vessel goes to the first."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Touch:
    """What is done to one cell per lane."""

    cell: Array  # int32[lanes]
    flip: Array  # bool[lanes], it becomes blocked or free
    popped: Array  # bool[lanes], it came first in the queue
    key: Array  # int32[lanes], with this key
    goal: Array  # int32[lanes]
    origin: Array  # int32[lanes], the cell that distances are taken from
    lead: Array  # int32[lanes], km


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Outcome:
    """What comes of it."""

    g: Array  # int32[lanes], of the cell
    keys: Array  # int32[3, 3, lanes], of the cells about it
    expanded: Array  # bool[lanes]
    overflow: Array  # bool[lanes], its value came too near to INFINITE
    ahead: Array  # int32[lanes], offset of the neighbour on the best way
    value_ahead: Array  # int32[lanes], and its g


def touch_patch(static: ReplanStatic, touch: Touch, patch: Array) -> Outcome:
    """Work out a touch.

    A popped cell is expanded, unless its key had fallen behind: then it only gets that of now.

    Args:
        static: choices of method.
        touch: what is done.
        patch: int32[5, 5, lanes], g of the cells about `touch.cell`.
    """
    bounds, guides = _distances(static, touch)
    old = patch[2, 2]
    ways = [way[0, 0] for way in _ways(static, patch[1:4, 1:4])]
    own = jnp.where(touch.cell == touch.goal, 0, _least(ways))
    worse = old < own
    key = jnp.minimum(old, own) + touch.lead + jnp.where(worse, bounds[1, 1], guides[1, 1])
    expanded = touch.popped & (touch.key >= key)
    new = jnp.where(expanded, jnp.where(worse, INFINITE, own), old)
    new = jnp.where(touch.flip, jnp.where(old == BLOCKED, INFINITE, BLOCKED), new)

    patch = patch.at[2, 2].set(new)
    g = patch[1:4, 1:4]
    is_goal = touch.cell + jnp.asarray(offsets(static.layout, 1)) == touch.goal
    rhs = jnp.where(is_goal, 0, _least(_ways(static, patch)))
    keys = jnp.minimum(g, rhs) + touch.lead + jnp.where(g < rhs, bounds, guides)
    ahead, value_ahead = _best(static.layout, ways)
    return Outcome(
        g=new,
        keys=jnp.where((g != rhs) & (g < BLOCKED), keys, NONE),
        expanded=expanded,
        overflow=expanded & ~worse & (own > LENGTH_LIMIT),
        ahead=ahead,
        value_ahead=value_ahead,
    )


def offsets(layout: Layout, reach: int) -> np.ndarray:
    """From a cell to those up to `reach` away, int32[2 reach + 1, 2 reach + 1, 1]."""
    side = np.arange(-reach, reach + 1, dtype=np.int32)
    return (side[:, None] * layout.stride + side)[..., None]


def separation(layout: Layout, a: Array, b: Array) -> tuple[Array, Array]:
    """Columns and rows from cell a to cell b."""
    return b % layout.stride - a % layout.stride, b // layout.stride - a // layout.stride


def _ways(static: ReplanStatic, g: Array) -> list[Array]:
    """Cost-to-go by way of each neighbour, INFINITE or more where there is none.

    Args:
        static: choices of method.
        g: int32[n + 2, m + 2, lanes].

    Returns:
        int32[n, m, lanes] for the inner cells, by neighbour in the order of `AROUND`.
    """
    n, m = g.shape[0] - 2, g.shape[1] - 2

    def shifted(dx: int, dy: int) -> Array:
        return g[1 + dy : 1 + dy + n, 1 + dx : 1 + dx + m]

    ways = []
    for dx, dy in AROUND:
        way = shifted(dx, dy) + (DIAGONAL if dx and dy else STRAIGHT)
        if dx and dy and not static.corner_cutting:
            sides = jnp.maximum(shifted(dx, 0), shifted(0, dy))
            way = jnp.where(sides >= BLOCKED, BLOCKED, way)
        ways.append(way)
    return ways


def _least(ways: list[Array]) -> Array:
    return reduce(jnp.minimum, ways, jnp.int32(INFINITE))


def _best(layout: Layout, ways: list[Array]) -> tuple[Array, Array]:
    """Offset and g of the neighbour on the first of the best ways, int32[lanes] each."""
    least = _least(ways)
    ahead = value = jnp.zeros_like(least)
    for (dx, dy), way in reversed(list(zip(AROUND, ways, strict=True))):
        ahead = jnp.where(way == least, dx + dy * layout.stride, ahead)
        value = jnp.where(way == least, way - (DIAGONAL if dx and dy else STRAIGHT), value)
    return ahead, value


def _distances(static: ReplanStatic, touch: Touch) -> tuple[Array, Array]:
    """Bound and guide of the 3 x 3 cells, int32[3, 3, lanes] each."""
    dx, dy = separation(static.layout, touch.origin, touch.cell)
    side = np.arange(-1, 2, dtype=np.int32)
    dx, dy = dx + side[None, :, None], dy + side[:, None, None]
    to_goal = separation(static.layout, touch.origin, touch.goal)
    guides = guide(static.heuristic, static.weight, dx, dy, *to_goal)
    return bound(static.heuristic, dx, dy), guides
