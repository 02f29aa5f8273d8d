"""Iterated local search: descend by 2-opt and Or-opt, kick, descend again, and begin anew.

Each run is at its own place: in every iteration it makes its best move if it has one, and else,
at a local optimum, keeps or drops what it found and goes on from a double bridge of what it keeps
or, after `patience` vain kicks, from a new random tour. So no run waits for another.

Source: Lourenco, Martin and Stutzle 2003, Iterated local search; Or 1976; Croes 1958; Martin, Otto
and Felten 1991 (double bridge).
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels import draws
from usvkernels.tours.lengths import rank_of
from usvkernels.tours.moves import Move, apply, best_move
from usvkernels.xla.stage import stage

LONGEST_KICK = 30
"""Stations in each of the three parts that a kick moves, at most; a fourth of the tour too."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class IlsParams:
    """Numbers of the search; each a number or int32[R], one per run.

    Attributes:
        patience: kicks in a row that find nothing better before a run begins anew; 0 is multi-start
            without kicks, -1 takes 0 up to 24 stations and twice their number beyond.
    """

    patience: int | Array = -1


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _State:
    order: Array  # int32[d, R], under way
    held: Array  # int32[d, R], local optimum that kicks start from
    held_length: Array  # float[R]
    best: Array  # int32[d, R]
    best_length: Array  # float[R]
    vain: Array  # int32[R], kicks since held became shorter


def run(
    distances: Array, seed: Array, params: IlsParams, *, iterations: int, symmetric: bool
) -> tuple[Array, Array]:
    """Search; each run on its own.

    Args:
        distances: float[d, d] or float[d, d, R], finite.
        seed: uint32[2, R].
        params: leaves numbers or int32[R].
        iterations: moves and kicks together, T.
        symmetric: whether distances are the same in both directions.

    Returns:
        int32[d, R], the shortest closed tours; float[T, R], their lengths so far.
    """
    count = distances.shape[0]
    patience = jnp.asarray(params.patience)
    patience = jnp.where(patience < 0, 0 if count <= 24 else 2 * count, patience)

    def step(state: _State, time: Array) -> tuple[_State, Array]:
        go = time > 0
        length, improving, move = best_move(distances, state.order, symmetric=symmetric)
        best = length < state.best_length
        best_length = jnp.minimum(length, state.best_length)
        shorter = length < state.held_length
        held = jnp.where(~improving & shorter, state.order, state.held)
        held_length = jnp.where(
            improving, state.held_length, jnp.minimum(length, state.held_length)
        )
        vain = jnp.where(improving, state.vain, jnp.where(shorter, 0, state.vain + 1))
        anew = ~improving & (vain >= patience)
        kicked = _chosen(improving, move, _double_bridge(seed, time, count))
        order = stage(go, apply, jnp.where(improving, state.order, held), kicked)
        fresh = stage(go, rank_of, stage(go, partial(_keys, count=count), seed, time))
        state = _State(
            order=jnp.where(anew, fresh, order),
            held=held,
            held_length=jnp.where(anew, jnp.inf, held_length),
            best=jnp.where(best, state.order, state.best),
            best_length=best_length,
            vain=jnp.where(anew, 0, vain),
        )
        return state, best_length

    first = rank_of(_keys(seed, 0, count))
    far = jnp.full(first.shape[1], jnp.inf, distances.dtype)
    state = _State(first, first, far, first, far, jnp.zeros(first.shape[1], jnp.int32))
    state, history = lax.scan(step, state, jnp.arange(1, iterations + 1))
    return state.best, history


def _keys(seed: Array, time: Array | int, count: int) -> Array:
    """Random words uint32[d, R], whose ranks are random tours."""
    four = draws.words(seed[:, None], time, jnp.arange(1, -(-count // 4) + 1)[:, None])
    return jnp.concatenate(four)[:count]


def _double_bridge(seed: Array, time: Array, count: int) -> Move:
    """Three adjacent parts of random sizes in the opposite order."""
    most = min(LONGEST_KICK, count // 4)
    words = draws.words(seed, time, 0)

    def below(word: Array, bound: int) -> Array:
        return (draws.uniform(word) * bound).astype(jnp.int32)

    first, between, last = (below(word, most) + (most > 0) for word in words[1:])
    straight = jnp.zeros(seed.shape[1], bool)
    return Move(below(words[0], count), first, between, last, straight)


def _chosen(condition: Array, one: Move, other: Move) -> Move:
    return jax.tree.map(lambda a, b: jnp.where(condition, a, b), one, other)
