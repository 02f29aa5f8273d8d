"""The JAX kernel against the float64 NumPy oracle, and the peers against each other.

A rounded computation may choose another candidate than the oracle only where the oracle itself
is undecided: two scores closer than rounding can tell apart, or a yes/no question (inside the
window, able to stop, inside the search sector) answered within rounding of its boundary. Both
are bounded here from the unit of the arithmetic, and how often they happen is bounded too.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from dwa_situations import Situations, enable_x64, kernel, parameters, situations

import usvjax as uj
from benchmarks.peers import Settings, dwa_numpy, dwa_python
from usvjax.missions.dwa.params import DwaParams

K = 20

# Errors of the quantities that a decision rests on, in units of the arithmetic. A unit is a few
# roundings (6e-8 and 1.1e-16 each): what thirty rotations and short polynomials accumulate.
FLOAT32, FLOAT64 = 1e-6, 4e-15
# A direction off by half a unit displaces what lies 16 m away by this many units.
BOUNDARY = 8.0
# Share of float32 decisions that may differ, all of them explained; it was 1 of 100,000.
TIES = 1e-4

PAPER = Settings(radius=0.5)
VARIANTS = {
    "traditional": PAPER,
    "traditional, capped": replace(PAPER, radius=0.3, clearance_cap=1.0),
    "improved": replace(PAPER, method="improved"),
    "improved, narrow, capped": replace(
        PAPER, method="improved", radius=0.3, clearance_cap=2.0, search_angle=np.pi / 8
    ),
}
OPTIONS = {
    "trajectory": replace(PAPER, clearance="trajectory"),
    "range": replace(PAPER, normalise="range"),
    "improved, trajectory": replace(PAPER, method="improved", clearance="trajectory"),
    "improved, not normalised": replace(PAPER, method="improved", normalise="none"),
    "other numbers, sector past abeam": Settings(
        v_min=-0.3, v_max=2.5, v_acc=0.5, v_dec=0.4, v_step=0.025, n_v=9,
        w_min=-0.8, w_max=0.6, w_acc=0.6, w_dec=0.9, w_step=0.0625, n_w=7,
        heading_weight=0.8, clearance_weight=0.1, velocity_weight=0.3, normalise="range",
        dt=0.25, horizon=13, radius=0.7, method="improved", search_angle=2.4,
        clearance_cap=3.0, clear_distance=2.0,
    ),
}  # fmt: skip


def score_error(
    s: Settings, case: Situations, oracle: dwa_numpy.Decision, unit: float
) -> dwa_numpy.Floats:
    """Bound [S, N] on the error of each score, from the errors of what it is made of."""
    to_goal = np.linalg.norm(case.goals[:, None] - oracle.end[:, :, :2], axis=2)
    reach = np.linalg.norm(case.goals - case.states[:, :2], axis=1)[:, None] + 3.0
    parts = (
        (s.heading_weight, oracle.heading, unit * (2.0 + reach / np.maximum(to_goal, unit))),
        (s.clearance_weight, oracle.clearance, np.full(to_goal.shape, BOUNDARY * unit)),
        (s.velocity_weight, oracle.v, np.full(to_goal.shape, unit)),
    )

    def among(value: dwa_numpy.Floats, otherwise: float) -> dwa_numpy.Floats:
        return np.where(oracle.admissible, value, otherwise)

    total = np.full(to_goal.shape, 1e-3 * unit)
    for weight, value, error in parts:
        scale = np.ones((len(case), 1))
        share = scale_error = np.zeros((len(case), 1))
        if s.normalise == "sum":
            scale = among(np.abs(value), 0.0).sum(axis=1, keepdims=True)
            scale_error = among(error, 0.0).sum(axis=1, keepdims=True)
            share = np.abs(value) / np.maximum(scale, unit)
        elif s.normalise == "range":
            low = among(value, np.inf).min(axis=1, keepdims=True)
            scale = np.maximum(among(value, -np.inf).max(axis=1, keepdims=True) - low, 0.0)
            scale_error = 2.0 * among(error, 0.0).max(axis=1, keepdims=True)
            share = np.ones_like(scale)
        # A quotient errs by its numerator's error and by its share of the divisor's.
        total += weight * (error + share * scale_error) / np.maximum(scale, scale_error + unit)
    return total


def doubtful(oracle: dwa_numpy.Decision, unit: float) -> dwa_numpy.Bools:
    """Where [S] rounding may answer one of the decision's yes/no questions either way."""
    near = (oracle.margin < BOUNDARY * unit) | (oracle.rate_margin < unit)
    return np.asarray(near.any(axis=1))


