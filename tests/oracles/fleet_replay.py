"""Recorded fleets judged again, step by step, in NumPy and double precision.

Nothing of the kernels is imported: the rules are those of the public docstrings and of
docs/equations.md. Each step begins at the recorded state, so no error adds up. Arrays are [B, T, n]
unless said otherwise: fleets, steps with the start, vessels.
"""

from dataclasses import dataclass

import numpy as np

RUNNING, REACHED, COLLIDED, STUCK, TIMED_OUT = range(5)
ABSENT = -1

AT_REST = 0.01  # m/s, below which a vessel whose passage has ended has stopped
MOST_AROUND = 6  # approaches off the heading, after which a vessel is stuck
NEAR = 0.5  # of the way to the guidance point, within which it moves on
CLOSING = 0.35  # of the way left, how far ahead on its guide segment a vessel steers for
COMFORT, TURNING = (
    0.8,
    0.1,
)  # of the deceleration, to stop at the goal with; of that speed, at least

METRES, CONTACT, RADIANS = 1e-3, 1e-4, 1e-5
"""By what single precision may be off, 2 km from the origin; the second, of what is near (m)."""


@dataclass(frozen=True)
class Asked:
    """What B fleets of n vessels were given.

    Attributes:
        strategy: of encounters.
        status: int[B, n], at the start.
        circles: float64[B, K, 2] (m).
        points: float64[B, n, P, 2], of the routes (m); ahead: int[B, n, P], the guidance point of
            each; last, gate: int[B, n], that of the goal, and the first of the guide segment.
        bow: float64[B, n, 2], unit vectors of the headings to arrive on, 0 where any will do.
        numbers: float64[B, n] each, by the names of `FleetParams`.
        unit: of the routes (m).
        max_steps: of an episode.
    """

    strategy: str
    status: np.ndarray
    circles: np.ndarray
    points: np.ndarray
    ahead: np.ndarray
    last: np.ndarray
    gate: np.ndarray
    bow: np.ndarray
    numbers: dict[str, np.ndarray]
    unit: float
    max_steps: int

    def point(self, index: np.ndarray) -> np.ndarray:
        """Points of the routes, float64[B, n, 2] (m)."""
        return np.take_along_axis(self.points, index[..., None, None], axis=2)[:, :, 0]

    def ahead_of(self, index: np.ndarray) -> np.ndarray:
        """Guidance points, int[B, n]."""
        return np.take_along_axis(self.ahead, index[..., None], axis=2)[..., 0]


@dataclass(frozen=True)
class Verdict:
    """How passages ended, [B, n]; `steps` int[B].

    Attributes:
        status, ended: and the step at which they did.
        livelock: of those that are stuck.
        moved: the last step in which a vessel moved.
        steps: until all had ended and were at rest.
        returns: bool[B, T, n], on the way around, back to the guide segment.
    """

    status: np.ndarray
    ended: np.ndarray
    livelock: np.ndarray
    moved: np.ndarray
    steps: np.ndarray
    returns: np.ndarray


# --- distances --------------------------------------------------------------------------------


def _least(start: np.ndarray, way: np.ndarray) -> np.ndarray:
    """Least distance to the origin along segments [..., 2]."""
    square = np.maximum(np.sum(way * way, axis=-1), 1e-300)
    share = np.clip(-np.sum(start * way, axis=-1) / square, 0, 1)
    return np.linalg.norm(start + share[..., None] * way, axis=-1)


def separations(track: np.ndarray, hull: np.ndarray, present: np.ndarray) -> np.ndarray:
    """Least distance of each hull to any other in each step, float64[..., T - 1, n]; inf alone.

    Args:
        track: float[..., T, n, 5].
        hull: float64[..., n], radii (m).
        present: bool[..., n].
    """
    place = track[..., :2].astype(np.float64)
    apart = place[..., None, :, :] - place[..., :, None, :]
    least = _least(apart[..., :-1, :, :, :], np.diff(apart, axis=-4))
    least -= (hull[..., None] + hull[..., None, :])[..., None, :, :]
    pair = present[..., None] & present[..., None, :] & ~np.eye(hull.shape[-1], dtype=bool)
    return np.where(pair[..., None, :, :], least, np.inf).min(axis=-1)


