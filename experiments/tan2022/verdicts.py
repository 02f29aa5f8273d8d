"""What holds of Tan et al. 2022: each table and claim against each reading, from the numbers."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from experiments.tan2022.episodes import Plan, Results
from experiments.tan2022.paired import Comparison
from experiments.tan2022.published import (
    METHODS,
    METRICS,
    TABLE2,
    TABLE3,
    TABLE4,
    TABLE4_MAPS,
    PublishedTable,
)
from experiments.tan2022.ranking import common_tables, of_twenty
from experiments.tan2022.readings import CASES, ONE_MAP_CASES, Case
from experiments.tan2022.tables import per_map_change
from experiments.verdicts import Finding, Verdict, weigh

ALPHA = 0.05
_HALF_UNIT = 0.005


@dataclass(frozen=True)
class Evidence:
    """All that is known about one comparison.

    Attributes:
        comparison: its readings.
        row: of `paired.compare`.
        tables: per radius, values on the maps where both succeed, float[2, n, 3].
        one_map: the same on the maps of Table 2.
    """

    comparison: Comparison
    row: dict[str, Any]
    tables: list[np.ndarray]
    one_map: list[np.ndarray]


def evidence(
    comparison: Comparison, row: dict[str, Any], results: Results, paired: Plan, one_map: Plan
) -> Evidence:
    """Collect what is known about one comparison."""
    return Evidence(
        comparison,
        row,
        _tables(comparison, results, paired, CASES),
        _tables(comparison, results, one_map, ONE_MAP_CASES),
    )


def _tables(
    comparison: Comparison, results: Results, plan: Plan, cases: Sequence[Case]
) -> list[np.ndarray]:
    by_case = [comparison.episodes(results, plan, case) for case in cases]
    return common_tables({m: [episodes[m] for episodes in by_case] for m in METHODS})


def judge(found: Sequence[Evidence]) -> list[Verdict]:
    """Judge every table and claim under every comparison."""
    claims: list[tuple[str, str, Callable[[Evidence], Finding]]] = [
        (
            "Table 2: one map, three radii",
            "18 values",
            lambda e: _single_maps(TABLE2, e.one_map),
        ),
        ("Table 3: one map per radius", "18 values", lambda e: _single_maps(TABLE3, e.tables)),
        ("Table 4: averages over 20 maps", "18 averages", _averages),
        *(
            (f"Table 4: {words}", _published_change(metric), _change_of(metric))
            for metric, words in (
                ("time", "time is reduced"),
                ("path_length", "the path is shortened"),
                ("mean_speed", "mean speed is increased"),
            )
        ),
        (
            "The path is shortened more, the larger the radius",
            "4, 11, 17 %",
            _grows_with_radius,
        ),
        *(
            (f'"Superior" in {words}', "at every radius", _superior(metric))
            for metric, words in (
                ("path_length", "path length"),
                ("time", "navigation time"),
                ("mean_speed", "mean speed"),
            )
        ),
        (
            '"Stronger obstacle avoidance adjustment ability"',
            "no rate is given",
            _safer,
        ),
    ]
    return [_verdict(claim, published, decide, found) for claim, published, decide in claims]


def _verdict(
    claim: str, published: str, decide: Callable[[Evidence], Finding], found: Sequence[Evidence]
) -> Verdict:
    findings = {e.comparison.label: decide(e) for e in found}
    shared = [
        findings[e.comparison.label]
        for e in found
        if e.comparison.traditional == e.comparison.improved
    ]
    return Verdict(claim, published, findings, weigh(shared))


def _single_maps(table: PublishedTable, ours: Sequence[np.ndarray]) -> Finding:
    """Hold when 95 % of the printed values lie between the 2.5 and 97.5 % quantiles of maps."""
    inside = asked = 0
    for place, values in enumerate(ours):
        if values.shape[1] < TABLE4_MAPS:
            continue
        low, high = np.quantile(values, [0.025, 0.975], axis=1)
        wanted = np.array([[table.values[m, k][place] for k in METRICS] for m in METHODS])
        inside += int(_within(wanted, low, high).sum())
        asked += wanted.size
    return _share_found(inside, asked)


def _averages(found: Evidence) -> Finding:
    """Hold when 95 % of the averages lie where a mean over 20 of our maps would."""
    inside = asked = 0
    for place, values in enumerate(found.tables):
        if values.shape[1] < TABLE4_MAPS:
            continue
        low, high = of_twenty(np.moveaxis(values, 0, 1), place)
        wanted = np.array([[TABLE4.values[m, k][place] for k in METRICS] for m in METHODS])
        inside += int(_within(wanted, low, high).sum())
        asked += wanted.size
    return _share_found(inside, asked)


def _within(wanted: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    within: np.ndarray = (wanted >= low - _HALF_UNIT) & (wanted <= high + _HALF_UNIT)
    return within


def _share_found(inside: int, asked: int) -> Finding:
    if asked == 0:
        return Finding(None, "too few maps")
    return Finding(inside >= 0.95 * asked, f"{inside} of {asked} within")


def _published_change(metric: str) -> str:
    return ", ".join(f"{100 * share:+.1f}" for share in TABLE4.change[metric]) + " %"


def _change_of(metric: str) -> Callable[[Evidence], Finding]:
    """Hold when each published rate lies where a mean of 20 per-map changes of ours would."""
    column = METRICS.index(metric)

    def decide(found: Evidence) -> Finding:
        shares, hits = [], []
        for place, values in enumerate(found.tables):
            if values.shape[1] < TABLE4_MAPS:
                shares.append("-")
                continue
            change = per_map_change(values[0], values[1])[:, column]
            low, high = of_twenty(change, place)
            shares.append(f"{100 * change.mean():+.1f}")
            hits.append(bool(low <= TABLE4.change[metric][place] <= high))
        return Finding(all(hits) if hits else None, ", ".join(shares) + " %")

    return decide


def _grows_with_radius(found: Evidence) -> Finding:
    changes = [
        float(per_map_change(v[0], v[1])[:, METRICS.index("path_length")].mean())
        if v.shape[1] >= TABLE4_MAPS
        else None
        for v in found.tables
    ]
    if any(change is None for change in changes):
        return Finding(None, "too few maps")
    known = [change for change in changes if change is not None]
    numbers = ", ".join(f"{-100 * change:.1f}" for change in known) + " %"
    return Finding(known[0] > known[1] > known[2], numbers)


def _superior(metric: str) -> Callable[[Evidence], Finding]:
    """Hold when the metric is better at each radius, Holm-corrected t-test at 5 %."""
    gain = 1 if metric == "mean_speed" else -1

    def decide(found: Evidence) -> Finding:
        rows = [case["metrics"][metric] for case in found.row["cases"]]
        tested = [row for row in rows if row is not None and row["p_t_holm"] is not None]
        if len(tested) < len(rows):
            return Finding(None, "too few maps")
        words = [_direction(row, gain) for row in tested]
        return Finding(all(word == "better" for word in words), ", ".join(words))

    return decide


def _direction(row: dict[str, Any], gain: int) -> str:
    if row["p_t_holm"] >= ALPHA:
        return "no difference shown"
    return "better" if gain * row["difference"]["value"] > 0 else "worse"


def _safer(found: Evidence) -> Finding:
    """Hold when it collides no more and succeeds no less often at any radius."""
    no_worse, numbers = [], []
    for case in found.row["cases"]:
        hits = [case["endings"][m]["COLLIDED"]["value"] for m in METHODS]
        success = case["success"]
        gained = success["difference"]["value"]
        lost = success["p_mcnemar_holm"] < ALPHA and gained < 0
        no_worse.append(hits[1] <= hits[0] and not lost)
        numbers.append(f"{100 * hits[0]:.1f} to {100 * hits[1]:.1f}")
    return Finding(all(no_worse), "collisions " + ", ".join(numbers) + " %")
