"""Cruises of ten stations: so many per second in one call, against one at a time in Python."""

import statistics
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import partial
from typing import Any

import numpy as np

import usvjax as uj
from benchmarks.markdown import table, verdict
from benchmarks.peers import cruise_plain
from benchmarks.processes import FreshProcess
from benchmarks.timing import in_turns, seconds_of, spread
from usvjax.devices import usable_cores
from usvjax.missions.cruise import CruiseParams, CruiseResult, CruiseStatic, cruise
from usvkernels.status import Status

TITLE = "Cruises per second"
CRUISES = 1000
CELL = 10.0  # m
SIDE, DENSITY, STATIONS, RATE = 50, 0.10, 10, 0.03
PEER_CRUISES = 10  # per core
REPETITIONS = 5
LEAST_RATIO = 20.0
METHODS: dict[str, dict[str, Any]] = {
    "D* Lite, Eq. 17 (the default)": {},
    "D* Lite, octile": {"heuristic": "octile"},
    "D* Lite, Chebyshev": {"heuristic": "chebyshev"},
    "A* anew": {"method": "astar"},
}
SCOPES = {
    "window, 3 %": (0.03, "window"),
    "window, 1 %": (0.01, "window"),
    "window, 10 %": (0.10, "window"),
    "map, 0.01 %": (0.0001, "map"),
    "map, 0.1 %": (0.001, "map"),
    "map, 3 %": (0.03, "map"),
}
"""How often cells flip at a step, and where."""


