"""The part of the page about whole cruises: how the paper was read, and the tables."""

from collections.abc import Iterator, Mapping
from typing import Any

from experiments.claims import Numbers
from experiments.yu2022.cruises.published import CASES, PROPOSED, RUNS, STATISTICS
from experiments.yu2022.cruises.runs import (
    CALM,
    ENCODINGS,
    ENVIRONMENTS,
    FLOOD,
    LABELS,
    LEAST_COMPLETE,
    LEAST_RUNS,
    USUAL,
)
from usvjax.report import Section, Sheet
from usvjax.report.numbers import NONE, fixed, interval, listed, p_value, percent

PRINTED = {method: name for names in ENCODINGS.values() for name, method in names.items()}
"""Of each method that stands for one of the paper's algorithms, which."""
_INDICATORS = {"length": ("Length (m)", 0), "inflections": ("Inflection points", 1)}


def readings(numbers: Numbers) -> list[str]:
    """How the paper was read."""
    return [
        "How a wolf stands for a tour is not printed. Both readings count, for Algorithm 4 as for "
        "the proposed one: *random keys*, whose order is the tour, and *swap sequences*, as in "
        "the paper's reference 23. ACO, GA and CMPSO stand for tours in one way (ants walk them, "
        "genes are permutations with order crossover, particles are random keys) and are the same "
        "in both.",
        "The printed change of 3 % per cell and move names no cells. Three readings count in "
        "Tables 3 and 6: 3 % in the 5 x 5 cells that the vessel sees, 1 % there, and none at all. "
        "3 % everywhere blocks half of the whole map in the long run; it stands in brackets and "
        f"can decide nothing, as Algorithms 1 to 3 were not run there{_came_home(numbers)}. All "
        "else is of 3 % in the window. In brackets stands too, where nothing changes, what the "
        "proposed one could be: the shortest tour, exact D* Lite and its smoothing.",
        "Maps are not printed: every run has a map of its own, each cell blocked with the printed "
        "density as probability, the stations' cells free. Run k of every algorithm meets map k "
        "and its changes. The vessel's cell and the stations never change. Algorithms 1 to 3 plan "
        "a leg on the map as known, sail, and plan anew where what they see blocks the way ahead; "
        "D* Lite repairs.",
        "Algorithms 1 to 4 sail the cells of their path; only the proposed one's track is pulled "
        "straight, as in the paper, and what stands beside them: the shortest tour, exact D* Lite "
        "and that smoothing. Length and inflection points are those of the line that is "
        "sailed. A chord counts only where it was clear on the map of each moment that it "
        "replaces.",
        f"Tables 3 and 6: of the first {RUNS} maps. The paper names a t-test; ours is Welch's, of "
        "two samples. Runs that do not visit all stations are counted apart and not averaged. A "
        f"mean counts from {LEAST_COMPLETE} complete cruises on, our limit; it was {LEAST_RUNS}, "
        "as many as are made of some kinds, until some of these had not come home.",
        "*Detection area*: the cells that came into sight anywhere on the way, or those that "
        "searches expanded, both grey in the paper's figures; each is judged.",
        "Planning time: seconds for one cruise in a call, the tour, all planning under way, the "
        "simulation itself and the smoothing, compiled before. Published: MATLAB R2017b on a Xeon "
        "E5-2620.",
        "Population of the GA, sub-swarms of the CMPSO and how ants, genes and particles stand "
        "for paths are not printed and were not varied; see the docstrings of "
        "`usvkernels.planners` and `usvkernels.tours`.",
    ]


def _came_home(numbers: Numbers) -> str:
    """How many cruises came home where the whole map changes: a clause, "" where none was run."""
    sailed = [
        own
        for tables in numbers["tables"].values()
        if FLOOD in tables
        for own in tables[FLOOD]["outcomes"].values()
    ]
    home = sum(round(own["complete"]["value"] * own["runs"]) for own in sailed)
    runs = sum(own["runs"] for own in sailed)
    return f"; of {runs:,} cruises by D* Lite there {home:,} came home" if runs else ""


