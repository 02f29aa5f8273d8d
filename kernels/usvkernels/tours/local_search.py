"""Descent to a local optimum by the best move of a neighbourhood at a time."""

import jax.numpy as jnp
from jax import Array, lax

from usvkernels.tours.moves import apply, best_move


def two_opt(distances: Array, order: Array, *, symmetric: bool, most: int) -> tuple[Array, Array]:
    """Turn stretches of tours round until none makes them shorter. Source: Croes 1958.

    Args:
        distances: float[d, d] or float[d, d, R], finite.
        order: int32[d, R].
        symmetric: whether distances are the same in both directions.
        most: moves at most.

    Returns:
        int32[d, R]; int32[R], moves made: less than `most` at a local optimum.
    """
    return descend(distances, order, symmetric=symmetric, most=most, kinds="two_opt")


def or_opt(distances: Array, order: Array, *, symmetric: bool, most: int) -> tuple[Array, Array]:
    """Take up to three stations elsewhere until that makes no tour shorter; as `two_opt`.

    Source: Or 1976.
    """
    return descend(distances, order, symmetric=symmetric, most=most, kinds="or_opt")


def descend(
    distances: Array, order: Array, *, symmetric: bool, most: int, kinds: str = "both"
) -> tuple[Array, Array]:
    """Make the best of the moves of `kinds` until none makes a tour shorter; as `two_opt`."""

    def unfinished(state: tuple[Array, Array, Array]) -> Array:
        _, moves, improving = state
        return jnp.any(improving & (moves < most))

    def move(state: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        order, moves, _ = state
        _, improving, best = best_move(distances, order, symmetric=symmetric, kinds=kinds)
        goes = improving & (moves < most)
        return jnp.where(goes, apply(order, best), order), moves + goes, improving

    runs = order.shape[1]
    begun = (order, jnp.zeros(runs, jnp.int32), jnp.ones(runs, bool))
    order, moves, _ = lax.while_loop(unfinished, move, begun)
    return order, moves
