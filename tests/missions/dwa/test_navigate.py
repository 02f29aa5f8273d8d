"""Episodes among circles: what comes back, and that it agrees with itself."""

import os
import subprocess
import sys
from dataclasses import fields, replace
from functools import cache
from pathlib import Path

import jax
import jax.monitoring
import numpy as np
import pytest
from navigate_episodes import MANY, NUMBERS, PARAMS, STATIC, B, assert_same, sail, waters

import usvjax as uj
from usvjax.missions.dwa import run as navigate
from usvjax.missions.dwa.run import NavigateResult


@pytest.fixture(scope="module")
def plain() -> NavigateResult:
    return sail(*waters())


@pytest.fixture(scope="module")
def recorded() -> NavigateResult:
    return sail(*waters(), record=True)


# --- what comes back --------------------------------------------------------------------------


def test_shapes_and_dtypes(plain: NavigateResult) -> None:
    for name in NUMBERS:
        value = getattr(plain, name)
        assert type(value) is np.ndarray, name
        assert value.shape == (B,), name
        assert value.dtype == (np.int32 if name in ("status", "steps") else np.float32), name
    assert plain.trajectory is None
    assert 0.0 < plain.occupancy <= 1.0


def test_these_waters_end_in_every_way(plain: NavigateResult) -> None:
    assert set(plain.status) == {
        uj.Status.REACHED, uj.Status.COLLIDED, uj.Status.STUCK, uj.Status.TIMED_OUT
    }  # fmt: skip


def test_time_and_speed_follow_from_steps_and_length(plain: NavigateResult) -> None:
    np.testing.assert_array_equal(plain.time, (plain.steps * PARAMS.dt).astype(np.float32))
    np.testing.assert_array_equal(plain.mean_speed, plain.path_length / plain.time)
    timed_out = plain.status == uj.Status.TIMED_OUT
    assert (plain.steps[timed_out] == STATIC.max_steps).all()
    assert (plain.steps <= STATIC.max_steps).all()


def test_start_at_the_goal_is_reached_at_once() -> None:
    obstacles, starts, goals = waters()
    goals[::2] = starts[::2, :2] + [0.0, 0.39]  # within the tolerance of 0.4 m
    r = sail(obstacles, starts, goals, record=True)
    np.testing.assert_array_equal(r.status[::2], uj.Status.REACHED)
    for name in ("time", "steps", "path_length", "mean_speed"):
        np.testing.assert_array_equal(getattr(r, name)[::2], 0.0, err_msg=name)
    nearest = np.linalg.norm(obstacles - starts[:, None, :2], axis=2).min(axis=1) - PARAMS.radius
    np.testing.assert_allclose(r.min_clearance[::2], nearest[::2], atol=1e-6)
    assert (r.steps[1::2] > 0).all()


# --- the trajectory ---------------------------------------------------------------------------


def test_recording_changes_nothing(plain: NavigateResult, recorded: NavigateResult) -> None:
    assert_same(recorded, plain)


def test_trajectory_runs_from_the_start_to_the_last_step(recorded: NavigateResult) -> None:
    path, (_, starts, _) = recorded.trajectory, waters()
    assert path is not None
    assert path.dtype == np.float32
    assert path.shape == (B, recorded.steps.max() + 1, 5)
    np.testing.assert_array_equal(path[:, 0, :3], starts.astype(np.float32))
    np.testing.assert_array_equal(path[:, 0, 3:], 0.0)
    for row, steps in enumerate(recorded.steps):
        np.testing.assert_array_equal(path[row, steps:], path[row, steps : steps + 1].repeat(
            path.shape[1] - steps, axis=0
        ))  # fmt: skip
        assert (path[row, 1 : steps + 1] != path[row, :steps]).any(axis=1).all()


def steps_of(r: NavigateResult) -> tuple[np.ndarray, np.ndarray]:
    """States before and after each executed step, float64[steps of all, 5]."""
    assert r.trajectory is not None
    path = r.trajectory.astype(np.float64)
    executed = np.arange(path.shape[1] - 1) < r.steps[:, None]
    return path[:, :-1][executed], path[:, 1:][executed]


def test_trajectory_obeys_equation_1(recorded: NavigateResult) -> None:
    (x, y, psi, _, _), (x2, y2, psi2, v, w) = (a.T for a in steps_of(recorded))
    rounding = 4 * np.finfo(np.float32).eps
    np.testing.assert_allclose(x2, x + v * 0.1 * np.cos(psi), rtol=0, atol=rounding * 5.0)
    np.testing.assert_allclose(y2, y + v * 0.1 * np.sin(psi), rtol=0, atol=rounding * 5.0)
    turned = np.angle(np.exp(1j * (psi2 - psi - w * 0.1)))
    np.testing.assert_allclose(turned, 0.0, atol=rounding * np.pi)
    assert ((psi2 >= -np.float32(np.pi)) & (psi2 < np.float32(np.pi))).all()


