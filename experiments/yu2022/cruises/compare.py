"""Tables 3, 4, 6 and 7 from the cruises: spread, t-tests, gaps to the shortest tour, times."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from scipy import stats

from experiments import estimates
from experiments.runs import Found
from experiments.yu2022.cruises.detection import detection
from experiments.yu2022.cruises.published import PROPOSED, RUNS
from experiments.yu2022.cruises.runs import (
    BESIDE,
    ENCODINGS,
    ENVIRONMENTS,
    FLIPS,
    LABELS,
    SWARMS,
    USUAL,
    Sailed,
    sailed_by,
)
from usvkernels.status import Status

INDICATORS: dict[str, Callable[[Sailed], np.ndarray]] = {
    "length": lambda own: own.length,
    "inflections": lambda own: own.inflections,
}
SHORTEST = 1e-5
"""By how much a tour may be longer than the shortest, relatively, and count as it: columns are of
single precision."""

Sails = Mapping[str, Sailed]
"""Cruises by method."""


def measure(found: Found) -> dict[str, Any]:
    """Everything about every case, for results.json."""
    numbers: dict[str, Any] = {"cases": {}, "tables": {}, "orders": {}, "detection": {}}
    for environment, where in ENVIRONMENTS.items():
        for case in where.cases:
            sailed = _sailed(found, environment, case, USUAL)
            if sailed:
                numbers["cases"].setdefault(environment, {})[str(case)] = _case(sailed)
        for flips in FLIPS:
            sailed = _sailed(found, environment, 1, flips)
            if sailed:
                numbers["tables"].setdefault(environment, {})[flips] = _table(sailed)
        if environment in numbers["cases"]:
            numbers["orders"][environment] = _orders(_sailed(found, environment, 1, USUAL))
            numbers["detection"][environment] = detection(found, environment)
    numbers["seconds"] = {
        environment: _times(cases) for environment, cases in found.made["times"].items()
    }
    return numbers


def _sailed(found: Found, environment: str, case: int, flips: str) -> dict[str, Sailed]:
    sails = {name: sailed_by(found, environment, case, flips, name) for name in LABELS}
    return {name: own for name, own in sails.items() if own is not None}


def _case(sailed: Sails) -> dict[str, Any]:
    """A case of Table 4 or 7, and what stands behind it."""
    optimum = float(sailed["recommended"].columns["tour_length"].min())
    return {
        "optimum": optimum,
        "algorithms": {name: _algorithm(own, optimum) for name, own in sailed.items()},
        "against_proposed": {
            encoding: {
                rival: _against(sailed[method], sailed[names[PROPOSED]])
                for rival, method in names.items()
                if rival != PROPOSED and method in sailed
            }
            for encoding, names in ENCODINGS.items()
        },
    }


def _algorithm(own: Sailed, optimum: float) -> dict[str, Any]:
    """One algorithm, all its runs."""
    complete, columns = own.complete, own.columns
    tour = columns["tour_length"].astype(np.float64)
    gap = tour / optimum - 1.0
    return {
        **_outcome(own),
        "endings": {
            Status(code).name.lower(): float(np.mean(columns["status"] == code))
            for code in np.unique(columns["status"])
        },
        "track": estimates.spread(columns["length"][complete]),
        "smoothed": estimates.spread(columns["smooth_length"][complete]),
        "gap": {
            "mean": float(gap.mean()),
            "least": float(gap.min()),
            "largest": float(gap.max()),
            "optimal": estimates.share(gap < SHORTEST),
        },
        "detour": estimates.spread(own.length[complete] / tour[complete]),
    }


def _outcome(own: Sailed) -> dict[str, Any]:
    """How many came home, and how they went."""
    complete = own.complete
    return {
        "runs": len(complete),
        "complete": estimates.share(complete),
        "length": estimates.spread(own.length[complete]),
        "inflections": estimates.spread(own.inflections[complete]),
        "waits": estimates.spread(own.columns["waits"][complete].astype(float)),
    }


def _table(sailed: Sails) -> dict[str, Any]:
    """Table 3 or 6 under one kind of flips: rows on the first 50 maps, and t-tests by encoding."""
    table: dict[str, Any] = {
        "rows": {},
        "p": {},
        "outcomes": {name: _outcome(own) for name, own in sailed.items()},
    }
    for indicator, values_of in INDICATORS.items():
        rows = {
            name: _row(values_of(own)[:RUNS][own.complete[:RUNS]]) for name, own in sailed.items()
        }
        table["rows"][indicator] = rows
        table["p"][indicator] = {
            encoding: {
                rival: _welch(rows[method], rows[names[PROPOSED]])
                for rival, method in names.items()
                if rival != PROPOSED and method in rows
            }
            for encoding, names in (ENCODINGS | BESIDE).items()
        }
    return table


def _row(values: np.ndarray) -> dict[str, Any]:
    if len(values) < 2:
        return {"n": len(values)}
    found = estimates.mean(values)
    return {
        "n": len(values),
        "best": float(values.min()),
        "mean": found["value"],
        "low": found["low"],
        "high": found["high"],
        "worst": float(values.max()),
        "std": float(values.std(ddof=1)),
    }


def _welch(row: Mapping[str, Any], proposed: Mapping[str, Any]) -> float | None:
    """Welch's t-test of two rows, its p; None of too few values, or where they are all equal."""
    if min(row["n"], proposed["n"]) < 2 or not (row["std"] or proposed["std"]):
        return None
    samples = (one[key] for one in (row, proposed) for key in ("mean", "std", "n"))
    return float(stats.ttest_ind_from_stats(*samples, equal_var=False).pvalue)


