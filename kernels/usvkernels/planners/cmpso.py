"""Chaos multi-population particle swarms for paths on a grid, several queries side by side.

A particle's coordinates are the columns of way points at equal distances along the axis on which
start and goal are farther apart. Straight lines join them; where a line meets blocked cells the
path goes along them to the nearest opening (`rows.thread`), which costs length. A particle's value
is the length of its path.

Yu et al. 2022, section 5.1 print the inertia and both learning factors for their Algorithm 3 and
refer to Liu et al. 2018 (Chinese Automation Congress) for the rest. Assumed: four sub-swarms, each
led by its own best; positions that begin on logistic maps z -> 4 z (1 - z), one per coordinate;
every 10 iterations the sub-swarms share the best of all, and the worst particle of each goes on to
the next point of the map; speeds up to a fifth of the range, which is the map; 3 way points,
which gave shorter paths than 5 and 8; numbers of particles and of iterations.
"""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax
from jax.typing import DTypeLike

from usvkernels.draws import uniform, words
from usvkernels.planners.rows import (
    Frame,
    RowPlans,
    RowQueries,
    frame,
    length_of,
    measure,
    thread,
)

SWARMS = 4
EXCHANGE = 10
"""Iterations from one exchange between the sub-swarms to the next."""

FRACTION = 256
"""Parts of a column in which lines are followed: whole numbers, the same on every machine."""

_MARGIN = 1e-6  # the map stays at 0 and at 1 once it is there


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class CmpsoParams:
    """Numbers, or arrays of no dimension; of Yu et al. 2022, section 5.1, but for the last."""

    inertia: Array | float = 0.4  # omega
    cognitive: Array | float = 2.0  # c1, pull of a particle's own best
    social: Array | float = 2.0  # c2, pull of its sub-swarm's best
    max_speed: Array | float = 0.2  # per iteration, as a share of the range


@dataclass(frozen=True)
class CmpsoStatic:
    """Sizes."""

    rows: int  # of a frame, more than lie between any start and goal
    population: int  # a multiple of SWARMS
    iterations: int
    waypoints: int = 3


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Particles:
    """Of all queries; lane q * population + i is particle i of query q, columns in [0, width)."""

    x: Array  # float[D, L]
    velocity: Array  # float[D, L]
    own: Array  # float[D, L], each particle's best
    own_length: Array  # float[L]
    lead: Array  # float[D, L], best of its sub-swarm
    chaos: Array  # float[D, Q], in (0, 1)


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Best:
    x: Array  # float[D, Q]
    exits: Array  # int32[R, Q]
    length: Array  # float[Q]


def plan(static: CmpsoStatic, params: CmpsoParams, queries: RowQueries) -> RowPlans:
    """Plan all queries; start and goal differ and are free."""
    place = frame(queries, static.rows, static.population)
    dtype = jnp.result_type(float)
    count = len(queries.blocked)
    particles = _chaotic(static, place, queries.seed, dtype)
    best = _Best(
        x=jnp.zeros((static.waypoints, count), dtype),
        exits=jnp.zeros((static.rows, count), jnp.int32),
        length=jnp.full(count, jnp.inf, dtype),
    )
    history = jnp.zeros((static.iterations, count), dtype)

    def iterate(
        time: Array, carry: tuple[_Particles, _Best, Array]
    ) -> tuple[_Particles, _Best, Array]:
        particles, best, history = carry
        exits, alive = thread(place, _lines(static, place, particles.x))
        length = length_of(measure(place, exits), alive, dtype)
        best = _better(static, best, particles.x, exits, length)
        particles = _remembered(static, particles, length)
        particles = _exchanged(static, place, particles, best, (time + 1) % EXCHANGE == 0)
        history = lax.dynamic_update_index_in_dim(history, best.length, time, axis=0)
        return _moved(static, params, place, particles, time), best, history

    carry = (particles, best, history)
    _, best, history = lax.fori_loop(0, static.iterations, iterate, carry)
    spread = jnp.repeat(best.exits, static.population, axis=1)
    joins = measure(place, spread).joins[:, :: static.population]
    return RowPlans(best.exits, joins, best.length, history)


def _logistic(z: Array) -> Array:
    """The next point of the logistic map at its most chaotic, kept off its ends."""
    return jnp.clip(4 * z * (1 - z), _MARGIN, 1 - _MARGIN)


