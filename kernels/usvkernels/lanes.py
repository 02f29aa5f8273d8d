"""The driver for everything that ends early: searches, episodes, hunts.

A fixed set of lanes works through a queue of jobs. Lanes advance together, a chunk of steps at
a time; then those that finished write their result to its place in job order and take the next
job. Without the refill every lane would wait for the slowest of its batch.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array

Tree = Any
"""A pytree of arrays."""

LEAST_LANES = 16
"""Lanes that just fill the processor's vectors; the last jobs run in blocks of so many."""

NARROW_BELOW = 0.6
"""Share of lanes at work below which blocks cost less: a lane's step is dearer in a block."""


@dataclass(frozen=True)
class Program:
    """What a lane does. All functions are batched: lanes are the LAST axis of a state's leaves.

    Attributes:
      start: int32[lanes] job numbers -> state.
      step: state -> state, for all lanes; what it does to a finished lane is discarded. Leaves
        that it passes on untouched cost nothing.
      done: state -> bool[lanes]; must come true after some number of steps.
      result: state -> pytree of [lanes, ...] arrays (lanes first: these are rows of a table).
      taken: state -> int32[lanes], steps that advanced the job so far.
    """

    start: Callable[[Array], Tree]
    step: Callable[[Tree], Tree]
    done: Callable[[Tree], Array]
    result: Callable[[Tree], Tree]
    taken: Callable[[Tree], Array]


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Usage:
    """How the lanes spent their time; busy / total is the occupancy."""

    busy: Array  # float, lane-steps that advanced an unfinished job
    total: Array  # float, lane-steps executed


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Queue:
    state: Tree
    job: Array  # int32[lanes], the job in each lane; n_jobs or more: idle
    next_job: Array  # int32, first job not yet given out
    results: Tree  # [capacity, ...]
    usage: Usage
    waited: Array  # int32, chunks since a job last ended


def run(
    program: Program,
    n_jobs: Array | int,
    *,
    capacity: int,
    lanes: int,
    chunk: int,
    max_steps: int,
    refill: bool = True,
    narrow: bool = True,
) -> tuple[Tree, Usage]:
    """Run jobs 0 .. n_jobs - 1 and return their results in job order.

    Args:
      program: what a lane does.
      n_jobs: number of jobs, from 1 to `capacity`; may be traced.
      capacity: rows of the result, static.
      lanes: jobs under way at a time, static.
      chunk: steps between two refills, static.
      max_steps: steps after which any job is done, static; bounds the loop.
      refill: False gives out new jobs only when all lanes have finished (for comparison).
      narrow: when the queue is empty and many lanes idle, gather the jobs under way in small blocks
        of lanes; lengths are heavy-tailed, and the last jobs would otherwise pay for all lanes.
        Compiles the step a second time, for that width.

    Returns:
      The results, leaves [capacity, ...] with rows from n_jobs on zero, and the lanes' usage.
    """
    n_jobs = jnp.asarray(n_jobs, jnp.int32)
    job = jnp.arange(lanes, dtype=jnp.int32)
    state = program.start(jnp.minimum(job, n_jobs - 1))
    row = jax.eval_shape(program.result, state)
    queue = _Queue(
        state=state,
        job=job,
        next_job=jnp.int32(lanes),
        results=jax.tree.map(lambda a: jnp.zeros((capacity, *a.shape[1:]), a.dtype), row),
        usage=Usage(busy=jnp.float32(0), total=jnp.float32(0)),
        waited=jnp.int32(0),
    )
    drain = narrow and refill
    queue = _work(program, queue, n_jobs, chunk, max_steps, refill, to_the_end=not drain)
    if drain:
        queue = _drain(program, queue, n_jobs, chunk, max_steps)
    return queue.results, queue.usage


