"""Tables of what the swarms found."""

from collections.abc import Mapping
from itertools import takewhile
from typing import Any

import numpy as np
from scipy.special import beta

from experiments.runs import Columns, Found
from experiments.yu2022.functions.mission import MARKS
from experiments.yu2022.functions.published import ITERATIONS, MEAN, MU, PROPOSED, RUNS
from experiments.yu2022.functions.runs import (
    ALGORITHMS,
    OTHERS,
    READINGS,
    WITH_OWN,
    WOLVES_ONLY,
    label,
)

CHECKPOINTS = (10, 20, 40)
"""Marks at which convergence is compared (Fig. 16): a quarter, half and all of the iterations."""
EXPERIMENTS = 2000
"""Drawn from our runs, each of as many runs as the paper's."""
OF_EACH = 0.01
"""Share of experiments outside the interval of one of the five means."""
PAIRS = ((1.0, 0.1), (1.0, 0.0), (5.0, 0.1), (20.0, 0.1), (1.0, 0.5))
"""(lambda1, lambda2) of Fig. 2; those of the paper's curves, but for the chosen ones, are not
legible in its text."""

Rows = Mapping[str, Columns]


def measure(found: Found) -> dict[str, Any]:
    """All tables."""
    budget, longest = found.studies["budget"], found.studies["longest"]
    functions = [condition.varied["swarm.function"] for condition in longest.spec.conditions]
    tables = {}
    for function in functions:
        columns: dict[str, Rows] = {
            kind: {name: budget.columns(label(function, kind), name) for name in ALGORITHMS}
            for kind in READINGS
        }
        own = found.studies["own"]
        columns["own"] = {name: own.columns(label(function, "own"), name) for name in WITH_OWN}
        table: dict[str, Any] = {
            kind: {name: row_of(one) for name, one in rows.items()}
            for kind, rows in columns.items()
        }
        table["longer"] = _longer(found, function)
        table["experiments"] = {
            kind: experiments(columns["budget"] | dict(columns[kind]))
            for kind in ("budget", "own", "other")
        }
        tables[function] = table | budgets_met(function, table)
    return {
        "runs": budget.spec.episodes,
        "longer_runs": longest.spec.episodes,
        "functions": tables,
        "laws": {f"{pair[0]:g}, {pair[1]:g}": law_row(law(pair)) for pair in PAIRS},
        "law_from_one": law_row(law(PAIRS[0], 1)),
        "linear_law": law_row(linear_law()),
    }


def row_of(own: Columns) -> dict[str, Any]:
    """One swarm on one function: the first runs, as many as are printed, and all of them."""
    return {
        "evaluations": int(own["evaluations"][0]),
        "printed": _statistics(own["best"][:RUNS]),
        "all": _statistics(own["best"]),
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


def experiments(rows: Rows) -> dict[str, Any]:
    """What the paper's experiment would find with our swarms, drawn again and again.

    Args:
        rows: algorithm to its runs.

    Returns:
        "means": of each, the interval that holds all but `OF_EACH` of the means of 30 runs; the
        share of experiments in which the proposed one has the least mean ("mean"), the least
        standard deviation ("std"), and the lowest mean curve at all checkpoints ("curve").
    """
    rng = np.random.default_rng(0)
    curves, spreads = [], []
    for name in ALGORITHMS:
        own = rows[name]
        drawn = rng.integers(0, len(own["best"]), (EXPERIMENTS, RUNS))
        curves.append([own[f"at_{mark}"][drawn].mean(axis=1) for mark in CHECKPOINTS])
        spreads.append(own["best"][drawn].std(axis=1, ddof=1))
    means = np.array(curves)  # [algorithm, mark, experiment]
    place = ALGORITHMS.index(PROPOSED)
    leads = means.argmin(axis=0) == place
    return {
        "means": {
            name: np.quantile(ends, [OF_EACH / 2, 1 - OF_EACH / 2]).tolist()
            for name, ends in zip(ALGORITHMS, means[:, -1], strict=True)
        },
        "mean": float(leads[-1].mean()),
        "std": float((np.array(spreads).argmin(axis=0) == place).mean()),
        "curve": float(leads.all(axis=0).mean()),
    }


def _longer(found: Found, function: str) -> dict[str, Any]:
    """What was found within numbers of iterations."""
    wolves, longest = found.studies["wolves"], found.studies["longest"]
    budgets = sorted({one.varied["swarm.iterations"] for one in wolves.spec.conditions})
    table: dict[str, Any] = {name: {} for name in ALGORITHMS}
    for budget in budgets:
        mark = MARKS * budget // budgets[-1]
        for name in WOLVES_ONLY:
            own = wolves.columns(label(function, str(budget)), name)
            table[name][str(budget)] = _averages(own["best"])
        for name in OTHERS:
            own = longest.columns(label(function, "longest"), name)
            table[name][str(budget)] = _averages(own[f"at_{mark}"])
    return table


def _averages(values: np.ndarray) -> dict[str, float]:
    return {"mean": float(values.mean()), "median": float(np.median(values))}


def budgets_met(function: str, tables: Mapping[str, Any]) -> dict[str, dict[str, int | None]]:
    """Fewest iterations from which on means and medians meet the published means.

    Args:
        function: key of Table 8.
        tables: its rows, "budget" and "longer".

    Returns:
        "met_by_mean" and "met_by_median", each algorithm to the budget or None.
    """
    return {
        f"met_by_{word}": {
            name: _met(tables, name, word, MEAN[function][name]) for name in ALGORITHMS
        }
        for word in ("mean", "median")
    }


def _met(tables: Mapping[str, Any], algorithm: str, word: str, wanted: float) -> int | None:
    """Fewest of the budgets tried that meets what is wanted, as do all longer ones."""
    found = {ITERATIONS: tables["budget"][algorithm]["printed"][word]}
    found |= {int(t): own[word] for t, own in tables["longer"][algorithm].items()}
    longest_first = sorted(found, reverse=True)
    meeting = list(takewhile(lambda t: found[t] <= wanted, longest_first))
    return meeting[-1] if meeting else None


def law(pair: tuple[float, float], first: int = 0) -> np.ndarray:
    """Eq. 14 with the printed mu and these lambdas; float[iterations], t from `first` on."""
    t = np.arange(ITERATIONS) + first
    a: np.ndarray = MU[0] * beta(MU[1], (t + pair[0]) / ITERATIONS) + pair[1]
    return a


def linear_law() -> np.ndarray:
    """Eq. 2; float[iterations]."""
    a: np.ndarray = 2.0 - 2.0 * np.arange(ITERATIONS) / ITERATIONS
    return a


def law_row(a: np.ndarray) -> dict[str, Any]:
    """a(t) at the first, sixth and last iteration, how often it is above 1, and when it is halved.

    "above_linear_from": when it is above Eq. 2.
    """
    above = np.flatnonzero(a > linear_law())
    later = above[above > 0]
    return {
        "first": float(a[0]),
        "sixth": float(a[5]),
        "last": float(a[-1]),
        "wide": int((a > 1.0).sum()),
        "halved": int(np.argmax(a <= a[0] / 2)) if (a <= a[0] / 2).any() else None,
        "above_linear_from": int(later[0]) if len(later) else None,
    }
