"""What holds of Tables 3, 4, 6 and 7 of Yu et al. 2022."""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from experiments.markdown import interval
from experiments.verdicts import Finding, Verdict
from experiments.yu2022.cruises.compare import LEAST_RUNS
from experiments.yu2022.cruises.published import (
    ALGORITHMS,
    ALPHA,
    CASES,
    PROPOSED,
    STATISTICS,
)
from experiments.yu2022.parts import verdict

LEVEL = 0.05
"""Share of the published mean within which ours counts as the same."""
SAME = 0.95
"""Share of runs that must find the shortest tour for the tours to count as the same."""
LEAST_PAIRS = 5
"""Maps sailed by both from which on the interval of a difference counts."""
RIVALS = tuple(name for name in ALGORITHMS if name != PROPOSED)
_TABLES = {"ordinary": ("3", "4"), "complex": ("6", "7")}
_WORDS = {"length": "shortest", "inflections": "fewest inflection points"}
_DIGITS = {"length": 0, "inflections": 1}

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


def _too_few(runs: Mapping[str, int], wanted: int = LEAST_RUNS) -> str:
    """Name those with fewer runs than wanted; empty where there is none."""
    few = [f"{name.upper()} {n}" for name, n in runs.items() if n < wanted]
    return f"too few runs: {', '.join(few)} of {wanted}" if few else ""


def _listed(values: Iterable[float | None], digits: int = 0, scale: float = 1.0) -> str:
    return ", ".join("-" if v is None else f"{scale * v:.{digits}f}" for v in values)


def _least(case: Found, indicator: str) -> Finding:
    """Hold when the proposed mean is significantly less than each other; fail by one rival."""
    table = {name: case["printed"][indicator][name] for name in ALGORITHMS}
    few = _too_few({name: row["n"] for name, row in table.items()})
    if table[PROPOSED]["n"] < LEAST_RUNS:
        return Finding(None, few)
    means = "means " + _listed(row.get("mean") for row in table.values())
    own = table[PROPOSED]["mean"]
    known = [name for name in RIVALS if table[name]["n"] >= LEAST_RUNS]
    unlike = [name for name in known if table[name]["p"] < ALPHA]
    less = [name for name in unlike if table[name]["mean"] < own]
    if less:
        return Finding(False, f"{means}; less: {_by_p(table, less)}")
    if few:
        return Finding(None, f"{means}; {few}")
    alike = [name for name in known if name not in unlike]
    if alike:
        return Finding(None, f"{means}; no significant difference: {_by_p(table, alike)}")
    return Finding(True, f"{means}; largest p {max(table[name]['p'] for name in RIVALS):.2g}")


def _by_p(table: Found, names: Iterable[str]) -> str:
    rows = ((name, table[name]) for name in names)
    return ", ".join(f"{name.upper()} (p {row['p']:.2g}, n {row['n']})" for name, row in rows)


def _level(case: Found, environment: str, indicator: str) -> Finding:
    """Hold when every algorithm's mean lies near the published one; fail by one that does not."""
    table = {name: case["printed"][indicator][name] for name in ALGORITHMS}
    changes = {
        name: row["mean"] / STATISTICS[environment][indicator][name].mean - 1
        for name, row in table.items()
        if row["n"] >= LEAST_RUNS
    }
    few = _too_few({name: row["n"] for name, row in table.items()})
    numbers = ", ".join(
        f"{100 * changes[name]:+.0f}" if name in changes else "-" for name in ALGORITHMS
    )
    numbers = "; ".join(filter(None, (f"off by {numbers} %", few)))
    if any(abs(change) > LEVEL for change in changes.values()):
        return Finding(False, numbers)
    return Finding(None if few else True, numbers)


class _Difference(NamedTuple):
    """A rival less the proposed one in a case, on the maps that both sailed."""

    text: str
    n: int
    low: float
    high: float


def _every_case(cases: Found, environment: str, indicator: str) -> Finding:
    """Hold when every rival has more in every case; one interval below 0 refutes it."""
    tables = [
        [_difference(number, name, case, indicator) for name in RIVALS]
        for number, case in cases.items()
    ]
    below = [[own for own in table if own.high < 0] for table in tables]
    less = [max(table, key=lambda own: own.n).text for table in below if table]
    if less:
        return Finding(False, f"less than the proposed one: {', '.join(less)}")
    all_ = [own for table in tables for own in table]
    unsure = [own.text for own in all_ if own.low <= 0]
    if unsure:
        numbers = f"{len(unsure)} of {len(all_)} differences undecided: {', '.join(unsure)}"
        return Finding(None, numbers)
    if len(cases) < len(CASES[environment]):
        return Finding(None, "not all cases were run")
    least = [min(table, key=lambda own: own.low).text for table in tables]
    return Finding(True, f"nearest to the proposed one: {', '.join(least)}")


def _difference(number: str, name: str, case: Found, indicator: str) -> _Difference:
    """Of one rival; anything may be where too few maps tell."""
    row = case["against_proposed"][name]
    own = row[indicator]
    shown = interval(own, 1, _DIGITS[indicator], sign=True)
    low, high = own["low"], own["high"]
    if row["n"] < LEAST_PAIRS or low is None:
        low, high = float("-inf"), float("inf")
    return _Difference(f"Case {number} {name.upper()} {shown} (n {row['n']})", row["n"], low, high)


def _fastest(case: Found) -> Finding:
    """Hold when the slowest cruise alone is faster than any of the others; fail by one rival."""
    times = {name: case["seconds_alone"][name] for name in ALGORITHMS}
    own = times[PROPOSED]
    sooner = [name for name in RIVALS if times[name]["largest"] < own["least"]]
    later = [name for name in RIVALS if times[name]["least"] > own["largest"]]
    between = [name for name in RIVALS if name not in sooner and name not in later]
    medians = f"alone {_listed((t['median'] for t in times.values()), 2)} s"
    if sooner:
        return Finding(False, f"{medians}; sooner: {_ranges(times, sooner)}")
    if between:
        return Finding(None, f"{medians}; ranges overlap: {_ranges(times, between)}")
    return Finding(True, f"{medians}; ranges apart")


def _ranges(times: Found, names: Iterable[str]) -> str:
    rows = ((name, times[name]) for name in (*names, PROPOSED))
    return ", ".join(
        f"{name.upper()} {row['least']:.3f} to {row['largest']:.3f}" for name, row in rows
    )


def _orders(case: Found) -> Finding:
    """Hold when nearly every run of every algorithm has the shortest tour; fail by one."""
    rows = {name: case["algorithms"][name] for name in ALGORITHMS}
    shares = {name: row["gap"]["optimal"] for name, row in rows.items()}
    numbers = f"shortest in {_listed((s['value'] for s in shares.values()), scale=100)} %"
    known = [name for name, row in rows.items() if row["runs"] >= LEAST_RUNS]
    if any(shares[name]["high"] < SAME for name in known):
        return Finding(False, numbers)
    few = _too_few({name: row["runs"] for name, row in rows.items()})
    if few:
        return Finding(None, f"{numbers}; {few}")
    if any(share["value"] < SAME for share in shares.values()):
        return Finding(None, f"{numbers}; intervals hold {100 * SAME:.0f} %")
    return Finding(True, numbers)
