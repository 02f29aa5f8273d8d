"""The dynamic window approach as a numba `prange` loop over episodes.

Written as users write it: compiled functions over plain loops, a stepwise Euler rollout of each
candidate, no fastmath. `closed_form=True` gives the same loop the closed-form rollout of the
kernels, its trigonometry shared by all candidates of one yaw rate, so that the comparison can
tell the algebra from the machine.

Arrays keep the caller's dtype (float64 or float32) throughout: every constant travels in that
dtype, because numba would otherwise promote float32 arithmetic to float64.

Endpoint clearance and normalisation by the sum only. All given obstacles count as existing.
"""

from dataclasses import asdict
from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt
from numba.np.unsafe.ndarray import to_fixed_tuple

from benchmarks.peers import SLACK, Settings

Real = npt.NDArray[Any]


class Numbers(NamedTuple):
    """`Settings` as scalars of one dtype, with the constants that the loops need."""

    v_min: Any
    v_max: Any
    w_min: Any
    w_max: Any
    v_acc: Any
    v_dec: Any
    w_acc: Any
    w_dec: Any
    heading_weight: Any
    clearance_weight: Any
    velocity_weight: Any
    dt: Any
    clearance_cap: Any
    clear_distance: Any
    radius: Any
    cos_phi: Any
    sin_phi: Any
    v_slack: Any  # tolerance of the window's end and of standing still
    w_slack: Any
    span: Any  # the horizon as a real number
    zero: Any
    half: Any
    two: Any
    pi: Any
    two_pi: Any
    infinity: Any


N_NUMBERS = len(Numbers._fields)


def _problem(s: Settings, dtype: npt.DTypeLike, closed_form: bool) -> tuple[Any, ...]:
    """Return (numbers, speed offsets, yaw-rate offsets, horizon, improved, closed_form)."""
    if s.clearance != "endpoint" or s.normalise != "sum":
        raise ValueError(
            "the numba peer has clearance='endpoint' and normalise='sum' only, "
            f"got {s.clearance!r} and {s.normalise!r}"
        )
    constants = {
        "cos_phi": np.cos(s.search_angle),
        "sin_phi": np.sin(s.search_angle),
        "v_slack": SLACK * s.v_step,
        "w_slack": SLACK * s.w_step,
        "span": s.horizon,
        "zero": 0.0,
        "half": 0.5,
        "two": 2.0,
        "pi": np.pi,
        "two_pi": 2.0 * np.pi,
        "infinity": np.inf,
    }
    values = asdict(s) | constants
    return (
        np.array([values[name] for name in Numbers._fields], dtype),
        (np.arange(s.n_v) * s.v_step).astype(dtype),
        (np.arange(s.n_w) * s.w_step).astype(dtype),
        s.horizon,
        s.method == "improved",
        closed_form,
    )


@nb.njit
def _named(a):  # type: ignore[no-untyped-def]
    """Name the packed numbers; arrays are all that a parallel loop can take."""
    return Numbers(*to_fixed_tuple(a, N_NUMBERS))


@nb.njit
def _rollout(x, y, psi, v, w, p, horizon):  # type: ignore[no-untyped-def]
    """Predict by Euler steps of Eq. 1: end position and heading."""
    for _ in range(horizon):
        x += v * p.dt * np.cos(psi)
        y += v * p.dt * np.sin(psi)
        psi += w * p.dt
    return x, y, psi


@nb.njit
def _unit_rollout(psi, w, p):  # type: ignore[no-untyped-def]
    """Return the closed form of the rollout for v = 1 m/s: displacement and heading at the end."""
    turn = p.half * w * p.dt
    gain = p.span
    if turn != p.zero:
        gain = np.sin(p.span * turn) / np.sin(turn)
    middle = psi + (p.span * turn - turn)
    return gain * p.dt * np.cos(middle), gain * p.dt * np.sin(middle), psi + p.span * w * p.dt


