"""The window's choice among traffic: plain float64 NumPy finds the same; blocks change nothing."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from property_draws import FUZZ

from usvjax.missions.fleet.params import FleetParams, FleetStatic, split
from usvkernels.dwa.clearance import FAR
from usvkernels.fleet.blocks import BLOCK, decide_all
from usvkernels.fleet.choice import Asked, decide
from usvkernels.fleet.traffic import Circles, Traffic

pytestmark = pytest.mark.usefixtures("one_device")

VESSELS = 3 * BLOCK - 5
ESCAPE = 0.999999
STATIC = FleetStatic(n_v=13, n_w=9)
PARAMS = FleetParams(v_max=8.0, v_acc=0.5, v_dec=0.4, v_step=0.1, w_acc=0.05, w_step=0.015)


def drawn(seed: int) -> tuple[Asked, Traffic]:
    """Vessels among circles at rest and others that move, in single precision."""
    rng = np.random.default_rng(seed)
    settings = split(PARAMS, STATIC, "rules", None)
    motion = np.stack(
        [
            *rng.uniform(-100, 100, (2, VESSELS)),
            rng.uniform(-np.pi, np.pi, VESSELS),
            rng.uniform(0, 8, VESSELS),
            rng.uniform(-0.2, 0.2, VESSELS),
        ]
    ).astype(np.float32)
    goal = motion[:2] + rng.uniform(-400, 400, (2, VESSELS)).astype(np.float32)
    objective = replace(
        settings.objective, clearance_cap=jnp.asarray(rng.uniform(0, 500, VESSELS), jnp.float32)
    )
    asked = Asked(settings.vessel, settings.sampling, objective, motion, goal)
    still = circles(rng, 6, 900.0, 0.0)
    moving = circles(rng, 5, 400.0, 8.0)
    course = rng.uniform(5, 60, VESSELS).astype(np.float32)
    # Two right ahead, as far as they just matter, and as they just do not.
    lasts = course + STATIC.horizon
    off = still.rows[4, 1] + np.asarray(objective.clearance_cap)
    place_ahead(rng, still.rows[:, 1], motion, off + motion[3] * lasts)
    lasts = np.minimum(course, motion[3] / PARAMS.v_dec) + STATIC.horizon
    closing = motion[3] + np.hypot(*moving.rows[2:4, 1])
    place_ahead(rng, moving.rows[:, 1], motion, moving.rows[4, 1] + closing * lasts)
    return jax.tree.map(jnp.asarray, (asked, Traffic(still, moving, course)))


def circles(rng: np.random.Generator, count: int, side: float, speed: float) -> Circles:
    rows = np.concatenate(
        [
            rng.uniform(-side, side, (2, count, VESSELS)),
            rng.uniform(-speed, speed, (2, count, VESSELS)),
            *np.sort(rng.uniform(5, 60, (2, 1, count, VESSELS)), axis=0)[::-1],
        ]
    ).astype(np.float32)
    rows[:2, 0, ::7] = FAR
    return Circles(rows, count)


def place_ahead(rng: np.random.Generator, circle, motion, distance) -> None:
    """Put circles [6, vessels] about that far ahead, coming nearer if they move."""
    ahead = np.stack([np.cos(motion[2]), np.sin(motion[2])])
    circle[:2] = ahead * distance * rng.uniform(0.85, 1.05, VESSELS)
    circle[2:4] = -ahead * np.hypot(*circle[2:4])


def plain(asked: Asked, traffic: Traffic, i: int) -> tuple[float, float, float]:
    """Speed, yaw rate, and the lead in score of vessel i's choice, by sampling no formula."""
    p, s = PARAMS, STATIC
    _, _, psi, v_now, w_now = np.asarray(asked.motion, float)[:, i]
    goal = np.asarray(asked.goal - asked.motion[:2], float)[:, i]
    cap, course = float(asked.objective.clearance_cap[i]), float(traffic.course[i])
    speeds = max(0.0, v_now - p.v_dec) + p.v_step * np.arange(s.n_v)
    rates = max(-p.w_max, w_now - p.w_acc) + p.w_step * np.arange(s.n_w)
    found, braking = [], []
    for v in speeds[speeds <= min(p.v_max, v_now + p.v_acc) + 1e-3 * p.v_step]:
        for w in rates[rates <= min(p.w_max, w_now + p.w_acc) + 1e-3 * p.w_step]:
            steps = psi + w * np.arange(s.horizon)
            end = v * np.array([np.cos(steps).sum(), np.sin(steps).sum()])
            bow = np.array([np.cos(psi + w * s.horizon), np.sin(psi + w * s.horizon)])
            angle = abs(w * s.horizon) / 4
            bulge = v * s.horizon * 0.5 * (angle + 0.45 * angle**3)
            dist, clear, room = cap, True, np.inf
            for kind, weighs in ((traffic.weighing, True), (traffic.others, False)):
                for row in np.asarray(kind.rows, float)[:, :, i].T:
                    step = row[2:4] - v * np.array([np.cos(psi), np.sin(psi)])
                    clear &= nearest(row[:2], step, 1.0) > min(row[4], ESCAPE * np.hypot(*row[:2]))
                    gap, ok, soon = passes(row, end, v * bow, s.horizon, course, v / p.v_dec, bulge)
                    clear &= ok
                    dist, room = min(dist, gap) if weighs else dist, min(room, soon)
            if v == speeds[0]:
                braking.append((room, -abs(w), w))
            if clear:
                to = goal - end
                off = np.arctan2(bow[0] * to[1] - bow[1] * to[0], bow @ to)
                found.append((v, w, np.pi - abs(off), dist, v))
    if not found:
        first, second = sorted(braking)[:-3:-1]
        return speeds[0], first[2], first[0] - second[0]
    table = np.array(found)
    weights = p.heading_weight, p.clearance_weight, p.velocity_weight
    score = sum(
        weight * part / max(np.abs(part).sum(), 1e-300)
        for weight, part in zip(weights, table[:, 2:].T, strict=True)
    )
    order = np.argsort(-score)
    lead = score[order[0]] - score[order[1]] if len(order) > 1 else 1.0
    return table[order[0], 0], table[order[0], 1], lead / score[order[0]]