def _chaotic(static: CmpsoStatic, place: Frame, seed: Array, dtype: DTypeLike) -> _Particles:
    """Particles along the maps, a point of each map for each."""
    index = jnp.arange(static.waypoints, dtype=jnp.int32)[:, None]
    start = uniform(words(seed[:, None], 0, index)[0], dtype)

    def advance(z: Array, _: None) -> tuple[Array, Array]:
        return _logistic(z), z

    chaos, points = lax.scan(advance, _logistic(start), None, length=static.population)
    points = jnp.moveaxis(points, 0, -1).reshape(static.waypoints, -1)
    x = points * place.width
    return _Particles(
        x=x,
        velocity=jnp.zeros_like(x),
        own=x,
        own_length=jnp.full(x.shape[1], jnp.inf, dtype),
        lead=x,
        chaos=chaos,
    )


def _lines(static: CmpsoStatic, place: Frame, x: Array) -> Array:
    """Columns int32[R, L] in which the lines through way points float[D, L] enter the next row."""
    ends = [FRACTION * column + FRACTION // 2 for column in (place.first, place.last)]
    knots = jnp.concatenate([ends[0][None], (x * FRACTION).astype(jnp.int32), ends[1][None]])
    row = jnp.minimum(jnp.arange(static.rows, dtype=jnp.int32)[:, None] + 1, place.rows)
    pieces = static.waypoints + 1
    piece = jnp.minimum(row * pieces // place.rows, pieces - 1)
    along = row * pieces - piece * place.rows
    lane = jnp.arange(x.shape[1], dtype=jnp.int32)
    begin, end = knots[piece, lane], knots[piece + 1, lane]
    return (begin + (end - begin) * along // place.rows) // FRACTION


def _moved(
    static: CmpsoStatic, params: CmpsoParams, place: Frame, particles: _Particles, time: Array
) -> _Particles:
    x, dtype = particles.x, particles.x.dtype
    member = jnp.arange(x.shape[1], dtype=jnp.int32) % static.population
    index = jnp.arange(static.waypoints, dtype=jnp.int32)[:, None] * static.population + member
    first, second, *_ = words(place.seed[:, None], time + 1, index)
    velocity = (
        params.inertia * particles.velocity
        + params.cognitive * uniform(first, dtype) * (particles.own - x)
        + params.social * uniform(second, dtype) * (particles.lead - x)
    )
    most = params.max_speed * place.width
    velocity = jnp.clip(velocity, -most, most).astype(dtype)
    farthest = place.width - jnp.asarray(1 / FRACTION, dtype)
    return replace(particles, x=jnp.clip(x + velocity, 0, farthest), velocity=velocity)


def _remembered(static: CmpsoStatic, particles: _Particles, length: Array) -> _Particles:
    """Each particle's own best, and each sub-swarm's."""
    new = length < particles.own_length
    own = jnp.where(new, particles.x, particles.own)
    own_length = jnp.where(new, length, particles.own_length)
    size = static.population // SWARMS
    index = jnp.argmin(own_length.reshape(-1, size), axis=1).astype(jnp.int32)
    lane = jnp.repeat(jnp.arange(len(index), dtype=jnp.int32) * size + index, size)
    return replace(particles, own=own, own_length=own_length, lead=jnp.take(own, lane, axis=1))


def _exchanged(
    static: CmpsoStatic, place: Frame, particles: _Particles, best: _Best, now: Array
) -> _Particles:
    """Where `now`: all follow the best of all, and the worst of each sub-swarm starts again."""
    size = static.population // SWARMS
    index = jnp.argmax(particles.own_length.reshape(-1, size), axis=1).astype(jnp.int32)
    worst = jnp.repeat(index, size) == jnp.arange(len(place.base), dtype=jnp.int32) % size
    leaves = worst & now
    shared, point = (jnp.repeat(a, static.population, axis=1) for a in (best.x, particles.chaos))
    found = jnp.repeat(jnp.isfinite(best.length), static.population)
    return replace(
        particles,
        x=jnp.where(leaves, point * place.width, particles.x),
        velocity=jnp.where(leaves, 0, particles.velocity),
        lead=jnp.where(now & found, shared, particles.lead),
        chaos=jnp.where(now, _logistic(particles.chaos), particles.chaos),
    )


def _better(static: CmpsoStatic, best: _Best, x: Array, exits: Array, length: Array) -> _Best:
    """Take the shortest path of each query where it beats all before."""
    grouped = length.reshape(-1, static.population)
    index = jnp.argmin(grouped, axis=1).astype(jnp.int32)
    lane = jnp.arange(len(index), dtype=jnp.int32) * static.population + index
    found = _Best(x=x[:, lane], exits=exits[:, lane], length=length[lane])
    new = found.length < best.length
    return jax.tree.map(lambda a, b: jnp.where(new, a, b), found, best)
