"""Designs of the priority queue in lanes, per size of the grid, at the work of an A* search."""

from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from benchmarks import pqueue_buckets
from benchmarks.markdown import table
from benchmarks.timing import in_turns, spread
from usvjax.devices import COMPILER_OPTIONS
from usvkernels.search import pqueue, pqueue_heap
from usvkernels.search.pqueue import ABSENT

TITLE = "priority queues: block minima, binary heap, buckets"
SIDES = (25, 50, 100, 256, 512)
LANES = 64
AROUND = 9  # cells that an expansion reads and writes, its own among them
STEP = 1000  # keys grow by 1 to this
RING, DEPTH = 64, 64
CELLS = {
    f"{levels} levels, blocks of {leaf}": (leaf, levels) for levels in (2, 3) for leaf in (16, 32)
}
HEAP, BUCKETS = "binary heap", "buckets"
MOST_BLOCKS = 5000  # with two levels; beyond, reading a column takes milliseconds

# Cells are queued in pairs: one of two is, and popping it pushes the other. So every design holds
# the same keys, without duplicates, and pops the same sequence.


def measure(quick: bool) -> dict[str, Any]:
    """Time steps of one pop and one push, in all lanes, with an open list of 4 cells a side."""
    found = []
    for side in SIDES[:2] if quick else SIDES:
        steps = 20 if quick else 400
        calls = _contestants(side, steps)
        sums: dict[str, np.ndarray] = {}

        def call(name: str, run: Callable[[], Array], into: dict[str, np.ndarray] = sums) -> None:
            into[name] = np.asarray(jax.block_until_ready(run()))

        timed = in_turns({name: partial(call, name, run) for name, run in calls.items()})
        if (sums[BUCKETS] < 0).any():
            raise RuntimeError(f"{BUCKETS}: a bucket overflowed at {side} x {side}")
        exact = {name: s for name, s in sums.items() if name != BUCKETS}
        first = next(iter(exact.values()))
        for name, popped in exact.items():
            if not np.array_equal(popped, first):
                raise RuntimeError(f"{name}: pops differ from those of {next(iter(exact))}")
        for times in timed.values():
            times["ns"] = times["median"] / steps / LANES * 1e9
        found.append({"side": side, "timed": timed})
    return {"lanes": LANES, "found": found}


