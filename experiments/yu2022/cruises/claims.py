"""What Tables 3, 4, 6 and 7 and Figs. 6 to 15 of Yu et al. 2022 claim of whole cruises."""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

from experiments.claims import Claim, Finding, Numbers, above, below
from experiments.yu2022.cruises.published import ALGORITHMS, ALPHA, CASES, PROPOSED, STATISTICS
from experiments.yu2022.cruises.runs import (
    BESIDE,
    CALM,
    ENCODINGS,
    ENVIRONMENTS,
    FLIPS,
    FLOOD,
    LEAST_COMPLETE,
    USUAL,
)
from usvjax.report.numbers import fixed, interval, listed, p_value

NEAR, FAR = 0.05, 0.10
"""A mean within the first share of the published one is the same, beyond the second another."""
LEAST_PAIRS = 5
"""Maps sailed by both from which on a difference counts."""
ALWAYS = 0.94
"""Share of runs below which one of 50 fails with a probability of 95 %."""
RANKED = 40
"""Runs from which on the rank of one more can be as rare as 5 %."""
RIVALS = tuple(name for name in ALGORITHMS if name != PROPOSED)
_WORDS = {"length": "shortest", "inflections": "fewest inflection points"}
_NAMES = {"length": "length", "inflections": "inflection points"}
_DIGITS = {"length": 0, "inflections": 1}

_NOTHING = {"value": None, "low": None, "high": None, "p": None}

Reading = tuple[str, str]
"""Encoding and flips."""

_STRICT = (
    "Yes where all four rivals differ significantly for the worse (p < 0.05 each, which a wrong "
    "claim passes in at most 5 % of samples); no where one is significantly better "
    "(p < 0.05 / 4, so that a claim that just holds fails in at most 5 %)"
)
_TESTS = {
    "best": (
        "Welch's t-test, two-sided, of the first 50 maps, "
        f"{LEAST_COMPLETE} complete cruises or more of each; the paper names a t-test and not "
        f"which. {_STRICT}."
    ),
    "level": (
        "All five means within 5 % of the published ones, each with its whole 95 % t interval: "
        "yes; one beyond 10 % with all of it: no, to which five means just at these 10 % come in "
        f"12.5 % of samples at most; means of {LEAST_COMPLETE} complete cruises or more. The "
        "published maps are not known, and the published means are taken as they are."
    ),
    "cases": (
        "The t-test of differences map by map, on the maps that both sailed completely, 5 or more. "
        "Yes where all 16 differ significantly for the worse (p < 0.05 each); no where one is "
        "significantly better (p < 0.05 / 16, so that a claim that just holds fails in at most "
        "5 %)."
    ),
    "time": f"The Mann-Whitney test of cruises timed alone. {_STRICT}.",
    "times": (
        "The t-test of the logarithms of the ratios of median times, one for each of the four "
        f"cases; four of which one is negative are never significant. {_STRICT}."
    ),
    "figure": (
        "The figures show one run. No where p of its rank among ours, of which some are so and "
        "the others not, is below 5 %: were it drawn as ours were, it would be in at most 5 % of "
        f"papers; else it is not excluded. Of {RANKED} runs or more; tours of the same length "
        "count as the same."
    ),
    "always": (
        "No where the share of runs with the shortest tour lies below 94 %, its whole interval: 50 "
        "runs without a failure then have a probability below 5 %; yes where none fails."
    ),
    "area": (
        "Yes or no where the mean difference map by map lies to that side of 0 with its whole 95 % "
        "t interval, on the first 50 maps as far as both completed them; equal areas come to "
        "either in 2.5 % of samples."
    ),
}


def claims(numbers: Numbers) -> list[Claim]:
    """Every claim about whole cruises."""
    found: list[Claim] = []
    for environment in numbers["cases"]:
        found += [
            *_tabled(numbers, environment),
            *_timed(numbers, environment),
            *_drawn(numbers, environment),
        ]
    return found


