"""Tours of 20 stations: how many per second, and how good they are, against peers."""

import statistics
from typing import Any

import numpy as np

from benchmarks.markdown import table, verdict
from benchmarks.peers.tours import SOLVERS, Crew
from benchmarks.timing import seconds_of
from usvjax.devices import usable_cores
from usvjax.tours import solve_tour

TITLE = "Tours of 20 stations against peers"
STATIONS = 20
OURS = {"recommended": 4096, "igwo_swap": 2048, "igwo": 2048, "ga": 1024, "aco": 256}
"""Tours of each in one call."""
MOST = {
    "LKH (elkai, C)": 64,
    "python-tsp, 2-opt": 16,
    "python-tsp, annealing": 8,
    "scikit-opt, GA_TSP": 4,
    "scikit-opt, ACA_TSP": 2,
}
"""Tours of each peer per core."""
REPETITIONS = 3
LEAST = 50.0
"""Times as fast as each peer in Python, and no worse a tour."""


def measure(quick: bool) -> dict[str, Any]:
    """Time all in turns on random problems; gaps to the best that any of ours or LKH found."""
    cores = usable_cores()
    points = np.random.default_rng(20).random((max(OURS.values()), STATIONS, 2))
    apart = points[:, :, None] - points[:, None]
    tables = np.hypot(apart[..., 0], apart[..., 1])
    ours = {name: count // 32 if quick else count for name, count in OURS.items()}
    theirs = {
        name: cores * (1 if quick else most) for name, most in MOST.items() if name in SOLVERS
    }
    longest = max(*ours.values(), *theirs.values())
    best = solve_tour(points[:longest], 1).length
    seconds: dict[str, list[float]] = {name: [] for name in (*ours, *theirs)}
    gaps: dict[str, float] = {}
    compiled = {
        name: seconds_of(lambda n=name, c=count: solve_tour(points[:c], 0, algorithm=n))
        for name, count in ours.items()
    }
    crew = Crew(cores)
    try:
        for _ in range(1 if quick else REPETITIONS):
            for name, count in ours.items():
                found: list[np.ndarray] = []
                seconds[name].append(
                    seconds_of(
                        lambda n=name, c=count, f=found: f.append(
                            solve_tour(points[:c], 0, algorithm=n).length
                        )
                    )
                )
                gaps[name] = _gap(found[0], best)
            for name, count in theirs.items():
                taken, lengths = crew.run(name, tables[:count])
                seconds[name].append(taken)
                gaps[name] = _gap(np.array(lengths), best)
    finally:
        crew.close()
    count_of = {**ours, **theirs}
    rates = {n: [count_of[n] / s for s in taken] for n, taken in seconds.items()}
    return {"rates": rates, "gaps": gaps, "tours": count_of, "first": compiled}


def _gap(lengths: np.ndarray, best: np.ndarray) -> float:
    """Mean excess over the best known, per cent."""
    return float(100 * (lengths / best[: len(lengths)] - 1).mean())


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    rates = {name: statistics.median(values) for name, values in found["rates"].items()}
    gaps, fast = found["gaps"], rates["recommended"]
    rows = [
        (
            name if name in MOST else f"usvjax, {name}",
            f"{rate:,.1f}" if rate < 100 else f"{rate:,.0f}",
            f"{fast / rate:,.1f}x",
            f"{gaps[name]:.2f} %",
            found["tours"][name],
        )
        for name, rate in rates.items()
    ]
    verdicts = [
        verdict(
            f"{name}: recommended is {fast / rates[name]:,.0f} times as fast, at least {LEAST:g}, "
            f"and its tours no longer ({gaps['recommended']:.3f} % against {gaps[name]:.2f} %)",
            fast >= LEAST * rates[name] and gaps["recommended"] <= gaps[name] + 1e-6,
        )
        for name in rates
        if name in MOST and "LKH" not in name
    ]
    return (
        f"{STATIONS} stations, uniform in a square, a problem of its own for each tour; all on all "
        "cores, peers with a process per core, medians. The gap is to the best tour that "
        "`recommended` found with another seed; LKH, in C, is the yardstick of quality.\n\n"
        + table(("", "tours/s", "recommended is", "mean gap", "tours"), rows)
        + "\n\n"
        + "\n".join(verdicts)
    )
