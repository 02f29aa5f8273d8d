"""Fleets by the rules of the road: vessel-steps per second against a loop as users write it."""

from functools import partial
from typing import Any

import numpy as np

from benchmarks.markdown import table, verdict
from benchmarks.peers import fleet_numba
from benchmarks.timing import in_turns, spread
from usvjax.missions.fleet.inputs import Voyage, pack
from usvjax.missions.fleet.params import FleetParams, FleetStatic, strides
from usvjax.missions.fleet.run import FleetResult, sail
from usvkernels.status import Status

TITLE = "Fleets by the rules, vessel-steps per second"

SEED = 2023
SIDE = 4000.0  # m, of the square in which fleets start and end
CIRCLES = 8
PARAMS = FleetParams(hull_radius=20.0, obstacle_radius=100.0)
STATIC = FleetStatic()
APART = 4 * (PARAMS.hull_radius + PARAMS.passing)  # m, between starts, and between goals

OURS = "usvjax, float32"
STEPWISE = "numba prange, stepwise, float64"
SHARED = "numba prange, sines shared, float64"
FLEETS = {3: 1024, 10: 512, 20: 256}
"""Fleets of ours by their vessels; the peers sail the first of them."""
PEERS_SHARE = 32
BAR, AIM = 10.0, 25.0
NEAR = 0.01
"""Share by which path lengths that agree may differ."""


def measure(quick: bool) -> dict[str, Any]:
    """Time fleets of each size with all contestants in turns."""
    return {str(n): _size(n, 32 if quick else fleets) for n, fleets in FLEETS.items()}