def check(s: Settings, case: Situations, found: dwa_numpy.Decision, unit: float) -> dwa_numpy.Bools:
    """Compare a result with the oracle's; return where [S] the choice differs, all explained."""
    oracle = dwa_numpy.decide(case.states, case.obstacles, case.goals, s, case.valid)
    sure = ~doubtful(oracle, unit)
    error = score_error(s, case, oracle, unit)

    assert sure.mean() > 0.995
    np.testing.assert_array_equal(found.admissible[sure], oracle.admissible[sure])
    assert np.abs(found.end - oracle.end[:, :, :2]).max() <= BOUNDARY * unit
    assert np.abs(found.clearance - oracle.clearance)[sure].max() <= BOUNDARY * unit
    rows = sure[:, None] & oracle.admissible
    assert (np.abs(found.score[rows] - oracle.score[rows]) <= error[rows]).all()
    assert (found.score[~found.admissible] == -np.inf).all()

    differ = found.chosen != oracle.chosen
    tied = np.zeros_like(differ)
    both = np.flatnonzero((found.chosen >= 0) & (oracle.chosen >= 0))
    ours, theirs = found.chosen[both], oracle.chosen[both]
    gap = oracle.score[both, theirs] - oracle.score[both, ours]
    tied[both] = gap <= error[both, theirs] + error[both, ours]
    unexplained = np.flatnonzero(differ & sure & ~tied)
    assert not len(unexplained), f"situations {unexplained[:5]} of {s}"
    assert np.abs(found.command - oracle.command)[~differ].max() <= unit
    return differ


@pytest.mark.parametrize("variant", VARIANTS)
def test_kernel_makes_the_oracles_decisions(
    variant: str, record_property: Callable[[str, object], None]
) -> None:
    s = VARIANTS[variant]
    case = situations(np.random.default_rng(2022), 25_000, K, s)
    differ = check(s, case, kernel(s, case), FLOAT32)
    record_property("share of ties", float(differ.mean()))
    assert differ.mean() <= TIES


@pytest.mark.parametrize("variant", VARIANTS)
def test_kernel_under_x64(variant: str) -> None:
    s = VARIANTS[variant]
    case = situations(np.random.default_rng(64), 4_000, K, s)
    with enable_x64():
        found = kernel(s, case)
    assert found.score.dtype == np.float64
    assert not check(s, case, found, FLOAT64).any()


@pytest.mark.parametrize("option", OPTIONS)
def test_kernel_options(option: str) -> None:
    s = OPTIONS[option]
    case = situations(np.random.default_rng(2), 900, 8, s)
    with enable_x64():
        found = kernel(s, case)
    assert not check(s, case, found, FLOAT64).any()


def test_kernel_with_more_obstacles_than_it_unrolls() -> None:
    case = situations(np.random.default_rng(3), 450, 150, PAPER)
    assert check(PAPER, case, kernel(PAPER, case), FLOAT32).mean() <= TIES


def test_kernel_with_a_fine_window() -> None:
    fine = replace(PAPER, n_v=21, v_step=0.002, n_w=41, w_step=PAPER.w_step / 4)
    case = situations(np.random.default_rng(4), 900, 40, fine)
    with enable_x64():
        exact = kernel(fine, case)
    assert not check(fine, case, exact, FLOAT64).any()
    found = kernel(fine, case)  # 861 candidates lie closer to each other than single precision
    moves = np.flatnonzero((exact.chosen >= 0) & (found.chosen >= 0))
    assert len(moves) > 0.5 * len(case)
    missed = exact.score[moves, exact.chosen[moves]] - exact.score[moves, found.chosen[moves]]
    assert (missed[np.isfinite(missed)] < 1e-5).all()
    assert np.isfinite(missed).mean() > 0.99


