"""D* Lite episodes through a fixed set of lanes, each taking the next when its own has ended.

`lanes.run` selects between whole states where a lane begins anew. Here a state holds planes of
the map, so only those of the lanes that ended are written.
"""

from dataclasses import dataclass, fields, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.lanes import LEAST_LANES
from usvkernels.search.dstar_layout import ReplanStatic
from usvkernels.search.dstar_lite import Episodes, Lanes, advance
from usvkernels.search.dstar_search import begin_planes, first_key, idle_searches

NARROWING = 4
"""How many times fewer lanes the last episodes get."""

_PLANES = ("g", "key", "unseen")  # flat, lanes one after the other


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Queue:
    lanes: Lanes
    next_job: Array  # int32, first episode not yet given out
    records: Array  # int32[capacity, 3]
    busy: Array  # float32, lane-iterations that advanced an episode
    total: Array  # float32, lane-iterations


def run(
    static: ReplanStatic,
    episodes: Episodes,
    n_jobs: Array | int,
    *,
    capacity: int,
    lanes: int,
    chunk: int,
    narrow: bool = True,
) -> tuple[Array, Array, Array]:
    """Sail episodes 0 .. n_jobs - 1.

    Args:
      static: choices of method.
      episodes: n of them.
      n_jobs: how many are real; may be traced.
      capacity: of records, static; n_jobs * (T + 1) at least, less than `dstar_lite.NOWHERE`.
      lanes: under way at a time, static.
      chunk: iterations between two refills, static.
      narrow: move the last episodes into fewer lanes; compiles the iteration a second time.

    Returns:
      int32[capacity, 3], rows j * (T + 1) + i: the vessel's cell, cost-to-go (as
      `dstar_lite.advance` has it) and expansions; cell -1 where the episode had ended before.
      And float32, lane-iterations that advanced an episode, and all of them.
    """
    n_jobs = jnp.asarray(n_jobs, jnp.int32)
    queue = _Queue(
        lanes=_idle(static, lanes),
        next_job=jnp.int32(0),
        records=jnp.full((capacity, 3), -1, jnp.int32),
        busy=jnp.float32(0),
        total=jnp.float32(0),
    )
    narrower = lanes // NARROWING
    if narrow and narrower >= LEAST_LANES:
        queue = _work(static, episodes, n_jobs, chunk, narrower, queue)
        queue = replace(queue, lanes=_gathered(queue.lanes, narrower))
        queue = _work(static, episodes, n_jobs, chunk, 0, queue, refill=False)
    else:
        queue = _work(static, episodes, n_jobs, chunk, 0, queue)
    return queue.records, queue.busy, queue.total


def _idle(static: ReplanStatic, lanes: int) -> Lanes:
    zero = jnp.zeros(lanes, jnp.int32)
    return Lanes(
        **idle_searches(static, lanes),
        unseen=jnp.zeros(lanes * static.layout.size if static.sensing else 0, bool),
        job=zero,
        record=zero,
        cursor=zero,
        moved=jnp.zeros(lanes, bool),
    )


def _refilled(static: ReplanStatic, episodes: Episodes, n_jobs: Array, queue: _Queue) -> _Queue:
    """Idle lanes take the next episodes, as long as there are any."""
    lanes, size = queue.lanes, static.layout.size
    job = queue.next_job + jnp.cumsum(~lanes.live, dtype=jnp.int32) - 1
    takes = ~lanes.live & (job < n_jobs)
    job = jnp.where(takes, job, lanes.job)
    start, goal = episodes.start[job], episodes.goal[job]
    key = first_key(static, start, goal)

    def begin(i: Array, planes: tuple[Array, ...]) -> tuple[Array, ...]:
        lane = order[i]
        unseen = planes[3]
        blocked = lax.dynamic_index_in_dim(episodes.blocked, episodes.map_of[job[lane]], 0, False)
        g, keys, bounds = begin_planes(
            static, (planes[0], planes[1], planes[2]), lane, blocked, goal[lane], key[lane]
        )
        if static.sensing:
            unseen = lax.dynamic_update_slice(unseen, jnp.zeros(size, bool), (lane * size,))
        return g, keys, bounds, unseen

    order = jnp.argsort(~takes, stable=True).astype(jnp.int32)
    count = jnp.sum(takes, dtype=jnp.int32)
    planes = (lanes.g, lanes.key, lanes.bounds, lanes.unseen)
    g, keys, bounds, unseen = lax.fori_loop(0, count, begin, planes)

    def fresh(new: Array | int, old: Array) -> Array:
        return jnp.where(takes, new, old)

    lanes = Lanes(
        g=g,
        key=keys,
        bounds=bounds,
        unseen=unseen,
        job=job,
        live=lanes.live | takes,
        record=fresh(0, lanes.record),
        cursor=fresh(0, lanes.cursor),
        moved=lanes.moved & ~takes,
        here=fresh(start, lanes.here),
        goal=fresh(goal, lanes.goal),
        origin=fresh(start, lanes.origin),
        lead=fresh(0, lanes.lead),
        expanded=fresh(0, lanes.expanded),
        iterations=fresh(0, lanes.iterations),
    )
    return replace(queue, lanes=lanes, next_job=queue.next_job + count)


def _work(
    static: ReplanStatic,
    episodes: Episodes,
    n_jobs: Array,
    chunk: int,
    fewer: int,
    queue: _Queue,
    refill: bool = True,
) -> _Queue:
    """Work until nothing is left, or until what is left fits into `fewer` lanes.

    Every iteration counts towards its lane's bound between two records, so this ends.
    """

    def unfinished(queue: _Queue) -> Array:
        left = jnp.sum(queue.lanes.live, dtype=jnp.int32)
        return (left > fewer) | (queue.next_job < n_jobs)

    def iterate(_: Array, carry: tuple[Lanes, Array, Array]) -> tuple[Lanes, Array, Array]:
        lanes, records, busy = carry
        busy = busy + jnp.sum(lanes.live, dtype=jnp.int32)
        lanes, place, written = advance(static, episodes, lanes)
        return lanes, records.at[place].set(written, mode="drop", unique_indices=True), busy

    def turn(queue: _Queue) -> _Queue:
        queue = _refilled(static, episodes, n_jobs, queue) if refill else queue
        carry = (queue.lanes, queue.records, jnp.int32(0))
        lanes, records, busy = lax.fori_loop(0, chunk, iterate, carry)
        return replace(
            queue,
            lanes=lanes,
            records=records,
            busy=queue.busy + busy,
            total=queue.total + chunk * lanes.job.shape[0],
        )

    return lax.while_loop(unfinished, turn, queue)


def _gathered(lanes: Lanes, count: int) -> Lanes:
    """The live lanes, at most `count`, and none of the others."""
    chosen = jnp.argsort(~lanes.live, stable=True)[:count]

    def pick(name: str, leaf: Array) -> Array:
        if name in _PLANES:
            return leaf.reshape(lanes.job.shape[0], -1)[chosen].reshape(-1)
        return leaf[..., chosen]

    return Lanes(**{f.name: pick(f.name, getattr(lanes, f.name)) for f in fields(Lanes)})
