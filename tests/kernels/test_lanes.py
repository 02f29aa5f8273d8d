"""Lanes: whatever shares a batch with a job, its result is that of the job alone."""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import usvjax as uj
from usvjax.missions.dwa.params import DwaParams, DwaStatic, split
from usvkernels import lanes
from usvkernels.dwa import episodes
from usvkernels.dwa.episodes import Jobs, Outcome

MAX_STEPS = 60


# --- a program whose every number is known ----------------------------------------------------


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Count:
    """Counts up to a target and adds up what it saw."""

    target: jax.Array  # int32[lanes]
    steps: jax.Array  # int32[lanes]
    seen: jax.Array  # float[2, lanes]


def counting(targets: np.ndarray) -> lanes.Program:
    """Job j takes targets[j] steps and sums 1 + ... + targets[j] in two rows."""
    wanted = jnp.asarray(targets, jnp.int32)

    def start(job: jax.Array) -> Count:
        return Count(wanted[job], jnp.zeros_like(job), jnp.zeros((2, *job.shape)))

    def step(state: Count) -> Count:
        steps = state.steps + 1
        return Count(state.target, steps, state.seen + jnp.stack([steps, -steps]))

    return lanes.Program(
        start=start,
        step=step,
        done=lambda state: state.steps >= state.target,
        result=lambda state: {"steps": state.steps, "seen": state.seen.T},
        taken=lambda state: state.steps,
    )


def heavy_tailed(n: int) -> np.ndarray:
    rng = np.random.default_rng(1)
    targets = np.minimum(rng.geometric(0.1, n), MAX_STEPS)
    targets[::17] = 0  # over before they began
    targets[5] = MAX_STEPS
    return targets


@pytest.mark.parametrize("refill", [True, False])
@pytest.mark.parametrize(
    ("n_jobs", "capacity", "width", "chunk"),
    [(100, 100, 8, 7), (100, 128, 16, 1), (3, 8, 8, 5), (1, 1, 1, 1), (100, 100, 100, 64)],
)
def test_results_come_in_job_order(
    n_jobs: int, capacity: int, width: int, chunk: int, refill: bool
) -> None:
    targets = heavy_tailed(100)
    result, usage = lanes.run(
        counting(targets),
        n_jobs,
        capacity=capacity,
        lanes=width,
        chunk=chunk,
        max_steps=MAX_STEPS,
        refill=refill,
    )
    want = np.zeros(capacity, np.int64)
    want[:n_jobs] = targets[:n_jobs]
    np.testing.assert_array_equal(result["steps"], want)
    sums = want * (want + 1) // 2
    np.testing.assert_array_equal(result["seen"], np.stack([sums, -sums], axis=1))
    # Every step of every job is counted once, and nothing else.
    assert int(usage.busy) == want.sum()
    assert int(usage.busy) <= int(usage.total)
    assert int(usage.total) % (chunk * width) == 0


def test_refilling_keeps_lanes_busier() -> None:
    targets = heavy_tailed(400)
    share = {}
    for refill in (True, False):
        _, usage = lanes.run(
            counting(targets),
            400,
            capacity=400,
            lanes=16,
            chunk=4,
            max_steps=MAX_STEPS,
            refill=refill,
        )
        share[refill] = int(usage.busy) / int(usage.total)
    assert share[True] > 1.5 * share[False]
    assert share[True] > 0.6


def test_a_job_that_never_ends_does_not_hang() -> None:
    program = counting(np.array([3, 10**9, 4]))
    result, _ = lanes.run(program, 3, capacity=3, lanes=1, chunk=4, max_steps=MAX_STEPS)
    # What finished is there; the endless job and those behind it have no result.
    np.testing.assert_array_equal(result["steps"], [3, 0, 0])


def test_the_number_of_jobs_may_be_traced() -> None:
    run = jax.jit(
        lambda n: lanes.run(
            counting(heavy_tailed(50)), n, capacity=50, lanes=8, chunk=4, max_steps=MAX_STEPS
        )[0]["steps"]
    )
    for n in (1, 7, 50):
        want = np.where(np.arange(50) < n, heavy_tailed(50), 0)
        np.testing.assert_array_equal(run(n), want)


