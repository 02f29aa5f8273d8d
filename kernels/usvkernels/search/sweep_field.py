"""Fields of distances to sets of cells by sweeps over whole maps (see `sweep`)."""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.search.sweep import (
    Sweep,
    cut,
    each_group,
    farthest,
    first_element,
    lay_out,
    put,
    relaxed,
)
from usvkernels.xla.single import single


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Fields:
    """Distances; leaves [G, ...].

    Attributes:
        length: uint[G, height * width, lanes], units to the nearest source; ``units.cap`` where
            there is none and in blocked cells.
        capped: bool[G, lanes], lengths came near the greatest that there is: cells with
            ``units.cap`` may be farther away rather than cut off.
        passes: int32[G], passes over the maps of a group.
    """

    length: Array
    capped: Array
    passes: Array


def field(sweep: Sweep, packed: Array, sources: Array, groups: Array) -> Fields:
    """Find the distance of every cell to the nearest source.

    Args:
        sweep: static.
        packed: uint8[G or 1, words, lanes or 1], as of `SweepQueries`.
        sources: int32[G, K, lanes, 2], cells (x, y); negative ones are padding, blocked ones do
            not count.
        groups: int32[], how many groups to do; the rows of the others are zero.

    Returns:
        The fields.
    """

    def group(i: Array) -> Fields:
        maps = packed[jnp.minimum(i, packed.shape[0] - 1)]
        maps = jnp.broadcast_to(maps, (sweep.words, sweep.lanes))
        row = lax.dynamic_index_in_dim(sources, i, 0, keepdims=False)
        return single(partial(_field_group, sweep), maps, row)

    return each_group(group, sources.shape[0], groups)


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Waves:
    plane: Array
    moved: Array  # bool[blocks], blocks in which the last pass changed a cell
    passes: Array  # int32[]


def _field_group(sweep: Sweep, packed: Array, sources: Array) -> Fields:
    straight_up = jnp.zeros(sweep.lanes, bool)
    plane, moved = _sources_set(sweep, lay_out(sweep, packed, straight_up), sources)

    def unfinished(waves: _Waves) -> Array:
        return jnp.any(waves.moved) & (waves.passes < sweep.most_passes)

    def run_pass(waves: _Waves) -> _Waves:
        plane, moved = _pass(sweep, waves.plane, waves.moved, waves.passes % 2 == 1)
        # The first pass leaves its own sources to the second.
        moved = moved | jnp.where(waves.passes == 0, waves.moved, False)
        return _Waves(plane, moved, waves.passes + 1)

    waves = lax.while_loop(unfinished, run_pass, _Waves(plane, moved, jnp.int32(0)))
    top = farthest(sweep, waves.plane).astype(jnp.uint32)
    return Fields(
        length=_unlaid(sweep, waves.plane),
        capped=top + sweep.units.diagonal >= sweep.units.cap,
        passes=waves.passes,
    )


def _sources_set(sweep: Sweep, plane: Array, sources: Array) -> tuple[Array, Array]:
    """The plane with zeros at free sources int32[K, lanes, 2], and bool[blocks] where they are."""
    flat = sources.reshape(-1, 2)
    flag = jnp.asarray(sweep.units.flag, sweep.units.dtype)

    def one(i: Array, state: tuple[Array, Array]) -> tuple[Array, Array]:
        plane, moved = state
        x, y = jnp.maximum(flat[i, 0], 0), jnp.maximum(flat[i, 1], 0)
        element = first_element(sweep, x, y) + i % sweep.lanes
        own = cut(plane, element, 1)
        counts = (flat[i, 0] >= 0) & (flat[i, 1] >= 0) & (own[0] != flag)
        block = (element - sweep.margin * sweep.lanes) // (sweep.block * sweep.lanes)
        plane = put(plane, jnp.where(counts, jnp.zeros_like(own), own), element)
        return plane, put(moved, cut(moved, block, 1) | counts, block)

    return lax.fori_loop(0, flat.shape[0], one, (plane, jnp.zeros(sweep.blocks, bool)))


def _pass(sweep: Sweep, plane: Array, before: Array, backward: Array) -> tuple[Array, Array]:
    """One pass over the blocks behind which, as the pass goes, something changed.

    Args:
        sweep: static.
        plane: of lengths.
        before: bool[blocks], changed in the pass before, which went the other way.
        backward: bool[], the direction.

    Returns:
        The plane, and bool[blocks] where it changed.
    """
    size, blocks = sweep.block * sweep.lanes, sweep.blocks
    sign = jnp.where(backward, -sweep.lanes, sweep.lanes)
    reach = -(-(sweep.stride + sweep.block) // sweep.block)  # blocks back to the neighbours

    def update(plane: Array, start: Array) -> tuple[Array, Array]:
        new = relaxed(sweep, plane, start, sign)
        return new, jnp.any(new != cut(plane, start, size))

    def same(plane: Array, start: Array) -> tuple[Array, Array]:
        return cut(plane, start, size), jnp.zeros((), bool)

    def step(i: Array, state: tuple[Array, ...]) -> tuple[Array, ...]:
        plane, moved, since = state
        block = jnp.where(backward, blocks - 1 - i, i)
        start = sweep.margin * sweep.lanes + block * size
        new, change = lax.cond(since <= reach, update, same, plane, start)
        change = change[None]
        since = jnp.where((change | cut(before, block, 1))[0], 1, since + 1)
        return put(plane, new, start), put(moved, change, block), since

    start = (plane, jnp.zeros(blocks, bool), jnp.int32(reach + 1))
    plane, moved, _ = lax.fori_loop(0, blocks, step, start)
    return plane, moved


def _unlaid(sweep: Sweep, plane: Array) -> Array:
    """The cells of a plane in the map's order, [height * width, lanes]."""
    cap = jnp.asarray(sweep.units.cap, sweep.units.dtype)

    def cell(i: Array, rows: Array) -> Array:
        start = first_element(sweep, i % sweep.width, i // sweep.width)
        return put(rows, jnp.minimum(cut(plane, start, sweep.lanes), cap), i * sweep.lanes)

    count = sweep.width * sweep.height
    rows = jnp.zeros(count * sweep.lanes, sweep.units.dtype)
    return lax.fori_loop(0, count, cell, rows).reshape(count, sweep.lanes)
