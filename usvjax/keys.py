"""Keys of random numbers, from seeds or from JAX's own."""

from typing import Any

import jax
import numpy as np

from usvjax.ambient import GENERATOR
from usvjax.checks import shown, whole_number
from usvjax.errors import BadInputError, BadTypeError


def seed_key(seed: int) -> jax.Array:
    """The threefry key that JAX, as it is by default, makes of a seed from 0 to 2**32 - 1.

    Made of its two words, so that it depends neither on JAX's default generator nor on the offset
    that JAX adds to seeds where jax_random_seed_offset is set.
    """
    words: Any = np.array([0, seed], np.uint32)
    return jax.random.wrap_key_data(words, impl=GENERATOR)


def as_key(key: Any) -> jax.Array:
    """A JAX key from what a user gives for one.

    Args:
        key: a seed (integer from 0 to 2**32 - 1) or a JAX threefry key, typed or uint32[2].

    Raises:
        BadTypeError: neither.
        BadInputError: a seed that does not fit 32 bits, several keys, or one of another kind.
    """
    if isinstance(key, jax.Array) and key.ndim > 0 and key.dtype == np.uint32:
        if key.shape != (2,):
            raise BadInputError(f"key: got shape {key.shape}; wanted one threefry key, uint32[2]")
        return jax.random.wrap_key_data(key, impl=GENERATOR)
    if isinstance(key, jax.Array) and jax.dtypes.issubdtype(key.dtype, jax.dtypes.prng_key):
        return _checked_key(key)
    if isinstance(key, bool) or not isinstance(key, int | np.integer):
        raise BadTypeError(f"key: got {shown(key)}; wanted an integer seed or a JAX key")
    if not 0 <= key < 2**32:
        raise BadInputError(f"key: got {shown(key)}; wanted a seed from 0 to 2**32 - 1")
    return seed_key(int(key))


def _checked_key(key: jax.Array) -> jax.Array:
    if key.shape != ():
        raise BadInputError(f"key: got an array of shape {key.shape}; wanted one key")
    kind = str(jax.random.key_impl(key))
    if kind != GENERATOR:
        # A batch of keys of the other kinds does not draw each key's own stream.
        raise BadInputError(f"key: got a {kind!r} key; wanted {GENERATOR!r}, the JAX default")
    return key


def first_run(first: Any, count: int) -> int:
    """Number of the first of `count` runs, each of which has a part of the key.

    Raises:
        BadTypeError: not a whole number.
        BadInputError: below 0, or so high that a run's number exceeds 31 bits.
    """
    first = whole_number("first", first, 0)
    if first + count > 2**31:
        raise BadInputError(f"first + runs: got {first} + {count}; wanted at most 2**31")
    return first
