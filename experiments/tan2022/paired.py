"""Traditional against improved on the same maps: rates, paired differences, sensitivities."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy import stats

from experiments.tan2022.episodes import Episodes, Plan, Results
from experiments.tan2022.published import METHODS, METRICS, RADII, TABLE4
from experiments.tan2022.readings import CASES, Case, Reading
from experiments.tan2022.tables import per_map_change
from usvjax.statistics import (
    RESAMPLES,
    averages,
    holm,
    paired_difference,
    paired_rates,
    wilson,
)
from usvkernels.status import Status

LEVEL = 0.95
ENDINGS = (Status.REACHED, Status.COLLIDED, Status.STUCK, Status.TIMED_OUT)
_TESTS = ("p_t", "p_wilcoxon")


@dataclass(frozen=True)
class Comparison:
    """Two methods, each under a reading; the same one unless it is a hybrid.

    Attributes:
        label: for tables.
        traditional, improved: reading of each method.
    """

    label: str
    traditional: Reading
    improved: Reading

    def episodes(self, results: Results, plan: Plan, case: Case) -> dict[str, Episodes]:
        """Return each method's episodes."""
        readings = {"traditional": self.traditional, "improved": self.improved}
        return {m: results[plan.run(r, case, m)] for m, r in readings.items()}


def compare(
    comparisons: Sequence[Comparison], results: Results, plan: Plan
) -> list[dict[str, Any]]:
    """Compare the methods at every radius; p-values are Holm-corrected over everything here.

    Returns:
        Per comparison: "label" and "cases", each with the rates of every ending, the paired
        difference of success, and per metric both means, their difference with t and
        bootstrap intervals, and tests.
    """
    found = [
        {
            "label": comparison.label,
            "traditional": comparison.traditional.label,
            "improved": comparison.improved.label,
            "cases": [_case(comparison, results, plan, case) for case in CASES],
        }
        for comparison in comparisons
    ]
    _correct(found)
    return found


def _case(comparison: Comparison, results: Results, plan: Plan, case: Case) -> dict[str, Any]:
    episodes = comparison.episodes(results, plan, case)
    old, new = (episodes[method] for method in METHODS)
    both = old.reached & new.reached
    return {
        "radius": case.radius,
        "rate": case.rate,
        "maps": len(both),
        "endings": {method: endings(episodes[method]) for method in METHODS},
        "success": asdict(paired_rates(new.reached, old.reached, LEVEL)),
        "both": int(both.sum()),
        "metrics": _metrics(old.table(both), new.table(both), plan.seed),
        "as_much_as_published": _as_much(
            old.table(both), new.table(both), RADII.index(case.radius)
        ),
    }


def endings(episodes: Episodes) -> dict[str, Any]:
    """Rate of every ending with its Wilson interval."""
    n = len(episodes.status)
    counts = {ending.name: int((episodes.status == int(ending)).sum()) for ending in ENDINGS}
    return {
        name: {"count": count, **asdict(wilson(count, n, LEVEL))} for name, count in counts.items()
    }


def _metrics(old: np.ndarray, new: np.ndarray, seed: int) -> dict[str, Any]:
    """Compare float[n, 3] with float[n, 3], metric by metric."""
    if len(old) == 0:
        return {metric: None for metric in METRICS}
    change = per_map_change(old, new)
    columns = np.concatenate([old, new, new - old, change], axis=1)
    figures = np.reshape(np.array(averages(columns, LEVEL, (seed,)), object), (4, len(METRICS)))
    compared = {}
    for i, metric in enumerate(METRICS):
        tested = paired_difference(new[:, i], old[:, i], LEVEL)
        compared[metric] = {
            "traditional": asdict(figures[0, i].mean),
            "improved": asdict(figures[1, i].mean),
            "difference": asdict(tested.mean),
            "difference_bootstrap": asdict(figures[2, i].mean),
            "change_of_means": tested.relative,
            "mean_change": asdict(figures[3, i].mean),
            "p_t": tested.p_t,
            "p_wilcoxon": tested.p_wilcoxon,
        }
    return compared


def _as_much(old: np.ndarray, new: np.ndarray, place: int) -> dict[str, float] | None:
    """Share of maps on which a value changes at least as much as Table 4 says on average."""
    if len(old) == 0:
        return None
    wanted = np.array([TABLE4.change[metric][place] for metric in METRICS])
    reached = per_map_change(old, new) * np.sign(wanted) >= np.abs(wanted)
    return dict(zip(METRICS, map(float, reached.mean(axis=0)), strict=True))


def _correct(found: list[dict[str, Any]]) -> None:
    """Add Holm-corrected p-values; a family is all tests of one kind."""
    cases = [case for comparison in found for case in comparison["cases"]]
    metrics = [m for case in cases for m in case["metrics"].values() if m is not None]
    families = [(test, metrics) for test in _TESTS]
    families.append(("p_mcnemar", [case["success"] for case in cases]))
    for test, holders in families:
        for holder, p in zip(holders, holm([h[test] for h in holders]), strict=True):
            holder[f"{test}_holm"] = p


def sensitivities(
    readings: Sequence[Reading], results: Results, plan: Plan
) -> list[dict[str, Any]]:
    """Return what each reading makes of the comparison, one row per reading and radius."""
    return [
        {
            "reading": reading.label,
            "group": reading.group,
            **_sensitivity(Comparison("", reading, reading), results, plan, case),
        }
        for reading in readings
        for case in CASES
    ]


def _sensitivity(
    comparison: Comparison, results: Results, plan: Plan, case: Case
) -> dict[str, Any]:
    episodes = comparison.episodes(results, plan, case)
    old, new = (episodes[method] for method in METHODS)
    both = old.reached & new.reached
    tables = {method: episodes[method].table(both) for method in METHODS}
    rate = case.rate if comparison.improved.rate is None else comparison.improved.rate
    return {
        "radius": case.radius,
        "rate": rate,
        "maps": len(both),
        "endings": {method: endings(episodes[method]) for method in METHODS},
        "both": int(both.sum()),
        "means": {
            method: dict(zip(METRICS, map(float, table.mean(axis=0)), strict=True))
            for method, table in tables.items()
        }
        if both.any()
        else None,
        "time_ratio": ratio(tables["improved"][:, 0], tables["traditional"][:, 0], plan.seed),
    }


def ratio(new: np.ndarray, old: np.ndarray, seed: int) -> dict[str, float | None]:
    """Ratio of two means over the same maps with its percentile bootstrap interval."""
    if len(new) == 0:
        return {"value": None, "low": None, "high": None}
    value = float(new.mean() / old.mean())
    if len(new) < 2 or np.ptp(new / old) == 0.0:
        return {"value": value, "low": None, "high": None}

    def of_means(a: np.ndarray, b: np.ndarray, axis: int) -> np.ndarray:
        quotient: np.ndarray = a.mean(axis=axis) / b.mean(axis=axis)
        return quotient

    interval = stats.bootstrap(
        (new, old),
        of_means,
        paired=True,
        vectorized=True,
        method="percentile",
        n_resamples=RESAMPLES,
        batch=100,
        confidence_level=LEVEL,
        rng=np.random.default_rng(seed),
    ).confidence_interval
    return {"value": value, "low": float(interval.low), "high": float(interval.high)}