def test_kernel_with_parameters_of_its_own_per_situation() -> None:
    several = [
        replace(PAPER, method="improved", radius=r, search_angle=a, heading_weight=h, dt=dt)
        for r, a, h, dt in ((0.5, 1.0, 0.05, 0.1), (0.3, 0.4, 0.2, 0.1), (0.8, 2.0, 0.01, 0.05))
    ]
    case = situations(np.random.default_rng(4), 2_700, 8, PAPER)
    which = np.arange(len(case)) // len(several) % len(several)
    numbers: dict[str, Any] = {
        name: np.array([getattr(parameters(s)[0], name) for s in several], np.float32)[which]
        for name in ("radius", "search_angle", "heading_weight", "dt")
    }
    found = kernel(several[0], case, DwaParams(**numbers))
    for i, s in enumerate(several):
        rows = np.flatnonzero(which == i)
        parts = {k: v[rows] for k, v in vars(found).items() if len(v)} | {
            name: found.margin for name in ("margin", "rate_margin")
        }
        assert check(s, case.rows(rows), dwa_numpy.Decision(**parts), FLOAT32).mean() <= 10 * TIES


# --- closed loop ------------------------------------------------------------------------------

EPISODES = 120
LOOP = Settings(radius=0.3, clearance_cap=1.5, goal_tolerance=0.4, stuck_time=6.0, max_steps=400)


@dataclass(frozen=True)
class Sailed:
    """Episodes that the simulator sailed, with what it was given."""

    s: Settings
    starts: dwa_numpy.Floats  # [B, 3]
    obstacles: dwa_numpy.Floats  # [B, K, 2]
    goals: dwa_numpy.Floats  # [B, 2]
    valid: dwa_numpy.Bools  # [B, K]
    result: uj.NavigateResult
    path: dwa_numpy.Floats  # [B, T, 5], the recorded trajectories

    def nearest(self) -> dwa_numpy.Floats:
        """Clearance float64[B, T] at the recorded positions."""
        offset = self.path[:, :, None, :2] - self.obstacles[:, None]
        gap = np.hypot(offset[..., 0], offset[..., 1])
        return np.where(self.valid[:, None], gap, np.inf).min(axis=2) - self.s.radius


@pytest.fixture(scope="module", params=["traditional", "improved"])
def sailed(request: pytest.FixtureRequest) -> Sailed:
    rng = np.random.default_rng(7)
    starts = np.column_stack((np.zeros((EPISODES, 2)), rng.uniform(0.0, np.pi / 2, EPISODES)))
    goals = rng.uniform(6.0, 10.0, (EPISODES, 2))
    obstacles = rng.uniform(0.0, 10.0, (EPISODES, K, 2))
    starts, goals, obstacles = (
        a.astype(np.float32).astype(np.float64) for a in (starts, goals, obstacles)
    )
    off_start = np.hypot(obstacles[..., 0], obstacles[..., 1])
    off_goal = np.linalg.norm(obstacles - goals[:, None], axis=2)
    valid = (off_start > 1.0) & (off_goal > 0.6)
    s = replace(LOOP, method=request.param)
    params, static = parameters(s)
    result = uj.navigate_dwa(
        obstacles, starts, goals, params=params, static=static, valid=valid, record=True
    )
    assert result.trajectory is not None
    path = result.trajectory.astype(np.float64)
    return Sailed(s, starts, obstacles, goals, valid, result, path)


def test_episodes_end_as_the_oracles(sailed: Sailed) -> None:
    r = sailed.result
    want = dwa_numpy.episodes(sailed.starts, sailed.obstacles, sailed.goals, sailed.s, sailed.valid)
    # A tie taken otherwise sends an episode along another path: a few in a hundred, which then
    # mostly end the same way, some steps apart.
    same = (r.status == want.status) & (r.steps == want.steps)
    assert (r.status == want.status).mean() >= 0.98
    assert same.mean() >= 0.95
    steps = int(r.steps.max()) + 1
    off = np.abs(sailed.path[:, :, :2] - want.trajectory[:, :steps, :2]).max(axis=(1, 2))
    assert np.median(off) < 1e-4
    assert np.quantile(np.abs(r.path_length - want.path_length), 0.9) < 1e-2
    assert len(np.unique(want.status)) >= 3