def _work(
    program: Program,
    queue: _Queue,
    n_jobs: Array,
    chunk: int,
    max_steps: int,
    refill: bool,
    to_the_end: bool,
) -> _Queue:
    """Work in all lanes until the queue is empty and many of them idle, or to the very end."""
    lanes = queue.job.shape[0]
    # Reached only if `done` never comes true: some job ends within the chunks of the longest.
    bound = -(-max_steps // chunk) + 1

    def unfinished(queue: _Queue) -> Array:
        busy = queue.job < n_jobs
        wanted = jnp.any(busy) if to_the_end else jnp.sum(busy) >= NARROW_BELOW * lanes
        return wanted & (queue.waited < bound)

    def turn(queue: _Queue) -> _Queue:
        state = _advance(program, queue.state, chunk)
        ended = program.done(state) & (queue.job < n_jobs)
        results = _written(queue.results, program.result(state), queue.job, ended)
        take = ended if refill else ended & jnp.all(ended | (queue.job >= n_jobs))
        given = queue.next_job + jnp.cumsum(take, dtype=jnp.int32) - 1
        job = jnp.where(take, given, queue.job)
        fresh = program.start(jnp.minimum(job, n_jobs - 1))
        return _Queue(
            state=keep(~take | (job >= n_jobs), state, fresh),
            job=job,
            next_job=queue.next_job + jnp.sum(take, dtype=jnp.int32),
            results=results,
            usage=_used(program, queue, state, n_jobs, chunk * lanes),
            waited=jnp.where(jnp.any(ended), 0, queue.waited + 1),
        )

    return jax.lax.while_loop(unfinished, turn, queue)


def _drain(program: Program, queue: _Queue, n_jobs: Array, chunk: int, max_steps: int) -> _Queue:
    """Finish the jobs that are under way, a block of lanes after the other.

    Lengths are heavy-tailed. Blocks that hold no job cost nothing, and before each chunk the
    unfinished jobs gather in the first of them.
    """
    lanes = queue.job.shape[0]
    width = min(lanes, LEAST_LANES)
    if lanes % width:
        idle = width - lanes % width
        state = jax.tree.map(lambda a: jnp.concatenate([a, a[..., :idle]], axis=-1), queue.state)
        job = jnp.concatenate([queue.job, jnp.broadcast_to(n_jobs, idle)])
        queue = replace(queue, state=state, job=job)
    bound = -(-max_steps // chunk) + 1

    def unfinished(queue: _Queue) -> Array:
        return jnp.any(queue.job < n_jobs) & (queue.waited < bound)

    def turn(queue: _Queue) -> _Queue:
        order = jnp.argsort(queue.job >= n_jobs, stable=True)
        gathered = jax.tree.map(lambda leaf: jnp.take(leaf, order, axis=-1), queue.state)
        queue = replace(queue, state=gathered, job=queue.job[order])
        job = queue.job
        blocks = -(-jnp.sum(job < n_jobs, dtype=jnp.int32) // width)

        def advance(block: Array, state: Tree) -> Tree:
            part = jax.tree.map(lambda leaf: _block(leaf, block, width), state)
            part = _advance(program, part, chunk)
            return jax.tree.map(partial(_put_block, block=block), state, part)

        state = jax.lax.fori_loop(0, blocks, advance, queue.state)
        ended = program.done(state) & (job < n_jobs)
        return _Queue(
            state=state,
            job=jnp.where(ended, n_jobs, job),
            next_job=queue.next_job,
            results=_written(queue.results, program.result(state), job, ended),
            usage=_used(program, queue, state, n_jobs, blocks * chunk * width),
            waited=jnp.where(jnp.any(ended), 0, queue.waited + 1),
        )

    return jax.lax.while_loop(unfinished, turn, queue)


def _block(leaf: Array, block: Array, width: int) -> Array:
    return jax.lax.dynamic_slice_in_dim(leaf, block * width, width, axis=-1)


def _put_block(leaf: Array, part: Array, block: Array) -> Array:
    at = block * part.shape[-1]
    return jax.lax.dynamic_update_slice_in_dim(leaf, part, at, axis=-1)


def _written(results: Tree, rows: Tree, job: Array, ended: Array) -> Tree:
    """Results with the rows of the jobs that ended at their places."""
    capacity = jax.tree.leaves(results)[0].shape[0]
    place = jnp.where(ended, job, capacity)
    return jax.tree.map(lambda out, new: out.at[place].set(new, mode="drop"), results, rows)


def record(
    program: Program, jobs: Array, steps: int, observe: Callable[[Tree], Tree]
) -> tuple[Tree, Tree]:
    """Run one job per lane for a fixed number of steps and keep what `observe` sees.

    Args:
      program: what a lane does.
      jobs: int32[lanes].
      steps: static.
      observe: state -> pytree of arrays, called on the first state and after each step; a
        finished lane repeats its last state.

    Returns:
      The results [lanes, ...] and the observations [steps + 1, ...].
    """
    first = program.start(jobs)

    def advance(state: Tree, _: None) -> tuple[Tree, Tree]:
        state = keep(program.done(state), state, program.step(state))
        return state, observe(state)

    last, seen = jax.lax.scan(advance, first, None, length=steps)
    seen = jax.tree.map(lambda a, b: jnp.concatenate([a[None], b]), observe(first), seen)
    return program.result(last), seen


def keep(mask: Array, old: Tree, new: Tree) -> Tree:
    """Per lane: the old state where `mask` bool[lanes], else the new one."""
    return jax.tree.map(lambda a, b: a if a is b else jnp.where(mask, a, b), old, new)


def _advance(program: Program, state: Tree, chunk: int) -> Tree:
    """Advance all lanes by a chunk."""

    def advance(_: Array, state: Tree) -> Tree:
        return keep(program.done(state), state, program.step(state))

    return jax.lax.fori_loop(0, chunk, advance, state)


def _used(
    program: Program, queue: _Queue, state: Tree, n_jobs: Array, executed: Array | int
) -> Usage:
    """The usage after `executed` lane-steps that led from the queue's state to `state`."""
    advanced = program.taken(state) - program.taken(queue.state)
    busy = jnp.sum(jnp.where(queue.job < n_jobs, advanced, 0))
    return Usage(busy=queue.usage.busy + busy, total=queue.usage.total + executed)