def _against(rival: Sailed, proposed: Sailed) -> dict[str, Any]:
    """A rival less the proposed one, map by map, where both are complete."""
    n = min(len(rival.complete), len(proposed.complete))
    both = rival.complete[:n] & proposed.complete[:n]
    table: dict[str, Any] = {"n": int(both.sum())}
    for indicator, values_of in INDICATORS.items():
        less = values_of(rival)[:n][both] - values_of(proposed)[:n][both]
        table[indicator] = estimates.difference(less)
    return table


def _orders(sailed: Sails) -> dict[str, Any]:
    """How often tours are the same in Case 1, by encoding; tours of the same length are."""
    found: dict[str, Any] = {}
    for encoding, names in ENCODINGS.items():
        tours = {
            name: sailed[method].columns["tour_length"].astype(np.float64)
            for name, method in names.items()
            if method in sailed
        }
        n = min(map(len, tours.values()))
        alike = {name: _alike(tour, tours[PROPOSED]) for name, tour in tours.items()}
        every = np.array([own[:n] for own in alike.values()])
        swarms = np.array([own[:n] for name, own in alike.items() if name in SWARMS])
        found[encoding] = {
            "all": _share(every.all(axis=0)),
            "wolves": _share(alike["gwo"]),
            "swarms_differ": _share(~swarms.any(axis=0)),
        }
    return found


def _share(which: np.ndarray) -> dict[str, Any]:
    """How often something is so, and "rank_p" of one run more that is so."""
    p = estimates.rank_p(which.astype(float), 1.0)
    return {**estimates.share(which), "runs": len(which), "rank_p": p}


def _alike(tours: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Which are of the same length, bool[n]."""
    n = min(len(tours), len(others))
    alike: np.ndarray = np.abs(tours[:n] / others[:n] - 1.0) < SHORTEST
    return alike


def _times(cases: Mapping[str, Mapping[str, list[float]]]) -> dict[str, Any]:
    """Seconds of single cruises in every case, and whether the proposed one takes less.

    In Case 1 by the Mann-Whitney test of its cruises; over all cases by the t-test of the
    logarithms of how many times as long each case takes.
    """
    found: dict[str, Any] = {"cases": {}, "case_1": {}, "all": {}}
    for case, rows in cases.items():
        found["cases"][case] = {
            name: {"n": len(took), "median": float(np.median(took)), "least": min(took)}
            | {"largest": max(took)}
            for name, took in rows.items()
        }
    for encoding, names in ENCODINGS.items():
        rivals = {rival: names[rival] for rival in names if rival != PROPOSED}
        rows, own = cases["1"], names[PROPOSED]
        found["case_1"][encoding] = {
            rival: {
                "times": float(np.median(rows[method]) / np.median(rows[own])),
                "p": float(stats.mannwhitneyu(rows[method], rows[own]).pvalue),
            }
            for rival, method in rivals.items()
        }
        found["all"][encoding] = {
            rival: _times_as_long(
                np.array(
                    [np.median(rows[method]) / np.median(rows[own]) for rows in cases.values()]
                )
            )
            for rival, method in rivals.items()
        }
    return found


def _times_as_long(ratios: np.ndarray) -> dict[str, Any]:
    """Of a rival, by case."""
    return {
        "by_case": ratios.tolist(),
        "times": float(np.exp(np.log(ratios).mean())),
        "p": estimates.difference(np.log(ratios))["p"],
    }