def test_recorded_steps_follow_eq_1(sailed: Sailed) -> None:
    r, dt = sailed.result, sailed.s.dt
    path = sailed.path
    assert path.shape == (EPISODES, r.steps.max() + 1, 5)
    np.testing.assert_array_equal(path[:, 0, :3], sailed.starts)
    np.testing.assert_array_equal(path[:, 0, 3:], 0.0)
    before, after = path[:, :-1], path[:, 1:]
    running = np.arange(path.shape[1] - 1) < r.steps[:, None]
    moved = after[..., 3] * dt * np.exp(1j * before[..., 2])
    step = (after[..., :2] - before[..., :2]) @ [1.0, 1j]
    assert np.abs(step - moved)[running].max() < 3e-6
    turned = after[..., 2] - before[..., 2] - after[..., 4] * dt
    assert np.abs(np.exp(1j * turned) - 1.0)[running].max() < 2e-6
    np.testing.assert_array_equal(after[~running], before[~running])
    assert (path[..., 2] >= -np.float32(np.pi)).all()
    assert (path[..., 2] < np.float32(np.pi)).all()


def test_recorded_decisions_are_the_oracles(sailed: Sailed) -> None:
    r, s = sailed.result, sailed.s
    episode, step = np.nonzero(np.arange(sailed.path.shape[1] - 1) < r.steps[:, None])
    case = Situations(
        sailed.path[episode, step],
        sailed.obstacles[episode],
        sailed.valid[episode],
        sailed.goals[episode],
        np.zeros(len(step), np.int64),
    )
    oracle = dwa_numpy.decide(case.states, case.obstacles, case.goals, s, case.valid)
    command = sailed.path[episode, step + 1, 3:]
    differ = np.flatnonzero(np.abs(command - oracle.command).max(axis=1) > FLOAT32)
    assert len(differ) <= 10 * TIES * len(step)
    off = np.abs(oracle.v - command[:, :1]) + np.abs(oracle.w - command[:, 1:])
    ours, theirs = off.argmin(axis=1), oracle.chosen
    error = score_error(s, case, oracle, FLOAT32)
    doubt = doubtful(oracle, FLOAT32)
    for n in differ:
        tie = oracle.score[n, theirs[n]] - oracle.score[n, ours[n]]
        tied = theirs[n] >= 0 and off[n].min() < FLOAT32
        assert doubt[n] or (tied and tie <= error[n, ours[n]] + error[n, theirs[n]])


def test_results_follow_from_the_recorded_trajectory(sailed: Sailed) -> None:
    r, s = sailed.result, sailed.s
    rows, last = np.arange(EPISODES), r.steps
    times = np.arange(sailed.path.shape[1])
    speeds = np.abs(sailed.path[:, 1:, 3]) * (times[1:] <= last[:, None])
    np.testing.assert_allclose(r.path_length, speeds.sum(axis=1) * s.dt, rtol=1e-5)
    np.testing.assert_allclose(r.time, last * s.dt, rtol=1e-6)
    np.testing.assert_allclose(r.mean_speed, r.path_length / r.time, rtol=1e-6)
    clearance = sailed.nearest()
    np.testing.assert_allclose(r.min_clearance, clearance.min(axis=1), atol=2e-6)

    to_goal = np.linalg.norm(sailed.path[:, :, :2] - sailed.goals[:, None], axis=2)
    sailing = times < last[:, None]
    # Never over before its end, to rounding of the positions.
    assert clearance[sailing].min() > -2e-6
    assert to_goal[sailing].min() > s.goal_tolerance - 2e-6
    collided = clearance[rows, last] < 0.0
    near = np.abs(clearance[rows, last]) < 2e-6
    reached = to_goal[rows, last] <= s.goal_tolerance
    near |= np.abs(to_goal[rows, last] - s.goal_tolerance) < 2e-6
    idle = np.array(
        [idle_steps(path[: n + 1], s) for path, n in zip(sailed.path, last, strict=True)]
    )
    stuck = idle * s.dt >= s.stuck_time
    late = last >= s.max_steps
    codes = [uj.Status.COLLIDED, uj.Status.REACHED, uj.Status.STUCK, uj.Status.TIMED_OUT]
    want = np.select([collided, reached, stuck, late], codes, uj.Status.RUNNING)
    np.testing.assert_array_equal(r.status[~near], want[~near])
    assert near.sum() <= 1


