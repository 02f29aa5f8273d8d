"""Traditional against improved on the same maps: rates, paired differences, sensitivities."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from scipy import stats

from experiments.estimates import LEVEL, difference
from experiments.tan2022.arithmetic import shares
from experiments.tan2022.episodes import (
    SEED,
    Episodes,
    Pair,
    common_table,
    per_map_change,
)
from experiments.tan2022.published import METHODS, METRICS, TABLE4
from experiments.tan2022.readings import CASES, Case, Reading
from experiments.tan2022.tables import Pairs
from usvjax.statistics import (
    RESAMPLES,
    averages,
    holm,
    paired_difference,
    paired_rates,
    wilson,
)
from usvkernels.status import EPISODE_ENDINGS, Status

_TESTS = ("p_t", "p_wilcoxon")
_RATES = ("success", "collisions")


def compare(compared: Mapping[str, Pairs]) -> dict[str, dict[str, Any]]:
    """Compare the methods at every radius; p-values are Holm-corrected over everything here.

    Args:
        compared: label to the episodes of both methods by case.

    Returns:
        Per label its "cases", each with the rates of every ending, the paired differences of
        success and of collisions, and per metric both means, their difference with t and bootstrap
        intervals, and tests.
    """
    found = {
        label: {"cases": [_case(pairs[case], place) for place, case in enumerate(CASES)]}
        for label, pairs in compared.items()
    }
    _correct([case for row in found.values() for case in row["cases"]])
    return found


def _case(pair: Pair, place: int) -> dict[str, Any]:
    table = common_table(pair)
    old, new = (pair[method].status for method in METHODS)
    return {
        "radius": CASES[place].radius,
        "rate": CASES[place].rate,
        "maps": len(old),
        "endings": {method: endings(pair[method]) for method in METHODS},
        **{
            name: asdict(paired_rates(new == int(ending), old == int(ending), LEVEL))
            for name, ending in zip(_RATES, (Status.REACHED, Status.COLLIDED), strict=True)
        },
        "both": table.shape[1],
        "metrics": _metrics(*table),
        "as_much_as_published": _as_much(table, place),
    }


def endings(episodes: Episodes) -> dict[str, Any]:
    """Rate of every ending with its Wilson interval."""
    n = len(episodes.status)
    counts = {
        ending.name: int((episodes.status == int(ending)).sum()) for ending in EPISODE_ENDINGS
    }
    return {
        name: {"count": count, **asdict(wilson(count, n, LEVEL))} for name, count in counts.items()
    }


def _metrics(old: np.ndarray, new: np.ndarray) -> dict[str, Any]:
    """Compare float[n, 3] with float[n, 3], metric by metric."""
    if len(old) == 0:
        return {metric: None for metric in METRICS}
    change = per_map_change(np.stack([old, new]))
    columns = np.concatenate([old, new, new - old, change], axis=1)
    figures = np.reshape(np.array(averages(columns, LEVEL, (SEED,)), object), (4, len(METRICS)))
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


def _as_much(table: np.ndarray, place: int) -> dict[str, float] | None:
    """Share of maps on which a value changes at least as much as Table 4 says on average."""
    if table.shape[1] == 0:
        return None
    wanted = np.array([shares(TABLE4, metric)[place] for metric in METRICS])
    reached = per_map_change(table) * np.sign(wanted) >= np.abs(wanted)
    return dict(zip(METRICS, map(float, reached.mean(axis=0)), strict=True))


def _correct(cases: Sequence[dict[str, Any]]) -> None:
    """Add Holm-corrected p-values; a family is all tests of one kind."""
    metrics = [m for case in cases for m in case["metrics"].values() if m is not None]
    families = [(test, metrics) for test in _TESTS]
    families += [("p_mcnemar", [case[name] for case in cases]) for name in _RATES]
    for test, holders in families:
        for holder, p in zip(holders, holm([h[test] for h in holders]), strict=True):
            holder[f"{test}_holm"] = p


def sensitivity(reading: Reading, case: Case, pair: Pair) -> dict[str, Any]:
    """What a reading makes of the comparison at one radius."""
    table = common_table(pair)
    means = table.mean(axis=1) if table.shape[1] else None
    return {
        "reading": reading.label,
        "group": reading.group,
        "radius": case.radius,
        "maps": len(pair["improved"].status),
        "endings": {method: endings(pair[method]) for method in METHODS},
        "both": table.shape[1],
        "means": None
        if means is None
        else {
            method: dict(zip(METRICS, map(float, means[i]), strict=True))
            for i, method in enumerate(METHODS)
        },
        "time_ratio": ratio_of_means(table[1, :, 0], table[0, :, 0]),
    }


def slower(old: Episodes, new: Episodes) -> dict[str, Any]:
    """How much longer episodes take than others of the same method on the same maps, s.

    Returns:
        The mean over the "maps" that are crossed both times, with a t interval and its "p".
    """
    count = min(len(old.status), len(new.status))
    old, new = old.first(count), new.first(count)
    both = old.reached & new.reached
    return {"maps": int(both.sum()), **difference((new.time - old.time)[both])}


def ratio_of_means(new: np.ndarray, old: np.ndarray) -> dict[str, float | None]:
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
        rng=np.random.default_rng(SEED),
    ).confidence_interval
    return {"value": value, "low": float(interval.low), "high": float(interval.high)}