def test_commands_stay_inside_the_window(recorded: NavigateResult) -> None:
    before, after = steps_of(recorded)
    p = PARAMS
    for column, low, high, loss, gain, step in (
        (3, p.v_min, p.v_max, p.v_dec, p.v_acc, p.v_step),
        (4, p.w_min, p.w_max, p.w_dec, p.w_acc, p.w_step),
    ):
        now, then = before[:, column], after[:, column]
        slack = 1e-3 * float(step) + 1e-6
        braked = np.abs(then) <= np.abs(now)  # towards zero, within v_dec or w_dec
        least = np.maximum(low, now - loss * p.dt) - 1e-6
        most = np.minimum(high, now + gain * p.dt) + slack
        assert ((then >= least) & (then <= most) | braked).all()
        assert (np.abs(then - now) <= max(loss, gain) * p.dt + slack).all()
        assert np.ptp(then) > 5 * step, "the vessels hardly steer: this shows nothing"


def test_outcomes_follow_from_the_trajectory(recorded: NavigateResult) -> None:
    obstacles, _, goals = waters()
    path = recorded.trajectory
    assert path is not None
    away = np.linalg.norm(path[:, :, None, :2] - obstacles[:, None], axis=3).min(axis=2)
    clearance = away - PARAMS.radius
    np.testing.assert_allclose(recorded.min_clearance, clearance.min(axis=1), atol=1e-6)
    collided = recorded.status == uj.Status.COLLIDED
    np.testing.assert_array_equal(collided, clearance[:, -1] < 0.0)
    first = np.arange(path.shape[1]) < recorded.steps[:, None]
    assert (clearance[first] >= 0.0).all(), "an episode went on after a collision"
    reached = np.linalg.norm(path[:, -1, :2] - goals, axis=1) <= PARAMS.goal_tolerance
    np.testing.assert_array_equal(recorded.status == uj.Status.REACHED, reached & ~collided)
    moving = np.arange(1, path.shape[1]) <= recorded.steps[:, None]
    length = (np.abs(path[:, 1:, 3]) * moving).sum(axis=1) * PARAMS.dt
    np.testing.assert_allclose(recorded.path_length, length, rtol=1e-5)
    for row in np.flatnonzero(recorded.status == uj.Status.STUCK):
        last = path[row, recorded.steps[row] - 40 : recorded.steps[row] + 1, :2]
        away = np.linalg.norm(last[:, None] - last, axis=2).max()
        assert away <= 2 * PARAMS.stuck_distance, "it was not stuck for stuck_time"


# --- how episodes are given -------------------------------------------------------------------


def test_shared_obstacles_start_and_goal_stand_for_repeated_ones() -> None:
    obstacles, starts, goals = waters()
    repeated = sail(np.repeat(obstacles[:1], B, 0), starts, np.repeat(goals[:1], B, 0))
    assert_same(sail(obstacles[0], starts, goals[0]), repeated)
    assert_same(sail(obstacles[0], starts, goals[:1]), repeated)
    assert_same(sail(obstacles, starts[0], goals), sail(obstacles, starts[[0] * B], goals))
    assert_same(sail(obstacles[0], starts[0], goals[0]), repeated, slice(0, 1))


def test_lists_and_other_dtypes_are_taken() -> None:
    obstacles, starts, goals = (np.round(a * 4) / 4 for a in waters())
    want = sail(obstacles, starts, goals)
    assert_same(sail(obstacles.tolist(), starts.tolist(), goals.tolist()), want)
    assert_same(sail(*(a.astype(np.float32) for a in (obstacles, starts, goals))), want)
    with jax.default_device(jax.devices("cpu")[0]):
        arrays = [jax.numpy.asarray(a) for a in (obstacles, starts, goals)]
    assert_same(sail(*arrays), want)


def test_without_obstacles_the_goal_is_reached() -> None:
    _, starts, _ = waters()
    goals = 2.5 * np.column_stack((np.cos(starts[:, 2]), np.sin(starts[:, 2])))
    r = sail(np.zeros((0, 2)), starts, goals)
    np.testing.assert_array_equal(r.min_clearance, np.inf)
    np.testing.assert_array_equal(r.status, uj.Status.REACHED)
    assert_same(sail(np.zeros((B, 0, 2)), starts, goals), r)