def idle_steps(path: np.ndarray, s: Settings) -> int:
    """Steps at the end of a path [T, 5] since the vessel last got away from its anchor."""
    anchor, since = path[0, :2], 0
    for step, position in enumerate(path[:, :2]):
        if np.hypot(*(position - anchor)) > s.stuck_distance:
            anchor, since = position, step
    return len(path) - 1 - since


# --- the peers among themselves ---------------------------------------------------------------


def crowded(seed: int, n: int, s: Settings) -> Situations:
    """Situations in which every obstacle row exists, as the simpler peers have it."""
    case = situations(np.random.default_rng(seed), n, K, s)
    return replace(case, valid=np.ones_like(case.valid))


@pytest.mark.parametrize("variant", VARIANTS)
def test_numba_and_numpy_agree(variant: str) -> None:
    dwa_numba = pytest.importorskip("benchmarks.peers.dwa_numba", reason="needs numba")
    s = VARIANTS[variant]
    case = crowded(8, 9_000, s)
    scene = case.states, case.obstacles, case.goals
    oracle = dwa_numpy.decide(*scene, s)
    for closed_form in (False, True):
        chosen, score, admissible = dwa_numba.decide(*scene, s, closed_form)
        np.testing.assert_array_equal(chosen, oracle.chosen)
        np.testing.assert_array_equal(admissible, oracle.admissible)
        np.testing.assert_allclose(score[admissible], oracle.score[admissible], atol=1e-11)
        single = (a.astype(np.float32) for a in scene)
        chosen, score, _ = dwa_numba.decide(*single, s, closed_form)
        assert score.dtype == np.float32
        assert (chosen != oracle.chosen).mean() <= 10 * TIES


@pytest.mark.parametrize("variant", VARIANTS)
def test_closed_loops_of_the_peers_agree(variant: str) -> None:
    dwa_numba = pytest.importorskip("benchmarks.peers.dwa_numba", reason="needs numba")
    s = VARIANTS[variant]
    case = crowded(9, 45, s)
    scene = case.states, case.obstacles, case.goals
    want = dwa_numpy.run(*scene, s, 15)
    for closed_form in (False, True):
        np.testing.assert_allclose(dwa_numba.run(*scene, s, 15, closed_form), want, atol=1e-9)
    for i in range(len(case)):
        state, obstacles, goal = (a[i].tolist() for a in scene)
        got = dwa_python.run(state, obstacles, goal, s, 15)
        np.testing.assert_allclose(got, want[i], atol=1e-9)


def test_plain_python_and_numpy_agree() -> None:
    for s in VARIANTS.values():
        case = crowded(10, 180, s)
        oracle = dwa_numpy.decide(case.states, case.obstacles, case.goals, s)
        for i in range(len(case)):
            state, obstacles, goal = case.states[i].tolist(), case.obstacles[i], case.goals[i]
            chosen, v, w = dwa_python.decide(state, obstacles.tolist(), goal.tolist(), s)
            assert chosen == oracle.chosen[i]
            np.testing.assert_allclose((v, w), oracle.command[i], atol=1e-15)


@pytest.mark.parametrize("change", [{"clearance": "trajectory"}, {"normalise": "range"}])
def test_simpler_peers_refuse_what_they_lack(change: dict[str, Any]) -> None:
    dwa_numba = pytest.importorskip("benchmarks.peers.dwa_numba", reason="needs numba")
    s = replace(PAPER, **change)
    case = crowded(11, 1, s)
    with pytest.raises(ValueError, match="only, got"):
        dwa_numba.decide(case.states, case.obstacles, case.goals, s)
    with pytest.raises(ValueError, match="only, got"):
        dwa_python.decide((0.0,) * 5, [], (1.0, 1.0), s)