@nb.njit
def _nearest_square(px, py, obstacles, p):  # type: ignore[no-untyped-def]
    """Return the squared distance from (px, py) to the nearest obstacle centre."""
    nearest = p.infinity
    for k in range(obstacles.shape[0]):
        dx = obstacles[k, 0] - px
        dy = obstacles[k, 1] - py
        nearest = min(nearest, dx * dx + dy * dy)
    return nearest


@nb.njit
def _nearest_square_ahead(px, py, heading, v, obstacles, p):  # type: ignore[no-untyped-def]
    """Return the same among the obstacles whose circles meet the search sector at (px, py)."""
    nearest = p.infinity
    ux = np.cos(heading)
    uy = np.sin(heading)
    if v < -p.v_slack:
        ux = -ux
        uy = -uy
    for k in range(obstacles.shape[0]):
        dx = obstacles[k, 0] - px
        dy = obstacles[k, 1] - py
        square = dx * dx + dy * dy
        if square < nearest:
            along = dx * ux + dy * uy
            across = abs(dx * uy - dy * ux)
            outside = across * p.cos_phi - along * p.sin_phi
            beside = along * p.cos_phi + across * p.sin_phi
            if (
                outside <= p.zero
                or (outside <= p.radius and beside > p.zero)
                or square <= p.radius * p.radius
            ):
                nearest = square
    return nearest


@nb.njit
def _clearance(px, py, heading, v, obstacles, p, improved):  # type: ignore[no-untyped-def]
    if improved:
        nearest = _nearest_square_ahead(px, py, heading, v, obstacles, p)
    else:
        nearest = _nearest_square(px, py, obstacles, p)
    if nearest == p.infinity:
        return min(p.clear_distance, p.clearance_cap)
    return min(np.sqrt(nearest) - p.radius, p.clearance_cap)


