"""Rows dealt into blocks, run and joined: each once, in order, and no padding to be seen."""

import threading
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usvjax import batches
from usvjax.batches import (
    SIZES,
    Batch,
    bucket,
    deal,
    deal_groups,
    deal_longest_first,
    few_sizes,
    filled,
    most_rows,
    sized,
    split,
)
from usvjax.programs import Programs, make_room, mappings

COUNTS = st.integers(1, 300)
MOSTS = st.integers(1, 80)
DEVICES = st.integers(1, 5)


def rows_of(count: int, seed: int = 0) -> np.ndarray:
    """Some of the rows of a larger batch, ascending."""
    return np.sort(np.random.default_rng(seed).choice(3 * count, count, replace=False))


def assert_each_once(blocks: list[np.ndarray], rows: np.ndarray) -> None:
    np.testing.assert_array_equal(np.sort(np.concatenate(blocks)), rows)
    assert min(map(len, blocks)) > 0


# --- dealing ----------------------------------------------------------------------------------


@given(COUNTS, MOSTS)
def test_split_is_even_in_order_and_as_few_as_can_be(count: int, most: int) -> None:
    rows = rows_of(count)
    blocks = split(rows, most)
    np.testing.assert_array_equal(np.concatenate(blocks), rows)
    lengths = [len(block) for block in blocks]
    assert max(lengths) <= most
    assert max(lengths) - min(lengths) <= 1
    assert (len(blocks) - 1) * most < count