def test_record_repeats_the_last_state_and_goes_on_from_it() -> None:
    targets = np.array([0, 2, 5])
    program = counting(targets)
    state, parts = program.start(jnp.arange(3)), []
    for _ in range(2):
        state, seen = lanes.record(program, state, 3, lambda state: {"steps": state.steps})
        parts.append(seen["steps"])
    want = np.minimum(np.arange(1, 7)[:, None], targets)
    np.testing.assert_array_equal(np.concatenate(parts), want)
    np.testing.assert_array_equal(program.result(state)["steps"], targets)


def test_keep_chooses_per_lane() -> None:
    old = {"a": jnp.zeros((2, 3)), "same": jnp.arange(3)}
    new = {"a": jnp.ones((2, 3)), "same": old["same"]}
    kept = lanes.keep(jnp.array([True, False, True]), old, new)
    np.testing.assert_array_equal(kept["a"], [[0, 1, 0], [0, 1, 0]])
    assert kept["same"] is old["same"]


@pytest.mark.parametrize("mask", [[True, False, True, True], [False, False], [True]])
def test_those_are_the_lanes_of_a_mask(mask: list[bool]) -> None:
    order, number = lanes.those(jnp.array(mask))
    np.testing.assert_array_equal(order[: int(number)], np.flatnonzero(mask))
    assert order.shape == (len(mask),)


# --- the same, where states hold planes that are written in place -----------------------------

CELLS = 5


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Fill:
    """Adds the number of each step to one cell after the other of a plane."""

    plane: jax.Array  # int32[lanes * CELLS]
    job: jax.Array  # int32[lanes], and so are all below
    steps: jax.Array
    target: jax.Array
    taken: jax.Array


def filling(targets: np.ndarray) -> lanes.InPlace:
    """Job j takes targets[j] steps on a plane that is j at first, and logs each of them once."""
    wanted = jnp.asarray(targets, jnp.int32)

    def idle(count: int) -> Fill:
        zero = jnp.zeros(count, jnp.int32)
        return Fill(jnp.full(count * CELLS, -7, jnp.int32), zero, zero, zero, zero)

    def refill(state: Fill, job: jax.Array, takes: jax.Array) -> Fill:
        def begin(i: jax.Array, plane: jax.Array) -> jax.Array:
            fresh = jnp.broadcast_to(job[order[i]], CELLS)
            return jax.lax.dynamic_update_slice(plane, fresh, (order[i] * CELLS,))

        order, number = lanes.those(takes)
        return Fill(
            plane=jax.lax.fori_loop(0, number, begin, state.plane),
            job=jnp.where(takes, job, state.job),
            steps=jnp.where(takes, 0, state.steps),
            target=jnp.where(takes, wanted[job], state.target),
            taken=state.taken,
        )

    def step(state: Fill, log: jax.Array) -> tuple[Fill, jax.Array]:
        works = state.steps < state.target
        lane = jnp.arange(len(works), dtype=jnp.int32)
        cell = jnp.where(works, lane * CELLS + state.steps % CELLS, len(state.plane))
        place = jnp.where(works, state.job * MAX_STEPS + state.steps, log.size)
        plane = state.plane.at[cell].add(state.steps, mode="drop")
        log = log.at[place].add(1 + state.job, mode="drop")
        steps, taken = state.steps + works, state.taken + works
        return Fill(plane, state.job, steps, state.target, taken), log

    return lanes.InPlace(
        idle=idle,
        refill=refill,
        step=step,
        done=lambda state: state.steps >= state.target,
        taken=lambda state: state.taken,
        result=lambda state: state.plane.reshape(-1, CELLS),
        log=jnp.zeros(len(targets) * MAX_STEPS, jnp.int32),
    )


