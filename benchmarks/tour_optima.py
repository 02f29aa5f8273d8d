"""How far every algorithm's tours are from the optimum: the paper's cases, and TSPLIB."""

from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.markdown import table, verdict
from benchmarks.peers.tours import closed_length
from experiments.yu2022.cases import CASES
from usvjax.tours import optimal_tour, solve_tour, tour_length
from usvjax.tours.algorithms import ALGORITHMS

TITLE = "Tours against their optima"
TSPLIB = Path(__file__).resolve().parents[2] / "shared" / "data" / "tsplib"
PUBLISHED = {"eil51": 426, "berlin52": 7542, "st70": 675, "kroA100": 21282}
KNOWN = {"ordinary 1": 160.8247, "complex 1": 458.0556}
SEEDS = 30
"""Of a TSPLIB instance."""


def measure(quick: bool) -> dict[str, Any]:
    """Gaps of all runs of all algorithms; TSPLIB with the recommended one."""
    runs = 16 if quick else 1000
    names = ("recommended", *ALGORITHMS)
    cases = {name: _case(points, names, runs) for name, points in CASES.items()}
    instances = {}
    for name, best in list(PUBLISHED.items())[: 1 if quick else None]:
        if (TSPLIB / f"{name}.tsp").exists():
            lengths = solve_tour(distances=rounded(name), key=0, runs=SEEDS).length
            instances[name] = {"best": best, "lengths": lengths.tolist()}
    return {"runs": runs, "cases": cases, "instances": instances}


def _case(points: np.ndarray, names: tuple[str, ...], runs: int) -> dict[str, Any]:
    best, source = reference(points)
    gaps = {}
    for name in names:
        lengths = solve_tour(points, 0, algorithm=name, runs=runs).length
        excess = 100 * (lengths / best - 1)
        gaps[name] = {
            "mean": float(excess.mean()),
            "worst": float(excess.max()),
            "optimal": float((excess < 1e-4).mean()),
        }
    return {"best": best, "source": source, "gaps": gaps}


def reference(points: np.ndarray) -> tuple[float, str]:
    """The optimum by Held-Karp, or the best of ten runs of LKH; and which."""
    if len(points) <= 13:
        return float(tour_length(optimal_tour(points), points)[0]), "Held-Karp"
    import elkai

    apart = points[:, None] - points[None]
    distances = np.hypot(apart[..., 0], apart[..., 1])
    whole = elkai.DistanceMatrix(np.round(1000 * distances).astype(int).tolist())
    return closed_length(np.array(whole.solve_tsp(runs=10)[:-1]), distances), "LKH"


def rounded(name: str) -> np.ndarray:
    """Distances of an instance of TSPLIB, EUC_2D: to the nearest whole number."""
    lines = (TSPLIB / f"{name}.tsp").read_text(encoding="utf-8").splitlines()
    first = lines.index("NODE_COORD_SECTION") + 1
    rows = [line.split()[1:] for line in lines[first:] if len(line.split()) == 3]
    points = np.array(rows, float)
    apart = points[:, None] - points[None]
    return np.floor(np.hypot(apart[..., 0], apart[..., 1]) + 0.5)


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    names = list(next(iter(found["cases"].values()))["gaps"])
    rows, verdicts = [], []
    for case, one in found["cases"].items():
        gaps = one["gaps"]
        rows.append((case, f"{one['best']:.4f}", *(f"{gaps[n]['mean']:.2f}" for n in names)))
        share = gaps["recommended"]["optimal"]
        what = f"{case}: {100 * share:.1f} % of the runs at {one['best']:.4f} ({one['source']})"
        known = abs(one["best"] - KNOWN.get(case, one["best"])) < 5e-5
        verdicts.append(verdict(f"{what}, at least 99 %", share >= 0.99 and known))
    others = []
    for name, one in found["instances"].items():
        excess = 100 * (np.array(one["lengths"]) / one["best"] - 1)
        others.append(
            (name, one["best"], f"{excess.mean():.2f}", f"{excess.max():.2f}", (excess == 0).sum())
        )
        what = f"{name}: {excess.mean():.2f} % over the optimum on average, at most 2 %"
        verdicts.append(verdict(what, excess.mean() <= 2))
    return (
        f"Mean gap to the optimum, per cent, of {found['runs']} runs each; closed tours, straight "
        "legs, each algorithm with its defaults.\n\n"
        + table(("case", "optimum", *names), rows)
        + f"\n\nTSPLIB, recommended, {SEEDS} seeds:\n\n"
        + table(("instance", "optimum", "mean gap %", "worst gap %", "runs at it"), others)
        + "\n\n"
        + "\n".join(verdicts)
    )
