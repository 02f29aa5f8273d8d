"""Batches of priority queues against Python's heapq and a dictionary."""

import heapq
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from property_draws import examples

from usvkernels.search import pqueue, pqueue_heap
from usvkernels.search.pqueue import ABSENT

LANES = 4
# Two levels, three levels with several groups, and a column too long to be written out.
LAYOUTS = {
    "two levels": pqueue.layout(LANES, 150, leaf=8, levels=2),
    "three levels": pqueue.layout(LANES, 150, leaf=4, levels=3),
    "long column": pqueue.layout(LANES, 600, leaf=4, levels=2),
}
CELLS = 150
WIDTH = 5  # cells per lane and operation


@partial(jax.jit, static_argnames="sizes")
def _lower(sizes: Any, queues: Any, go: Any, cells: Any, values: Any) -> Any:
    return pqueue.lower(sizes, queues, go, cells, values)


@partial(jax.jit, static_argnames="sizes")
def _least(sizes: Any, queues: Any, go: Any) -> Any:
    return pqueue.least(sizes, queues, go)


@partial(jax.jit, static_argnames="sizes")
def _replace(sizes: Any, queues: Any, go: Any, take: Any, cells: Any, values: Any) -> Any:
    popped = pqueue.least(sizes, queues, go)
    at = jnp.where(take, popped.cell, cells[0])
    cells = jnp.concatenate([at[None], cells[1:]])
    values = jnp.concatenate([jnp.where(take, pqueue.ABSENT, values[0])[None], values[1:]])
    return pqueue.replace(sizes, queues, go, popped, take, cells, values)


class Model:
    """One queue: a dictionary of keys, and a heap of all that was ever pushed."""

    def __init__(self) -> None:
        self.keys: dict[int, int] = {}
        self.heap: list[tuple[int, int]] = []

    def lower(self, cell: int, key: int) -> None:
        self.keys[cell] = key
        heapq.heappush(self.heap, (key, cell))

    def least(self) -> tuple[int, int] | None:
        while self.heap and self.keys.get(self.heap[0][1]) != self.heap[0][0]:
            heapq.heappop(self.heap)
        return self.heap[0] if self.heap else None

    def pop(self) -> tuple[int, int]:
        key, cell = heapq.heappop(self.heap)
        del self.keys[cell]
        return key, cell


def test_layouts_have_the_levels_they_say() -> None:
    assert [s.levels for s in LAYOUTS.values()] == [2, 3, 2]
    assert all(s.size >= CELLS for s in LAYOUTS.values())
    assert LAYOUTS["long column"].groups > 128
    assert LAYOUTS["three levels"].groups > 1
    for cells in (1, 31, 2704, 10_000, 66_000, 264_000, 5_000_000):
        chosen = pqueue.layout(1, cells)
        assert chosen.size >= cells
        assert chosen.size < cells + chosen.leaf * chosen.group + chosen.leaf


@pytest.mark.parametrize("name", LAYOUTS)
@examples(15)
@given(seed=st.integers(0, 2**32 - 1), few_keys=st.booleans(), pushes=st.floats(0.3, 0.9))
def test_like_heapq(name: str, seed: int, few_keys: bool, pushes: float) -> None:
    sizes, go = LAYOUTS[name], jnp.bool_(True)
    rng = np.random.default_rng(seed)
    queues = pqueue.empty(sizes)
    models = [Model() for _ in range(LANES)]
    low, high = (-5, -1) if few_keys else (-(2**31), -1)
    for _ in range(30):
        if rng.random() < pushes:
            cells = np.stack([rng.permutation(CELLS)[:WIDTH] for _ in range(LANES)], 1)
            drawn = rng.integers(low, high, (WIDTH, LANES))
            values = np.empty((WIDTH, LANES), np.int32)
            for lane, model in enumerate(models):
                for i, cell in enumerate(cells[:, lane]):
                    old = model.keys.get(int(cell), int(ABSENT))
                    values[i, lane] = min(old, drawn[i, lane])
                    if values[i, lane] < old:
                        model.lower(int(cell), int(values[i, lane]))
            queues = _lower(sizes, queues, go, cells.astype(np.int32), values)
        else:
            least = _least(sizes, queues, go)
            take = rng.random(LANES) < 0.7
            for lane, model in enumerate(models):
                want = model.least()
                assert bool(least.found[lane]) == (want is not None)
                if want is not None:
                    assert (int(least.key[lane]), int(least.cell[lane])) == want
                    if take[lane]:
                        model.pop()
            # What is not popped is written back as it is, at cells that the popped are not.
            planes = np.asarray(queues.keys).reshape(LANES, -1)
            cells = np.empty((2, LANES), np.int32)
            cells[0] = sizes.size - 1
            cells[1] = np.where(np.asarray(least.cell) == 7, 8, 7)
            values = np.take_along_axis(planes, cells.T, 1).T
            take = take & np.asarray(least.found)
            queues = _replace(sizes, queues, go, take, cells, values)
    planes = np.asarray(queues.keys).reshape(LANES, -1)
    for lane, model in enumerate(models):
        queued = {int(c): int(planes[lane, c]) for c in np.flatnonzero(planes[lane] < ABSENT)}
        assert queued == model.keys