def _size(n: int, fleets: int) -> dict[str, Any]:
    ours, _ = voyage(n, fleets, SEED + n)
    few = max(2, fleets // PEERS_SHARE)
    theirs, own = voyage(n, few, SEED + n)
    by = strides(PARAMS, STATIC)
    calls = {
        OURS: partial(sail, ours, STATIC, "rules"),
        STEPWISE: partial(fleet_numba.run, theirs, own, STATIC, by, shared=False),
        SHARED: partial(fleet_numba.run, theirs, own, STATIC, by, shared=True),
    }
    timed = in_turns(calls)
    found, some = calls[OURS](), calls[STEPWISE]()
    counts = {OURS: _arrival_steps(found), STEPWISE: _steps(some), SHARED: _steps(some)}
    for name, times in timed.items():
        times["vessel_steps"] = counts[name]
        times["per_second"] = counts[name] / times["median"]
        times["compile_seconds"] = max(0.0, times["first"] - times["median"])
    return {"fleets": fleets, "few": few, "timed": timed, **_agreement(found, some)}


def voyage(n: int, fleets: int, seed: int) -> tuple[Voyage, np.ndarray]:
    """Fleets of n with random starts, goals and circles, and the circles float64[fleets, K, 2].

    Fewer fleets of a seed are the first of more.
    """
    starts, goals = np.empty((fleets, n, 3)), np.empty((fleets, n, 2))
    circles = np.empty((fleets, CIRCLES, 2))
    for row in range(fleets):
        rng = np.random.default_rng((seed, row))
        circles[row] = rng.uniform(0.0, SIDE, (CIRCLES, 2))
        starts[row, :, :2] = _free(rng, n, circles[row])
        starts[row, :, 2] = rng.uniform(-np.pi, np.pi, n)
        goals[row] = _free(rng, n, circles[row])
    return pack(circles, starts, goals, *[None] * 5, PARAMS, STATIC), circles


def _free(rng: np.random.Generator, n: int, circles: np.ndarray) -> np.ndarray:
    """Points of the square, apart from each other and from the circles; float64[n, 2] (m)."""
    found = np.empty((0, 2))
    reach = PARAMS.hull_radius + PARAMS.obstacle_radius
    while len(found) < n:
        point = rng.uniform(0.0, SIDE, 2)
        off = np.linalg.norm(circles - point, axis=1) > 1.2 * reach
        if off.all() and (np.linalg.norm(found - point, axis=1) > APART).all():
            found = np.vstack([found, point])
    return found


def _arrival_steps(found: FleetResult) -> int:
    """Steps of the vessels that reached their goals, until they did."""
    times = found.arrival_time[found.vessel_status == int(Status.REACHED)]
    return round(float(np.sum(times, dtype=np.float64)) / float(PARAMS.dt))


def _steps(ended: fleet_numba.Ended) -> int:
    """As `_arrival_steps`, of the peer."""
    return int(ended.ended_step[ended.status == int(Status.REACHED)].sum())


def _agreement(found: FleetResult, peer: fleet_numba.Ended) -> dict[str, float]:
    """Of the fleets that both sail: how many vessels end alike, and how path lengths differ."""
    status, length = (part[: len(peer.status)] for part in (found.vessel_status, found.path_length))
    alike = status == peer.status
    off = np.abs(length - peer.path_length) / np.maximum(peer.path_length, 1.0)
    return {
        "reached": float(np.mean(status == int(Status.REACHED))),
        "reached_peer": float(np.mean(peer.status == int(Status.REACHED))),
        "statuses_alike": float(np.mean(alike)),
        "lengths_near": float(np.mean(off[alike] < NEAR)),
        "length_median": float(np.median(off[alike])),
        "length_mean": float(np.mean(length) / np.mean(peer.path_length) - 1.0),
    }


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    rows, agreed, verdicts = [], [], []
    for n, size in found.items():
        ours = size["timed"][OURS]["per_second"]
        for name, times in size["timed"].items():
            rows.append(
                (
                    f"{n} vessels, {name}",
                    size["fleets"] if name == OURS else size["few"],
                    f"{times['per_second']:,.0f}",
                    f"{ours / times['per_second']:,.1f}",
                    f"{times['compile_seconds']:.1f}",
                    spread(times["seconds"]),
                )
            )
        agreed.append(
            (
                f"{n} vessels",
                f"{size['reached']:.2%}",
                f"{size['reached_peer']:.2%}",
                f"{size['statuses_alike']:.2%}",
                f"{size['lengths_near']:.2%}",
                f"{size['length_median']:.1e}",
                f"{size['length_mean']:+.1e}",
            )
        )
        ratio = ours / size["timed"][STEPWISE]["per_second"]
        verdicts.append(
            verdict(f"{n} vessels, at least {BAR:g}x {STEPWISE}: {ratio:.1f}x", ratio >= BAR)
        )
        verdicts.append(verdict(f"{n} vessels, {AIM:g}x aimed for: {ratio:.1f}x", ratio >= AIM))
    header = ("fleets of", "fleets", "vessel-steps/s", "usvjax is x", "compile s", "timings")
    ends = (
        "float32 against float64",
        "reached",
        "peer's",
        "end alike",
        f"lengths within {NEAR:.0%}",
        "median off",
        "mean length",
    )
    return "\n\n".join(
        [
            f"Random starts, goals and {CIRCLES} circles in a square of {SIDE / 1000:g} km, hulls "
            f"of {PARAMS.hull_radius:g} m, Wei & Zhang's Tables 1 and 2 (41 x 11 candidates), "
            'encounters "rules", whole episodes, all cores. Both are given the routes; counted '
            "are the steps of vessels until they reach their goals. The peers sail the first of "
            "the fleets: whole passages as plain loops, whose candidates skip what is behind the "
            "first obstacle that rules them out.",
            table(header, rows),
            "The fleets that all sail, in closed loop. A passage holds hundreds of choices among "
            "451 candidates, of which rounding may turn any that are nearly equal. The rules of "
            "the peers are simpler: without sailing on parallel to the route, the distance that "
            "the window keeps, parting after a wait, and braking on the clearest turn. That costs "
            "them less.",
            table(ends, agreed),
            "\n".join(verdicts),
        ]
    )