def test_masked_and_far_rows_change_nothing(plain: NavigateResult) -> None:
    obstacles, starts, goals = waters()
    more = np.concatenate([starts[:, None, :2] + [0.05, 0.05], obstacles], axis=1)
    valid = np.arange(7) > 0
    assert_same(sail(more, starts, goals, valid=valid), plain)
    assert_same(sail(more, starts, goals, valid=np.tile(valid, (B, 1))), plain)
    for far in (7.1e5, -3e6, 1e300):
        more[:, 0] = far
        assert_same(sail(more, starts, goals), plain)
    rows = np.arange(6) < np.arange(B)[:, None]  # 0, 1, 2, ... obstacles
    masked = sail(obstacles, starts, goals, valid=rows)
    for row in (0, 1, 4):
        alone = sail(obstacles[row, :row], starts[row], goals[row])
        assert_same(alone, masked, slice(row, row + 1))
    assert np.isinf(masked.min_clearance[0])


def test_shared_obstacles_may_be_masked_per_episode() -> None:
    obstacles, starts, goals = waters()
    valid = np.random.default_rng(9).random((B, 6)) < 0.5
    got = sail(obstacles[0], starts, goals, valid=valid)
    assert_same(got, sail(np.repeat(obstacles[:1], B, 0), starts, goals, valid=valid))


def test_swept_parameters_are_those_of_single_calls() -> None:
    sets = (
        PARAMS,
        replace(PARAMS, v_max=0.6, radius=0.35, dt=0.08, heading_weight=0.2, search_angle=0.6),
        replace(PARAMS, w_acc=0.5, v_dec=0.1, clear_distance=3.0, goal_tolerance=0.5, stuck_time=3),
    )
    which = np.arange(B) % len(sets)
    every = {
        f.name: np.array([getattr(sets[i], f.name) for i in which]) for f in fields(uj.DwaParams)
    }
    swept = sail(*waters(), params=uj.DwaParams(**every))
    for i, params in enumerate(sets):
        rows = which == i
        assert_same(sail(*(a[rows] for a in waters()), params=params), swept, rows)
    # One episode, several parameters.
    one = sail(*(a[0] for a in waters()), params=uj.DwaParams(**every))
    assert_same(sail(*(a[[0]] for a in waters())), one, [0])
    np.testing.assert_array_equal(one.steps[3:], one.steps[:-3])


# --- one decision -----------------------------------------------------------------------------


def test_candidates_are_those_of_the_first_step(recorded: NavigateResult) -> None:
    obstacles, starts, goals = waters()
    assert recorded.trajectory is not None
    for row in range(3):
        state = np.append(starts[row], [0.0, 0.0])
        c = uj.dwa_candidates(obstacles[row], state, goals[row], params=PARAMS, static=STATIC)
        np.testing.assert_allclose(c.command, recorded.trajectory[row, 1, 3:], atol=1e-7)
        assert c.chosen is not None
        assert c.command == pytest.approx((c.v[c.chosen[0]], c.w[c.chosen[1]]), abs=1e-7)
        assert c.score[c.chosen] == c.score[c.admissible].max()
        assert np.isneginf(c.score[~c.admissible]).all()


def test_candidates_shapes() -> None:
    obstacles, starts, goals = waters()
    state = np.append(starts[0], [0.4, 0.1])
    c = uj.dwa_candidates(obstacles[0], state, goals[0], params=PARAMS, static=STATIC)
    for name, shape in (
        ("v", (5,)),
        ("w", (11,)),
        ("end", (5, 11, 2)),
        ("paths", (5, 11, 31, 2)),
        ("clearance", (5, 11)),
        ("admissible", (5, 11)),
        ("score", (5, 11)),
    ):
        value = getattr(c, name)
        assert type(value) is np.ndarray, name
        assert value.shape == shape, name
        assert value.dtype == (bool if name == "admissible" else np.float32), name
    np.testing.assert_allclose(c.paths[:, :, -1], c.end, atol=1e-5)
    np.testing.assert_array_equal(c.paths[:, :, 0], np.broadcast_to(state[:2], (5, 11, 2)))


def test_without_an_admissible_candidate_it_brakes() -> None:
    large = replace(PARAMS, radius=0.85)  # all predicted ends, 0.9 m ahead, lie inside
    state = [0.0, 0.0, 0.0, 0.3, -0.2]
    c = uj.dwa_candidates([[0.9, 0.0]], state, [5.0, 0.0], params=large, static=STATIC)
    assert c.chosen is None
    assert not c.admissible.any()
    assert c.command == pytest.approx((0.3 - 0.2 * 0.1, -0.2 + 0.8727 * 0.1), abs=1e-6)