def label_of(encoding: str, flips: str = USUAL) -> str:
    """Words for a reading."""
    return f"{encoding}, {flips}"


def _crossed(numbers: Numbers, environment: str) -> dict[str, Reading]:
    """All readings that were run: encodings times flips."""
    kinds = [flips for flips in FLIPS if flips in numbers["tables"][environment]]
    return {label_of(code, flips): (code, flips) for flips in kinds for code in ENCODINGS}


def _split(crossed: Mapping[str, Reading]) -> tuple[dict[str, Reading], dict[str, Reading]]:
    """What counts, and what stands beside it."""
    # Where the whole map changes Algorithms 1 to 3 do not sail: no verdict can follow.
    beside = {label: own for label, own in crossed.items() if own[1] == FLOOD}
    counted = {label: own for label, own in crossed.items() if label not in beside}
    return counted, beside | {label_of(name, CALM): (name, CALM) for name in BESIDE}


def _encodings() -> dict[str, str]:
    return {label_of(code): code for code in ENCODINGS}


def _tabled(numbers: Numbers, environment: str) -> Iterable[Claim]:
    """Lengths and inflection points of Table 3 or 6, and of Table 4 or 7."""
    first, second = ENVIRONMENTS[environment].tables
    for indicator, word in _WORDS.items():
        published = STATISTICS[environment][indicator]
        means = "means " + listed((published[name].mean for name in ALGORITHMS), 0)
        crossed, beside = _split(_crossed(numbers, environment))
        yield Claim(
            f"Table {first}: the proposed one has the {word} of all",
            f"{means}; all p < {ALPHA:g}",
            partial(_least, environment, indicator),
            crossed,
            beside,
            test=_TESTS["best"],
        )
        yield Claim(
            f"Table {first}: the level of {_NAMES[indicator]}",
            means,
            partial(_level, environment, indicator),
            crossed,
            beside,
            test=_TESTS["level"],
        )
        yield Claim(
            f"Table {second}: so in all cases ({_NAMES[indicator]})",
            "all four cases",
            partial(_every_case, environment, indicator),
            _encodings(),
            test=_TESTS["cases"],
        )


def _timed(numbers: Numbers, environment: str) -> Iterable[Claim]:
    first, second = ENVIRONMENTS[environment].tables
    published = STATISTICS[environment]["planning_time"]
    means = listed(published[name].mean for name in ALGORITHMS)
    yield Claim(
        f"Table {first}: the proposed one plans in the least time",
        f"means {means} s",
        partial(_fastest, environment),
        _encodings(),
        test=_TESTS["time"],
    )
    yield Claim(
        f"Table {second}: so in all cases (planning time)",
        "all four cases",
        partial(_always_fastest, environment),
        _encodings(),
        test=_TESTS["times"],
    )


def _drawn(numbers: Numbers, environment: str) -> Iterable[Claim]:
    """What the text says of the figures."""
    pair = "Figs. 9, 10" if environment == "ordinary" else "Figs. 14, 15"
    for kind, words in (("seen", "cells in sight"), ("expanded", "cells expanded")):
        yield Claim(
            f"{pair}: a smaller detection area ({words})",
            '"obviously"',
            partial(_area, environment, kind),
            _encodings(),
            test=_TESTS["area"],
        )
    weak = {"test": _TESTS["figure"], "weak": True}
    if environment == "ordinary":
        yield Claim(
            "Figs. 6 to 10: all five find the same order",
            "the same",
            partial(_order, environment, "all"),
            _encodings(),
            **weak,
        )
        yield Claim(
            'Table 3: the proposed one "always found an optimal solution" (order)',
            "always",
            partial(_always, environment),
            _encodings(),
            test=_TESTS["always"],
        )
        return
    yield Claim(
        "Figs. 14, 15: the same order",
        "the same",
        partial(_order, environment, "wolves"),
        _encodings(),
        **weak,
    )
    yield Claim(
        "Figs. 11 to 13: other orders than in Figs. 14 and 15",
        "different",
        partial(_order, environment, "swarms_differ"),
        _encodings(),
        **weak,
    )