def _contestants(side: int, steps: int) -> dict[str, Callable[[], Array]]:
    rng = np.random.default_rng(side)
    queued = 4 * side
    cells = np.stack([rng.permutation(side * side // 2)[:queued] * 2 for _ in range(LANES)], 1)
    keys = rng.integers(1, STEP, cells.shape)
    start = (jnp.asarray(keys, jnp.int32), jnp.asarray(cells, jnp.int32))
    go, count = jnp.bool_(True), jnp.int32(steps)
    calls: dict[str, Callable[[], Array]] = {}
    for name, (leaf, levels) in CELLS.items():
        sizes = pqueue.layout(LANES, side * side, leaf, levels)
        if levels == 2 and sizes.blocks > MOST_BLOCKS:
            continue
        calls[name] = partial(_by_cells, sizes, _cells_filled(sizes, start, go), go, count)
    calls[HEAP] = partial(_by_heap, _heaps_filled(2 * queued, start), count)
    calls[BUCKETS] = partial(_by_buckets, _buckets_filled(start), count)
    return calls


def _grown(key: Array, cell: Array) -> Array:
    return key + 1 + (cell * 40503 + key) % STEP


@partial(jax.jit, static_argnums=0)
def _cells_filled(sizes: pqueue.Layout, start: tuple[Array, Array], go: Array) -> pqueue.Queues:
    keys, cells = start
    return pqueue.lower(sizes, pqueue.empty(sizes), go, cells, pqueue.pair(keys, keys * 0, 1))


@partial(jax.jit, static_argnums=0, compiler_options=COMPILER_OPTIONS)
def _by_cells(sizes: pqueue.Layout, queues: pqueue.Queues, go: Array, steps: Array) -> Array:
    lane = jnp.arange(LANES, dtype=jnp.int32)
    offset = jnp.arange(AROUND, dtype=jnp.int32)[:, None] - AROUND // 2

    def step(_: Array, carry: tuple[pqueue.Queues, Array]) -> tuple[pqueue.Queues, Array]:
        queues, total = carry
        least = pqueue.least(sizes, queues, go)
        key = pqueue.first_of(least.key, 1)
        # A window about the cell, as a search has it, moved inside where it would stick out.
        middle = jnp.clip(least.cell, AROUND // 2, sizes.size - AROUND // 2 - 1)
        around = middle + offset
        seen = queues.keys.at[lane * sizes.size + around].get(mode="promise_in_bounds")
        new = pqueue.pair(_grown(key, least.cell), key * 0, 1)
        values = jnp.where(around == (least.cell ^ 1), new, seen)
        values = jnp.where(around == least.cell, ABSENT, values)
        queues = pqueue.replace(sizes, queues, go, least, least.found, around, values)
        return queues, total + key

    return lax.fori_loop(0, steps, step, (queues, jnp.zeros(LANES, jnp.int32)))[1]


@partial(jax.jit, static_argnums=0)
def _heaps_filled(capacity: int, start: tuple[Array, Array]) -> pqueue_heap.Heaps:
    def fill(i: Array, heaps: pqueue_heap.Heaps) -> pqueue_heap.Heaps:
        entry = (start[0][i], start[1][i] * 0, start[1][i])
        return pqueue_heap.push(heaps, jnp.ones(LANES, bool), entry)

    return lax.fori_loop(0, start[0].shape[0], fill, pqueue_heap.empty(LANES, capacity))


@partial(jax.jit, compiler_options=COMPILER_OPTIONS)
def _by_heap(heaps: pqueue_heap.Heaps, steps: Array) -> Array:
    every = jnp.ones(LANES, bool)

    def step(_: Array, carry: tuple[pqueue_heap.Heaps, Array]) -> tuple[pqueue_heap.Heaps, Array]:
        heaps, total = carry
        key, _, cell = pqueue_heap.top(heaps)
        heaps = pqueue_heap.pop(heaps, every)
        new = (_grown(key, cell), cell * 0, cell ^ 1)
        return pqueue_heap.push(heaps, every, new), total + key

    return lax.fori_loop(0, steps, step, (heaps, jnp.zeros(LANES, jnp.int32)))[1]


_WIDTH = 2 * STEP // RING + 1  # of a bucket


@jax.jit
def _buckets_filled(start: tuple[Array, Array]) -> pqueue_buckets.Buckets:
    def fill(i: Array, queues: pqueue_buckets.Buckets) -> pqueue_buckets.Buckets:
        return pqueue_buckets.push(queues, _WIDTH, start[0][i], start[1][i])

    queued = start[0].shape[0]
    empty = pqueue_buckets.empty(LANES, RING, max(DEPTH, queued // 4))
    return lax.fori_loop(0, queued, fill, empty)


@partial(jax.jit, compiler_options=COMPILER_OPTIONS)
def _by_buckets(queues: pqueue_buckets.Buckets, steps: Array) -> Array:
    def step(
        _: Array, carry: tuple[pqueue_buckets.Buckets, Array]
    ) -> tuple[pqueue_buckets.Buckets, Array]:
        queues, total = carry
        queues, key, cell = pqueue_buckets.pop(queues)
        queues = pqueue_buckets.push(queues, _WIDTH, _grown(key, cell), cell ^ 1)
        return queues, total + key

    queues, total = lax.fori_loop(0, steps, step, (queues, jnp.zeros(LANES, jnp.int32)))
    # Dropped entries would leave less to do: no sum, then.
    return jnp.where(jnp.any(queues.overflow), -1, total)


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    names = [*CELLS, HEAP, BUCKETS]
    rows = []
    for size in found["found"]:
        timed = size["timed"]
        chosen = pqueue.layout(1, (size["side"] + 2) * (size["side"] + 1) + 1)
        best = min(timed, key=lambda name: timed[name]["ns"])
        rows.append(
            (
                f"{size['side']} x {size['side']}",
                *(f"{timed[name]['ns']:.0f}" if name in timed else "" for name in names),
                f"{chosen.levels} of {chosen.leaf}",
                best,
                "; ".join(spread(times["seconds"]) for times in timed.values()),
            )
        )
    return (
        f"Nanoseconds per lane for one pop and one push, {found['lanes']} lanes on one device, "
        "medians, on an open list of four cells a side. The cell-addressed queues read and "
        "write nine cells a step, as A* does, the others one; they need no decrease-key here, "
        "which the heap and the buckets lack. Buckets are exact to their width only. All other "
        "designs pop the same.\n\n"
        + table(("grid", *names, "chosen by `pqueue.layout`", "fastest", "timings"), rows)
    )