def summary(numbers: Numbers) -> list[str]:
    """The most important findings besides the verdicts."""
    lines = []
    for environment, tables in numbers["tables"].items():
        published = STATISTICS[environment]["length"][PROPOSED].mean
        means = {
            (flips, method): tables[flips]["rows"]["length"][method].get("mean")
            for flips in (USUAL, CALM)
            for method in ("proposed", "proposed_swap", "recommended")
        }
        usual, calm = (
            [means[flips, name] for name in ("proposed", "proposed_swap", "recommended")]
            for flips in (USUAL, CALM)
        )
        gaps = (
            numbers["cases"][environment]["1"]["algorithms"][name]["gap"]["mean"]
            for name in ("proposed", "proposed_swap")
        )
        lines.append(
            f"**{environment.capitalize()} environment, Case 1**: the proposed algorithm sails "
            f"{fixed(usual[0], 0)} m with random keys and {fixed(usual[1], 0)} m with swap "
            f"sequences (published {published:.0f} m), {fixed(calm[0], 0)} and {fixed(calm[1], 0)} "
            f"m where nothing changes; the shortest tour with exact D* Lite and the same smoothing "
            f"{fixed(usual[2], 0)} and {fixed(calm[2], 0)} m. Its tours are longer than the "
            f"shortest by {listed(gaps, 1, 100)} %."
        )
    return lines


def sections(numbers: Numbers) -> list[Section]:
    """The tables."""
    found = []
    for environment, cases in numbers["cases"].items():
        first, second = ENVIRONMENTS[environment].tables
        tables = numbers["tables"][environment]
        found += [
            Section(
                f"Table {first}: Case 1, {environment} environment",
                [
                    f"Best, mean, worst and standard deviation of n complete cruises of the first "
                    f"{RUNS}, with 3 % of changes in the window; p: of Welch's t-test against the "
                    "proposed one with the same encoding.",
                    _printed(tables[USUAL], environment),
                ],
            ),
            Section(f"Table {first} under every reading", _readings(tables, environment)),
            Section(
                f"Planning time, {environment} environment",
                [_times(numbers["seconds"][environment]["cases"], environment)],
            ),
            Section(
                f"Table {second}: all cases, {environment} environment", _cases(cases, environment)
            ),
            Section(f"The order of stations, {environment} environment", _tours(cases)),
            Section(f"What each part brings, {environment} environment", _parts(cases)),
            Section(
                f"Detection area, {environment} environment, Case 1",
                [_areas(numbers["detection"][environment])],
            ),
        ]
    return found


def _printed(table: Mapping[str, Any], environment: str) -> Sheet:
    header = ["Indicator", "Algorithm", "n", "Best", "Mean", "Worst", "Std. dev."]
    header += [f"p, {encoding}" for encoding in ENCODINGS]
    header += ["Published best", "mean", "worst", "std. dev.", "p"]
    rows = []
    for indicator, (label, digits) in _INDICATORS.items():
        for method, row in table["rows"][indicator].items():
            own = [fixed(row.get(key), digits) for key in ("best", "mean", "worst", "std")]
            theirs = [NONE] * 5
            if method in PRINTED:
                printed = STATISTICS[environment][indicator][PRINTED[method]]
                values = (printed.best, printed.mean, printed.worst, printed.std)
                theirs = [*(fixed(value, digits) for value in values), p_value(printed.p)]
            tests = [
                p_value(
                    table["p"][indicator][encoding].get(PRINTED.get(method))
                    if method in names.values()
                    else None
                )
                for encoding, names in ENCODINGS.items()
            ]
            rows.append([label, LABELS[method], str(row["n"]), *own, *tests, *theirs])
    return Sheet("", header, rows, words=2)


def _readings(tables: Mapping[str, Any], environment: str) -> list[str | Sheet]:
    header = ["What changes", "Algorithm", "Runs", "All stations (%)"]
    header += ["Length (m)", "Published", "Inflections", "Published", "Waits"]
    rows = []
    for flips, table in tables.items():
        for method, own in table["outcomes"].items():
            rows.append(
                [
                    flips,
                    LABELS[method],
                    f"{own['runs']:,}",
                    interval(own["complete"], 100, digits=1),
                    interval(own["length"], 1, digits=0),
                    _published(environment, "length", method, 0),
                    interval(own["inflections"], 1, digits=1),
                    _published(environment, "inflections", method, 1),
                    interval(own["waits"], 1, digits=1),
                ]
            )
    text = (
        "Means over all runs that visited all stations, with the range of 95 % of them in "
        "brackets; shares with Wilson intervals. Each cell of the vessel's window or of the whole "
        "map changes with that probability at every move; what happens outside the window is "
        "noticed when it comes into sight."
    )
    return [text, Sheet("", header, rows, words=2)]


