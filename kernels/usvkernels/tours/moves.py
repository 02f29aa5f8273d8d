"""The neighbourhood of a tour: 2-opt and Or-opt, all moves of it weighed at once.

A move takes the tour apart behind position i. The next `first` stations, the `between` after them
and the `last` after those change places: the last come first, the first come last, turned round if
`reverse`. With between = last = 0 that is a 2-opt move, with between = 0 an Or-opt move, and with
neither a double bridge. Positions count around the tour, wherever it begins.
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.tours.gains import name_bits, named_move, near_legs, turning_costs, weigh
from usvkernels.xla.stage import stage

_SLACK = 8.0
"""Gains of fewer roundings of the length than this are none."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Move:
    """A move of every run; int32[R] but for `reverse`, bool[R]."""

    behind: Array
    first: Array
    between: Array
    last: Array
    reverse: Array


def apply(order: Array, move: Move) -> Array:
    """Tours int32[d, R] after the move, beginning where it took them apart."""
    count = order.shape[0]
    place = jnp.arange(count, dtype=jnp.int32)[:, None]
    within = place - move.last - move.between  # of the first segment, in its new place
    taken = jnp.where(move.reverse, move.first - 1 - within, within)
    source = jnp.where(within < 0, place - move.last + move.first, taken)
    source = jnp.where(place < move.last, place + move.first + move.between, source)
    source = jnp.where(within < move.first, source, place)
    source = source + move.behind + 1
    return jnp.take_along_axis(order, jnp.where(source < count, source, source - count), axis=0)


@jax.named_scope("best_move")
def best_move(
    distances: Array, order: Array, *, symmetric: bool, kinds: str = "both"
) -> tuple[Array, Array, Move]:
    """The move that shortens each tour most.

    Args:
        distances: float[d, d] or float[d, d, R], finite.
        order: int32[d, R].
        symmetric: whether distances are the same in both directions.
        kinds: one of `gains.NEIGHBOURHOODS`.

    Returns:
        The tours' lengths float[R]; whether any move shortens them, by more than rounding, bool[R];
        the move: of gains that agree in their first 23 - `name_bits(d)` binary digits, any one.
    """
    count = order.shape[0]
    go = order[0, 0] >= 0
    near = stage(go, partial(near_legs, symmetric=symmetric), distances, order)
    length = jnp.sum(near[0, :count], axis=0)
    turning = None if symmetric else stage(go, partial(turning_costs, count=count), near)
    words = stage(go, partial(weigh, count=count, kinds=kinds), near, turning)
    word = stage(go, _highest, words)
    least = length * jnp.asarray(_SLACK * jnp.finfo(length.dtype).eps, length.dtype)
    floor = lax.bitcast_convert_type(least.astype(jnp.float32), jnp.int32)
    worth = word > floor | ((1 << name_bits(count)) - 1)
    # Where there is none, to turn round a single station: it stays a tour.
    behind, first, last, reverse = named_move(jnp.where(worth, word, 0), count)
    return length, worth, Move(behind, first, jnp.zeros_like(first), last, reverse)


def _highest(values: Array) -> Array:
    """The maximum along the first axis, by halves, which vectorises along the last."""
    while values.shape[0] > 1:
        half = values.shape[0] // 2
        left = values[2 * half :]
        values = jnp.concatenate([jnp.maximum(values[:half], values[half : 2 * half]), left])
    return values[0]
