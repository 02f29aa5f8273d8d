"""The part of the report about whole cruises, as Markdown."""

from collections.abc import Mapping
from typing import Any

from experiments.markdown import grid, interval
from experiments.yu2022.cruises.compare import LEAST_RUNS
from experiments.yu2022.cruises.published import (
    ALGORITHMS as PUBLISHED,
)
from experiments.yu2022.cruises.published import (
    CASES,
    PROPOSED,
    RUNS,
    STATISTICS,
)
from experiments.yu2022.cruises.runs import ALGORITHMS
from experiments.yu2022.cruises.verdicts import LEAST_PAIRS, LEVEL, SAME

Found = Mapping[str, Any]

_TABLES = {"ordinary": ("3", "4"), "complex": ("6", "7")}
_INDICATORS = {"length": ("Length (m)", 0), "inflections": ("Inflection points", 1)}
_MAPS = {"ordinary": "figs_6_10.png", "complex": "figs_11_15.png"}


def figures(found: Found) -> list[str]:
    """What the figures show that were drawn.

    Args:
        found: of `compare`.
    """
    maps = ", ".join(f"`figures/{_MAPS[environment]}`" for environment in found)
    return [
        f"{maps}: one cruise of each algorithm on the same map; numbers are the order of visits, "
        "grey is what was seen.",
        "`figures/cruises.png`: lengths and inflection points of all algorithms beside the "
        "published means.",
    ]


def counts(plan: Found) -> str:
    """How many cruises there are of each algorithm.

    Args:
        plan: of the cruises, as in results.json.
    """
    text = (
        f"cruises of Case 1: {plan['runs']:,} by each algorithm that sails by D* Lite, "
        f"{plan['swarm_runs']:,} by each of Algorithms 1 to 3"
    )
    if len(plan["cases"]) > 1:
        text += f", of each other case {plan['case_runs']:,} and {plan['case_swarm_runs']:,}"
    return text


def note(plan: Found) -> str:
    """How to read the verdicts.

    Args:
        plan: of the cruises, as in results.json.
    """
    return (
        f"Of {LEAST_RUNS} runs or more that visit all stations. Shortest and fewest: Welch's "
        "t-test as in the paper, on the maps of Tables 3 and 6; one algorithm that is "
        "significantly better refutes it, and it holds where the proposed one is significantly "
        f"better than each. The level: every mean within {100 * LEVEL:.0f} %. All cases: the "
        "mean difference to the proposed one map by map, on the maps n that both sailed "
        f"completely, {LEAST_PAIRS} or more; only where its interval of 95 % lies off 0 does it "
        f"count, for or against. The least time: the ranges of {plan['repeats']} cruises lie "
        f"apart. The same order: the shortest tour in {100 * SAME:.0f} % of the runs of each."
    )


def section(found: Found) -> str:
    """Write the tables.

    Args:
        found: of `compare`.
    """
    parts = []
    for environment, cases in found.items():
        first, second = _TABLES[environment]
        parts += [
            f"### Table {first}: Case 1, {environment} environment\n\n"
            + _printed(cases["1"], environment),
            f"### Planning time, {environment}, Case 1\n\n" + _times(cases["1"], environment),
            f"### Table {second}: all cases, {environment} environment\n\n"
            + _cases(cases, environment),
            f"### The order of stations, {environment} environment\n\n" + _tours(cases),
            f"### What each part brings, {environment} environment\n\n" + _parts(cases),
        ]
    return "\n\n".join(parts)


