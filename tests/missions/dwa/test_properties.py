"""What must hold of the dynamic window whatever the numbers."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest
from dwa_situations import Situations, enable_x64, kernel, parameters, situations
from hypothesis import given
from hypothesis import strategies as st
from property_draws import examples

from benchmarks.peers import SLACK, Settings
from benchmarks.peers.dwa_numpy import Bools, Decision, wrap
from usvjax.missions.dwa.params import split
from usvkernels.dwa import window as dwa_window

K = 8
TIE = 1e-10  # between two scores in float64
TRADITIONAL = Settings(radius=0.5)
IMPROVED = replace(TRADITIONAL, method="improved")
METHODS = pytest.mark.parametrize("s", [TRADITIONAL, IMPROVED], ids=["traditional", "improved"])


def draw(seed: int, n: int, s: Settings = TRADITIONAL) -> Situations:
    return situations(np.random.default_rng(seed), n, K, s)


def undecided(found: Decision) -> Bools:
    """Where [S] the two best scores are a tie."""
    best = np.sort(found.score, axis=1)[:, -2:]
    return np.isfinite(best[:, 0]) & (
        best[:, 1] - np.where(np.isfinite(best[:, 0]), best[:, 0], 0.0) < TIE
    )


# --- the window -------------------------------------------------------------------------------


@given(
    v=st.floats(-1.0, 1.0),
    w=st.floats(-0.5236, 0.5236),
    dt=st.floats(0.01, 0.2),
    v_acc=st.floats(0.0, 0.25),
    v_dec=st.floats(0.0, 0.25),
    w_acc=st.floats(0.0, 0.9),
    w_dec=st.floats(0.0, 0.9),
)
@examples(150)
def test_window_lies_inside_the_limits(
    v: float, w: float, dt: float, v_acc: float, v_dec: float, w_acc: float, w_dec: float
) -> None:
    s = replace(
        TRADITIONAL, dt=dt, v_acc=v_acc, v_dec=v_dec, w_acc=w_acc, w_dec=w_dec, n_v=11, n_w=22
    )
    vessel, sampling, *_ = split(*parameters(s))
    resolution = dwa_window.resolution(vessel, sampling, jnp.dtype("float32"))
    v_i, inside_v, w_j, inside_w = (
        np.asarray(a)[:, 0]
        for a in dwa_window.window(vessel, resolution, jnp.float32([v]), jnp.float32([w]))
    )
    rounding = 3e-7
    for values, inside, now, low, high, dec, acc, step in (
        (v_i, inside_v, v, s.v_min, s.v_max, v_dec, v_acc, s.v_step),
        (w_j, inside_w, w, s.w_min, s.w_max, w_dec, w_acc, s.w_step),
    ):
        slack = SLACK * step + rounding
        assert (values[inside] >= max(low, now - dec * dt) - rounding).all()
        assert (values[inside] <= min(high, now + acc * dt) + slack).all()
        assert (values[~inside] > min(high, now + acc * dt) + SLACK * step - rounding).all()
        assert inside[0], "the lower end itself is always a candidate"
        np.testing.assert_allclose(np.diff(values), step, atol=rounding)


def test_commands_stay_inside_the_limits() -> None:
    for s in (TRADITIONAL, IMPROVED):
        case = draw(1, 5_000, s)
        v, w = kernel(s, case).command.T
        now_v, now_w = case.states[:, 3], case.states[:, 4]
        slack_v, slack_w = SLACK * s.v_step + 1e-6, SLACK * s.w_step + 1e-6
        assert (v >= s.v_min - 1e-6).all()
        assert (v <= s.v_max + slack_v).all()
        assert (np.abs(w) <= s.w_max + slack_w).all()
        assert (np.abs(v - now_v) <= s.v_acc * s.dt + slack_v).all()
        assert (np.abs(w - now_w) <= s.w_acc * s.dt + slack_w).all()


# --- symmetries -------------------------------------------------------------------------------


@METHODS
def test_mirrored_situations_give_mirrored_decisions(s: Settings) -> None:
    # The candidates are mirror images where the window is symmetric: five steps to either side.
    reach = 5 * s.w_step / s.dt
    s = replace(s, w_acc=reach, w_dec=reach, w_min=-2.0, w_max=2.0)
    case = draw(2, 4_500, TRADITIONAL)
    flip = np.array([1.0, -1.0])
    mirror = replace(
        case,
        states=case.states * [1.0, -1.0, -1.0, 1.0, -1.0],
        obstacles=case.obstacles * flip,
        goals=case.goals * flip,
    )
    with enable_x64():
        plain, mirrored = kernel(s, case), kernel(s, mirror)
    np.testing.assert_allclose(mirrored.clearance, across(plain.clearance, s), atol=1e-11)
    clear = ~undecided(plain)
    assert clear.mean() > 0.85
    i, j = np.divmod(plain.chosen, s.n_w)
    image = np.where(plain.chosen < 0, -1, i * s.n_w + s.n_w - 1 - j)
    np.testing.assert_array_equal(mirrored.chosen[clear], image[clear])
    np.testing.assert_allclose(mirrored.command[clear], plain.command[clear] * flip, atol=1e-12)


def across(a: np.ndarray, s: Settings) -> np.ndarray:
    """The candidates [S, N] in the order of their mirror images."""
    return a.reshape(-1, s.n_v, s.n_w)[:, :, ::-1].reshape(len(a), -1)


@METHODS
def test_where_the_world_lies_changes_nothing(s: Settings) -> None:
    case = draw(3, 4_500, s)
    rng = np.random.default_rng(33)
    angle = rng.uniform(-np.pi, np.pi, len(case))
    shift = rng.uniform(-1e3, 1e3, (len(case), 1, 2))

    def moved(points: np.ndarray) -> np.ndarray:
        cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
        x, y = points[..., 0], points[..., 1]
        return np.stack((cos * x - sin * y, sin * x + cos * y), axis=-1) + shift

    states = case.states.copy()
    states[:, :2] = moved(states[:, None, :2])[:, 0]
    states[:, 2] = wrap(states[:, 2] + angle)
    elsewhere = replace(
        case,
        states=states,
        obstacles=moved(case.obstacles),
        goals=moved(case.goals[:, None])[:, 0],
    )
    with enable_x64():
        here, there = kernel(s, case), kernel(s, elsewhere)
    np.testing.assert_array_equal(there.admissible, here.admissible)
    np.testing.assert_allclose(there.clearance, here.clearance, atol=1e-9)
    clear = ~undecided(here)
    assert clear.mean() > 0.85
    np.testing.assert_array_equal(there.chosen[clear], here.chosen[clear])


@METHODS
def test_padding_and_order_of_obstacles_change_nothing(s: Settings) -> None:
    case = draw(4, 2_700, s)
    n = len(case)
    rng = np.random.default_rng(44)
    order = rng.permutation(K + 5)
    padded = replace(
        case,
        # What a masked row holds is nobody's business: here, the vessel's own position.
        obstacles=np.concatenate(
            (case.obstacles, np.repeat(case.states[:, None, :2], 5, axis=1)), axis=1
        )[:, order],
        valid=np.concatenate((case.valid, np.zeros((n, 5), bool)), axis=1)[:, order],
    )
    plain, more = kernel(s, case), kernel(s, padded)
    for name in ("chosen", "command", "clearance", "admissible", "score"):
        np.testing.assert_array_equal(getattr(more, name), getattr(plain, name), err_msg=name)


# --- the search sector ------------------------------------------------------------------------


def on_axis() -> Situations:
    """A vessel at rest with an obstacle ahead, abeam, astern and to port, one at a time."""
    bearings = np.arange(8) * np.pi / 4
    obstacles = 2.0 * np.stack((np.cos(bearings), np.sin(bearings)), axis=1)[:, None]
    n = len(obstacles)
    return Situations(
        np.zeros((n, 5)),
        np.where(np.abs(obstacles) < 1e-9, 0.0, obstacles),
        np.ones((n, 1), bool),
        np.tile([10.0, 0.0], (n, 1)),
        np.zeros(n, np.int64),
    )


@pytest.mark.parametrize("angle", [np.pi, 0.9999 * np.pi])
def test_a_full_sector_is_the_traditional_method(angle: float) -> None:
    reach = 5 * TRADITIONAL.w_step / TRADITIONAL.dt  # holds exactly straight candidates
    traditional = replace(TRADITIONAL, w_acc=reach, w_dec=reach)
    improved = replace(traditional, method="improved", search_angle=angle)
    for case in (draw(5, 4_500), on_axis()):
        want, got = kernel(traditional, case), kernel(improved, case)
        np.testing.assert_array_equal(got.clearance, want.clearance)
        np.testing.assert_array_equal(got.chosen, want.chosen)


def test_a_wider_sector_never_finds_more_room() -> None:
    case = draw(6, 1_800)
    narrower = None
    with enable_x64():
        for angle in (0.05, 0.4, 1.0, np.pi / 2, 2.0, 2.8):
            s = replace(IMPROVED, search_angle=angle, clear_distance=1e4)
            clearance = kernel(s, case).clearance
            assert narrower is None or (clearance <= narrower).all()
            narrower = clearance


def test_a_vessel_at_rest_looks_ahead() -> None:
    case = on_axis()
    found = kernel(IMPROVED, case)
    ahead, astern = found.clearance[0].reshape(5, 11), found.clearance[4].reshape(5, 11)
    # Of the five speeds -0.02 .. 0.02 m/s the third is zero but for rounding.
    assert (ahead[:2] == IMPROVED.clear_distance).all()
    np.testing.assert_allclose(ahead[2], 1.5, atol=1e-6)
    assert (ahead[3:] < 1.5).all()
    assert (astern[:2] < 1.5).all()
    assert (astern[2:] == IMPROVED.clear_distance).all()


# --- scores and choice ------------------------------------------------------------------------


def test_clearance_along_the_trajectory_is_never_larger() -> None:
    case = draw(7, 900)
    endpoint = kernel(TRADITIONAL, case).clearance
    whole = kernel(replace(TRADITIONAL, clearance="trajectory"), case).clearance
    assert (whole <= endpoint + 2e-6).all()
    assert (whole < endpoint - 1e-3).any()


@pytest.mark.parametrize("part", ["heading", "clearance", "velocity"])
def test_normalised_parts_add_up_to_one(part: str) -> None:
    s = replace(
        TRADITIONAL,
        heading_weight=float(part == "heading"),
        clearance_weight=float(part == "clearance"),
        velocity_weight=float(part == "velocity"),
    )
    found = kernel(s, draw(8, 900))
    total = np.where(found.admissible, np.abs(found.score), 0.0).sum(axis=1)
    some = found.admissible.any(axis=1)
    np.testing.assert_allclose(total[some], 1.0, atol=5e-6)
    ranged = kernel(replace(s, normalise="range"), draw(8, 900))
    scores = ranged.score[ranged.admissible]
    assert scores.min() >= 0.0
    assert scores.max() <= 1.0 + 1e-6


def test_equal_scores_go_to_the_first() -> None:
    s = replace(TRADITIONAL, heading_weight=0.0, clearance_weight=0.0, velocity_weight=0.0)
    found = kernel(s, draw(9, 900))
    some = found.admissible.any(axis=1)
    np.testing.assert_array_equal(found.chosen[some], found.admissible[some].argmax(axis=1))
    assert (found.chosen[~some] == -1).all()


def test_braking_where_nothing_is_admissible() -> None:
    s = TRADITIONAL
    case = draw(10, 900)
    found = kernel(s, case)
    trapped = found.chosen == -1
    np.testing.assert_array_equal(trapped, ~found.admissible.any(axis=1))
    now = case.states[trapped, 3:]
    step = np.array([s.v_dec, s.w_dec]) * s.dt
    want = np.sign(now) * np.maximum(np.abs(now) - step, 0.0)
    np.testing.assert_allclose(found.command[trapped], want, atol=1e-7)
    assert (want == 0.0).any()
    assert (want != 0.0).any()


def test_admissible_commands_can_stop_in_time() -> None:
    for s in (TRADITIONAL, IMPROVED):
        found = kernel(s, draw(11, 2_700, s))
        room = np.broadcast_to(found.clearance, found.v.shape)[found.admissible] + 1e-5
        assert (found.v[found.admissible] ** 2 / (2 * s.v_dec) <= room).all()
        assert (found.w[found.admissible] ** 2 / (2 * s.w_dec) <= room).all()
        assert (found.clearance[found.admissible] > 0.0).all()