def measure(quick: bool) -> dict[str, Any]:
    """Sail the same stations each way."""
    count = 64 if quick else CRUISES
    maps, stations, order = drawn(count)

    def sail(**options: Any) -> CruiseResult:
        return cruise(maps, stations, 1, order=order, **options)

    def some(rate: float, scope: str) -> CruiseResult:
        rows = slice(max(count // 5, 1))
        return cruise(
            maps[rows],
            stations[rows],
            1,
            order=order[rows],
            params=CruiseParams(flip_rate=rate),
            static=CruiseStatic(flip_scope=scope),
        )

    calls = {name: lambda how=how: sail(**how) for name, how in METHODS.items()}
    timed = in_turns(calls, repetitions=1 if quick else REPETITIONS)
    return {
        "cruises": count,
        "timed": timed,
        "sailed": {name: _summary(call()) for name, call in calls.items()},
        "peers": _peers(maps, stations, order, 1 if quick else PEER_CRUISES),
        "scopes": {name: _timed_summary(partial(some, *how)) for name, how in SCOPES.items()},
    }


def drawn(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Maps, stations anywhere on them, and an order: always on to the nearest station left."""
    rng = np.random.default_rng(2022)
    maps = uj.random_maps(2022, count, (SIDE, SIDE), DENSITY)
    cells = np.stack([rng.permutation(SIDE * SIDE)[:STATIONS] for _ in range(count)])
    stations = np.stack([cells % SIDE, cells // SIDE], axis=-1)
    rows = np.arange(count)
    maps[rows[:, None], stations[..., 1], stations[..., 0]] = False
    apart = np.linalg.norm(stations[:, :, None] - stations[:, None], axis=-1)
    order = np.zeros((count, STATIONS), int)
    for k in range(1, STATIONS):
        apart[rows, :, order[:, k - 1]] = np.inf
        order[:, k] = apart[rows, order[:, k - 1]].argmin(axis=1)
    return maps, stations, order


def _summary(result: CruiseResult) -> dict[str, float]:
    return {
        "reached": float(np.mean(result.status == Status.REACHED)),
        "visited": float(result.visited.mean()),
        "home": float(np.mean(result.leg_status[:, -1] == Status.REACHED)),
        "length": float(result.length.mean()),
        "smooth_length": float(result.smooth_length.mean()),
        "inflections": float(result.inflections.mean()),
        "smooth_inflections": float(result.smooth_inflections.mean()),
        "waits": float(result.waits.mean()),
        "expanded": float(result.expanded.mean()),
        "replanned": float(result.replanned.mean()),
        "occupancy": result.occupancy,
    }


def _timed_summary(call: Any) -> dict[str, float]:
    result = call()
    return {"rate": len(result.status) / seconds_of(call), **_summary(result)}


def _peers(
    maps: np.ndarray, stations: np.ndarray, order: np.ndarray, each: int
) -> dict[str, dict[str, Any]]:
    """Plain Python with a process per core, each with cruises of its own."""
    stops = np.take_along_axis(stations, np.append(order, order[:, :1], 1)[..., None], axis=1)
    shares = [slice(j * each, (j + 1) * each) for j in range(usable_cores())]
    found = {}
    for name in cruise_plain.PLANNERS:
        work = [(name, maps[rows], stops[rows], RATE) for rows in shares]
        lengths: list[float] = []
        with ExitStack() as stack:
            crew = [stack.enter_context(FreshProcess()) for _ in shares]
            pool = stack.enter_context(ThreadPoolExecutor(len(crew)))
            _all_sail(crew, [(name, m[:1], s[:1], r) for name, m, s, r in work], pool)  # imports
            call = partial(_all_sail, crew, work, pool)
            seconds = seconds_of(lambda call=call, kept=lengths: kept.extend(call()))
        mean = statistics.mean(lengths) * CELL
        found[name] = {"rate": len(lengths) / seconds, "length": mean, "cruises": len(lengths)}
    return found


def _all_sail(
    crew: list[FreshProcess], work: list[tuple[Any, ...]], pool: ThreadPoolExecutor
) -> list[float]:
    """Let each process do its part of the work, all at once."""
    parts = pool.map(lambda one, share: one.call(cruise_plain.sail, *share), crew, work)
    return [length for part in parts for length in part]


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    count = found["cruises"]
    rates = {name: count / one["median"] for name, one in found["timed"].items()}
    plain = {name: one["rate"] for name, one in found["peers"].items()}
    rows = []
    for name, one in found["timed"].items():
        sailed = found["sailed"][name]
        gains = [f"{rates[name] / rate:,.0f}" for rate in plain.values()]
        how = (f"{sailed['expanded']:.0f}", f"{sailed['replanned']:.1f}", f"{sailed['length']:.0f}")
        times = (f"{one['first'] - one['median']:.1f}", spread(one["seconds"]))
        rows.append((name, f"{rates[name]:,.0f}", *gains, *how, *times))
    for name, one in found["peers"].items():
        nothing = [""] * (len(plain) + 2)
        row = (f"plain Python, {name}", f"{one['rate']:.1f}", *nothing, f"{one['length']:.0f}")
        rows.append((*row, "", ""))
    header = ("method", "cruises/s", *(f"times plain {name}" for name in plain))
    header += ("cells expanded", "plans", "track m", "compile s", "timings")
    sailed_by_peers = next(iter(found["peers"].values()))["cruises"]
    text = (
        f"{count:,} cruises of {STATIONS} stations on {SIDE} x {SIDE} maps, {DENSITY:.0%} blocked, "
        f"in one call; cells in the 5 x 5 window flip with {RATE:.0%} a step; tracks pulled "
        "straight and measured afterwards. The order is given. Plain Python with a process per "
        f"core, on {sailed_by_peers} of the cruises, with flips of its own; it neither pulls "
        "straight nor measures.\n\n" + table(header, rows)
    )
    scopes = [
        (
            name,
            f"{one['reached']:.1%}",
            f"{one['home']:.1%}",
            f"{one['visited']:.1%}",
            f"{one['waits']:.1f}",
            f"{one['length']:.0f}",
            f"{one['smooth_length']:.0f}",
            f"{one['inflections']:.0f}",
            f"{one['smooth_inflections']:.0f}",
            f"{one['rate']:,.0f}",
        )
        for name, one in found["scopes"].items()
    ]
    columns: tuple[str, ...] = (
        "flips",
        "all visited",
        "home again",
        "stations visited",
        "waits",
        "track m",
    )
    columns += ("pulled straight m", "inflections", "after", "cruises/s")
    text += "\n\nWhere and how often cells flip, default method:\n\n" + table(columns, scopes)
    octile = rates["D* Lite, octile"] / plain["D* Lite"]
    what = f"{octile:,.0f} times plain Python of the same method, at least {LEAST_RATIO:g}"
    return text + "\n\n" + verdict(what, octile >= LEAST_RATIO)
