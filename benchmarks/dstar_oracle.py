"""D* Lite against Dijkstra after every change, and what overestimating heuristics cost."""

import importlib
import sys
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.markdown import table, verdict
from usvjax.search.replanning import DstarLiteResult, dstar_lite

sys.path.insert(0, str(Path(__file__).parent.parent / "tests" / "oracles"))
plain = importlib.import_module("dstar_reference")

TITLE = "D* Lite is exact"
SHAPE, STEPS, CHANGES = (30, 40), 50, 8
EPISODES = 400  # of each method; five exact ones make 2,000
EXACT: dict[str, dict[str, Any]] = {
    "octile": {},
    "chebyshev": {"heuristic": "chebyshev"},
    "octile, cutting corners": {"corner_cutting": True},
    "octile, sensing 5 x 5": {"sensing": (5, 5)},
    "octile, sensing 7 x 3, cutting corners": {"sensing": (7, 3), "corner_cutting": True},
}
WEIGHTED: dict[str, dict[str, Any]] = {
    "Eq. 17 as printed": {"heuristic": "weighted"},
    "weighted octile, w of Eq. 17": {"heuristic": "weighted_octile"},
    "weighted octile, w = 1.5": {"heuristic": "weighted_octile", "weight": 1.5},
}
Episodes = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def measure(quick: bool) -> dict[str, Any]:
    """Replay every episode and compare each record and each move."""
    count = 16 if quick else EPISODES
    found: dict[str, Any] = {"episodes": count}
    for seed, (name, method) in enumerate((EXACT | WEIGHTED).items()):
        # The methods that overestimate see the episodes of the first one, to be compared with it.
        episodes = drawn(seed if name in EXACT else 0, count)
        result = dstar_lite(*episodes, **method)
        found[name] = _judged(episodes, result, method) | _effort(result)
    return found


def drawn(seed: int, count: int) -> Episodes:
    """Maps from open water to mazes; none to eight cells a step become blocked or free."""
    rng = np.random.default_rng([3, seed])
    height, width = SHAPE
    blocked = rng.random((count, *SHAPE)) < np.linspace(0, 0.5, count)[:, None, None]
    cells = rng.permuted(np.tile(np.arange(height * width), (count, 1)), axis=1)[:, :2]
    ends = np.stack([cells % width, cells // width], axis=-1)
    for i in range(2):
        blocked[np.arange(count), ends[:, i, 1], ends[:, i, 0]] = False
    flips = rng.integers(0, [width, height], (count, STEPS, CHANGES, 2))
    flips[rng.random(flips.shape[:3]) < rng.random((count, 1, 1))] = -1
    return blocked, ends[:, 0], ends[:, 1], flips


def _effort(result: DstarLiteResult) -> dict[str, Any]:
    first, later = result.expanded[:, 0], result.expanded[:, 1:]
    return {"first": float(first.mean()), "later": float(later[later > 0].mean())}


def _judged(episodes: Episodes, result: DstarLiteResult, method: dict[str, Any]) -> dict[str, Any]:
    """Count records and moves, those that are wrong, and the ratios to the shortest."""
    cutting, sensing = method.get("corner_cutting", False), method.get("sensing")
    told = {"records": 0, "cut_off": 0, "freed": 0, "other": 0, "below": 0, "invalid": 0}
    ratios: list[float] = []
    for row, (blocked, _, goal, flips) in enumerate(zip(*episodes, strict=True)):
        end = (int(goal[0]), int(goal[1]))
        position, cost = result.position[row], result.cost_to_go[row]
        maps = plain.replay(blocked, position, end, flips, sensing)
        last = int(np.argmax(np.all(position == goal, axis=1))) or STEPS
        for t in range(last + 1):
            x, y = position[t]
            best = plain.distances(maps.known[t], end, cutting)[y, x] / plain.STRAIGHT
            told["records"] += 1
            told["cut_off"] += bool(np.isinf(best))
            told["freed"] += bool(t and np.isinf(cost[t - 1]) and np.isfinite(cost[t]))
            told["other"] += not np.isclose(cost[t], best, rtol=1e-9)
            told["below"] += not cost[t] >= best * (1 - 1e-9)
            if 0 < best < np.inf:
                ratios.append(float(cost[t] / best))
            if t < last:
                here, there = tuple(position[t].tolist()), tuple(position[t + 1].tolist())
                steps = dict(plain.steps_from(maps.true[t], here, cutting))
                told["invalid"] += here != there and there not in steps
    spread = np.quantile(ratios, [0.5, 0.95, 1.0]).tolist()
    return told | {"mean_ratio": float(np.mean(ratios)), "ratios": spread}


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    rows, wrong = [], 0
    for name in EXACT:
        one = found[name]
        wrong += one["other"] + one["invalid"]
        counts = (one[key] for key in ("records", "cut_off", "freed", "other", "invalid"))
        rows.append((name, *(f"{n:,}" for n in counts)))
    exact = table(("exact", "records", "cut off", "freed", "other length", "invalid moves"), rows)
    rows, base = [], found["octile"]
    for name in ("octile", *WEIGHTED):
        one = found[name]
        wrong += one["below"] + one["invalid"]
        median, most, worst = one["ratios"]
        rows.append(
            (
                name,
                f"{one['mean_ratio']:.4f}",
                f"{median:.3f}",
                f"{most:.3f}",
                f"{worst:.3f}",
                f"{one['first']:.0f}",
                f"{1 - one['first'] / base['first']:.0%}",
                f"{one['later']:.1f}",
                f"{one['below']:,}",
                f"{one['invalid']:,}",
            )
        )
    header = ("length to shortest", "mean", "median", "95 %", "worst", "expanded, first plan")
    header += ("saved", "expanded, replanning", "below shortest", "invalid moves")
    total = found["episodes"] * len(EXACT)
    return (
        f"{total:,} random episodes, {found['episodes']} of each method, on maps of {SHAPE[1]} x "
        f"{SHAPE[0]} cells, 0 to 50 % blocked, up to {CHANGES} changes before each of up to "
        f"{STEPS} moves. "
        "After every move the cost-to-go is compared with scipy's Dijkstra on the map as known. "
        "Freed: had been cut off the record before.\n\n"
        f"{exact}\n\nOverestimating heuristics, on the episodes of octile; the length is that "
        "which the search has for its path, the expansions of replannings that took any.\n\n"
        f"{table(header, rows)}\n\n" + verdict("every length and every move right", wrong == 0)
    )
