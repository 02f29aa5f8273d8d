"""Tables 3, 4, 6 and 7 from the cruises: spread, t-tests, gaps to the shortest tour."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from scipy import stats

from experiments import estimates
from experiments.yu2022.cruises.published import PROPOSED, RUNS
from experiments.yu2022.cruises.runs import CELL, Cruises, Results, Seconds, Varied
from usvkernels.status import Status

LEAST_RUNS = 20
"""Runs from which on there is a verdict."""
INDICATORS: dict[str, Callable[[Cruises], np.ndarray]] = {
    "length": lambda own: own.length,
    "inflections": lambda own: own.inflections.astype(float),
}


def compare(
    results: Results, optima: Mapping[tuple[str, int], float], seconds: Seconds
) -> dict[str, Any]:
    """Everything about every case, for results.json.

    Args:
        results: of `sail_all`.
        optima: environment and case -> length of the shortest tour, cells.
        seconds: of `time_alone`.
    """
    found: dict[str, Any] = {}
    for (environment, case), sailed in results.items():
        optimum = optima[environment, case]
        found.setdefault(environment, {})[str(case)] = {
            "optimum": optimum,
            "algorithms": {name: _algorithm(own, optimum) for name, own in sailed.items()},
            "printed": _statistics(sailed, RUNS),
            "against_proposed": _against(sailed),
        }
    for environment, algorithms in seconds.items():
        found[environment]["1"]["seconds_alone"] = {
            name: {
                "median": float(np.median(took)),
                "least": float(min(took)),
                "largest": float(max(took)),
            }
            for name, took in algorithms.items()
        }
    return found


def _algorithm(own: Cruises, optimum: float) -> dict[str, Any]:
    """One algorithm, all its runs."""
    complete = own.complete
    gap = own.tour_length / optimum - 1.0
    shares = {
        Status(code).name.lower(): float(np.mean(own.result.status == code))
        for code in np.unique(own.result.status)
    }
    return {
        **_outcome(own),
        "endings": shares,
        "track": estimates.spread(own.result.length[complete]),
        "smoothed": estimates.spread(own.result.smooth_length[complete]),
        "gap": {
            "mean": float(gap.mean()),
            "least": float(gap.min()),
            "largest": float(gap.max()),
            "optimal": estimates.share(gap < 1e-5),
        },
        "detour": estimates.spread(own.length[complete] / (CELL * own.tour_length[complete])),
        "expanded": estimates.spread(own.result.expanded[complete].astype(float)),
    }


def vary(varied: Varied) -> dict[str, Any]:
    """What the flips change, in Case 1: environment, kind of flips, algorithm."""
    return {
        environment: {
            label: {name: _outcome(own) for name, own in rows.items()}
            for label, rows in kinds.items()
        }
        for environment, kinds in varied.items()
    }


def _outcome(own: Cruises) -> dict[str, Any]:
    """How many came home, and how they went."""
    complete = own.complete
    return {
        "runs": len(complete),
        "complete": estimates.share(complete),
        "length": estimates.spread(own.length[complete]),
        "inflections": estimates.spread(own.inflections[complete].astype(float)),
        "waits": estimates.spread(own.result.waits[complete].astype(float)),
    }


def _statistics(sailed: Mapping[str, Cruises], runs: int) -> dict[str, Any]:
    """Tables 3 and 6 on the first `runs` maps: best, mean, worst, deviation, Welch's t-test."""
    table: dict[str, Any] = {}
    for indicator, values_of in INDICATORS.items():
        values = {name: values_of(own)[:runs][own.complete[:runs]] for name, own in sailed.items()}
        table[indicator] = {
            name: _row(own, None if name == PROPOSED else values[PROPOSED])
            for name, own in values.items()
        }
    return table


def _row(values: np.ndarray, proposed: np.ndarray | None) -> dict[str, Any]:
    if len(values) < 2:
        return {"n": len(values)}
    row: dict[str, Any] = {
        "n": len(values),
        "best": float(values.min()),
        "mean": float(values.mean()),
        "worst": float(values.max()),
        "std": float(values.std(ddof=1)),
    }
    if proposed is not None and len(proposed) > 1:
        row["p"] = float(stats.ttest_ind(values, proposed, equal_var=False).pvalue)
    return row


def _against(sailed: Mapping[str, Cruises]) -> dict[str, Any]:
    """Each algorithm less the proposed one, map by map, where both are complete."""
    table: dict[str, Any] = {}
    proposed = sailed[PROPOSED]
    for name, own in sailed.items():
        if name == PROPOSED:
            continue
        n = min(len(own.complete), len(proposed.complete))
        both = own.complete[:n] & proposed.complete[:n]
        table[name] = {"n": int(both.sum())}
        for indicator, values_of in INDICATORS.items():
            difference = values_of(own)[:n][both] - values_of(proposed)[:n][both]
            table[name][indicator] = estimates.mean(difference)
    return table