@nb.njit
def _weigh(  # type: ignore[no-untyped-def]
    state, obstacles, goal, problem, parts, score, admissible
):
    """Fill score[N] and admissible[N] (parts[3, N] is scratch); return the choice and (v, w)."""
    numbers, v_offsets, w_offsets, horizon, improved, closed_form = problem
    p = _named(numbers)
    x, y, psi, v_now, w_now = state[0], state[1], state[2], state[3], state[4]
    v_first = max(p.v_min, v_now - p.v_dec * p.dt)
    v_last = min(p.v_max, v_now + p.v_acc * p.dt) + p.v_slack
    w_first = max(p.w_min, w_now - p.w_dec * p.dt)
    w_last = min(p.w_max, w_now + p.w_acc * p.dt) + p.w_slack
    n_v = v_offsets.shape[0]
    n_w = w_offsets.shape[0]
    heading_sum = clearance_sum = speed_sum = p.zero
    for j in range(n_w):
        w = w_first + w_offsets[j]
        if closed_form:
            unit_x, unit_y, heading = _unit_rollout(psi, w, p)
        for i in range(n_v):
            v = v_first + v_offsets[i]
            n = i * n_w + j
            admissible[n] = False
            if v > v_last or w > w_last:
                continue
            if closed_form:
                px = x + v * unit_x
                py = y + v * unit_y
            else:
                px, py, heading = _rollout(x, y, psi, v, w, p, horizon)
            dist = _clearance(px, py, heading, v, obstacles, p, improved)
            reach = p.two * dist
            if dist <= p.zero or v * v > reach * p.v_dec or w * w > reach * p.w_dec:
                continue
            theta = np.arctan2(goal[1] - py, goal[0] - px) - heading
            theta = abs((theta + p.pi) % p.two_pi - p.pi)
            admissible[n] = True
            parts[0, n] = p.pi - theta
            parts[1, n] = dist
            parts[2, n] = v
            heading_sum += p.pi - theta
            clearance_sum += dist
            speed_sum += abs(v)
    # Dividing by infinity drops a part whose magnitudes add up to nothing.
    by_heading = p.heading_weight / (heading_sum if heading_sum > p.zero else p.infinity)
    by_clearance = p.clearance_weight / (clearance_sum if clearance_sum > p.zero else p.infinity)
    by_speed = p.velocity_weight / (speed_sum if speed_sum > p.zero else p.infinity)
    chosen = -1
    best = -p.infinity
    for n in range(n_v * n_w):
        score[n] = -p.infinity
        if admissible[n]:
            score[n] = (
                by_heading * parts[0, n] + by_clearance * parts[1, n] + by_speed * parts[2, n]
            )
            if score[n] > best:
                best = score[n]
                chosen = n
    if chosen < 0:
        v = max(abs(v_now) - p.v_dec * p.dt, p.zero)
        w = max(abs(w_now) - p.w_dec * p.dt, p.zero)
        return chosen, v if v_now > p.zero else -v, w if w_now > p.zero else -w
    return (
        chosen,
        v_first + v_offsets[chosen // n_w],
        w_first + w_offsets[chosen % n_w],
    )


@nb.njit
def _episode(state, obstacles, goal, problem, steps):  # type: ignore[no-untyped-def]
    """Take `steps` decisions; `state` becomes the final one."""
    p = _named(problem[0])
    n = problem[1].shape[0] * problem[2].shape[0]
    parts = np.empty((3, n), state.dtype)
    score = np.empty(n, state.dtype)
    admissible = np.empty(n, np.bool_)
    for _ in range(steps):
        _, v, w = _weigh(state, obstacles, goal, problem, parts, score, admissible)
        psi = state[2]
        state[0] += v * p.dt * np.cos(psi)
        state[1] += v * p.dt * np.sin(psi)
        state[2] = (psi + w * p.dt + p.pi) % p.two_pi - p.pi
        state[3] = v
        state[4] = w


@nb.njit(parallel=True)
def _run(  # type: ignore[no-untyped-def]
    states, obstacles, goals, numbers, v_offsets, w_offsets, horizon, improved, closed_form, steps
):
    for b in nb.prange(states.shape[0]):
        problem = (numbers, v_offsets, w_offsets, horizon, improved, closed_form)
        _episode(states[b], obstacles[b], goals[b], problem, steps)


@nb.njit
def _decide(states, obstacles, goals, problem, chosen, score, admissible):  # type: ignore[no-untyped-def]
    parts = np.empty((3, score.shape[1]), states.dtype)
    for b in range(states.shape[0]):
        chosen[b], _, _ = _weigh(
            states[b], obstacles[b], goals[b], problem, parts, score[b], admissible[b]
        )


def run(
    poses: Real,
    obstacles: Real,
    goals: Real,
    params: Settings,
    steps: int,
    closed_form: bool = False,
) -> Real:
    """Take `steps` decisions in closed loop and return the final states [B, 5].

    Args:
        poses: float[B, 5] (x, y, psi, v, w); its dtype is the arithmetic's.
        obstacles: float[B, K, 2] centres, m, same dtype.
        goals: float[B, 2], m, same dtype.
        params: numbers and choices of the method.
        steps: decisions per episode; an episode goes on after it reached or hit something.
        closed_form: predict by the closed form instead of step by step.

    Raises:
        ValueError: `params` asks for an option that this peer does not have.
    """
    states = poses.copy()
    problem = _problem(params, poses.dtype, closed_form)
    _run(states, obstacles, goals, *problem, steps)  # type: ignore[call-arg]
    return states


def decide(
    states: Real, obstacles: Real, goals: Real, params: Settings, closed_form: bool = False
) -> tuple[npt.NDArray[np.int64], Real, npt.NDArray[np.bool_]]:
    """Weigh S single situations and return (chosen [S], score [S, N], admissible [S, N]).

    `chosen` is -1 and every score -inf where no candidate is admissible. Arguments as for `run`.

    Raises:
        ValueError: `params` asks for an option that this peer does not have.
    """
    n = params.n_v * params.n_w
    chosen = np.empty(len(states), np.int64)
    score = np.empty((len(states), n), states.dtype)
    admissible = np.empty((len(states), n), np.bool_)
    problem = _problem(params, states.dtype, closed_form)
    _decide(states, obstacles, goals, problem, chosen, score, admissible)
    return chosen, score, admissible
