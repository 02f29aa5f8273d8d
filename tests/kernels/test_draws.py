"""The counter-based generator: against whole Python numbers, and as random numbers."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import swarms_reference as plain
from dwa_situations import enable_x64
from scipy import stats

from usvkernels import draws

RUNS, TIMES, PLACES = 24, 50, 600
LEVEL = 1e-6  # of a test; there are some hundred statistics in this file, with fixed seeds
BITS = np.arange(32, dtype=np.uint32)

words = jax.jit(draws.words)
seeds = jax.jit(draws.seeds, static_argnums=1)


@pytest.fixture(scope="module")
def table() -> np.ndarray:
    """uint32[word, run, time, index], times and indices from 0 as swarms have them."""
    seed = seeds(jax.random.key(5), RUNS)[:, :, None, None]
    time, index = jnp.arange(TIMES)[:, None], jnp.arange(PLACES)
    return np.stack([np.asarray(w) for w in words(seed, time, index)])


def neighbours(table: np.ndarray, axis: str) -> tuple[np.ndarray, np.ndarray]:
    place = {"run": 1, "time": 2, "index": 3}[axis]
    size = table.shape[place]
    return np.take(table, range(size - 1), place), np.take(table, range(1, size), place)


def test_words_are_those_of_whole_numbers() -> None:
    rng = np.random.default_rng(1)
    counters = rng.integers(0, 2**32, (20, 4), dtype=np.uint64)
    counters[:3] = [[0, 0, 0, 0], [2**32 - 1] * 4, [1, 2, 3, 4]]
    seed, rest = counters[:, :2].T.astype(np.uint32), counters[:, 2:].T.astype(np.uint32)
    got = np.stack([np.asarray(w) for w in words(jnp.asarray(seed), *map(jnp.asarray, rest))])
    wanted = np.array([plain.words(*(int(v) for v in row)) for row in counters])
    np.testing.assert_array_equal(got.T, wanted)


def test_seeds_do_not_depend_on_their_number() -> None:
    key = jax.random.key(3)
    few, many = (np.asarray(seeds(key, n)) for n in (3, 8))
    np.testing.assert_array_equal(few, many[:, :3])
    assert len(np.unique(many)) == many.size
    assert (np.asarray(seeds(jax.random.key(4), 8)) != many).all()


@pytest.mark.parametrize("shift", [0, 12, 24])
def test_every_byte_is_uniform(table: np.ndarray, shift: int) -> None:
    for word in table:
        counts = np.bincount((word.ravel() >> np.uint32(shift)) & np.uint32(255), minlength=256)
        assert stats.chisquare(counts).pvalue > LEVEL


@pytest.mark.parametrize("axis", ["run", "time", "index", "word"])
def test_neighbours_are_not_correlated(table: np.ndarray, axis: str) -> None:
    values = draws_of(table)
    for j, k in np.ndindex(4, 4):
        if axis == "word" and j >= k:
            continue
        first, second = (values, values) if axis == "word" else neighbours(values, axis)
        a, b = first[j].ravel(), second[k].ravel()
        z = np.corrcoef(a, b)[0, 1] * np.sqrt(a.size)
        assert 2 * stats.norm.sf(abs(z)) > LEVEL, (j, k, z)


def draws_of(table: np.ndarray) -> np.ndarray:
    return table.astype(np.float64) / 2.0**32


@pytest.mark.parametrize("axis", ["run", "time", "index"])
def test_every_bit_changes_half_the_time(table: np.ndarray, axis: str) -> None:
    first, second = neighbours(table, axis)
    for j in range(4):
        changed = (first[j] ^ second[j]).ravel()
        share = ((changed[:, None] >> BITS) & np.uint32(1)).mean(axis=0)
        z = np.abs(share - 0.5) * 2 * np.sqrt(changed.size)
        assert 2 * stats.norm.sf(z.max()) > LEVEL, (j, int(z.argmax()), float(z.max()))


@pytest.mark.parametrize("axis", ["run", "time", "index"])
def test_neighbouring_words_fill_four_dimensions(table: np.ndarray, axis: str) -> None:
    first, second = neighbours(table >> np.uint32(29), axis)  # eight parts a dimension
    for j in range(4):
        k = (j + 1) % 4
        cell = ((first[j] * 8 + first[k]) * 8 + second[j]) * 8 + second[k]
        counts = np.bincount(cell.ravel(), minlength=8**4)
        assert stats.chisquare(counts).pvalue > LEVEL


@pytest.mark.parametrize("bit", [0, 5, 11, 15])
@pytest.mark.parametrize("argument", range(4))
def test_one_bit_of_a_counter_changes_half_of_all_bits(argument: int, bit: int) -> None:
    rng = np.random.default_rng(10 * argument + bit)
    counters = rng.integers(0, 2**16, (4, 20_000)).astype(np.uint32)
    flipped = counters.copy()
    flipped[argument] ^= np.uint32(1 << bit)
    before, after = (
        words(jnp.asarray(c[:2]), *map(jnp.asarray, c[2:])) for c in (counters, flipped)
    )
    for a, b in zip(before, after, strict=True):
        changed = np.asarray(a) ^ np.asarray(b)
        share = ((changed[:, None] >> BITS) & np.uint32(1)).mean(axis=0)
        z = np.abs(share - 0.5).max() * 2 * np.sqrt(changed.size)
        assert 2 * stats.norm.sf(z) > LEVEL


def test_numbers_lie_where_they_should() -> None:
    words = jnp.array([0, 1, 255, 256, 2**31 - 1, 2**31, 2**32 - 1], jnp.uint32)
    single = np.asarray(draws.uniform(words))
    assert single.dtype == np.float32
    np.testing.assert_array_equal(
        single, np.float32([0, 0, 0, 2**-24, 0.5 - 2**-24, 0.5, 1 - 2**-24])
    )
    either = np.asarray(draws.signed(words))
    assert either.dtype == np.float32
    np.testing.assert_array_equal(
        either, np.float32([0, 2**-31, 255 * 2**-31, 2**-23, 1, -1, -(2**-31)])
    )
    with enable_x64():
        double = np.asarray(draws.uniform(words, jnp.float64))
        exact = np.asarray(draws.signed(words, jnp.float64))
    np.testing.assert_array_equal(double, np.asarray(words).astype(float) * 2.0**-32)
    np.testing.assert_array_equal(exact, np.asarray(words).astype(np.int32) * 2.0**-31)
