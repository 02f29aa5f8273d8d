"""Tours by random keys: each station has a number, and they are visited in its order.

So a swarm that moves through float[d] searches tours (Bean 1994). The paper says no more of its
encoding than that a wolf is a row of d numbers (Yu et al. 2022, Eqs. 10 and 11). Keys lie in
[0, 1]; a tour by all d keys is turned round to begin with station 0, which changes no closed one.
"""

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.swarms import cmpso, gwo
from usvkernels.swarms.laws import GwoParams
from usvkernels.swarms.pack import Box, Found, Objective
from usvkernels.tours.lengths import length, order_of
from usvkernels.xla.stage import stage


def run_gwo(
    distances: Array,
    seed: Array,
    params: GwoParams,
    *,
    static: gwo.GwoStatic,
    iterations: int,
    population: int,
) -> tuple[Array, Array]:
    """Search by grey wolves (`swarms.gwo`).

    Args:
        distances: float[d, d] or float[d, d, R], finite.
        seed: uint32[2, R].
        params: of the law "beta"; leaves numbers or float[R].
        static: choices of method.
        iterations: T.
        population: wolves, 3 or more.

    Returns:
        int32[d, R], the shortest closed tours; float[T, R], their lengths so far.
    """
    sizes = {"population": population, "iterations": iterations}
    return _tours(gwo.run(_objective(distances), _box(distances), seed, params, static, **sizes))


def run_cmpso(
    distances: Array,
    seed: Array,
    params: cmpso.CmpsoParams,
    *,
    static: cmpso.CmpsoStatic,
    iterations: int,
    population: int,
) -> tuple[Array, Array]:
    """Search by a chaos multi-population particle swarm (`swarms.cmpso`); as `run_gwo`.

    The population is a multiple of `static.swarms`.
    """
    sizes = {"population": population, "iterations": iterations}
    return _tours(cmpso.run(_objective(distances), _box(distances), seed, params, static, **sizes))


def _box(distances: Array) -> Box:
    low = jnp.zeros((distances.shape[0], 1), distances.dtype)
    return Box(low, jnp.ones_like(low))


def _tours(found: Found) -> tuple[Array, Array]:
    return order_of(found.x), found.history


def _objective(distances: Array) -> Objective:
    """Keys float[d] to the length of their tour; over runs, each with distances of its own."""
    go = jnp.sum(distances) >= 0  # always, but a compiler does not know

    def lengths(keys: Array) -> Array:
        order = stage(go, order_of, keys)
        return stage(go, lambda order: length(distances, order), order)

    @jax.custom_batching.custom_vmap
    def fn(keys: Array) -> Array:
        own = distances if distances.ndim == 2 else distances[:, :, 0]
        return length(own, order_of(keys[:, None]))[0]

    @fn.def_vmap
    def over_runs(size: int, batched: list[bool], keys: Array) -> tuple[Array, bool]:
        del size, batched
        return lengths(jnp.moveaxis(keys, 0, -1)), True

    return fn