def _compared(
    rivals: Mapping[str, Mapping[str, Any]], shown: Callable[[str], str], few: str, head: str
) -> Finding:
    """Hold when all rivals are significantly worse; fail by one that is significantly better.

    Args:
        rivals: by name, how much `more` each has and p of its test, None where too few tell.
        shown: words for a rival.
        few: what is missing, "" for nothing.
        head: of the numbers.
    """
    known = {name: own for name, own in rivals.items() if own["p"] is not None}
    level = ALPHA / len(rivals)
    better = [name for name, own in known.items() if own["more"] < 0 and own["p"] < level]
    if better:
        return Finding(False, f"{head}better: {', '.join(map(shown, better))}")
    unsure = [name for name, own in known.items() if not (own["more"] > 0 and own["p"] < ALPHA)]
    # Where too few tell, they are named once, together.
    few = few or ("" if len(known) == len(rivals) else "too few runs of the others")
    told = [f"not significantly worse: {', '.join(map(shown, unsure))}"] if unsure else []
    told += [few] if few else []
    if told:
        return Finding(None, head + "; ".join(told))
    return Finding(True, f"{head}largest p {p_value(max(own['p'] for own in known.values()))}")


def _rows(
    numbers: Numbers, environment: str, indicator: str, reading: Reading
) -> dict[str, Mapping[str, Any]]:
    """Rows of Table 3 or 6 under a reading, by the paper's algorithm; those that were run."""
    encoding, flips = reading
    rows = numbers["tables"][environment][flips]["rows"][indicator]
    return {
        name: rows.get(method, {"n": 0}) for name, method in (ENCODINGS | BESIDE)[encoding].items()
    }


def _too_few(rows: Mapping[str, Mapping[str, Any]]) -> str:
    """Name those with fewer runs than tell; empty where there is none."""
    few = [f"{name.upper()} {row['n']}" for name, row in rows.items() if row["n"] < LEAST_COMPLETE]
    return f"too few complete cruises: {', '.join(few)} of {LEAST_COMPLETE}" if few else ""


def _least(environment: str, indicator: str, numbers: Numbers, reading: Reading) -> Finding:
    """The proposed mean is the least."""
    encoding, flips = reading
    rows = _rows(numbers, environment, indicator, reading)
    few, own = _too_few(rows), rows[PROPOSED]
    if own["n"] < LEAST_COMPLETE:
        return Finding(None, few)
    tests = numbers["tables"][environment][flips]["p"][indicator][encoding]
    rivals = {}
    for name in RIVALS:
        enough = rows[name]["n"] >= LEAST_COMPLETE
        more = rows[name]["mean"] - own["mean"] if enough else 0.0
        rivals[name] = {"more": more, "p": tests[name] if enough else None}
    means = "means " + listed((row.get("mean") for row in rows.values()), _DIGITS[indicator])
    return _compared(
        rivals, lambda name: f"{name.upper()} (p {p_value(tests[name])})", few, means + "; "
    )


def _level(environment: str, indicator: str, numbers: Numbers, reading: Reading) -> Finding:
    """Every algorithm's mean lies near the published one; one that lies far off refutes it."""
    rows = _rows(numbers, environment, indicator, reading)
    published = STATISTICS[environment][indicator]
    times = {
        name: _times_printed(row, published[name].mean)
        for name, row in rows.items()
        if row["n"] >= LEAST_COMPLETE
    }
    few = _too_few(rows)
    changes = [times[name]["mean"] - 1 if name in times else None for name in ALGORITHMS]
    shown = f"off by {listed(changes, 0, 100, sign=True)} %" if times else ""
    shown = "; ".join(filter(None, (shown, few)))
    if any(above(own, 1 + FAR) or below(own, 1 - FAR) for own in times.values()):
        return Finding(False, shown)
    near = all(below(own, 1 + NEAR) and above(own, 1 - NEAR) for own in times.values())
    return Finding(True if near and not few else None, shown)


