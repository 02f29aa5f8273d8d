"""The eight moves from a cell and which of them are open."""

import jax.numpy as jnp
from jax import Array

MOVES = ((1, 0), (0, -1), (-1, 0), (0, 1), (1, -1), (-1, -1), (-1, 1), (1, 1))
"""(dx, dy); the first four are straight."""

OPPOSITE = (2, 3, 0, 1, 6, 7, 4, 5)
"""The move that undoes each."""


def open_moves(blocked: Array) -> Array:
    """Which moves are open from each cell; a diagonal one needs both cells beside it free.

    Args:
        blocked: bool[H, W].

    Returns:
        bool[8, (H + 2) * (W + 2)], cells row by row of the map with a blocked margin.
    """
    free = jnp.pad(~blocked, 1).reshape(-1)
    stride = blocked.shape[1] + 2

    def at(dx: int, dy: int) -> Array:
        return jnp.roll(free, -(dy * stride + dx))

    return jnp.stack([free & at(dx, dy) & at(dx, 0) & at(0, dy) for dx, dy in MOVES])
