"""Cruises through a fixed set of lanes; a lane goes on to its next leg, or to the next cruise."""

from dataclasses import dataclass, fields, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.cruise.sailing import STAY, Cruises, SailingStatic, Vessels, advance
from usvkernels.lanes import LEAST_LANES
from usvkernels.search.dstar_layout import BLOCKED
from usvkernels.search.dstar_search import begin_planes, first_key, idle_searches

NARROWING = 4
"""How many times fewer lanes the last cruises get: their lengths are heavy-tailed."""

_PLANES = ("g", "key", "unseen")  # flat, lanes one after the other


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Logs:
    """What came of the cruises.

    Attributes:
      moves: uint8[capacity], codes of the moves of cruise j from j * d * max_steps on; STAY where
        none was made.
      legs: int32[n * d, 4], of leg i of cruise j in row j * d + i: `Status` (REACHED, UNREACHABLE
        where its stop was given up, TIMED_OUT, OUT_OF_BUDGET; 0 where it did not begin), step of
        the cruise at its end, cells expanded in it, steps in which cells were.
      busy: float32, lane-iterations that advanced a cruise.
      total: float32, all of them.
    """

    moves: Array
    legs: Array
    busy: Array
    total: Array


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Queue:
    vessels: Vessels
    next_job: Array  # int32, first cruise not yet given out
    logs: Logs


def run(
    static: SailingStatic,
    cruises: Cruises,
    n_jobs: Array | int,
    *,
    capacity: int,
    lanes: int,
    chunk: int,
) -> Logs:
    """Sail cruises 0 .. n_jobs - 1.

    Args:
      static: choices of method.
      cruises: n of them.
      n_jobs: how many are real; may be traced.
      capacity: of moves, static; n_jobs * d * max_steps at least, less than
        `dstar_search.NOWHERE`.
      lanes: under way at a time, static.
      chunk: iterations between two refills, static.
    """
    n_jobs = jnp.asarray(n_jobs, jnp.int32)
    stops, n = cruises.stops.shape
    logs = Logs(
        moves=jnp.full(capacity, STAY, jnp.uint8),
        legs=jnp.zeros((n * (stops - 1), 4), jnp.int32),
        busy=jnp.float32(0),
        total=jnp.float32(0),
    )
    queue = _Queue(_idle(static, stops, lanes), jnp.int32(0), logs)
    work = partial(_work, static, cruises, n_jobs, chunk)
    narrower = lanes // NARROWING
    if narrower < LEAST_LANES:
        return work(0, queue).logs
    queue = work(narrower, queue)
    return work(0, replace(queue, vessels=_gathered(queue.vessels, narrower))).logs


def _work(
    static: SailingStatic, cruises: Cruises, n_jobs: Array, chunk: int, fewer: int, queue: _Queue
) -> _Queue:
    """Work until nothing is left, or until what is left fits into `fewer` lanes.

    Every iteration counts towards a bound on its lane's step, and steps towards one on its leg,
    so this ends.
    """

    def unfinished(queue: _Queue) -> Array:
        left = jnp.sum(~queue.vessels.over, dtype=jnp.int32)
        return (left > fewer) | (queue.next_job < n_jobs)

    def turn(queue: _Queue) -> _Queue:
        queue = _refilled(static, cruises, n_jobs, queue)
        vessels, logs = lax.fori_loop(0, chunk, iterate, (queue.vessels, queue.logs))
        total = logs.total + chunk * vessels.job.shape[0]
        return replace(queue, vessels=vessels, logs=replace(logs, total=total))

    def iterate(_: Array, carry: tuple[Vessels, Logs]) -> tuple[Vessels, Logs]:
        vessels, logs = carry
        busy = logs.busy + jnp.sum(vessels.live, dtype=jnp.int32)
        vessels, now = advance(static, cruises, vessels)
        moves = logs.moves.at[now.move_place].set(now.move, mode="drop", unique_indices=True)
        legs = logs.legs.at[now.leg_place].set(now.leg, mode="drop", unique_indices=True)
        return vessels, replace(logs, moves=moves, legs=legs, busy=busy)

    return lax.while_loop(unfinished, turn, queue)


def _gathered(vessels: Vessels, count: int) -> Vessels:
    """The lanes whose cruise is not over, at most `count`, and few of the others."""
    lanes = vessels.job.shape[0]
    chosen = jnp.argsort(vessels.over, stable=True)[:count]

    def pick(name: str, leaf: Array) -> Array:
        if name in _PLANES:
            return leaf.reshape(lanes, -1)[chosen].reshape(-1)
        return leaf[..., chosen]

    return Vessels(**{f.name: pick(f.name, getattr(vessels, f.name)) for f in fields(Vessels)})