@pytest.mark.parametrize("name", LAYOUTS)
def test_pop_all_in_order_while_others_are_lowered(name: str) -> None:
    sizes, go = LAYOUTS[name], jnp.bool_(True)
    rng = np.random.default_rng(3)
    keys = rng.integers(-1000, -1, (CELLS, LANES)).astype(np.int32)
    cells = np.repeat(np.arange(CELLS, dtype=np.int32)[:, None], LANES, 1)
    queues = _lower(sizes, pqueue.empty(sizes), go, cells, keys)
    out: list[list[tuple[int, int]]] = [[] for _ in range(LANES)]
    for _ in range(CELLS):
        least = _least(sizes, queues, go)
        assert np.asarray(least.found).all()
        for lane in range(LANES):
            out[lane].append((int(least.key[lane]), int(least.cell[lane])))
        end = np.full((1, LANES), sizes.size - 1, np.int32)
        value = np.full((1, LANES), ABSENT, np.int32)
        queues = _replace(sizes, queues, go, np.ones(LANES, bool), end, value)
    assert not np.asarray(_least(sizes, queues, go).found).any()
    for lane in range(LANES):
        assert out[lane] == sorted(zip(keys[:, lane].tolist(), range(CELLS), strict=True))


@examples(200)
@given(
    a=st.tuples(st.integers(0, 2**24 - 2), st.integers(0, 500)),
    b=st.tuples(st.integers(0, 2**24 - 2), st.integers(0, 500)),
)
def test_pairs_compare_lexicographically(a: tuple[int, int], b: tuple[int, int]) -> None:
    def packed(parts: tuple[int, int]) -> int:
        return int(pqueue.pair(jnp.int32(parts[0]), jnp.int32(parts[1]), 7))

    def clipped(parts: tuple[int, int]) -> tuple[int, int]:
        return parts[0], min(parts[1], 127)

    assert (packed(a) < packed(b)) == (clipped(a) < clipped(b))
    assert packed(a) < ABSENT
    assert int(pqueue.first_of(jnp.int32(packed(a)), 7)) == a[0]


_push = jax.jit(pqueue_heap.push)
_pop = jax.jit(pqueue_heap.pop)


@examples(15)
@given(seed=st.integers(0, 2**32 - 1), few_keys=st.booleans(), pushes=st.floats(0.3, 0.9))
def test_heaps_like_heapq(seed: int, few_keys: bool, pushes: float) -> None:
    rng = np.random.default_rng(seed)
    capacity = 13
    heaps = pqueue_heap.empty(LANES, capacity)
    models: list[list[tuple[int, int, int]]] = [[] for _ in range(LANES)]
    dropped = np.zeros(LANES, bool)
    for _ in range(60):
        mask = rng.random(LANES) < 0.8
        if rng.random() < pushes:
            entry = rng.integers(0, 3 if few_keys else 2**31 - 1, (3, LANES)).astype(np.int32)
            heaps = _push(heaps, mask, tuple(entry))
            for lane in np.flatnonzero(mask):
                if len(models[lane]) < capacity:
                    heapq.heappush(models[lane], tuple(entry[:, lane].tolist()))
                else:
                    dropped[lane] = True
        else:
            heaps = _pop(heaps, mask)
            for lane in np.flatnonzero(mask):
                if models[lane]:
                    heapq.heappop(models[lane])
        least = np.stack(pqueue_heap.top(heaps))
        for lane, model in enumerate(models):
            want = model[0] if model else (int(pqueue_heap.NOTHING),) * 3
            assert tuple(least[:, lane].tolist()) == want
        assert np.asarray(heaps.count).tolist() == [len(model) for model in models]
    assert np.array_equal(np.asarray(heaps.overflow), dropped)
