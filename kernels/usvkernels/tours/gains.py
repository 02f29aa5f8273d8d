"""What every 2-opt and Or-opt move of a tour gains, weighed along the vectors of a processor.

The stations of a move follow each other, so that all its legs are slices of one table: how far it
is from each position to the k-th behind it. A gain and the name of its move share a word: the high
bits of a positive float order as an integer does, the low ones name the move.
"""

from dataclasses import dataclass

import jax.numpy as jnp
from jax import Array, lax

from usvkernels.tours.lengths import leg

LONGEST_SEGMENT = 3
"""Stations that an Or-opt move takes elsewhere, at most (Or 1976)."""

NEIGHBOURHOODS = ("two_opt", "or_opt", "both")


def near_legs(distances: Array, order: Array, symmetric: bool) -> Array:
    """Legs near[k - 1, i] from each position i to i + k; k up to d / 2 if symmetric, else d - 1.

    float[d // 2 or d - 1, 2 d + 5, R], more than once around the tour.
    """
    count = order.shape[0]
    twice = jnp.concatenate([order, order])
    most = count // 2 if symmetric else count - 1
    near = jnp.stack([leg(distances, order, twice[k : k + count]) for k in range(1, most + 1)])
    return jnp.concatenate([near] * -(-_around(count) // count), axis=1)[:, : _around(count)]


def turning_costs(near: Array, count: int) -> Array:
    """Sums of what the legs before each position cost more backwards; float[2 d + 6, R]."""
    more = jnp.roll(near[count - 2, :count], -1, axis=0) - near[0, :count]
    more = jnp.concatenate([more] * -(-_around(count) // count))[: _around(count)]
    return jnp.concatenate([jnp.zeros_like(more[:1]), jnp.cumsum(more, axis=0)])


def _around(count: int) -> int:
    return 2 * count + LONGEST_SEGMENT + 2


def weigh(near: Array, turning: Array | None, count: int, kinds: str) -> Array:
    """Words of the best moves behind each position; int32[d, R], below 2**bits where none gains.

    Args:
        near: of `near_legs`.
        turning: of `turning_costs`; None if symmetric.
        count: d.
        kinds: one of `NEIGHBOURHOODS`.
    """
    words = jnp.zeros((count, near.shape[2]), jnp.int32)
    # Written out: slices that move with a loop's counter do not vectorise, nor do tables of them.
    for reach in range(1, count - 1):
        row = _Row(reach, count, near, turning)
        offers = []
        if kinds != "or_opt":
            offers += row.reversals()
        if kinds != "two_opt":
            for size in range(1, min(LONGEST_SEGMENT, count - reach - 1) + 1):
                offers += row.segments(size)
        for gain, kind in offers:
            words = jnp.maximum(words, row.named(gain, kind))
    return words


def name_bits(count: int) -> int:
    """Bits of a word that name the move."""
    return (2 * LONGEST_SEGMENT * count * count - 1).bit_length()


def named_move(word: Array, count: int) -> tuple[Array, Array, Array, Array]:
    """The stations before a move, in its first segment and its last, and whether it turns round."""
    name = word & jnp.int32((1 << name_bits(count)) - 1)
    row, behind = name // count, name % count
    kind, row = row // count, row % count
    reversal = kind == 0
    first = jnp.where(reversal, row + 1, kind // 2 + 1)
    return behind, first, jnp.where(reversal, 0, row), kind % 2 == 0


_Offer = tuple[Array, int]
"""Gains float[d, R] of one kind of move behind each position i."""


@dataclass(frozen=True)
class _Row:
    """The moves that reach from any position i to `reach` behind it, and a segment further."""

    reach: int
    count: int
    near: Array
    turning: Array | None

    def reversals(self) -> list[_Offer]:
        """2-opt: the reach + 1 stations behind i turn round."""
        size = self.reach + 1
        if self.turning is None and size > self.count // 2:
            return []  # the same as turning the others round
        gain = self._leg(1, 0) + self._leg(1, size) - self._leg(size, 0) - self._leg(size, 1)
        return [(gain - self._turned(size), 0)]

    def segments(self, size: int) -> list[_Offer]:
        """Or-opt: the `size` stations behind i go behind the `reach` stations after them."""
        reach = self.reach
        closed = self._leg(1, 0) + self._leg(1, size) - self._leg(size + 1, 0)
        gain = closed + self._leg(1, size + reach)
        straight = gain - self._back(size + reach - 1, 1) - self._leg(reach + 1, size)
        if size == 1:
            return [(straight, 1)]
        turned = gain - self._back(reach, size) - self._leg(size + reach, 1) - self._turned(size)
        return [(straight, 2 * size - 1), (turned, 2 * size - 2)]

    def named(self, gain: Array, kind: int) -> Array:
        """Words of gains."""
        name = (kind * self.count + self.reach) * self.count
        names = (name + jnp.arange(self.count, dtype=jnp.int32))[:, None]
        high = lax.bitcast_convert_type(gain.astype(jnp.float32), jnp.int32)
        return (high & jnp.int32(-(1 << name_bits(self.count)))) | names

    def _leg(self, more: int, shift: int) -> Array:
        """Legs from i + shift to `more` behind it; float[d, R]."""
        if more > len(self.near):  # symmetric: the same leg from its other end
            more, shift = self.count - more, shift + more
        shift %= self.count
        return self.near[more - 1, shift : shift + self.count]

    def _back(self, more: int, shift: int) -> Array:
        """The same legs the other way."""
        if self.turning is None:
            return self._leg(more, shift)
        return self._leg(self.count - more, shift + more)

    def _turned(self, size: int) -> Array | float:
        """What i + 1 .. i + size cost more the other way."""
        if self.turning is None:
            return 0.0
        return self.turning[size : size + self.count] - self.turning[1 : self.count + 1]