def _times_printed(row: Mapping[str, Any], printed: float) -> dict[str, Any]:
    """A row's mean with its interval, as so many times what is printed."""
    own = {key: row[key] for key in ("mean", "low", "high")}
    return {key: None if value is None else value / printed for key, value in own.items()}


def _every_case(environment: str, indicator: str, numbers: Numbers, encoding: str) -> Finding:
    """Every rival has more in every case."""
    rivals, shown = {}, {}
    cases = numbers["cases"][environment]
    for case, found in cases.items():
        for name in RIVALS:
            row = found["against_proposed"][encoding].get(name)
            enough = row is not None and row["n"] >= LEAST_PAIRS
            own = row[indicator] if enough else _NOTHING
            key = f"Case {case} {name.upper()}"
            rivals[key] = {"more": own["value"], "p": own["p"]}
            shown[key] = f"{key} {interval(own, 1, True, _DIGITS[indicator])}"
    return _compared(rivals, shown.__getitem__, _missing(environment, numbers), "")


def _missing(environment: str, numbers: Numbers) -> str:
    """Say that there are not all cases; empty where there are."""
    whole = len(numbers["cases"][environment]) == len(CASES[environment])
    return "" if whole else "not all cases were run"


def _fastest(environment: str, numbers: Numbers, encoding: str) -> Finding:
    """The proposed one takes the least time in Case 1."""
    found = numbers["seconds"][environment]
    names = ENCODINGS[encoding]
    tests = found["case_1"][encoding]
    medians = listed((found["cases"]["1"][names[name]]["median"] for name in ALGORITHMS), 2)
    rivals = {name: {"more": own["times"] - 1, "p": own["p"]} for name, own in tests.items()}
    return _compared(
        rivals,
        lambda name: f"{name.upper()} (p {p_value(tests[name]['p'])})",
        "",
        f"medians {medians} s; ",
    )


def _always_fastest(environment: str, numbers: Numbers, encoding: str) -> Finding:
    """The proposed one takes the least time in all cases."""
    tests = numbers["seconds"][environment]["all"][encoding]
    rivals = {name: {"more": own["times"] - 1, "p": own["p"]} for name, own in tests.items()}
    times = listed((own["times"] for own in tests.values()), 1)
    return _compared(
        rivals,
        lambda name: f"{name.upper()} ({listed(tests[name]['by_case'], 2)} times)",
        _missing(environment, numbers),
        f"the others take {times} times as long; ",
    )


def _order(environment: str, which: str, numbers: Numbers, encoding: str) -> Finding:
    """A share of runs that one figure may show."""
    share = numbers["orders"][environment][encoding][which]
    shown = f"in {interval(share, 100, digits=0)} % of {share['runs']} runs"
    if share["runs"] < RANKED:
        return Finding(None, shown)
    return Finding(share["rank_p"] >= ALPHA, shown)


def _always(environment: str, numbers: Numbers, encoding: str) -> Finding:
    """The proposed one always has the shortest tour."""
    method = ENCODINGS[encoding][PROPOSED]
    share = numbers["cases"][environment]["1"]["algorithms"][method]["gap"]["optimal"]
    shown = f"in {interval(share, 100, digits=0)} % of runs"
    if below(share, ALWAYS):
        return Finding(False, shown)
    return Finding(True if share["value"] == 1.0 else None, shown)


def _area(environment: str, kind: str, numbers: Numbers, encoding: str) -> Finding:
    """The proposed one's area is smaller."""
    own = numbers["detection"][environment][encoding][kind]
    less = own["less"]
    shown = (
        f"{fixed(own[PROPOSED]['value'], 0)} against {fixed(own['gwo']['value'], 0)} cells, less "
        f"by {interval(less, 1, digits=0)}"
    )
    return Finding(above(less) if own["n"] >= LEAST_COMPLETE else None, shown)