# --- whatever runs beside it ------------------------------------------------------------------


# Without a cap the scores lie closer together, and these waters show a sum in another order.
UNCAPPED = replace(PARAMS, clearance_cap=np.inf)
CLOSE = waters(MANY, seed=23)


def sail_many(method: str, max_lanes: int) -> NavigateResult:
    static = replace(STATIC, method=method)
    return uj.navigate_dwa(*CLOSE, params=UNCAPPED, static=static, max_lanes=max_lanes)


@cache
def one_device(method: str, max_lanes: int) -> NavigateResult:
    with jax.default_device(jax.devices("cpu")[0]):
        return sail_many(method, max_lanes)


def test_lanes_change_no_bit() -> None:
    assert_same(one_device("traditional", 16), one_device("traditional", 64))


def test_lanes_and_devices_change_no_bit(tmp_path: Path) -> None:
    command = (
        "import sys, jax, numpy as np, test_navigate as t\n"
        "assert jax.device_count() == 2\n"
        "r = t.sail_many('improved', 16)\n"
        "np.savez(sys.argv[1], **{name: getattr(r, name) for name in t.NUMBERS})\n"
    )
    here = Path(__file__).parent
    folders = os.pathsep.join([str(here), *sys.path])
    subprocess.run(
        [sys.executable, "-c", command, str(tmp_path / "two.npz")],
        check=True,
        env={**os.environ, "JAX_NUM_CPU_DEVICES": "2", "PYTHONPATH": folders},
        cwd=here.parent,
    )
    one = one_device("improved", 256)
    with np.load(tmp_path / "two.npz") as two:
        for name in NUMBERS:
            np.testing.assert_array_equal(two[name], getattr(one, name), err_msg=name)


def test_company_changes_no_bit() -> None:
    many = one_device("improved", 256)
    for row in (0, 611, MANY - 1):
        alone = sail(*(a[row] for a in CLOSE), params=UNCAPPED)
        assert_same(alone, many, slice(row, row + 1))
    assert_same(sail(*(a[100:116] for a in CLOSE), params=UNCAPPED), many, slice(100, 116))


@pytest.mark.parametrize("record", [False, True])
def test_results_come_in_the_order_of_the_episodes(
    plain: NavigateResult, monkeypatch: pytest.MonkeyPatch, record: bool
) -> None:
    # Five rows at a time, dealt by how long they promise to be, to one device and to all.
    monkeypatch.setattr(navigate, "MOST_ROWS", 5)
    monkeypatch.setattr(navigate, "MOST_LANES", 5)
    assert_same(sail(*waters(), record=record), plain)
    got = uj.navigate_dwa(*waters(), params=PARAMS, static=STATIC, record=record)
    assert_same(got, plain)
    if record:
        last = got.trajectory[np.arange(B), got.steps, :2]
        whole = sail(*waters(), record=True)
        np.testing.assert_array_equal(last, whole.trajectory[np.arange(B), whole.steps, :2])


def test_a_second_call_traces_nothing() -> None:
    traced: list[str] = []

    def note(event: str, _: float, **__: object) -> None:
        traced.append(event)

    def calls() -> None:
        uj.navigate_dwa(*waters(), params=PARAMS, static=STATIC)
        for device in jax.local_devices():
            with jax.default_device(device):
                uj.navigate_dwa(*waters(), params=PARAMS, static=STATIC)

    calls()
    jax.monitoring.register_event_duration_secs_listener(note)
    try:
        calls()
        assert [event for event in traced if "compile" in event] == []
    finally:
        jax.monitoring.unregister_event_duration_listener(note)


def test_a_heading_of_many_turns_is_the_heading() -> None:
    turns = np.array([0.0, 1.0, -3.0, 1e6])[:, None] * 2 * np.pi
    starts = np.concatenate([np.zeros((4, 2)), 0.7 + turns], axis=1)
    found = uj.navigate_dwa([[3.0, 2.0]], starts, [6.0, 4.0], record=True)
    assert found.trajectory is not None
    np.testing.assert_allclose(found.trajectory[:, 0, 2], 0.7, atol=1e-6)
    assert np.ptp(found.steps) == 0


def test_a_distant_bound_on_steps_leaves_no_episode_behind() -> None:
    static = uj.DwaStatic(max_steps=10_000_000)
    found = uj.navigate_dwa(np.full((8192, 1, 2), 50.0), [0, 0, 0], [1, 0], static=static)
    assert (found.status == uj.Status.REACHED).all()
