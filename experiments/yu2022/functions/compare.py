"""Tables of what the swarms found."""

from collections.abc import Mapping
from itertools import takewhile
from typing import Any

import jax.numpy as jnp
import numpy as np

from experiments.yu2022.functions.published import ALGORITHMS, ITERATIONS, MEAN, RUNS
from experiments.yu2022.functions.runs import WOLF_BUDGETS, Job, Results
from usvjax.swarms.minimising import MinimiseResult
from usvkernels.swarms.laws import GwoParams, convergence

CHECKPOINTS = (50, 100, 200)
"""Iterations at which convergence is compared (Fig. 16)."""
PAIRS = ((1.0, 0.1), (1.0, 0.0), (5.0, 0.1), (20.0, 0.1), (1.0, 0.5))
"""(lambda1, lambda2) of Fig. 2; those of the paper's curves, but for the chosen ones, are not
legible in its text."""


def compare(results: Results) -> dict[str, Any]:
    """Everything for results.json.

    Args:
        results: of `run_all`.
    """
    found: dict[str, Any] = {}
    for job, result in results.items():
        tables = found.setdefault(job.function, {})
        if job.kind == "longer":
            row = tables.setdefault("longer", {}).setdefault(job.algorithm, {})
            row.update(_budgets(job, result))
        else:
            tables.setdefault(job.kind, {})[job.algorithm] = _row(job, result)
    for function, tables in found.items():
        tables.update(budgets_met(function, tables))
    return {"functions": found, "laws": laws()}


def _row(job: Job, result: MinimiseResult) -> dict[str, Any]:
    history = result.history
    marks = [t for t in CHECKPOINTS if t <= history.shape[1]]
    return {
        "evaluations": result.evaluations,
        "population": job.population,
        "iterations": job.iterations,
        "printed": _statistics(result.best[:RUNS]),
        "all": _statistics(result.best),
        "at": {str(t): float(np.median(history[:, t - 1])) for t in marks},
    }


def _statistics(best: np.ndarray) -> dict[str, Any]:
    return {
        "n": len(best),
        "mean": float(best.mean()),
        "std": float(best.std(ddof=1)) if len(best) > 1 else None,
        "median": float(np.median(best)),
        "best": float(best.min()),
        "worst": float(best.max()),
    }


def _budgets(job: Job, result: MinimiseResult) -> dict[str, dict[str, float]]:
    """What was found within numbers of iterations."""
    steps = [t for t in WOLF_BUDGETS if t <= job.iterations]
    if job.algorithm in ("gwo", "igwo"):
        steps = [job.iterations]
    best = {t: result.history[:, t - 1] for t in steps}
    return {
        str(t): {"mean": float(own.mean()), "median": float(np.median(own))}
        for t, own in best.items()
    }


def budgets_met(function: str, tables: Mapping[str, Any]) -> dict[str, dict[str, int | None]]:
    """Fewest iterations from which on means and medians meet the published means.

    Args:
        function: key of Table 8.
        tables: its rows, "printed" and "longer".

    Returns:
        "met_by_mean" and "met_by_median", each algorithm to the budget or None.
    """
    return {
        f"met_by_{word}": {
            name: _met(tables, name, word, MEAN[function][name]) for name in tables["printed"]
        }
        for word in ("mean", "median")
    }


def _met(tables: Mapping[str, Any], algorithm: str, word: str, wanted: float) -> int | None:
    """Fewest of the budgets tried that meets what is wanted, as do all longer ones."""
    found = {ITERATIONS: tables["printed"][algorithm]["printed"][word]}
    found |= {int(t): own[word] for t, own in tables["longer"][algorithm].items()}
    longest_first = sorted(found, reverse=True)
    meeting = list(takewhile(lambda t: found[t] <= wanted, longest_first))
    return meeting[-1] if meeting else None


def laws() -> dict[str, Any]:
    """Eq. 14 at the first, sixth and last iteration, and how soon it is below the linear law."""
    linear = np.asarray(convergence("linear", ITERATIONS, GwoParams()))[:, 0]
    found = {}
    for pair in PAIRS:
        a = law(pair)
        above = np.flatnonzero(a > linear)
        later = above[above > 0]
        found[f"{pair[0]:g}, {pair[1]:g}"] = {
            "first": float(a[0]),
            "sixth": float(a[5]),
            "last": float(a[-1]),
            "above_linear_from": int(later[0]) if len(later) else None,
        }
    return found


def law(pair: tuple[float, float]) -> np.ndarray:
    """Eq. 14 with the printed mu and these lambdas; float[iterations]."""
    params = GwoParams(lambda1=jnp.float32(pair[0]), lambda2=jnp.float32(pair[1]))
    return np.asarray(convergence("beta", ITERATIONS, params))[:, 0]


def names(found: Mapping[str, Any]) -> list[str]:
    """The algorithms in the order of Table 9."""
    return [name for name in ALGORITHMS if name in found]
