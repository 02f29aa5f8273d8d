"""Grey wolves whose positions are tours and whose steps are swap sequences.

A swap sequence turns one tour into another: position by position, the station that belongs there
and the one that is there change places. A wolf takes, from the first to the third of its leaders, a
stretch of the sequence towards it that begins anywhere and is the longer the less |A| of that
leader is: at most a random share of (1 - |A|) (d - 1) positions, none where |A| >= 1. Then a random
stretch of its tour turns round. It goes there only if its tour becomes no longer (`greedy`), and
the three best tours of the pack lead (leaders "pack"), unless chosen otherwise. Station 0 stays
first, so that tours compare position by position.

Source of swap sequences: Wang et al. 2003 (particle swarms); of grey wolves with them, Sopto et al.
2018, cited by Yu et al. 2022, whose own encoding is not printed. The rest is ours.
"""

from functools import partial

import jax.numpy as jnp
from jax import Array, lax

from usvkernels import draws
from usvkernels.swarms.gwo import LEADERS, GwoStatic
from usvkernels.swarms.laws import GwoParams, convergence
from usvkernels.swarms.pack import lowest
from usvkernels.tours.lengths import length, rank_of
from usvkernels.xla.stage import stage

_Tours = tuple[Array, Array]
"""Tours int32[d, n, R] and their lengths float[n, R]."""


def run(
    distances: Array,
    seed: Array,
    params: GwoParams,
    *,
    static: GwoStatic,
    iterations: int,
    population: int,
) -> tuple[Array, Array]:
    """Search; population * (iterations + 1) tours in each run.

    Args:
        distances: float[d, d] or float[d, d, R], finite.
        seed: uint32[2, R].
        params: of the law "beta"; leaves numbers or float[R].
        static: choices of method; `greedy`, a wolf goes to a tour that is no longer than its own.
        iterations: T.
        population: wolves n, 3 or more.

    Returns:
        int32[d, R], the shortest closed tours; float[T, R], their lengths so far.
    """
    count = distances.shape[0]
    go = jnp.sum(distances) >= 0  # always, but a compiler does not know
    measured = partial(stage, go, partial(length, distances))
    factors = convergence(static.law, iterations, params, distances.dtype)

    def step(carry: tuple[_Tours, _Tours], now: tuple[Array, Array]) -> tuple[tuple, Array]:
        pack, kept = carry
        time, factor = now
        leaders, _ = kept if static.leaders == "kept" else _best(pack)
        new = stage(go, _moved, pack[0], leaders, seed, time, factor)
        moved = new, measured(new)
        kept = _best(_joined(kept, _best(moved)))
        pack = _no_longer(moved, pack) if static.greedy else moved
        return (pack, kept), jnp.min(known(pack, kept)[1], axis=0)

    def known(pack: _Tours, kept: _Tours) -> _Tours:
        """Tours of which one is the best ever: greedy wolves do not leave it."""
        return pack if static.greedy else kept

    order = stage(go, partial(_first_pack, shape=(count, population)), seed)
    pack = order, measured(order)
    times = jnp.arange(1, iterations + 1)
    carry, history = lax.scan(step, (pack, _best(pack)), (times, factors))
    best, _ = _best(known(*carry))
    return best[:, 0], history


def _first_pack(seed: Array, shape: tuple[int, int]) -> Array:
    """Random tours int32[d, n, R] that begin with station 0."""
    count, members = shape
    index = jnp.arange(count * members).reshape(count, members, 1)
    word, *_ = draws.words(seed[:, None, None], 0, index)
    return rank_of(word.at[0].set(0))


def _best(tours: _Tours) -> _Tours:
    """The three shortest."""
    order, value = tours
    least, index = lowest(value, LEADERS)
    return jnp.take_along_axis(order, index[None], axis=1), least


def _joined(one: _Tours, other: _Tours) -> _Tours:
    return jnp.concatenate([one[0], other[0]], axis=1), jnp.concatenate([one[1], other[1]])


def _no_longer(new: _Tours, old: _Tours) -> _Tours:
    """Of each wolf the new tour, unless it is longer than the old one."""
    better = new[1] <= old[1]
    return jnp.where(better, new[0], old[0]), jnp.where(better, new[1], old[1])


def _moved(pack: Array, leaders: Array, seed: Array, time: Array, factor: Array) -> Array:
    """Where the wolves would go."""
    count, members, _ = pack.shape
    first, second, third = (
        draws.words(seed[:, None], time, jnp.arange(k * members, (k + 1) * members)[:, None])
        for k in range(3)
    )
    for k in range(LEADERS):
        share = jnp.maximum(1 - jnp.abs(factor * draws.signed(first[k], factor.dtype)), 0)
        size = share * draws.uniform(second[k], factor.dtype) * (count - 1)
        begin = 1 + _below(third[k], count - 1)
        pack = _towards(pack, leaders[:, k], begin, size.astype(jnp.int32))
    return _turned(pack, 1 + _below(first[3], count - 1), 1 + _below(second[3], count - 1))


def _towards(pack: Array, leader: Array, begin: Array, size: Array) -> Array:
    """The tours after `size` int32[n, R] positions from `begin` on of the sequence to a leader."""
    count = pack.shape[0]

    def swapped(place: Array, pack: Array) -> Array:
        behind = jnp.where(place < begin, place - begin + count - 1, place - begin)
        own = pack[place]
        wanted = jnp.where(behind < size, leader[place], own)
        return jnp.where(pack == wanted, own, jnp.where(pack == own, wanted, pack))

    return lax.fori_loop(1, count, swapped, pack)


def _turned(pack: Array, one: Array, other: Array) -> Array:
    """The tours with the stretch between two positions int32[n, R] turned round."""
    place = jnp.arange(pack.shape[0], dtype=jnp.int32)[:, None, None]
    low, high = jnp.minimum(one, other), jnp.maximum(one, other)
    inside = (place >= low) & (place <= high)
    return jnp.take_along_axis(pack, jnp.where(inside, low + high - place, place), axis=0)


def _below(word: Array, bound: int) -> Array:
    return (word % jnp.uint32(bound)).astype(jnp.int32)
