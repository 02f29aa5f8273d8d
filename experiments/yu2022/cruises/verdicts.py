"""What holds of Tables 3, 4, 6 and 7 of Yu et al. 2022."""

from collections.abc import Mapping
from typing import Any

from experiments.verdicts import UNKNOWN, Finding, Verdict, verdict
from experiments.yu2022.cruises.compare import LEAST_RUNS
from experiments.yu2022.cruises.published import (
    ALGORITHMS,
    ALPHA,
    CASES,
    PROPOSED,
    STATISTICS,
)

LEVEL = 0.05
"""Share of the published mean within which ours counts as the same."""
SAME = 0.95
"""Share of runs that must find the shortest tour for the tours to count as the same."""
LEAST_CASE_RUNS = 5
"""Runs from which on the order in a case counts; the paper gives one value."""
_TABLES = {"ordinary": ("3", "4"), "complex": ("6", "7")}
_WORDS = {"length": "shortest", "inflections": "fewest inflection points"}

Found = Mapping[str, Any]


def judge(found: Found) -> list[Verdict]:
    """Judge every claim about whole cruises.

    Args:
        found: of `compare`.
    """
    verdicts = []
    for environment, cases in found.items():
        first, second = _TABLES[environment]
        for indicator, word in _WORDS.items():
            published = STATISTICS[environment][indicator]
            means = ", ".join(f"{published[name].mean:.0f}" for name in ALGORITHMS)
            verdicts += [
                verdict(
                    f"Table {first}: the proposed one has the {word} of all",
                    f"means {means}; all p < {ALPHA:g}",
                    {"as printed": _least(cases["1"], indicator)},
                ),
                verdict(
                    f"Table {first}: the level of {_name(indicator)}",
                    f"means {means}",
                    {"as printed": _level(cases["1"], environment, indicator)},
                ),
                verdict(
                    f"Table {second}: so in all cases ({_name(indicator)})",
                    "all four cases",
                    {"as printed": _every_case(cases, environment, indicator)},
                ),
            ]
        verdicts.append(
            verdict(
                f"Table {first}: the proposed one plans in the least time",
                _times(environment),
                {"as printed": _fastest(cases["1"])},
            )
        )
    if "ordinary" in found:
        claim = "Figs. 6 to 10: all five find the same order (ordinary, Case 1)"
        verdicts.append(verdict(claim, "the same", {"as printed": _orders(found["ordinary"]["1"])}))
    return verdicts


def _name(indicator: str) -> str:
    return {"length": "length", "inflections": "inflection points"}[indicator]


def _times(environment: str) -> str:
    published = STATISTICS[environment]["planning_time"]
    return "means " + ", ".join(f"{published[name].mean:.1f}" for name in ALGORITHMS) + " s"


def _enough(case: Found, indicator: str) -> bool:
    return all(case["printed"][indicator][name]["n"] >= LEAST_RUNS for name in ALGORITHMS)


def _least(case: Found, indicator: str) -> Finding:
    """Hold when the proposed mean is the least, and significantly less than each other."""
    if not _enough(case, indicator):
        return Finding(None, UNKNOWN)
    table = case["printed"][indicator]
    means = {name: table[name]["mean"] for name in ALGORITHMS}
    others = [name for name in ALGORITHMS if name != PROPOSED]
    holds = all(means[PROPOSED] < means[n] and table[n]["p"] < ALPHA for n in others)
    numbers = ", ".join(f"{mean:.0f}" for mean in means.values())
    worst = max(table[n]["p"] for n in others)
    return Finding(holds, f"means {numbers}; largest p {worst:.2g}")


def _level(case: Found, environment: str, indicator: str) -> Finding:
    """Hold when every algorithm's mean lies near the published one."""
    if not _enough(case, indicator):
        return Finding(None, UNKNOWN)
    changes = [
        case["printed"][indicator][name]["mean"] / STATISTICS[environment][indicator][name].mean - 1
        for name in ALGORITHMS
    ]
    numbers = ", ".join(f"{100 * change:+.0f}" for change in changes)
    return Finding(all(abs(change) <= LEVEL for change in changes), f"off by {numbers} %")


def _every_case(cases: Found, environment: str, indicator: str) -> Finding:
    """Hold when the proposed one's mean is the least in every case that was run."""
    if len(cases) < len(CASES[environment]):
        return Finding(None, "not all cases were run")
    least_runs = min(case["algorithms"][n]["runs"] for case in cases.values() for n in ALGORITHMS)
    if least_runs < LEAST_CASE_RUNS:
        return Finding(None, UNKNOWN)
    least = []
    for case in cases.values():
        means = {n: case["algorithms"][n][indicator]["value"] for n in ALGORITHMS}
        if None in means.values():
            return Finding(None, "an algorithm never came home")
        least.append(min(means, key=means.__getitem__))
    return Finding(all(n == PROPOSED for n in least), f"least: {', '.join(least)}")


def _fastest(case: Found) -> Finding:
    """Hold when a cruise of the proposed one alone takes the least time."""
    seconds = {n: case["seconds_alone"][n]["median"] for n in ALGORITHMS}
    numbers = ", ".join(f"{value:.2f}" for value in seconds.values())
    return Finding(min(seconds, key=seconds.__getitem__) == PROPOSED, f"alone {numbers} s")


def _orders(case: Found) -> Finding:
    """Hold when nearly every run of every algorithm has the shortest tour."""
    shares = {n: case["algorithms"][n]["gap"]["optimal"]["value"] for n in ALGORITHMS}
    if min(case["algorithms"][n]["runs"] for n in ALGORITHMS) < LEAST_RUNS:
        return Finding(None, UNKNOWN)
    numbers = ", ".join(f"{100 * share:.0f}" for share in shares.values())
    return Finding(all(share >= SAME for share in shares.values()), f"shortest in {numbers} %")
