"""The claims of Zhang et al. 2019, and every way to read what the paper does not print."""

from collections.abc import Iterator, Mapping
from functools import partial
from itertools import product
from math import log
from typing import Any, NamedTuple

from scipy import stats

from experiments.claims import Claim, Finding, Numbers, below, not_excluded
from experiments.estimates import least_rank_p
from experiments.zhang2019.arithmetic import ratio_range
from experiments.zhang2019.compare import PROGRAMS, WINDOWS
from experiments.zhang2019.published import IMPROVED, LOWER, TIMES, TRADITIONAL
from experiments.zhang2019.runs import FITTED, TIMED
from usvjax.report.numbers import interval, p_value, percent

LEVEL = 0.05
IMPROVEMENTS = ("printed", "accumulated")


class Reading(NamedTuple):
    """One way to read the paper.

    Attributes:
        program: of `PROGRAMS`.
        rule: how Eq. 7 is read.
        size: label of the map's size.
        window: which maps count as like the paper's, as in the tables.
    """

    program: str
    rule: str
    size: str
    window: str = ""


def claims(numbers: Numbers) -> list[Claim]:
    """All claims; see `experiments.paper.Part`."""
    sizes = list(numbers["sizes"])
    plain = {_traditional_words(one): one for one in _readings(sizes, ("traditional",))}
    changed, fitted = _apart({_words(one): one for one in _readings(sizes, IMPROVEMENTS)})
    timed = {_words(one): one for one in _timed()}
    windowed = {_words(one): one for one in _readings(sizes, IMPROVEMENTS, WINDOWS)}
    reduced = (
        "A cost is reduced under a reading where the mean paired difference over its maps lies "
        f"below 0 with its t interval, and is not where it lies above (95 % for all {len(changed)} "
        "readings that count together, Bonferroni; those beside are as wide); a rule that changes "
        "nothing anywhere would pass or fail under any that counts with at most 5 % probability."
    )
    return [
        Claim(
            "Table 3: cost of the traditional path",
            f"{TRADITIONAL.total}, turning {TRADITIONAL.turning}",
            _as_traditional,
            *_apart(plain),
            test="Excluded under a reading where a random map has a traditional path as far out "
            "in length or turning cost with at most 5 % probability (by ranks, two-sided, "
            "Bonferroni for the two); a map drawn by the reading would be excluded with at most "
            "5 %.",
            weak=True,
        ),
        Claim(
            "Table 3: cost of the improved path, on maps like that",
            f"{IMPROVED.total}, turning {IMPROVED.turning}",
            _as_improved,
            *_apart(windowed),
            test="Excluded under a reading where, on maps whose traditional path is within 1 (or "
            "2) squares of Table 3 in length and in turning cost, at most 5 % save as much of the "
            "total as the paper's (by ranks); a map drawn by the reading would be excluded with "
            "at most 5 %.",
            weak=True,
        ),
        Claim(
            "The turning cost is reduced",
            f"{TRADITIONAL.turning} to {IMPROVED.turning}",
            partial(_reduced, "turning", len(changed)),
            changed,
            fitted,
            reduced,
        ),
        Claim(
            "The number of turns is reduced",
            "no number",
            partial(_reduced, "bends", len(changed)),
            changed,
            fitted,
            reduced,
        ),
        Claim(
            "The total cost of the path is reduced",
            f"{TRADITIONAL.total} to {IMPROVED.total}",
            partial(_reduced, "total", len(changed)),
            changed,
            fitted,
            reduced,
        ),
        Claim(
            f'Table 4: performance "only {LOWER:g} % lower"',
            f"{TIMES['traditional']:g} to {TIMES['improved']:g} ms",
            partial(_time, len(timed)),
            timed,
            test="Holds where the ratio of processor times, with its t interval over runs that "
            f"take turns (95 % for all {len(timed)} readings together, Bonferroni), lies below "
            f"{ratio_range()[1]:.3f}, the largest that rounds to Table 4, and fails where it lies "
            "above; a true one fails under any of them with at most 5 % probability. Program and "
            "machine are ours, so it says nothing of theirs.",
        ),
    ]


