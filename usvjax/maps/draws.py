"""Random numbers of the jobs of a study, each job's from a key of its own.

Job j draws from `fold_in(key(seed), j)` and from nothing else, so its scene depends neither on the
shard it is computed in, nor on how many jobs there are, nor on the method. Random maps draw from
that very key, whatever else a scene holds from a `Stream` or a numbered round.
"""

from collections.abc import Callable
from enum import IntEnum
from functools import lru_cache, partial

import jax
import jax.numpy as jnp
import numpy as np

from usvjax.ambient import pinned
from usvjax.keys import seed_key

_BLOCK = 64
_MOST_KEPT = 2**20  # numbers of one draw, 8 MiB


class Stream(IntEnum):
    """Streams of a job's numbers, so that no two parts of a scene see the same ones."""

    ENDS = 1
    STATIONS = 2
    HEADINGS = 3
    VESSELS = 4
    CIRCLES = 5


@pinned()
def uniform_fields(seed: int, jobs: np.ndarray, count: int) -> np.ndarray:
    """Uniform numbers in [0, 1), float64[J, count], row j from `fold_in(key(seed), jobs[j])`.

    Read-only: the conditions of a study share the draws, so those of the last calls are kept.
    """
    numbers = jobs.astype(np.uint32).tobytes()
    draw = _kept_fields if len(jobs) * count <= _MOST_KEPT else _kept_fields.__wrapped__
    return draw(seed, numbers, count)


@lru_cache(maxsize=4)
def _kept_fields(seed: int, numbers: bytes, count: int) -> np.ndarray:
    jobs = np.frombuffer(numbers, np.uint32)
    drawn = np.array(_fields(seed_key(seed), jnp.asarray(jobs), count), float)
    drawn.flags.writeable = False
    return drawn


def uniform_points(seed: int, jobs: np.ndarray, count: int) -> np.ndarray:
    """Uniform points of the unit square, float32[J, count, 2].

    Point i has a key of its own, so that the first points of a job are the same whatever the
    count.
    """
    # Drawn in blocks, so that a sweep over counts meets few shapes to compile.
    blocks = -(-count // _BLOCK) * _BLOCK
    drawn = _points(seed_key(seed), jnp.asarray(jobs, jnp.uint32), blocks)
    return np.asarray(drawn)[:, :count]


def round_uniforms(seed: int, jobs: np.ndarray, number: int, count: int, size: int) -> np.ndarray:
    """Uniform numbers in [0, 1) of one round of draws.

    Args:
        seed: of the study.
        jobs: int64[J].
        number: of the round.
        count: numbers per job.
        size: jobs that draw at once. Fewer are padded to it, so that rounds with ever fewer jobs
            compile only once.

    Returns:
        float64[J, count].
    """
    return np.asarray(_padded(_uniforms, seed, jobs, size, number, count), float)


def round_bits(
    seed: int, jobs: np.ndarray, stream: Stream, number: int, count: int, size: int
) -> list[list[int]]:
    """Whole numbers below 2**32, `count` per job, of one round of draws of a stream.

    Args:
        seed: of the study.
        jobs: int64[J].
        stream: what they are for.
        number: of the round.
        count: numbers per job.
        size: as of `round_uniforms`.

    Returns:
        For each job, `count` numbers; of Python, whose products do not overflow.
    """
    drawn: list[list[int]] = _padded(_bits, seed, jobs, size, int(stream), number, count).tolist()
    return drawn


def in_rounds(
    count: int, most: int, attempt: Callable[[np.ndarray, int], np.ndarray]
) -> np.ndarray:
    """Let those who went empty try again, round by round.

    Args:
        count: who tries in round 0: rows 0 to count - 1.
        most: rounds.
        attempt: takes int64[R], the rows still open, and the number of the round, and says which
            of them were served, bool[R].

    Returns:
        int64[...], the rows left open after the last round.
    """
    rows = np.arange(count)
    for number in range(most):
        if not len(rows):
            break
        rows = rows[~attempt(rows, number)]
    return rows


def _padded(
    draw: Callable[..., jax.Array], seed: int, jobs: np.ndarray, size: int, *which: int
) -> np.ndarray:
    """Let jobs draw, `size` at a time, the last ones padded with job 0: array[J, ...]."""
    key = seed_key(seed)
    parts = []
    for first in range(0, len(jobs), size):
        some = jobs[first : first + size]
        padded = np.zeros(size, np.uint32)
        padded[: len(some)] = some
        parts.append(np.asarray(draw(key, jnp.asarray(padded), *which))[: len(some)])
    return np.concatenate(parts)


@partial(jax.jit, static_argnums=2)
def _fields(key: jax.Array, jobs: jax.Array, count: int) -> jax.Array:
    def field(job: jax.Array) -> jax.Array:
        return jax.random.uniform(jax.random.fold_in(key, job), (count,), jnp.float32)

    return jax.vmap(field)(jobs)


@partial(jax.jit, static_argnums=2)
def _points(key: jax.Array, jobs: jax.Array, count: int) -> jax.Array:
    def point(job_key: jax.Array, number: jax.Array) -> jax.Array:
        return jax.random.uniform(jax.random.fold_in(job_key, number), (2,), jnp.float32)

    def points(job: jax.Array) -> jax.Array:
        job_key = jax.random.fold_in(key, job)
        return jax.vmap(partial(point, job_key))(jnp.arange(count, dtype=jnp.uint32))

    return jax.vmap(points)(jobs)


@partial(jax.jit, static_argnums=3)
def _uniforms(key: jax.Array, jobs: jax.Array, number: int, count: int) -> jax.Array:
    def one(job: jax.Array) -> jax.Array:
        own = jax.random.fold_in(jax.random.fold_in(key, job), number)
        return jax.random.uniform(own, (count,), jnp.float32)

    return jax.vmap(one)(jobs)


@partial(jax.jit, static_argnums=(2, 4))
def _bits(key: jax.Array, jobs: jax.Array, stream: int, number: int, count: int) -> jax.Array:
    def one(job: jax.Array) -> jax.Array:
        own = jax.random.fold_in(jax.random.fold_in(key, job), stream)
        return jax.random.bits(jax.random.fold_in(own, number), (count,), jnp.uint32)

    return jax.vmap(one)(jobs)