def readings(plan: Found) -> list[str]:
    """How the paper was read.

    Args:
        plan: of the cruises, as in results.json.
    """
    few, many = (min(plan[key], RUNS) for key in ("swarm_runs", "runs"))
    return [
        "Maps are not printed: every run has a map of its own, each cell blocked with the printed "
        "density as probability, the stations' cells free. Run k of every algorithm meets map k "
        "and its flips. Where one has fewer runs than another, its means are those of fewer maps; "
        "what is said of differences map by map is of the maps that both sailed.",
        "The printed change of 3 % per cell and move would drive the whole map to half blocked; "
        "here it falls on the 5 x 5 cells that the vessel sees. The vessel's cell and the "
        "stations never change. Algorithms 1 to 3 plan a leg on the map as known, sail, and plan "
        "anew where what they see blocks the way ahead; D* Lite repairs.",
        "Algorithms 1 to 4 sail the cells of their path; only the proposed one's track is pulled "
        "straight, as in the paper. Length and inflection points are those of the line that is "
        "sailed. A chord counts only where it was clear on the map of each moment that it "
        "replaces.",
        f"Tables 3 and 6: the first {many} maps for the algorithms that sail by D* Lite and the "
        f"first {few} for Algorithms 1 to 3, where {RUNS} runs of each are printed, with Welch's "
        "t-test against the proposed algorithm. Runs that do not visit all stations are counted "
        "apart and not averaged.",
        "Population of the GA, sub-swarms of the CMPSO and how ants, genes and particles stand "
        "for paths are not printed; see the docstrings of `usvkernels.planners` and "
        "`usvkernels.tours`.",
    ]


def _printed(case: Found, environment: str) -> str:
    header = ["Indicator", "Algorithm", "n", "Best", "Mean", "Worst", "Std. dev.", "p"]
    header += ["Published best", "mean", "worst", "std. dev.", "p"]
    rows = []
    for indicator, (label, digits) in _INDICATORS.items():
        for name, row in case["printed"][indicator].items():
            own = [_number(row.get(k), digits) for k in ("best", "mean", "worst", "std")]
            own.append(f"{row['p']:.2g}" if row.get("p") is not None else "-")
            printed = STATISTICS[environment][indicator].get(name)
            theirs = ["-"] * 5
            if printed:
                values = (printed.best, printed.mean, printed.worst, printed.std)
                theirs = [f"{value:.{digits}f}" for value in values]
                theirs.append("-" if printed.p is None else f"{printed.p:.2g}")
            rows.append([label, ALGORITHMS[name].label, str(row["n"]), *own, *theirs])
    return grid(header, rows)


def _times(case: Found, environment: str) -> str:
    header = ["Algorithm", "Median (s)", "Least", "Largest", "Published mean (s)"]
    published = STATISTICS[environment]["planning_time"]
    rows = []
    for name, own in case["seconds_alone"].items():
        printed = published.get(name)
        rows.append(
            [
                ALGORITHMS[name].label,
                *(f"{own[k]:.3f}" for k in ("median", "least", "largest")),
                f"{printed.mean:.1f}" if printed else "-",
            ]
        )
    return (
        "Seconds for one cruise in a call: the tour, all planning under way, the simulation itself "
        "and the smoothing, compiled code. Published: MATLAB R2017b on a Xeon E5-2620.\n\n"
        + grid(header, rows)
    )


def _cases(cases: Found, environment: str) -> str:
    header = ["Case", "Algorithm", "Runs", "All stations (%)", "Length (m)", "Published"]
    header += ["Inflections", "Published"]
    rows = []
    for number, case in cases.items():
        printed = CASES[environment][int(number)]
        for name, own in case["algorithms"].items():
            rows.append(
                [
                    number,
                    ALGORITHMS[name].label,
                    f"{own['runs']:,}",
                    interval(own["complete"], 100, 1),
                    interval(own["length"], 1, 0),
                    _number(printed["length"].get(name), 0),
                    interval(own["inflections"], 1, 1),
                    _number(printed["inflections"].get(name), 0),
                ]
            )
    text = (
        "Means over the runs that visited all stations, with the range of 95 % of them in "
        "brackets; shares with Wilson intervals."
    )
    return text + "\n\n" + grid(header, rows)