@given(COUNTS, MOSTS, DEVICES, st.integers(1, 20))
def test_deal_is_even_and_as_many_for_each_device(
    count: int, most: int, devices: int, least: int
) -> None:
    rows = rows_of(count)
    blocks = deal(rows, max(most, least), devices, least)
    np.testing.assert_array_equal(np.concatenate(blocks), rows)
    lengths = [len(block) for block in blocks]
    assert max(lengths) <= max(most, least)
    assert max(lengths) - min(lengths) <= 1
    assert len(blocks) % devices == 0 or len(blocks) == -(-count // least)


@given(COUNTS, MOSTS, DEVICES)
def test_longest_first_deals_all_alike(count: int, most: int, devices: int) -> None:
    work = np.random.default_rng(count).integers(0, 9, count)
    blocks = deal_longest_first(work, most, devices)
    assert_each_once(blocks, np.arange(count))
    assert len(blocks) == len(deal(np.arange(count), most, devices))
    assert max(map(len, blocks)) == len(blocks[0]) <= most
    for block in blocks:
        assert (np.diff(work[block]) <= 0).all()
    # The k-th of one block is at least as long as the k + 1-th of every other.
    whole = [work[block] for block in blocks]
    for one in whole:
        for other in whole:
            shorter = other[1 : len(one) + 1]
            assert (one[: len(shorter)] >= shorter).all()


@given(COUNTS, st.integers(1, 16), st.integers(1, 9), DEVICES)
def test_groups_stay_whole(count: int, size: int, most: int, devices: int) -> None:
    rows = rows_of(count)
    blocks = deal_groups(rows, size, most, devices)
    np.testing.assert_array_equal(np.concatenate(blocks), rows)
    assert all(len(block) % size == 0 for block in blocks[:-1])
    assert max(map(len, blocks)) <= most * size


def test_nothing_is_dealt_to_nobody() -> None:
    none = np.zeros(0, int)
    assert split(none, 5) == deal(none, 5, 2) == deal_groups(none, 4, 5, 2) == []


@given(st.integers(1, 5000), st.sampled_from([1, *SIZES]))
def test_few_sizes_are_compiled_and_little_is_padding(count: int, most: int) -> None:
    batch = few_sizes(count, most)
    assert_each_once(batch.blocks, np.arange(count))
    assert batch.size in SIZES
    assert max(map(len, batch.blocks)) <= most
    if most >= SIZES[0] and count >= 2 * SIZES[0]:
        assert len(batch.blocks) * batch.size <= batches.MOST_PADDED * count
    assert len(batch.devices) <= len(batch.blocks)


def test_most_rows() -> None:
    assert [most_rows(each, 512) for each in (1, 2, 8, 9, 64, 65)] == [512, 64, 64, 8, 8, 1]


# --- shapes -----------------------------------------------------------------------------------


@given(st.integers(1, 10**6), st.integers(2, 5))
def test_bucket_is_the_next_power(size: int, factor: int) -> None:
    found = bucket(size, factor)
    assert found >= size
    assert found == 1 or found // factor < size
    while found > 1:
        assert found % factor == 0
        found //= factor


@given(st.integers(1, 9), st.integers(1, 20), st.integers(0, 1))
def test_filled_repeats_the_last(count: int, size: int, axis: int) -> None:
    array = np.moveaxis(np.arange(2 * count).reshape(count, 2), 0, axis)
    found = np.moveaxis(filled(array, size, axis), axis, 0)
    np.testing.assert_array_equal(found[:count], np.moveaxis(array, axis, 0))
    assert len(found) == max(size, count)
    assert (found[count:] == found[count - 1]).all()


@given(st.integers(0, 9), st.integers(0, 20), st.integers(0, 1))
def test_sized_cuts_or_fills_a_copy(count: int, size: int, axis: int) -> None:
    array = np.moveaxis(np.arange(2 * count).reshape(count, 2), 0, axis)
    found = sized(array, size, axis, fill=-7)
    assert found.dtype == array.dtype
    assert not np.shares_memory(found, array)
    found, array = np.moveaxis(found, axis, 0), np.moveaxis(array, axis, 0)
    assert len(found) == size
    np.testing.assert_array_equal(found[: min(size, count)], array[:size])
    assert (found[count:] == -7).all()


# --- running ----------------------------------------------------------------------------------


@jax.jit
def _cubed(values: jax.Array) -> jax.Array:
    return values**3


def batch_of(blocks: list[np.ndarray], devices: int) -> Batch:
    return Batch(blocks, bucket(max(map(len, blocks))), jax.local_devices()[:devices])


@given(st.integers(1, 60), st.integers(1, 17), st.integers(1, 2), st.booleans(), st.integers(-2, 1))
def test_results_do_not_depend_on_blocks_or_devices(
    count: int, most: int, devices: int, longest_first: bool, axis: int
) -> None:
    values = np.random.default_rng(count).integers(-99, 99, 3 * count).astype(np.int32)
    rows = rows_of(count)
    blocks = deal(rows, most, devices)
    if longest_first:
        blocks = [rows[block] for block in deal_longest_first(values[rows], most, devices)]
    axis = max(axis, -1)
    batch = batch_of(blocks, devices)

    def work(some: np.ndarray, known: int, device: jax.Device) -> tuple[jax.Array, np.ndarray]:
        assert len(some) == batch.size
        assert (some[known:] == some[known - 1]).all()
        plane = np.stack([values[some], some], axis=1 if axis == 0 else 0)
        cubes = _cubed(jax.device_put(plane, device))
        assert cubes.devices() == {device}
        return cubes, plane

    cubes, plane = batch.arrays(work, axis)
    wanted = np.stack([values[rows], rows], axis=1 if axis == 0 else 0)
    np.testing.assert_array_equal(plane, wanted)
    np.testing.assert_array_equal(cubes, wanted**3)
    assert cubes.flags.writeable


@pytest.mark.parametrize("at_once", [False, True])
@pytest.mark.parametrize("blocks", [1, 2, 5])
def test_at_once_means_from_the_calling_thread_and_changes_nothing(
    at_once: bool, blocks: int
) -> None:
    devices = jax.local_devices()[:2]
    batch = Batch(np.array_split(np.arange(20), blocks), 32, devices)
    threads = set()

    def work(rows: np.ndarray, count: int, device: jax.Device) -> Any:
        threads.add(threading.current_thread())
        return {"rows": jnp.asarray(rows), "count": count}

    found = batch.run(work, at_once)
    assert [part["count"] for part in found] == [len(block) for block in batch.blocks]
    np.testing.assert_array_equal(batch.join([part["rows"] for part in found]), np.arange(20))
    assert all(isinstance(part["rows"], np.ndarray) for part in found)
    here = threads == {threading.current_thread()}
    assert here == (at_once and blocks <= len(devices))


def test_parts_without_padding_join_as_well() -> None:
    batch = Batch([np.array([4, 1]), np.array([9, 7, 2])], 8, [])
    parts = [batch.blocks[0] * 10, filled(batch.blocks[1], 8) * 10]
    np.testing.assert_array_equal(batch.join(parts), [10, 20, 40, 70, 90])


def test_programs_are_compiled_once_for_each_device() -> None:
    programs, traced = Programs(), []

    @jax.jit
    def kernel(values: jax.Array) -> jax.Array:
        traced.append(values)
        return values + 1

    device = jax.local_devices()[-1]
    assert not programs.ready("plus one", [device])
    for start in (0, 5):
        found = programs.run("plus one", device, kernel, np.arange(start, start + 3))
        assert found.devices() == {device}
        np.testing.assert_array_equal(found, np.arange(start, start + 3) + 1)
    assert len(traced) == 1
    assert programs.ready("plus one", [device])
    assert not programs.ready("plus two", [device])


def test_compiled_programs_go_before_a_process_has_no_room_for_more(monkeypatch) -> None:
    """JAX crashes where mappings of memory run out: each kernel takes three."""
    programs, device = Programs(), jax.local_devices()[0]

    @partial(jax.jit, static_argnames="times")
    def kernel(values: jax.Array, times: int) -> jax.Array:
        return jnp.sort(jnp.cumsum(values) * times)

    def compiled(times: int) -> bool:
        programs.run(times, device, kernel, np.arange(3.0, dtype=np.float32), times=times)
        make_room()
        return programs.ready(times, [device])

    taken = mappings()
    assert taken > 0
    monkeypatch.setattr("usvjax.programs.most_mappings", lambda: 2 * taken + 60)
    assert compiled(1)
    kept = [compiled(times) for times in range(2, 30)]
    assert not all(kept)
    assert any(kept)
    assert mappings() < taken + 60
