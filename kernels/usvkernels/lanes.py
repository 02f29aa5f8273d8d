"""The driver for everything that ends early: searches, replanning, cruises, ants, episodes, hunts.

A fixed set of lanes works through a queue of jobs. Lanes advance together, a chunk of steps at
a time; then those that finished write their result to its place in job order and take the next
job. Without the refill every lane would wait for the slowest of its batch.

What a lane does is a `Program`, whose small states are selected between, old or new; or, where
states hold planes too large to be touched for a lane that goes on, a program `InPlace`.
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


@dataclass(frozen=True)
class InPlace:
    """What a lane does where states hold planes: written where they lie, never selected between.

    A plane of k values per lane is flat in the last axis of a leaf, lane after lane: [lanes * k].
    All functions are batched, and work for any number of lanes.

    Attributes:
        idle: number of lanes -> state in which all are done.
        refill: (state, int32[lanes] job numbers, bool[lanes] takes) -> state in which the lanes
            that `takes` are at the start of their job; numbers of others mean nothing. Called
            before every chunk, so a job that has stages may begin the next one here. The planes of
            lanes that begin are best written one lane after the other, by a loop over those few;
            see `those`.
        step: (state, log) -> (state, log), for all lanes; leaves finished lanes as they are.
        done, taken: as in `Program`; `taken` need not begin anew with each job.
        result: as in `Program`; nothing, where the log says it all.
        log: arrays that all lanes write to step by step, each to places of its job alone; and what
            is nobody's, as a clock. It stays as it is where lanes move.
        narrowing: how many times fewer lanes the last jobs get; 1 where they stay.
    """

    idle: Callable[[int], Tree]
    refill: Callable[[Tree, Array, Array], Tree]
    step: Callable[[Tree, Tree], tuple[Tree, Tree]]
    done: Callable[[Tree], Array]
    taken: Callable[[Tree], Array]
    result: Callable[[Tree], Tree] = lambda _: ()
    log: Tree = ()
    narrowing: int = 4


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
    log: Tree  # of all lanes
    job: Array  # int32[lanes], the job in each lane; n_jobs or more: idle
    next_job: Array  # int32, first job not yet given out
    began: Array  # bool, whether a lane has just begun a job
    results: Tree  # [capacity, ...]
    usage: Usage
    waited: Array  # int32, chunks since a job last ended


@dataclass(frozen=True)
class _Plan:
    """What `run` was asked for."""

    program: Program | InPlace
    n_jobs: Array
    chunk: int
    bound: int | None  # of chunks between two jobs' ends
    refill: bool


def run(
    program: Program | InPlace,
    n_jobs: Array | int,
    *,
    capacity: int,
    lanes: int,
    chunk: int,
    max_steps: int | None = None,
    refill: bool = True,
    narrow: bool = True,
) -> tuple[Tree, Usage]:
    """Run jobs 0 .. n_jobs - 1 and return their results in job order.

    When the queue is empty and many lanes idle, the jobs under way are gathered in fewer of them:
    lengths are heavy-tailed, and the last jobs would otherwise pay for all lanes. Small states
    gather before every chunk, in blocks of lanes of which those without a job cost nothing.
    Planes are moved once, as soon as what is left fits into `InPlace.narrowing` times fewer lanes.

    Args:
        program: what a lane does.
        n_jobs: number of jobs, from 1 to `capacity`; may be traced.
        capacity: rows of the result, static.
        lanes: jobs under way at a time, static.
        chunk: steps between two refills, static.
        max_steps: steps after which any job is done, static; bounds the loop. None where the
            program's own bounds end every job.
        refill: False gives out new jobs only when all lanes have finished (for comparison).
        narrow: whether to gather the last jobs; compiles the step a second time, for that width.

    Returns:
        The results, leaves [capacity, ...] with rows from n_jobs on zero, and the lanes' usage. Of
        a
        program `InPlace` the first is a pair: the results, and its log.
    """
    n_jobs = jnp.asarray(n_jobs, jnp.int32)
    # Reached only if `done` never comes true: some job ends within the chunks of the longest.
    bound = None if max_steps is None else -(-max_steps // chunk) + 1
    plan = _Plan(program, n_jobs, chunk, bound, refill)
    queue = _first(plan, lanes, capacity)
    narrow &= refill
    if isinstance(program, Program):
        queue = _work(plan, queue, _few(lanes) if narrow else 0)
        if narrow:
            queue = _drain(plan, queue)
        return queue.results, queue.usage
    fewer = lanes // program.narrowing
    narrow &= LEAST_LANES <= fewer < lanes
    queue = _work(plan, queue, fewer if narrow else 0)
    if narrow:
        queue = _work(plan, _gathered(plan, queue, fewer), 0, give=False)
    return (queue.results, queue.log), queue.usage


def _few(lanes: int) -> int:
    """Most lanes at work for which blocks cost less: a lane's step is dearer in a block."""
    return -(-lanes * 3 // 5) - 1


def _first(plan: _Plan, lanes: int, capacity: int) -> _Queue:
    """The queue with a job in every lane, as long as there are any."""
    program, job = plan.program, jnp.arange(lanes, dtype=jnp.int32)
    number = jnp.minimum(job, plan.n_jobs - 1)
    if isinstance(program, Program):
        state, log = program.start(number), ()
    else:
        state, log = program.refill(program.idle(lanes), number, job < plan.n_jobs), program.log
    row = jax.eval_shape(program.result, state)
    return _Queue(
        state=state,
        log=log,
        job=job,
        next_job=jnp.int32(lanes),
        began=jnp.bool_(True),
        results=jax.tree.map(lambda a: jnp.zeros((capacity, *a.shape[1:]), a.dtype), row),
        usage=Usage(busy=jnp.float32(0), total=jnp.float32(0)),
        waited=jnp.int32(0),
    )


def _work(plan: _Plan, queue: _Queue, fewer: int, give: bool = True) -> _Queue:
    """Work in all lanes until the queue is empty and at most `fewer` of them have a job."""
    program, lanes = plan.program, queue.job.shape[0]

    def unfinished(queue: _Queue) -> Array:
        wanted = jnp.sum(queue.job < plan.n_jobs) > fewer
        if isinstance(program, InPlace):  # who has just begun may end before planes are moved
            wanted |= queue.began
        return wanted & _moving(plan, queue)

    def turn(queue: _Queue) -> _Queue:
        state, log = _advance(program, queue.state, queue.log, plan.chunk)
        queue = _ended(plan, queue, state, log, plan.chunk * lanes)
        return _refilled(plan, queue, give)

    return jax.lax.while_loop(unfinished, turn, queue)


def _refilled(plan: _Plan, queue: _Queue, give: bool) -> _Queue:
    """Idle lanes take the next jobs, as long as there are any; none if not to `give`."""
    program = plan.program
    free = queue.job >= plan.n_jobs
    if not plan.refill:
        free &= jnp.all(free)
    given = queue.next_job + jnp.cumsum(free, dtype=jnp.int32) - 1
    takes = free & (given < plan.n_jobs) if give else jnp.zeros_like(free)
    job = jnp.where(takes, given, queue.job)
    number = jnp.minimum(job, plan.n_jobs - 1)
    if isinstance(program, Program):
        state = keep(~takes, queue.state, program.start(number))
    else:
        state = program.refill(queue.state, number, takes)
    return replace(
        queue,
        state=state,
        job=job,
        next_job=queue.next_job + jnp.sum(takes, dtype=jnp.int32),
        began=jnp.any(takes),
    )


def _drain(plan: _Plan, queue: _Queue) -> _Queue:
    """Finish the jobs that are under way, a block of lanes after the other.

    Lengths are heavy-tailed. Blocks that hold no job cost nothing, and before each chunk the
    unfinished jobs gather in the first of them.
    """
    lanes = queue.job.shape[0]
    width = min(lanes, LEAST_LANES)
    if lanes % width:
        idle = width - lanes % width
        state = jax.tree.map(lambda a: jnp.concatenate([a, a[..., :idle]], axis=-1), queue.state)
        job = jnp.concatenate([queue.job, jnp.broadcast_to(plan.n_jobs, idle)])
        queue = replace(queue, state=state, job=job)

    def unfinished(queue: _Queue) -> Array:
        return jnp.any(queue.job < plan.n_jobs) & _moving(plan, queue)

    def turn(queue: _Queue) -> _Queue:
        queue = _gathered(plan, queue, queue.job.shape[0])
        blocks = -(-jnp.sum(queue.job < plan.n_jobs, dtype=jnp.int32) // width)

        def advance(block: Array, state: Tree) -> Tree:
            part = jax.tree.map(lambda leaf: _block(leaf, block, width), state)
            part, _ = _advance(plan.program, part, (), plan.chunk)
            return jax.tree.map(partial(_put_block, block=block), state, part)

        state = jax.lax.fori_loop(0, blocks, advance, queue.state)
        return _ended(plan, queue, state, queue.log, blocks * plan.chunk * width)

    return jax.lax.while_loop(unfinished, turn, queue)


def _block(leaf: Array, block: Array, width: int) -> Array:
    return jax.lax.dynamic_slice_in_dim(leaf, block * width, width, axis=-1)


def _put_block(leaf: Array, part: Array, block: Array) -> Array:
    at = block * part.shape[-1]
    return jax.lax.dynamic_update_slice_in_dim(leaf, part, at, axis=-1)


def _gathered(plan: _Plan, queue: _Queue, count: int) -> _Queue:
    """The first `count` lanes, those that have a job before the others."""
    lanes = queue.job.shape[0]
    chosen = jnp.argsort(queue.job >= plan.n_jobs, stable=True)[:count]

    def pick(leaf: Array) -> Array:
        if leaf.shape[-1] == lanes:
            return jnp.take(leaf, chosen, axis=-1)
        planes = leaf.reshape(*leaf.shape[:-1], lanes, leaf.shape[-1] // lanes)
        return jnp.take(planes, chosen, axis=-2).reshape(*leaf.shape[:-1], -1)

    return replace(queue, state=jax.tree.map(pick, queue.state), job=queue.job[chosen])


def _moving(plan: _Plan, queue: _Queue) -> Array:
    """Whether jobs still end now and then; bool[]."""
    return jnp.bool_(True) if plan.bound is None else queue.waited < plan.bound


def _ended(plan: _Plan, queue: _Queue, state: Tree, log: Tree, executed: Array | int) -> _Queue:
    """The queue after `executed` lane-steps that led to `state`, with what they finished noted."""
    program, job = plan.program, queue.job
    ended = program.done(state) & (job < plan.n_jobs)
    rows = program.result(state)

    def written(out: Array, new: Array) -> Array:
        return out.at[jnp.where(ended, job, out.shape[0])].set(new, mode="drop")

    advanced = program.taken(state) - program.taken(queue.state)
    busy = jnp.sum(jnp.where(job < plan.n_jobs, advanced, 0))
    return replace(
        queue,
        state=state,
        log=log,
        job=jnp.where(ended, plan.n_jobs, job),
        results=jax.tree.map(written, queue.results, rows),
        usage=Usage(busy=queue.usage.busy + busy, total=queue.usage.total + executed),
        waited=jnp.where(jnp.any(ended), 0, queue.waited + 1),
    )


def _advance(program: Program | InPlace, state: Tree, log: Tree, chunk: int) -> tuple[Tree, Tree]:
    """Advance all lanes by a chunk."""

    def advance(_: Array, carry: tuple[Tree, Tree]) -> tuple[Tree, Tree]:
        if isinstance(program, InPlace):
            return program.step(*carry)
        state, log = carry
        return keep(program.done(state), state, program.step(state)), log

    return jax.lax.fori_loop(0, chunk, advance, (state, log))


def those(mask: Array) -> tuple[Array, Array]:
    """The lanes where `mask` bool[lanes]: their numbers, first in an int32[lanes]; how many."""
    count = jnp.cumsum(mask, dtype=jnp.int32)
    place = jnp.where(mask, count - 1, mask.shape[0])
    lane = jnp.arange(mask.shape[0], dtype=jnp.int32)
    return jnp.zeros_like(lane).at[place].set(lane, mode="drop"), count[-1]


def keep(mask: Array, old: Tree, new: Tree) -> Tree:
    """Per lane: the old state where `mask` bool[lanes], else the new one."""
    return jax.tree.map(lambda a, b: a if a is b else jnp.where(mask, a, b), old, new)


def record(
    program: Program, state: Tree, steps: int, observe: Callable[[Tree], Tree]
) -> tuple[Tree, Tree]:
    """Advance every lane a fixed number of steps, on the job it has, and keep what is seen.

    Args:
        program: what a lane does.
        state: of the lanes, from `program.start` or from a call before.
        steps: static.
        observe: state -> pytree of arrays, called after each step; a finished lane repeats its
            last state.

    Returns:
        The state after them and the observations [steps, ...].
    """

    def advance(state: Tree, _: None) -> tuple[Tree, Tree]:
        state = keep(program.done(state), state, program.step(state))
        return state, observe(state)

    return jax.lax.scan(advance, state, None, length=steps)