def _tours(cases: Found) -> str:
    header = ["Case", "Shortest (cells)", "Algorithm", "Gap mean (%)", "least", "largest"]
    header.append("Shortest found (%)")
    rows = []
    for number, case in cases.items():
        for name, own in case["algorithms"].items():
            gap = own["gap"]
            rows.append(
                [
                    number,
                    f"{case['optimum']:.4f}",
                    ALGORITHMS[name].label,
                    *(f"{100 * gap[k]:.2f}" for k in ("mean", "least", "largest")),
                    interval(gap["optimal"], 100, 1),
                ]
            )
    text = "Closed tours, straight from station to station, against the shortest there is."
    return text + "\n\n" + grid(header, rows)


def _parts(cases: Found) -> str:
    header = ["Case", "Algorithm", "Track (m)", "Pulled straight (m)", "Detour", "Waits"]
    header.append("Less the proposed one (m)")
    rows = []
    for number, case in cases.items():
        for name, own in case["algorithms"].items():
            against = case["against_proposed"].get(name)
            rows.append(
                [
                    number,
                    ALGORITHMS[name].label,
                    interval(own["track"], 1, 0),
                    interval(own["smoothed"], 1, 0),
                    interval(own["detour"], 1, 3),
                    interval(own["waits"], 1, 1),
                    interval(against["length"], 1, 0, sign=True) if against else "-",
                ]
            )
    text = (
        "Track: through the centres of the cells sailed. Pulled straight: the same with the "
        "proposed algorithm's smoothing, whoever planned it. Detour: the line sailed over its own "
        "tour's straight legs. The last column is the mean difference map by map, with its t "
        "interval."
    )
    return text + "\n\n" + grid(header, rows)


def flips(varied: Found) -> str:
    """Write what the flips change.

    Args:
        varied: of `vary`.
    """
    header = ["Environment", "What changes", "Algorithm", "Runs", "All stations (%)"]
    header += ["Length (m)", "Published", "Inflections", "Published", "Waits"]
    rows = []
    for environment, kinds in varied.items():
        printed = STATISTICS[environment]
        for label, algorithms in kinds.items():
            for name, own in algorithms.items():
                theirs = {
                    k: printed[k][name].mean if name in printed[k] else None for k in _INDICATORS
                }
                rows.append(
                    [
                        environment,
                        label,
                        ALGORITHMS[name].label,
                        f"{own['runs']:,}",
                        interval(own["complete"], 100, 1),
                        interval(own["length"], 1, 0),
                        _number(theirs["length"], 0),
                        interval(own["inflections"], 1, 1),
                        _number(theirs["inflections"], 1),
                        interval(own["waits"], 1, 1),
                    ]
                )
    text = (
        "Case 1. The paper's change of 3 % names no cells. Each cell of the vessel's window or of "
        "the whole map changes with that probability at every move; what happens outside the "
        "window is noticed when it comes into sight."
    )
    return f"### What the flips change\n\n{text}\n\n" + grid(header, rows)


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def summary(found: Found) -> list[str]:
    """Sentences for the head of the report."""
    lines = []
    for environment, cases in found.items():
        case = cases["1"]["algorithms"]
        own, best = case[PROPOSED], case["best"]
        if own["length"]["value"] is None or best["length"]["value"] is None:
            continue
        published = STATISTICS[environment]["length"][PROPOSED].mean
        gaps = ", ".join(f"{100 * case[name]['gap']['mean']:.1f}" for name in PUBLISHED)
        lines.append(
            f"**{environment.capitalize()} environment, Case 1**: the proposed algorithm sails "
            f"{own['length']['value']:.0f} m (published {published:.0f} m); the shortest tour "
            f"with exact D* Lite and the same smoothing {best['length']['value']:.0f} m. Mean gap "
            f"of the tours to the shortest: {gaps} % ({', '.join(PUBLISHED)})."
        )
    return lines