def _readings(
    sizes: list[str], rules: tuple[str, ...], windows: tuple[float, ...] = ()
) -> Iterator[Reading]:
    """Every combination of what is not printed."""
    words = [f"{window:g}" for window in windows] or [""]
    for rule, program, size, window in product(rules, PROGRAMS, sizes, words):
        yield Reading(program, rule, size, window)


def _timed() -> Iterator[Reading]:
    for program, rule, size in product(("batched", "textbook"), IMPROVEMENTS, TIMED):
        yield Reading(program, rule, size)


def _base(reading: Reading) -> tuple[str, str]:
    """The program without the order of equals, and that order."""
    base, _, order = reading.program.partition(", ")
    return base, order


def _traditional_words(reading: Reading) -> str:
    base, order = _base(reading)
    return f"{base}: {_with(reading.size, order)}"


def _words(reading: Reading) -> str:
    base, order = _base(reading)
    window = reading.window and f"within {reading.window}"
    return f"{reading.rule}, {base}: {_with(reading.size, order, window)}"


def _with(*words: str) -> str:
    return ", ".join(filter(None, words))


def _apart(readings: Mapping[str, Reading]) -> tuple[dict[str, Reading], dict[str, Reading]]:
    """Those that count, and those of the size that was chosen to fit."""
    fitted = {words: one for words, one in readings.items() if one.size.startswith(FITTED.label)}
    counted = {words: one for words, one in readings.items() if words not in fitted}
    return counted, {f"{FITTED.label}, chosen to fit: {words}": fitted[words] for words in fitted}


def _as_traditional(numbers: Numbers, reading: Reading) -> Finding:
    own = numbers["programs"][reading.program][reading.size]["traditional"]
    # Of two quantities, so twice that of one.
    holds = not_excluded(own["p"], 2.0 * least_rank_p(own["n"]), LEVEL)
    if holds is None:
        return Finding(None, f"{own['n']} maps")
    total, turning = (interval(own[name], digits=1) for name in ("total", "turning"))
    return Finding(holds, f"p {p_value(own['p'])}: {total}, turning {turning}")


def _as_improved(numbers: Numbers, reading: Reading) -> Finding:
    maps = numbers["programs"][reading.program][reading.size]["alike"][reading.window]
    own = maps[reading.rule]
    holds = not_excluded(own["p"], least_p(maps["n"]), LEVEL)
    if holds is None:
        return Finding(None, f"{maps['n']} maps")
    words = f"on {percent(own['as_published']['value'], 1)} % of {maps['n']}"
    return Finding(holds, f"p {p_value(own['p'])}: {words}")


def least_p(maps: int) -> float:
    """The smallest p that a saving can have on so many maps; one-sided."""
    return 1 / (1 + maps)


def _reduced(metric: str, tests: int, numbers: Numbers, reading: Reading) -> Finding:
    row = numbers["programs"][reading.program][reading.size]["against"][reading.rule]
    change = row[metric]
    holds = below(_widened(change, row["n"], tests))
    return Finding(holds, interval(change, sign=True, digits=2))


def _time(tests: int, numbers: Numbers, reading: Reading) -> Finding:
    row = numbers["time"][reading.size][reading.program][reading.rule]
    logs = {name: None if end is None else log(end) for name, end in row["ratio"].items()}
    holds = below(_widened(logs, row["n"], tests), log(ratio_range()[1]))
    return Finding(holds, f"ratio {interval(row['ratio'], digits=2)}")


def _widened(figure: Mapping[str, Any], n: int, tests: int) -> Mapping[str, Any]:
    """The 95 % t interval of a mean of n, widened so that it is one of so many tests."""
    if figure["high"] is None:
        return figure
    alone, together = stats.t.isf([LEVEL / 2, LEVEL / 2 / tests], n - 1)
    half = together / alone * (figure["high"] - figure["value"])
    return {"low": figure["value"] - half, "high": figure["value"] + half}