def _published(environment: str, indicator: str, method: str, digits: int) -> str:
    if method not in PRINTED:
        return NONE
    return fixed(STATISTICS[environment][indicator][PRINTED[method]].mean, digits)


def _times(cases: Mapping[str, Any], environment: str) -> Sheet:
    header = ["Case", "Algorithm", "n", "Median (s)", "Least", "Largest", "Published (s)"]
    rows = [
        [
            case,
            LABELS[method],
            str(own["n"]),
            *(fixed(own[key], 3) for key in ("median", "least", "largest")),
            fixed(CASES[environment][int(case)]["planning_time"][PRINTED[method]], 1),
        ]
        for case, methods in cases.items()
        for method, own in methods.items()
    ]
    return Sheet("", header, rows, words=2)


def _of_cases(cases: Mapping[str, Any]) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
    for case, found in cases.items():
        for method, own in found["algorithms"].items():
            yield case, method, own


def _cases(cases: Mapping[str, Any], environment: str) -> list[str | Sheet]:
    header = ["Case", "Algorithm", "Runs", "All stations (%)", "Length (m)", "Published"]
    header += ["Inflections", "Published"]
    rows = []
    for case, method, own in _of_cases(cases):
        printed = CASES[environment][int(case)]
        name = PRINTED.get(method)
        rows.append(
            [
                case,
                LABELS[method],
                f"{own['runs']:,}",
                interval(own["complete"], 100, digits=1),
                interval(own["length"], 1, digits=0),
                fixed(printed["length"][name], 0) if name else NONE,
                interval(own["inflections"], 1, digits=1),
                fixed(printed["inflections"][name], 0) if name else NONE,
            ]
        )
    text = (
        "Means over the runs that visited all stations, with the range of 95 % of them in "
        "brackets; shares with Wilson intervals."
    )
    return [text, Sheet("", header, rows, words=2)]


def _tours(cases: Mapping[str, Any]) -> list[str | Sheet]:
    header = ["Case", "Algorithm", "Shortest (m)", "Gap mean (%)", "least", "largest"]
    header.append("Shortest found (%)")
    rows = [
        [
            case,
            LABELS[method],
            fixed(cases[case]["optimum"], 1),
            *(percent(own["gap"][key]) for key in ("mean", "least", "largest")),
            interval(own["gap"]["optimal"], 100, digits=1),
        ]
        for case, method, own in _of_cases(cases)
    ]
    text = (
        "Closed tours, straight from station to station, against the shortest there is (of 20 "
        "stations the shortest that was found)."
    )
    return [text, Sheet("", header, rows, words=2)]


def _parts(cases: Mapping[str, Any]) -> list[str | Sheet]:
    header = ["Case", "Algorithm", "Track (m)", "Pulled straight (m)", "Detour", "Waits"]
    header += [f"Less the proposed one, {encoding} (m)" for encoding in ENCODINGS]
    rows = []
    for case, method, own in _of_cases(cases):
        against = cases[case]["against_proposed"]
        less = [
            interval(against[encoding][PRINTED[method]]["length"], 1, True, 0)
            if method in names.values() and PRINTED[method] in against[encoding]
            else NONE
            for encoding, names in ENCODINGS.items()
        ]
        rows.append(
            [
                case,
                LABELS[method],
                interval(own["track"], 1, digits=0),
                interval(own["smoothed"], 1, digits=0),
                interval(own["detour"], 1, digits=3),
                interval(own["waits"], 1, digits=1),
                *less,
            ]
        )
    text = (
        "Track: through the centres of the cells sailed. Pulled straight: the same with the "
        "proposed algorithm's smoothing, whoever planned it. Detour: the line sailed over its own "
        "tour's straight legs. The last columns are mean differences map by map, with their t "
        "intervals."
    )
    return [text, Sheet("", header, rows, words=2)]


def _areas(found: Mapping[str, Any]) -> Sheet:
    header = ["Reading", "Area", "Maps", "Algorithm 4", "Proposed", "Less by"]
    rows = [
        [
            encoding,
            {"seen": "cells in sight", "expanded": "cells expanded"}[kind],
            str(own["n"]),
            interval(own["gwo"], 1, digits=0),
            interval(own[PROPOSED], 1, digits=0),
            interval(own["less"], 1, digits=0),
        ]
        for encoding, kinds in found.items()
        for kind, own in kinds.items()
    ]
    return Sheet("", header, rows, words=2)
