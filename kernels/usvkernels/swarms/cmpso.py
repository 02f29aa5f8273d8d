"""Chaos multi-population particle swarm optimisation.

Yu et al. 2022 print the inertia and both learning factors, and refer to Liu et al. 2018 (Chinese
Automation Congress) for the rest. Assumed here: sub-swarms of equal size, each led by its own
best; positions that begin on logistic maps z -> 4 z (1 - z), one per coordinate; every few
iterations the sub-swarms share the best of all, and the worst particle of each goes on to the next
point of the map; speeds limited to a share of the range. Source of the swarm: Shi and Eberhart
1998.
"""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels import draws
from usvkernels.swarms.pack import (
    Box,
    Found,
    Objective,
    better,
    evaluate,
    first_record,
    numbers,
)

_MARGIN = 1e-6  # the map stays at 0 and at 1 once it is there


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class CmpsoParams:
    """Each a number or float[R], one per run.

    Attributes:
        inertia: omega.
        cognitive: c1, pull of a particle's own best.
        social: c2, pull of its sub-swarm's best.
        max_speed: per iteration, as a share of the range, above 0.
    """

    inertia: float | Array = 0.4  # section 5.1
    cognitive: float | Array = 2.0  # section 5.1
    social: float | Array = 2.0  # section 5.1
    max_speed: float | Array = 0.1  # not printed, nor are the next two; they do well on Sphere


@dataclass(frozen=True)
class CmpsoStatic:
    """Choices of method.

    Attributes:
        swarms: sub-swarms; the population is a multiple.
        exchange: iterations from one exchange to the next.
    """

    swarms: int = 2
    exchange: int = 5


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Particles:
    x: Array  # float[n, dim, R]
    velocity: Array  # float[n, dim, R]
    own: Array  # float[n, dim, R], best of each
    own_value: Array  # float[n, R]
    lead: Array  # float[swarms, dim, R]
    chaos: Array  # float[dim, R], in (0, 1)


def run(
    fn: Objective,
    box: Box,
    seed: Array,
    params: CmpsoParams,
    static: CmpsoStatic,
    *,
    population: int,
    iterations: int,
) -> Found:
    """Minimise fn in R runs; population * iterations evaluations each.

    Args:
        fn: the function.
        box: its bounds; positions are clipped to them.
        seed: uint32[2, R].
        params: leaves float or float[R].
        static: choices of method.
        population: particles, a multiple of `static.swarms`.
        iterations: T, the first evaluation included.

    Returns:
        What was found.
    """

    def step(carry: tuple, time: Array) -> tuple[tuple, Array]:
        particles, record = carry
        particles = _moved(particles, box, params, static, seed, time)
        value, nans = evaluate(fn, particles.x)
        record = better(record, value, particles.x, nans)
        particles = _remembered(particles, value, static)
        exchange = time % static.exchange == 0
        particles = _exchanged(particles, record.x, box, static, exchange)
        return (particles, record), record.best

    x, chaos = _chaotic(seed, box, population)
    value, nans = evaluate(fn, x)
    record = first_record(value, x, nans)
    begun = _Particles(
        x=x,
        velocity=jnp.zeros_like(x),
        own=x,
        own_value=value,
        lead=_leaders(x, value, static.swarms),
        chaos=chaos,
    )
    carry, history = lax.scan(step, (begun, record), jnp.arange(1, iterations))
    history = jnp.concatenate([record.best[None], history])
    return Found(carry[1].best, carry[1].x, history, carry[1].nans)


def logistic(z: Array) -> Array:
    """The next point of the logistic map at its most chaotic, kept off its ends."""
    return jnp.clip(4 * z * (1 - z), _MARGIN, 1 - _MARGIN)


def _chaotic(seed: Array, box: Box, members: int) -> tuple[Array, Array]:
    """Positions float[n, dim, R] along the maps, and the maps' next points float[dim, R]."""
    dim, dtype = box.low.shape[0], box.low.dtype
    start = draws.uniform(numbers(seed, 0, (dim,))[0], dtype)

    def advance(z: Array, _: None) -> tuple[Array, Array]:
        return logistic(z), z

    chaos, points = lax.scan(advance, logistic(start), None, length=members)
    return box.low + (box.high - box.low) * points, chaos


def _moved(
    particles: _Particles,
    box: Box,
    params: CmpsoParams,
    static: CmpsoStatic,
    seed: Array,
    time: Array,
) -> _Particles:
    x, dtype = particles.x, particles.x.dtype
    first, second, _, _ = numbers(seed, time, x.shape[:2])
    lead = jnp.repeat(particles.lead, x.shape[0] // static.swarms, axis=0)
    cognitive, social = (jnp.asarray(c, dtype) for c in (params.cognitive, params.social))
    velocity = (
        jnp.asarray(params.inertia, dtype) * particles.velocity
        + cognitive * draws.uniform(first, dtype) * (particles.own - x)
        + social * draws.uniform(second, dtype) * (lead - x)
    )
    most = jnp.asarray(params.max_speed, dtype) * (box.high - box.low)
    velocity = jnp.clip(velocity, -most, most)
    return replace(particles, x=jnp.clip(x + velocity, box.low, box.high), velocity=velocity)


def _remembered(particles: _Particles, value: Array, static: CmpsoStatic) -> _Particles:
    """Each particle's own best, and each sub-swarm's."""
    new = value < particles.own_value
    own = jnp.where(new[:, None], particles.x, particles.own)
    own_value = jnp.where(new, value, particles.own_value)
    lead = _leaders(own, own_value, static.swarms)
    return replace(particles, own=own, own_value=own_value, lead=lead)


def _leaders(own: Array, own_value: Array, swarms: int) -> Array:
    """Best position of each sub-swarm, float[swarms, dim, R]."""
    grouped = own_value.reshape(swarms, -1, own_value.shape[-1])
    index = jnp.argmin(grouped, axis=1)
    groups = own.reshape(swarms, -1, *own.shape[1:])
    return jnp.take_along_axis(groups, index[:, None, None], axis=1)[:, 0]


def _exchanged(
    particles: _Particles, best: Array, box: Box, static: CmpsoStatic, now: Array
) -> _Particles:
    """Where `now`: all follow the best of all, and the worst of each sub-swarm starts again."""
    swarms = static.swarms
    lead = jnp.where(now, best, particles.lead)
    grouped = particles.own_value.reshape(swarms, -1, particles.own_value.shape[-1])
    size = grouped.shape[1]
    worst = jnp.argmax(grouped, axis=1)
    here = (jnp.arange(size)[:, None] == worst[:, None]).reshape(-1, worst.shape[-1])
    point = box.low + (box.high - box.low) * particles.chaos
    leaves = (here & now)[:, None]
    return replace(
        particles,
        x=jnp.where(leaves, point, particles.x),
        velocity=jnp.where(leaves, 0, particles.velocity),
        lead=lead,
        chaos=jnp.where(now, logistic(particles.chaos), particles.chaos),
    )