def filled(targets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Planes int[n, CELLS] and logs int[n, MAX_STEPS] of the jobs, one after the other."""
    planes = np.zeros((len(targets), CELLS), int)
    logs = np.zeros((len(targets), MAX_STEPS), int)
    for job, target in enumerate(targets):
        planes[job] = job
        np.add.at(planes[job], np.arange(target) % CELLS, np.arange(target))
        logs[job, :target] = 1 + job
    return planes, logs


@pytest.mark.parametrize("refill", [True, False])
@pytest.mark.parametrize(
    ("n_jobs", "width", "chunk", "narrow"),
    [
        (300, 64, 7, True),
        (300, 64, 7, False),
        (300, 80, 1, True),
        (300, 8, 3, True),
        (3, 64, 5, True),
    ],
)
def test_planes_are_written_in_place(
    n_jobs: int, width: int, chunk: int, narrow: bool, refill: bool
) -> None:
    targets = heavy_tailed(300)
    run = jax.jit(
        lambda n: lanes.run(
            filling(targets),
            n,
            capacity=300,
            lanes=width,
            chunk=chunk,
            refill=refill,
            narrow=narrow,
        )
    )
    (planes, log), usage = run(n_jobs)
    want_planes, want_log = filled(targets)
    want_planes[n_jobs:], want_log[n_jobs:] = 0, 0
    np.testing.assert_array_equal(planes, want_planes)
    # Every step of every job is logged, and counted, exactly once.
    np.testing.assert_array_equal(log, want_log.reshape(-1))
    assert int(usage.busy) == targets[:n_jobs].sum()
    assert int(usage.busy) <= int(usage.total)


def test_the_last_planes_move_into_fewer_lanes() -> None:
    targets = np.full(64, 2)
    targets[[1, 40]] = MAX_STEPS
    widths: list[int] = []
    total = {}
    for narrow in (True, False):
        program = filling(targets)

        def step(
            state: Fill, log: jax.Array, own: lanes.InPlace = program
        ) -> tuple[Fill, jax.Array]:
            widths.append(len(state.job))
            return own.step(state, log)

        seen = lanes.InPlace(**{**vars(program), "step": step})
        (planes, _), usage = lanes.run(seen, 64, capacity=64, lanes=64, chunk=2, narrow=narrow)
        np.testing.assert_array_equal(planes, filled(targets)[0])
        assert set(widths) == ({64, 64 // program.narrowing} if narrow else {64})
        widths.clear()
        total[narrow] = int(usage.total)
    # One turn in all lanes (of which two have work left after it), the rest in a quarter of them.
    rest = MAX_STEPS - 2
    assert total == {True: 64 * 2 + 16 * rest, False: 64 * MAX_STEPS}


def test_planes_may_stay_in_all_lanes() -> None:
    targets = np.full(40, MAX_STEPS)  # many chunks in which no lane begins a job
    stays = lanes.InPlace(**{**vars(filling(targets)), "narrowing": 1})
    (planes, _), _ = lanes.run(stays, 40, capacity=40, lanes=16, chunk=7)
    np.testing.assert_array_equal(planes, filled(targets)[0])


def test_planes_of_jobs_that_never_end_are_given_up() -> None:
    program = filling(np.arange(40))
    never = lanes.InPlace(**{**vars(program), "done": lambda state: state.steps < 0})
    _, usage = lanes.run(never, 40, capacity=40, lanes=16, chunk=8, max_steps=MAX_STEPS)
    assert float(usage.total) <= 2 * 16 * (MAX_STEPS + 16)


# --- episodes ---------------------------------------------------------------------------------

N_EPISODES = 1200
SOME = (0, 1, 611, N_EPISODES - 1)


def waters() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Starts, obstacles and goals of short episodes that end in every way."""
    rng = np.random.default_rng(3)
    starts = np.column_stack((np.zeros((N_EPISODES, 2)), rng.uniform(0.0, 1.57, N_EPISODES)))
    obstacles = rng.uniform(0.5, 5.0, (N_EPISODES, 8, 2))
    goals = rng.uniform(1.0, 4.0, (N_EPISODES, 2))
    return starts, obstacles, goals


PARAMS = DwaParams(
    radius=0.3, clearance_cap=1.0, goal_tolerance=0.4, stuck_distance=0.7, stuck_time=4.0
)
STATIC = DwaStatic(method="improved", max_steps=100)


@partial(jax.jit, static_argnames=("width", "refill"))
def sail(
    jobs: Jobs, params: DwaParams, width: int, refill: bool = True
) -> tuple[Outcome, lanes.Usage]:
    count = jobs.start.shape[0]
    return lanes.run(
        episodes.program(jobs, split(params, STATIC)),
        count,
        capacity=count,
        lanes=width,
        chunk=16,
        max_steps=STATIC.max_steps,
        refill=refill,
    )


def jobs_of(rows: slice) -> Jobs:
    starts, obstacles, goals = (a[rows].astype(np.float32) for a in waters())
    return Jobs(
        start=jnp.asarray(starts),
        goal=jnp.asarray(goals),
        obstacles=jnp.asarray(obstacles.transpose(0, 2, 1)),
    )


def assert_same(got: Outcome | uj.NavigateResult, want: Outcome) -> None:
    for name in ("status", "steps", "path_length", "min_clearance"):
        np.testing.assert_array_equal(getattr(got, name), getattr(want, name), err_msg=name)


@pytest.fixture(scope="module")
def by_width() -> dict[int, tuple[Outcome, lanes.Usage]]:
    jobs = jobs_of(slice(None))
    return {width: sail(jobs, PARAMS, width) for width in (64, 256, 1024)}


@pytest.mark.parametrize("width", [64, 1024])
def test_an_episode_does_not_depend_on_the_number_of_lanes(
    by_width: dict[int, tuple[Outcome, lanes.Usage]], width: int
) -> None:
    assert_same(by_width[width][0], by_width[256][0])


def test_episodes_end_in_every_way(by_width: dict[int, tuple[Outcome, lanes.Usage]]) -> None:
    outcome, usage = by_width[64]
    assert set(np.unique(outcome.status)) == {
        uj.Status.REACHED, uj.Status.COLLIDED, uj.Status.STUCK, uj.Status.TIMED_OUT
    }  # fmt: skip
    assert int(usage.busy) == int(np.sum(outcome.steps))
    assert 0.5 < int(usage.busy) / int(usage.total) <= 1.0


@pytest.mark.parametrize("job", SOME)
def test_an_episode_alone_is_the_same(
    by_width: dict[int, tuple[Outcome, lanes.Usage]], job: int
) -> None:
    alone, _ = sail(jobs_of(slice(job, job + 1)), PARAMS, 1)
    among = jax.tree.map(lambda a: a[job : job + 1], by_width[256][0])
    assert_same(alone, among)


def test_without_refill_the_same(by_width: dict[int, tuple[Outcome, lanes.Usage]]) -> None:
    outcome, usage = sail(jobs_of(slice(None)), PARAMS, 64, refill=False)
    assert_same(outcome, by_width[64][0])
    assert int(usage.total) > int(by_width[64][1].total)


def test_the_library_sails_them_the_same(
    by_width: dict[int, tuple[Outcome, lanes.Usage]],
) -> None:
    starts, obstacles, goals = waters()
    want = by_width[256][0]
    some = uj.navigate_dwa(obstacles, starts, goals, params=PARAMS, static=STATIC)
    assert_same(some, want)
    assert 0.0 < some.occupancy <= 1.0
    seen = uj.navigate_dwa(
        obstacles[:100], starts[:100], goals[:100], params=PARAMS, static=STATIC, record=True
    )
    assert_same(seen, jax.tree.map(lambda a: a[:100], want))
    with jax.default_device(jax.devices("cpu")[0]):
        one = uj.navigate_dwa(obstacles, starts, goals, params=PARAMS, static=STATIC)
    assert_same(one, want)


@pytest.mark.parametrize("max_steps", [10**7, 2**31 - 1])
def test_a_distant_bound_on_steps_changes_nothing(max_steps):
    targets = heavy_tailed(8192)
    found, _ = lanes.run(
        counting(targets), 8192, capacity=8192, lanes=64, chunk=8, max_steps=max_steps
    )
    assert (np.asarray(found["steps"]) == targets).all()


@pytest.mark.parametrize("narrow", [True, False])
def test_jobs_that_never_end_are_given_up(narrow):
    never = lanes.Program(**{**vars(counting(np.arange(40))), "done": lambda s: s.steps < 0})
    _, usage = lanes.run(
        never, 40, capacity=40, lanes=16, chunk=8, max_steps=MAX_STEPS, narrow=narrow
    )
    assert float(usage.busy) == float(usage.total) <= 2 * 16 * (MAX_STEPS + 16)
