"""Ants, genes and particles between two cells: how long their paths are and how long they take."""

from typing import Any

import numpy as np

import usvjax as uj
from benchmarks.markdown import table, verdict
from benchmarks.timing import in_turns
from usvjax.planners import ALGORITHMS, plan_paths

TITLE = "paths of ants, genes and particles against A*"
SCENES = {"50 x 50, 10 %": (50, 0.10, 25), "100 x 100, 12 %": (100, 0.12, 50)}
"""Side, density and the longest leg, cells; legs of tours are about 16 and 23 cells on average."""
SHORTEST_LEG = 5
QUERIES = 128
REPETITIONS = 3
PUBLISHED = {
    "50 x 50, 10 %": {"aco": 1693.280, "ga": 1812.457, "cmpso": 1728.564, "proposed": 1678.002},
    "100 x 100, 12 %": {"aco": 5034.751, "ga": 5262.745, "cmpso": 5219.564, "proposed": 4841.964},
}
"""Mean length of whole tours, m: Yu et al. 2022, Tables 3 and 6."""


def measure(quick: bool) -> dict[str, Any]:
    """Plan the same legs with each planner, with the paper's parameters, and with A*."""
    found = {}
    for name, (side, density, longest) in SCENES.items():
        queries = legs(side, density, longest, 16 if quick else QUERIES)
        found[name] = _contest(queries, {"iterations": 5} if quick else {})
    return found


def legs(
    side: int, density: float, longest: float, n: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Maps of their own, starts anywhere, goals in all directions; both free."""
    rng = np.random.default_rng(side)
    blocked = rng.random((n, side, side)) < density
    starts = rng.integers(0, side, (n, 2))
    angle, far = rng.uniform(0, 2 * np.pi, n), rng.uniform(SHORTEST_LEG, longest, n)
    away = np.stack([np.cos(angle), np.sin(angle)], axis=1) * far[:, None]
    goals = np.clip(starts + np.round(away).astype(int), 0, side - 1)
    for cells in (starts, goals):
        blocked[np.arange(n), cells[:, 1], cells[:, 0]] = False
    return blocked, starts, goals


def _contest(
    queries: tuple[np.ndarray, np.ndarray, np.ndarray], options: dict[str, int]
) -> dict[str, Any]:
    contestants = {
        name: lambda name=name: plan_paths(*queries, 1, algorithm=name, **options)
        for name in ALGORITHMS
    }
    timings = in_turns(contestants | {"A*": lambda: uj.astar(*queries)}, REPETITIONS)
    best = uj.astar(*queries)
    reached = (best.status == uj.Status.FOUND) & (best.cost > 0)
    result = {"queries": int(reached.sum()), "A*": _row(best, best, reached, timings["A*"])}
    for name, plan in contestants.items():
        result[name] = _row(plan(), best, reached, timings[name])
    return result


def _row(plans: Any, best: Any, reached: np.ndarray, timing: dict[str, Any]) -> dict[str, float]:
    """What became of the queries that A* reaches; lengths where the planner found a path."""
    ok = reached & (plans.status == uj.Status.FOUND)
    ratio = plans.cost[ok] / best.cost[ok]
    inflections = uj.path_metrics(plans.path[ok], plans.path_cells[ok]).inflections
    return {
        "found": float(ok.sum() / reached.sum()),
        "total": float(plans.cost[ok].sum() / best.cost[ok].sum()),
        "worst": float(ratio.max()),
        "shorter": int((ratio < 1 - 1e-9).sum()),
        "optimal": float((ratio < 1 + 1e-9).mean()),
        "inflections": float(inflections.mean()),
        "ms": 1e3 * timing["median"] / len(plans.status),
        "compile": timing["first"] - timing["median"],
    }


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    sections, verdicts = [], []
    for name, one in found.items():
        published = PUBLISHED[name]
        rows = []
        for planner in ("A*", *ALGORITHMS):
            row = one[planner]
            theirs = published.get(planner, float("nan")) / published["proposed"]
            rows.append(
                (
                    planner,
                    f"{row['found']:.1%}",
                    f"{row['total']:.3f}",
                    "" if planner == "A*" else f"{theirs:.3f}",
                    f"{row['worst']:.2f}",
                    f"{row['optimal']:.0%}",
                    f"{row['inflections']:.1f}",
                    f"{row['ms']:.3f}",
                    f"{row['compile']:.1f}",
                )
            )
            if planner != "A*":
                what = f"{name}, {planner}: no path shorter than the shortest"
                verdicts.append(verdict(what, row["shorter"] == 0))
        header = (
            f"{name}, {one['queries']} legs",
            "found",
            "length / shortest",
            "published tours / proposed",
            "worst",
            "shortest found",
            "inflections",
            "ms per plan",
            "compile s",
        )
        sections.append(table(header, rows))
    return (
        "The planners of Algorithms 1 to 3 of Yu et al. 2022 with the printed parameters, and "
        "where nothing is printed with ours; all queries in one call. Lengths are those of the "
        "legs that the planner solved, added up. The published column is the mean length of whole "
        "tours beside that of the proposed method, a comparison of another kind, for orientation."
        "\n\n" + "\n\n".join(sections) + "\n\n" + "\n".join(verdicts)
    )