def clearances(track: np.ndarray, circles: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Least distance from each hull to a circle in each step, float64[..., T - 1, n].

    Args:
        track: float[..., T, n, 2 or more].
        circles: float64[..., K, 2], centres (m).
        reach: float64[..., n], radii of hull and circle (m).
    """
    place = track[..., :2].astype(np.float64)
    start = place[..., :-1, :, None, :] - circles[..., None, None, :, :]
    way = np.diff(place, axis=-3)[..., None, :]
    return _least(start, way).min(axis=-1) - reach[..., None, :]


def nearest(asked: Asked, track: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least distances to another hull and to a circle in each step, the start's alone first."""
    still = np.concatenate([track[:, :1], track], axis=1)
    hull = asked.numbers["hull_radius"]
    reach = hull + asked.numbers["obstacle_radius"]
    apart = separations(still, hull, asked.status != ABSENT)
    return apart, clearances(still, asked.circles, reach)


# --- what vessels do in a step ----------------------------------------------------------------


def departures(
    asked: Asked, track: np.ndarray, verdict: Verdict, judged: np.ndarray
) -> dict[str, float]:
    """By how much the worst step departs from how a vessel moves and what it may command.

    Args:
        asked: of the fleets.
        track: float[B, T, n, 5], as recorded.
        verdict: which steps are under way.
        judged: bool[B, n], whose steps count.

    Returns:
        By name: `place` (m) and `heading` (rad) against the unicycle's Euler step; past its limits
        `speed` (m/s), `turn` (rad/s), `gain`, `loss` (m/s in a step) and `swing` (rad/s in a step);
        against the window's candidates `speeds` (m/s) and `turns` (rad/s); `cap`, past what leaves
        room to stop at the goal (m/s); `anchor`, of who has ended against braking without turning.
    """
    x, y, psi, v, w = np.moveaxis(track.astype(np.float64), -1, 0)
    of = {name: value[:, None] for name, value in asked.numbers.items()}
    dt, speed, turn = of["dt"], v[:, 1:], w[:, 1:]
    before = v[:, :-1], w[:, :-1], psi[:, :-1]
    # The command of step k + 1 is given by who has not ended at k.
    ahead = np.arange(track.shape[1] - 1)[:, None] < verdict.ended[:, None]
    ahead &= (asked.status == RUNNING)[:, None]
    lost, gained = speed - before[0] + of["v_dec"] * dt, speed - before[0] - of["v_acc"] * dt
    slowest = np.maximum(before[0] - of["v_dec"] * dt, 0)
    easing = np.sign(before[1]) * np.maximum(np.abs(before[1]) - of["w_acc"] * dt, 0)
    found = {
        "place": np.hypot(
            x[:, :-1] + speed * dt * np.cos(before[2]) - x[:, 1:],
            y[:, :-1] + speed * dt * np.sin(before[2]) - y[:, 1:],
        ),
        "heading": np.abs(_wrapped(before[2] + turn * dt - psi[:, 1:])),
        "speed": np.maximum(speed - of["v_max"], -speed),
        "turn": np.abs(turn) - of["w_max"],
        "gain": gained,
        "loss": np.where(speed > 0, -lost, 0),
        "swing": np.where(ahead, np.abs(turn - before[1]) - of["w_acc"] * dt, 0),
        "anchor": np.where(ahead, 0, np.maximum(np.abs(speed - slowest), np.abs(turn))),
    }
    if asked.strategy != "orca":
        lowest = np.maximum(before[1] - of["w_acc"] * dt, -of["w_max"])
        off = _off_lattice(turn - lowest, of["w_step"])
        found["turns"] = np.where(ahead, np.minimum(off, np.abs(turn - easing)), 0)
        found["speeds"] = np.where(ahead, _off_lattice(speed - slowest, of["v_step"]), 0)
        cap = np.maximum(_comfort(asked, track, verdict), slowest)
        found["cap"] = np.where(ahead, speed - cap, 0)
    return {
        name: float(np.max(np.where(judged[:, None], value, 0))) for name, value in found.items()
    }


def _off_lattice(value: np.ndarray, step: np.ndarray) -> np.ndarray:
    return np.abs(value - np.round(value / step) * step)


def _wrapped(angle: np.ndarray) -> np.ndarray:
    return (angle + np.pi) % (2 * np.pi) - np.pi


def _comfort(asked: Asked, track: np.ndarray, verdict: Verdict) -> np.ndarray:
    """Speed from which a vessel can stop at its goal, less where that is abeam; m/s."""
    left = asked.point(asked.last)[:, None] - track[:, :-1, :, :2]
    psi = track[:, :-1, :, 2].astype(np.float64)
    distance = np.linalg.norm(left, axis=-1)
    ahead = np.cos(psi) * left[..., 0] + np.sin(psi) * left[..., 1]
    abeam = np.clip(ahead / np.maximum(distance, 1e-3), TURNING, 1.0)
    wanted = abeam * np.sqrt(2 * COMFORT * asked.numbers["v_dec"][:, None] * distance)
    wanted = np.where(verdict.returns[:, :-1], np.inf, wanted)
    return np.minimum(wanted, asked.numbers["v_max"][:, None])


# --- endings ----------------------------------------------------------------------------------


def judge(asked: Asked, track: np.ndarray, early: float = 0.0) -> Verdict:
    """How and when passages end.

    Args:
        asked: of the fleets; no route's point may be passed by in a step.
        track: float[B, T, n, 5], as recorded.
        early: tolerances by which every ending comes before its threshold.
    """
    assert np.max(asked.numbers["v_max"] * asked.numbers["dt"]) <= asked.unit
    of, slack = asked.numbers, early * METRES
    place = track[..., :2].astype(np.float64)
    psi, v = track[..., 2].astype(np.float64), track[..., 3].astype(np.float64)
    present = asked.status != ABSENT
    apart, clear = nearest(asked, track)
    hit = (np.minimum(apart, clear) < early * CONTACT) & present[:, None]
    status, anchor = asked.status.copy(), place[:, 0].copy()
    zero = np.zeros_like(status)
    ended, anchored, index, came, moved, around = (zero.copy() for _ in range(6))
    returns = deadlock = np.zeros(status.shape, bool)
    steps = np.full(len(track), -1)
    history = []
    for k in range(track.shape[1]):
        under_way = status == RUNNING
        if k:
            held = returns | _yields(asked, place[:, k - 1], psi[:, k - 1], index, returns, status)
            onward = _onward(asked, place[:, k], index, slack) & ~held
            index, came = index + onward, np.where(onward, k, came)
        made = np.linalg.norm(place[:, k] - anchor, axis=-1) > of["stuck_distance"] + slack
        anchor = np.where(made[..., None], place[:, k], anchor)
        anchored = np.where(made, k, anchored)
        there, missed, returns = _approach(asked, place[:, k], psi[:, k], index, returns, early)
        idle = (k - anchored) * of["dt"] >= of["stuck_time"]
        nowhere = ((k - came) * of["dt"] >= of["livelock_time"]) | (around >= MOST_AROUND)
        index, around = np.where(missed, asked.gate, index), around + missed
        new = np.where(idle | nowhere, STUCK, TIMED_OUT if k >= asked.max_steps else RUNNING)
        status = np.where(under_way, np.where(there, REACHED, new), status)
        status = np.where(hit[:, k], COLLIDED, status)
        ended, deadlock = np.where(under_way, k, ended), np.where(under_way, idle, deadlock)
        moving = v[:, k] > AT_REST
        moved = np.where(moving, k, moved)
        history.append(returns)
        over = ~np.any((status == RUNNING) | (moving & present), axis=1)
        steps = np.where(over & (steps < 0), k, steps)
    livelock = (status == STUCK) & ~deadlock
    return Verdict(status, ended, livelock, moved, steps, np.stack(history, axis=1))


def judged(asked: Asked, track: np.ndarray) -> tuple[Verdict, np.ndarray]:
    """How passages end, and which of them, bool[B, n], otherwise within tolerances of a threshold.

    Args: as of `judge`.
    """
    verdict, *shifted = (judge(asked, track, early) for early in (0.0, 1.0, -1.0))
    near = np.zeros(verdict.status.shape, bool)
    for other in shifted:
        for name in ("status", "ended", "livelock"):
            near |= getattr(other, name) != getattr(verdict, name)
    return verdict, near


def _onward(asked: Asked, place: np.ndarray, index: np.ndarray, slack: float) -> np.ndarray:
    """Whether vessels have come to the next point of their routes, bool[B, n].

    That is when it is nearer, or the guidance point is within a half of the way along the route.
    """
    to = [
        np.linalg.norm(asked.point(at) - place, axis=-1)
        for at in (index, np.minimum(index + 1, asked.last), asked.ahead_of(index))
    ]
    close = to[2] < NEAR * asked.unit * (asked.ahead_of(index) - index) + slack
    return (index < asked.last) & ((to[1] <= to[0] + slack) | close)


def _approach(
    asked: Asked,
    place: np.ndarray,
    psi: np.ndarray,
    index: np.ndarray,
    returns: np.ndarray,
    early: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Who is at its goal as it should be, who missed it, and who is on its way around; bool[B, n].

    On the guide segment alone a vessel arrives. Off the heading there, or past the goal, it goes
    back to within the unit length of where the segment begins.
    """
    tolerance = asked.numbers["goal_tolerance"] + early * METRES
    left = asked.point(asked.last) - place
    bow = asked.bow
    along = np.cos(psi) * bow[..., 0] + np.sin(psi) * bow[..., 1]
    across = np.sin(psi) * bow[..., 0] - np.cos(psi) * bow[..., 1]
    off = np.abs(np.arctan2(across, along))
    fits = off <= asked.numbers["heading_tolerance"] + early * RADIANS
    fits |= ~bow.any(axis=-1)
    near = np.linalg.norm(left, axis=-1) <= tolerance
    past = np.sum(bow * left, axis=-1) < early * METRES - asked.numbers["goal_tolerance"]
    led = (index >= asked.gate) & ~returns
    missed = led & ((near & ~fits) | past)
    begins = np.linalg.norm(asked.point(asked.gate) - place, axis=-1)
    back = returns & (begins > asked.unit - early * METRES)
    return led & near & fits, missed, missed | back


def _yields(
    asked: Asked,
    place: np.ndarray,
    psi: np.ndarray,
    index: np.ndarray,
    returns: np.ndarray,
    status: np.ndarray,
) -> np.ndarray:
    """Who keeps its guidance point for another, bool[B, n]: by "wei2023" alone.

    Of two under way whose guidance points are within the threshold, that with the smaller bearing
    of the other off its bow; of equals, the later one of the fleet.
    """
    if asked.strategy != "wei2023":
        return np.zeros(status.shape, bool)
    guide = _guides(asked, place, index, returns)
    between = np.linalg.norm(guide[:, None] - guide[:, :, None], axis=-1)
    n = status.shape[1]
    both = (status == RUNNING)[:, None] & (status == RUNNING)[:, :, None] & ~np.eye(n, dtype=bool)
    meets = both & (between <= asked.numbers["threshold"][..., None])
    east, north = np.moveaxis(place[:, None] - place[:, :, None], -1, 0)
    bearing = np.abs(_wrapped(np.arctan2(north, east) - psi[..., None]))
    theirs = bearing.swapaxes(1, 2)
    earlier = np.arange(n)[:, None] < np.arange(n)
    return np.any(meets & ((bearing < theirs) | ((bearing == theirs) & ~earlier)), axis=2)


def _guides(asked: Asked, place: np.ndarray, index: np.ndarray, returns: np.ndarray) -> np.ndarray:
    """Guidance points, float64[B, n, 2] (m)."""
    goal, begins, bow = asked.point(asked.last), asked.point(asked.gate), asked.bow
    led = bow.any(axis=-1) & (index >= asked.gate)
    left = np.sum(bow * (goal - place), axis=-1)
    beyond = np.maximum(CLOSING * left, asked.unit) - left
    guide = np.where(
        led[..., None], goal + beyond[..., None] * bow, asked.point(asked.ahead_of(index))
    )
    return np.where(returns[..., None], begins, guide)
