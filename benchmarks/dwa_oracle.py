"""Whether the kernel chooses the candidates that float64 NumPy chooses."""

import importlib
import sys
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.markdown import table, verdict
from benchmarks.peers import Settings, dwa_numpy

sys.path.insert(0, str(Path(__file__).parent.parent / "tests" / "oracles"))
cases = importlib.import_module("dwa_situations")

TITLE = "the same decisions as the oracle"
METHODS = ("traditional", "improved")
PRECISIONS = ("float32", "float64")
OBSTACLES = 40
BLOCK = 5_000

# Float32 may choose otherwise where the oracle's scores of both candidates differ by less than
# this share of themselves (a tie), or where the oracle's answer to a yes/no question (inside the
# window, inside the sector, able to stop) is this close to changing, or a predicted position this
# close to the goal, whose bearing is then undefined (an edge; m, m/s or rad/s).
TIE = 1e-5
EDGE = 1e-5


def measure(quick: bool) -> dict[str, Any]:
    """Put the same random situations before the oracle and the kernel in both precisions."""
    blocks = 1 if quick else 20
    found: dict[str, Any] = {"situations": blocks * BLOCK}
    for method in METHODS:
        settings = Settings(method=method)
        parts = [_block(settings, seed) for seed in range(blocks)]
        found[method] = {
            precision: _sum([part[precision] for part in parts]) for precision in PRECISIONS
        }
    return found


def _block(settings: Settings, seed: int) -> dict[str, dict[str, Any]]:
    case = cases.situations(np.random.default_rng(seed), BLOCK, OBSTACLES, settings)
    oracle = dwa_numpy.decide(case.states, case.obstacles, case.goals, settings, case.valid)
    found = {"float32": _compare(cases.kernel(settings, case), oracle, case.goals)}
    with cases.enable_x64():
        found["float64"] = _compare(cases.kernel(settings, case), oracle, case.goals)
    return found


def _compare(
    kernel: dwa_numpy.Decision, oracle: dwa_numpy.Decision, goals: np.ndarray
) -> dict[str, Any]:
    """Sort the situations [S] by whether the choice is the oracle's, and why not."""
    other = np.flatnonzero(kernel.chosen != oracle.chosen)
    to_goal = np.linalg.norm(goals[:, None] - oracle.end[:, :, :2], axis=2)
    doubt = np.minimum(np.minimum(oracle.margin, oracle.rate_margin), to_goal)
    edge = doubt.min(axis=1)[other] <= EDGE
    ours, theirs = kernel.chosen[other], oracle.chosen[other]
    score = np.where(np.isinf(oracle.score), np.nan, oracle.score)[other]
    best, got = (score[np.arange(len(other)), np.maximum(i, 0)] for i in (theirs, ours))
    gap = np.where((ours >= 0) & (theirs >= 0), (best - got) / np.abs(best), np.nan)
    tie = gap <= TIE
    return {
        "other": len(other),
        "tie": int(tie.sum()),
        "edge": int((edge & ~tie).sum()),
        "unexplained": int((~edge & ~tie).sum()),
        "largest_tie": float(gap[tie].max(initial=0.0)),
    }


def _sum(parts: list[dict[str, Any]]) -> dict[str, Any]:
    total = {name: sum(part[name] for part in parts) for name in parts[0]}
    return total | {"largest_tie": max(part["largest_tie"] for part in parts)}


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    count, rows, unexplained = found["situations"], [], 0
    for method in METHODS:
        for precision in PRECISIONS:
            one = found[method][precision]
            unexplained += one["unexplained"]
            cells = (one["other"], one["tie"], one["edge"], one["unexplained"])
            share = f"{1 - one['other'] / count:.4%}"
            rows.append((f"{method}, {precision}", share, *cells, f"{one['largest_tie']:.0e}"))
    header = ("kernel", "same candidate", "another", "tie", "edge", "neither", "widest tie")
    return (
        f"{count:,} random situations per method ({', '.join(cases.FAMILIES)}), up to {OBSTACLES} "
        "obstacles, against NumPy in float64. Another candidate is a tie where the oracle's two "
        f"scores differ by at most {TIE:g} of themselves, an edge where one of its yes/no "
        f"questions is within {EDGE:g} of the other answer or a prediction ends on the goal, where "
        "there is no heading error.\n\n"
        + table(header, rows)
        + "\n\n"
        + verdict("same candidate except for ties and edges", unexplained == 0)
    )