def _idle(static: SailingStatic, stops: int, lanes: int) -> Vessels:
    zero = jnp.zeros(lanes, jnp.int32)
    counters = ("rate", "job", "leg", "step", "first", "waited", "spent", "plans")
    return Vessels(
        **idle_searches(static.search, lanes),
        **dict.fromkeys(counters, zero),
        unseen=jnp.zeros(lanes * static.search.layout.size if static.scope == "map" else 0, bool),
        changes=jnp.zeros((static.words, lanes), jnp.uint32),
        drawn=jnp.zeros(lanes, bool),
        over=jnp.ones(lanes, bool),
        stops=jnp.zeros((stops, lanes), jnp.int32),
        seed=jnp.zeros((2, lanes), jnp.uint32),
    )


def _refilled(static: SailingStatic, cruises: Cruises, n_jobs: Array, queue: _Queue) -> _Queue:
    """Lanes whose leg has ended begin the next; those whose cruise has, the next cruise."""
    vessels = queue.vessels
    free = ~vessels.live & vessels.over
    job = queue.next_job + jnp.cumsum(free, dtype=jnp.int32) - 1
    takes = free & (job < n_jobs)
    job = jnp.where(takes, job, vessels.job)

    def fresh(new: Array | int, old: Array) -> Array:
        return jnp.where(takes, new, old)

    stops = fresh(cruises.stops[:, job], vessels.stops)
    leg = fresh(1, vessels.leg + (~vessels.live & ~vessels.over))
    here = fresh(stops[0], vessels.here)
    begins = takes | (~vessels.live & ~vessels.over)
    goal = jnp.where(begins, jnp.take_along_axis(stops, leg[None], axis=0)[0], vessels.goal)
    vessels = replace(
        vessels,
        live=vessels.live | begins,
        here=here,
        goal=goal,
        origin=jnp.where(begins, here, vessels.origin),
        lead=jnp.where(begins, 0, vessels.lead),
        expanded=jnp.where(begins, 0, vessels.expanded),
        iterations=jnp.where(begins, 0, vessels.iterations),
        drawn=vessels.drawn & ~takes,
        over=vessels.over & ~takes,
        stops=stops,
        seed=fresh(cruises.seed[:, job], vessels.seed),
        rate=fresh(cruises.rate[job], vessels.rate),
        job=job,
        leg=leg,
        step=fresh(0, vessels.step),
        first=jnp.where(begins, fresh(0, vessels.step), vessels.first),
        waited=jnp.where(begins, 0, vessels.waited),
        spent=jnp.where(begins, 0, vessels.spent),
        plans=jnp.where(begins, 0, vessels.plans),
    )
    vessels = _begun(static, cruises, vessels, takes, begins)
    next_job = queue.next_job + jnp.sum(takes, dtype=jnp.int32)
    return replace(queue, vessels=vessels, next_job=next_job)


def _begun(
    static: SailingStatic, cruises: Cruises, vessels: Vessels, takes: Array, begins: Array
) -> Vessels:
    """The planes of the lanes that begin a leg: on the cruise's map, or on that known so far."""
    size = static.search.layout.size
    key = first_key(static.search, vessels.here, vessels.goal)

    def begin(i: Array, planes: tuple[Array, ...]) -> tuple[Array, ...]:
        lane = order[i]
        g, keys, bounds, unseen = planes
        which = cruises.map_of[vessels.job[lane]]
        first = lax.dynamic_index_in_dim(cruises.blocked, which, 0, False)
        known = lax.dynamic_slice(g, (lane * size,), (size,)) == BLOCKED
        blocked = jnp.where(takes[lane], first, known)
        g, keys, bounds = begin_planes(
            static.search, (g, keys, bounds), lane, blocked, vessels.goal[lane], key[lane]
        )
        if static.scope == "map":
            plane = lax.dynamic_slice(unseen, (lane * size,), (size,)) & ~takes[lane]
            unseen = lax.dynamic_update_slice(unseen, plane, (lane * size,))
        return g, keys, bounds, unseen

    order = jnp.argsort(~begins, stable=True).astype(jnp.int32)
    planes = (vessels.g, vessels.key, vessels.bounds, vessels.unseen)
    count = jnp.sum(begins, dtype=jnp.int32)
    g, keys, bounds, unseen = lax.fori_loop(0, count, begin, planes)
    return replace(vessels, g=g, key=keys, bounds=bounds, unseen=unseen)