def passes(row, end, sails, turning, course, stopping, bulge):
    """Least distance to a circle less its reach, whether clear, and the room until it stops."""
    place, moves, reach, touch = row[:2], row[2:4], row[4], row[5]
    drawn_in = moves - end / turning
    after = place + turning * drawn_in
    closing = moves - sails
    on_turn = nearest(place, drawn_in, turning)
    escape = ESCAPE * np.hypot(*place)
    clear = on_turn > min(reach + bulge, escape)
    soon = nearest(after, closing, course, stopping)
    clear &= soon > min(reach, escape - bulge)
    far = nearest(after, closing, course)
    return min(on_turn - bulge, far) - reach, clear, min(on_turn - bulge, soon) - touch


def nearest(place, closing, lasts, at_most=np.inf):
    square = closing @ closing
    time = min(max(-(place @ closing) / square, 0.0), lasts) if square > 0.0 else 0.0
    return np.hypot(*(place + closing * min(time, at_most)))


@pytest.mark.parametrize("seed", [1, 2] if FUZZ else [1])
def test_plain_numpy_chooses_the_same(seed):
    asked, traffic = drawn(seed)
    v, w = (np.asarray(part) for part in decide(asked, traffic))
    alike, close = 0, 0
    for i in range(0, VESSELS, 3):
        wanted = plain(asked, traffic, i)
        same = abs(v[i] - wanted[0]) < 1e-4 and abs(w[i] - wanted[1]) < 1e-5
        alike += same
        close += wanted[2] < 1e-5
        assert same or wanted[2] < 1e-5, i
    assert alike > 0.95 * VESSELS / 3
    assert close < 0.05 * VESSELS / 3


@pytest.mark.parametrize("seed", [3, 4] if FUZZ else [3])
def test_blocks_and_what_they_leave_out_change_nothing(seed):
    asked, traffic = drawn(seed)
    active = np.random.default_rng(seed).random(VESSELS) < 0.7
    whole = np.stack(jax.jit(decide)(asked, traffic))
    for some in (active, np.ones(VESSELS, bool), np.arange(VESSELS) == 7):
        found = np.stack(jax.jit(decide_all)(jnp.asarray(some), asked, traffic))
        assert np.array_equal(found[:, some], whole[:, some])


def test_what_is_left_out_matters_to_nobody_who_has_no_way_clear():
    """The room to a collision decides there, which may be large: of who keeps far apart."""
    asked, traffic = drawn(6)
    near = np.array(traffic.others.rows)
    ahead = np.stack([np.cos(asked.motion[2]), np.sin(asked.motion[2])])
    # Too close, dead astern and no slower: whatever is done, it stays too close.
    near[:2, 0], near[2:4, 0] = -230.0 * ahead, 9.0 * ahead
    near[4, 0], near[5, 0] = 260.0, 10.0
    traffic = traffic._replace(others=Circles(jnp.asarray(near), traffic.others.number))
    every = jnp.ones(VESSELS, bool)
    whole = np.stack(jax.jit(decide)(asked, traffic))
    assert np.array_equal(np.stack(jax.jit(decide_all)(every, asked, traffic)), whole)


def test_nobody_is_asked():
    asked, traffic = drawn(5)
    found = np.stack(jax.jit(decide_all)(jnp.zeros(VESSELS, bool), asked, traffic))
    assert not found.any()
