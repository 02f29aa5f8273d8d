"""Ant colony optimisation of a path between two cells of a grid, several queries side by side.

In every iteration each ant walks from the start, one free neighbour at a time, never to a cell
where it has been: to neighbour j of cell i with a probability in proportion to

    tau_ij ** alpha * eta_j ** beta,   eta_j = 1 / (distance in a straight line from j to the goal)

until it is at the goal or has nowhere to go, in which case it leaves nothing. Then pheromone
evaporates, tau <- (1 - rho) tau, and each ant that arrived adds q / length to the edges of its
path, in both directions. Source: Dorigo's ant system on a grid graph, as Yu et al. 2022, section
5.1 use it in their Algorithm 1; they print alpha, beta, rho, q and the numbers of ants and of
iterations. Assumed: tau = 1 at first, pheromone on undirected edges, no elitist ants.
"""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax
from jax.typing import DTypeLike

from usvkernels.planners.ants import CHUNK, AcoQueries, AcoStatic, Walk, walked
from usvkernels.planners.moves import MOVES, OPPOSITE, open_moves

AT_GOAL = 0.1  # cells, the distance that stands for none: an ant beside the goal goes there
LEAST_PHEROMONE = 1e-30  # evaporation never closes an edge for good


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class AcoParams:
    """Numbers, or arrays of no dimension; of Yu et al. 2022, section 5.1, by default."""

    alpha: Array | float = 1.0  # weight of pheromone
    beta: Array | float = 5.0  # weight of nearness
    rho: Array | float = 0.1  # share of pheromone that evaporates in an iteration
    q: Array | float = 1.0  # pheromone that an ant has for its path, cells


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class AcoPlans:
    """The shortest walk of all iterations."""

    length: Array  # float[queries], cells; inf where no ant arrived
    steps: Array  # int32[queries], moves of the walk
    move: Array  # int8[queries, max_steps], index into `moves.MOVES`; what follows is undefined
    history: Array  # float[queries, iterations], the shortest so far


def plan(static: AcoStatic, params: AcoParams, queries: AcoQueries, count: Array) -> AcoPlans:
    """Plan the first `count` queries.

    Args:
        static: sizes.
        params: of the method.
        queries: checked; start and goal differ and are free.
        count: int32, 1 or more; may be traced.
    """
    dtype = jnp.result_type(float)
    attraction = _attraction(static, params, queries, dtype)
    places = static.queries * static.size
    none = jnp.full(static.queries, jnp.inf, dtype)
    plans = AcoPlans(
        length=none,
        steps=jnp.zeros(static.queries, jnp.int32),
        move=jnp.zeros((static.queries, static.max_steps), jnp.int8),
        history=jnp.zeros((static.queries, static.iterations), dtype),
    )
    record = jnp.zeros(static.rows * static.lanes, jnp.int32)

    def iterate(i: Array, carry: tuple[Array, Array, AcoPlans]) -> tuple[Array, Array, AcoPlans]:
        pheromone, record, plans = carry
        weight = lax.cond(
            params.alpha == 1.0, lambda tau: tau, lambda tau: tau**params.alpha, pheromone
        )
        walk = walked(static, queries, count, i, weight * attraction, record)
        length = _lengths(static, walk, dtype)
        pheromone = (1.0 - params.rho) * pheromone + params.q * _deposits(static, walk, length)
        pheromone = jnp.maximum(pheromone, LEAST_PHEROMONE).astype(dtype)
        plans = _better(static, plans, walk, length)
        history = lax.dynamic_update_index_in_dim(plans.history, plans.length, i, axis=1)
        return pheromone, walk.log.record, replace(plans, history=history)

    pheromone = jnp.ones((places, 8), dtype)
    return lax.fori_loop(0, static.iterations, iterate, (pheromone, record, plans))[2]


def _attraction(
    static: AcoStatic, params: AcoParams, queries: AcoQueries, dtype: DTypeLike
) -> Array:
    """(eta_j / eta_i) ** beta of the open edges, 0 of the others: float[places, 8].

    The division by eta_i changes no probability and keeps the powers in range.
    """
    cell = jnp.arange(static.size)
    y, x = jnp.divmod(cell, static.stride)

    def of_query(blocked: Array, goal: Array) -> Array:
        goal_y, goal_x = jnp.divmod(goal, static.stride)
        squared = jnp.square(x - goal_x) + jnp.square(y - goal_y)
        distance = jnp.maximum(jnp.sqrt(squared.astype(dtype)), AT_GOAL)
        is_open = open_moves(blocked)
        edges = []
        for k, (dx, dy) in enumerate(MOVES):
            nearer = distance / jnp.roll(distance, -(dy * static.stride + dx))
            edges.append(jnp.where(is_open[k], nearer**params.beta, 0.0))
        return jnp.stack(edges, axis=-1)

    found = jax.vmap(of_query)(queries.blocked, queries.goal)
    return found.reshape(-1, 8).astype(dtype)


def _lengths(static: AcoStatic, walk: Walk, dtype: DTypeLike) -> Array:
    """Lengths of the walks that arrived, inf of the others: float[ants, queries]."""
    steps, diagonals = walk.ends[:, 0], walk.ends[:, 1]
    cells = (steps - diagonals).astype(dtype) + diagonals.astype(dtype) * 2**0.5
    return jnp.where(steps > 0, cells, jnp.inf).reshape(static.ants, static.queries)


def _deposits(static: AcoStatic, walk: Walk, length: Array) -> Array:
    """Sum of 1 / length over the walks that used an edge: float[places, 8]."""
    amount = jnp.round(static.deposit / length).astype(jnp.int32).reshape(-1)
    amount = jnp.append(amount, 0)
    edges = static.queries * static.size * 8
    offset = jnp.array([dy * static.stride + dx for dx, dy in MOVES], jnp.int32)
    opposite = jnp.array(OPPOSITE, jnp.int32)

    def add(chunk: Array, total: Array) -> Array:
        given = amount[walk.log.owner[chunk]]

        def add_row(i: Array, total: Array) -> Array:
            begin = (chunk * CHUNK + i) * static.lanes
            edge = lax.dynamic_slice(walk.log.record, (begin,), (static.lanes,))
            move = edge & 7
            back = jnp.where(edge < edges, ((edge >> 3) + offset[move]) * 8 + opposite[move], edges)
            total = total.at[edge].add(given, mode="drop")
            return total.at[back].add(given, mode="drop")

        return lax.fori_loop(0, jnp.where(jnp.any(given > 0), CHUNK, 0), add_row, total)

    total = lax.fori_loop(0, walk.log.time // CHUNK, add, jnp.zeros(edges, jnp.int32))
    return total.reshape(-1, 8).astype(length.dtype) / static.deposit


def _better(static: AcoStatic, plans: AcoPlans, walk: Walk, length: Array) -> AcoPlans:
    """Keep the iteration's shortest walk where it beats all before."""
    ant = jnp.argmin(length, axis=0).astype(jnp.int32)
    best = jnp.min(length, axis=0)
    improved = best < plans.length
    query = jnp.arange(static.queries, dtype=jnp.int32)
    steps, _, began, slot = walk.ends[ant * static.queries + query].T
    row = jnp.minimum(
        began[:, None] + jnp.arange(static.max_steps, dtype=jnp.int32), static.rows - 1
    )
    move = (walk.log.record[row * static.lanes + slot[:, None]] & 7).astype(jnp.int8)
    return replace(
        plans,
        length=jnp.where(improved, best, plans.length),
        steps=jnp.where(improved, steps, plans.steps),
        move=jnp.where(improved[:, None], move, plans.move),
    )
