"""What Chen et al. 2023 claim of path planning, and how each claim is put to the test.

The text smooths "the planning path of the traditional A* algorithm" (Eq. 5) and says nothing of
lines of sight, so what is proposed is Algorithm 1 on A*'s own path, with the R and with the u / r
of Table 1. Shortening the path first is a step of ours and stands beside.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from math import ceil
from typing import Any

from scipy.stats import binomtest

from experiments.chen2023.angles import DIGITS, ratio
from experiments.chen2023.published import EXPANSION, TABLE_3
from experiments.chen2023.routes import (
    ARCS,
    ARCS_3,
    ARCS_WIDE,
    ASTAR,
    CONTACTS,
    CORNER_SPLINE,
    SHORT_ARCS,
    SHORT_ARCS_3,
    SHORT_SPLINE,
    SPLINE,
    Method,
)
from experiments.chen2023.studies import MAIN, OTHER_GRIDS, PRINTED
from experiments.claims import Claim, Finding, Numbers, above, every, not_excluded
from experiments.estimates import least_rank_p
from usvjax.report.numbers import interval, listed, percent

FEWEST = 20
"""Scenes that a difference rests on at least."""
ALPHA = 0.05
ROWS = len(TABLE_3)
RANKED = ceil(2 * ROWS / ALPHA) - 1
"""Scenes below which no rank could exclude a row."""

RADII = {"R = 15 m": ARCS, "R = 3 m": ARCS_3}
LITERAL = {"R = 15 m": ARCS, "R = 15 m, R_s = 2 R": ARCS_WIDE, "R = 3 m": ARCS_3}
SHORTENED = {"shortened first, R = 15 m": SHORT_ARCS, "shortened first, R = 3 m": SHORT_ARCS_3}
EXPANDED, BARE = ("left", "entered", "touched", "hit"), ("touched", "hit")
"""Contacts told apart where islands are expanded, and where they are not."""

DIRECTION = (
    "95 % t intervals of the mean paired difference in each of the four rows: yes where all lie on "
    "the printed side of 0 (wrongly in at most 2.5 %), no where one lies on the other (in at most "
    "10 %); none from fewer than 20 scenes."
)
RANKS = (
    "Each row by the rank that what is printed takes among our scenes, as one more of them, "
    f"two-sided, at 5 % / {ROWS}: excluded where one row is, so a true claim in at most 5 %; a row "
    f"of fewer than {RANKED} scenes could not be, and leaves open what no other row excludes."
)


def claims(numbers: Numbers) -> list[Claim]:
    """Every figure and table, as a claim.

    Args:
        numbers: of `tables.measure`.
    """
    grids = [label for label in OTHER_GRIDS if label in numbers["compared"]]
    smoothed = {name: (MAIN, method) for name, method in LITERAL.items()}
    smoothed |= {f"{g}, {n}": (g, method) for g in grids for n, method in LITERAL.items()}
    beside = {name: (MAIN, method) for name, method in SHORTENED.items()}
    return [
        Claim(
            "Fig. 15: the vessel leaves the path of A*",
            "one scene",
            _leaves,
            RADII,
            SHORTENED,
            "95 % t interval of how much farther the vessel is off at most than on the proposed "
            "path, ends of Scene 1: yes above 0, no below 0, each wrongly in at most 2.5 %; none "
            "from fewer than 20 scenes.",
        ),
        Claim(
            "Fig. 15: there it collides with an obstacle",
            "one scene",
            _collides,
            _contact_readings(numbers),
            test="Excluded where it happens on less than 5 % of the routes of Scene 1 (95 % "
            "Wilson interval): the paper's one scene would then show it with less than 5 %.",
            weak=True,
        ),
        Claim(
            "Fig. 16: on the proposed path it does not, and arrives",
            "one scene",
            _is_safe,
            _crossed(LITERAL, _contact_readings(numbers)),
            _crossed(SHORTENED, _contact_readings(numbers)),
            "Yes where no route of any pair of ends has contact and all arrive; in n routes that "
            "are independent a share of 3 / n would go unseen with 5 %.",
        ),
        Claim(
            "Algorithm 1 smooths the path of A*",
            "all five paths",
            _smooths,
            smoothed,
            beside,
            "Excluded where all five paths of a scene are smoothed whole in less than 5 % of "
            "scenes (95 % Wilson interval): the paper's five would then be with less than 5 %.",
            weak=True,
        ),
        Claim(
            "The proposed path bends no more than the vessel can turn",
            "curvature at most r/u",
            _bends,
            LITERAL,
            SHORTENED,
            "Yes where no path bends more; of n paths a share of 3 / n would go unseen with 5 %.",
        ),
        Claim(
            "Tables 2 and 3: the proposed path is shorter than the B-spline",
            "in all 4 rows",
            partial(_direction, "length"),
            _against_splines(grids, ("decimals",)),
            _shortened(),
            DIRECTION,
        ),
        Claim(
            "Tables 2 and 3: by as much as printed",
            "ratios " + listed((ratio(row, "length") for row in TABLE_3), 3),
            partial(_as_printed, "length"),
            _against_splines(grids, ("decimals",)),
            _shortened(),
            RANKS,
            weak=True,
        ),
        Claim(
            "Table 3: the proposed path turns less than the B-spline",
            "as decimals in all 4 rows, as minutes in all but row 2",
            partial(_direction, "turning"),
            _against_splines(grids, tuple(DIGITS)),
            _shortened(),
            DIRECTION,
        ),
        Claim(
            "Table 3: it turns less by as much as printed",
            "ratios "
            + "; ".join(
                f"{listed((ratio(row, 'turning', d) for row in TABLE_3), 2)} as {d}" for d in DIGITS
            ),
            partial(_as_printed, "turning"),
            _against_splines(grids, tuple(DIGITS)),
            _shortened(),
            RANKS,
            weak=True,
        ),
        Claim(
            "Table 3: length of the proposed path over the straight line",
            listed((row.proposed.length / row.straight for row in TABLE_3), 3),
            _detours,
            _by_waters(numbers, RADII),
            _by_waters(numbers, {"shortened first, R = 15 m": SHORT_ARCS}),
            RANKS,
            weak=True,
        ),
        Claim(
            "Tables 2 and 3: planning takes less time than with a B-spline",
            "ratios " + listed((ratio(row, "time") for row in TABLE_3), 2),
            _takes_less,
            _crossed(RADII, _TIMED),
            _crossed({"shortened first, R = 15 m": SHORT_ARCS}, _TIMED),
            "Sign test over repeats of our program, here, each row at 5 %: yes where all rows are "
            "quicker (wrongly in at most 5 %), no where one is slower (in at most 20 %). Of an "
            "enumeration, which the paper gains by leaving out, it says nothing.",
        ),
    ]


_TIMED = {"one path a call": "single", "many at once": "batch"}


def _crossed(first: Mapping[str, Any], second: Mapping[str, Any]) -> dict[str, tuple[Any, Any]]:
    """Every pair of readings of two choices."""
    return {f"{a}, {b}": (x, y) for a, x in first.items() for b, y in second.items()}


def _contact_readings(numbers: Numbers) -> dict[str, tuple[float, str]]:
    """What counts as an obstacle, with the printed expansion and without any."""
    found = {f"E = {EXPANSION:g}, {CONTACTS[kind]}": (EXPANSION, kind) for kind in EXPANDED}
    if 0.0 in numbers["sailing"]:
        found |= {f"E = 0, {CONTACTS[kind]}": (0.0, kind) for kind in BARE}
    return found


def _against_splines(grids: Sequence[str], digits: Sequence[str]) -> dict[str, Any]:
    """Readings of a comparison: R, the points that control the spline, digits, and the grid."""
    named = {f"{radius}": (MAIN, ours, SPLINE) for radius, ours in LITERAL.items()}
    named |= {f"{n}, spline of corners": (MAIN, o, CORNER_SPLINE) for n, o in LITERAL.items()}
    found = _with_digits(named, digits)
    return found | _with_digits(
        {f"{grid}, {n}": (grid, o, SPLINE) for grid in grids for n, o in LITERAL.items()},
        digits[:1],
    )


def _shortened() -> dict[str, Any]:
    """The same where paths are shortened by lines of sight first."""
    splines = {"": SPLINE, ", spline of corners": CORNER_SPLINE, ", spline of it": SHORT_SPLINE}
    named = {f"{n}{w}": (MAIN, o, s) for n, o in SHORTENED.items() for w, s in splines.items()}
    return _with_digits(named, ("decimals",))


def _with_digits(named: Mapping[str, tuple[Any, ...]], digits: Sequence[str]) -> dict[str, Any]:
    return {
        f"{label}, as minutes" if d == "minutes" else label: (*given, d)
        for d in digits
        for label, given in named.items()
    }


def _by_waters(numbers: Numbers, methods: Mapping[str, Method]) -> dict[str, Any]:
    drawn = {PRINTED.words if label == MAIN else label: label for label in numbers["lengths"]}
    return _crossed(methods, drawn)


def _few(n: int) -> Finding:
    return Finding(None, f"only {n} scenes")


def _leaves(numbers: Numbers, method: Method) -> Finding:
    found = numbers["leaves"][method.name]
    if found["n"] < FEWEST:
        return _few(found["n"])
    words = f"{interval(found['astar'], digits=1)} m off at most on average; "
    return Finding(
        above(found["more"]),
        f"{words}{interval(found['proposed'], digits=1)} m on the proposed path",
    )


def _collides(numbers: Numbers, given: tuple[float, str]) -> Finding:
    expansion, kind = given
    row = numbers["sailing"][expansion][ASTAR.name]
    rate = row["contacts"][kind]["pairs"][0]
    if row["scenes"] < FEWEST:
        return _few(row["scenes"])
    return Finding(above(rate, ALPHA), f"on {percent(rate['value'], 1)} % of routes")


def _is_safe(numbers: Numbers, given: tuple[Method, tuple[float, str]]) -> Finding:
    method, (expansion, kind) = given
    row = numbers["sailing"][expansion][method.name]
    if row["ok"] < FEWEST:
        return _few(row["ok"])
    touched, missing = row["contacts"][kind]["count"], row["not_arrived"]
    words = f"{touched:,} of {row['ok']:,} in contact"
    if missing:
        words += f", {missing:,} not arrived"
    return Finding(touched == 0 and missing == 0, words)


def _smooths(numbers: Numbers, given: tuple[str, Method]) -> Finding:
    label, method = given
    row = numbers["corners"][label][method.name]
    if row["n"] < FEWEST:
        return _few(row["n"])
    five = row["all_five"]
    return Finding(
        above(five, ALPHA),
        f"{row['fitted']:,} of {row['found']:,} paths whole; all five in "
        f"{percent(five['value'], 1)} % of scenes",
    )


def _bends(numbers: Numbers, method: Method) -> Finding:
    row = numbers["bends"][method.name]
    if row["n"] < FEWEST:
        return _few(row["n"])
    return Finding(row["too_tight"] == 0, f"{row['too_tight']:,} of {row['n']:,} paths over r/u")


def _rows(numbers: Numbers, given: tuple[str, Method, Method, str]) -> list[Mapping[str, Any]]:
    """The rows of Table 3 under a reading."""
    label, ours, spline, _ = given
    compared: Sequence[Mapping[str, Any]] = numbers["compared"][label][ours.name][spline.name]
    return list(compared[1:])


def _direction(metric: str, numbers: Numbers, given: tuple[str, Method, Method, str]) -> Finding:
    """Whether the proposed path has less, or more where the paper prints more, in every row."""
    rows = _rows(numbers, given)
    if min(row["n"] for row in rows) < FEWEST:
        return _few(min(row["n"] for row in rows))
    more = [above(row[metric]["difference"]) for row in rows]
    printed = [ratio(row, metric, given[-1]) > 1 for row in TABLE_3]
    as_said = [None if m is None else m == p for m, p in zip(more, printed, strict=True)]
    return Finding(every(as_said), _ratios(metric, rows))


def _ratios(metric: str, rows: Sequence[Mapping[str, Any]]) -> str:
    ratios = listed((row[metric]["ratio"]["value"] for row in rows), 3 if metric == "length" else 2)
    return f"ratios {ratios} of {listed((row['n'] for row in rows), 0)} scenes"


def _as_printed(metric: str, numbers: Numbers, given: tuple[str, Method, Method, str]) -> Finding:
    rows = _rows(numbers, given)
    ps = [row[metric]["rank_p"][given[-1]] for row in rows]
    return _inside(ps, [row["n"] for row in rows], _ratios(metric, rows))


def _inside(ps: Sequence[float], n: Sequence[int], words: str) -> Finding:
    """Whether no row is printed farther out than scenes of ours are."""
    rows = [
        not_excluded(p, least_rank_p(count), ALPHA / ROWS) for p, count in zip(ps, n, strict=True)
    ]
    words += f"; of {ROWS} rows {rows.count(False)} excluded"
    few = rows.count(None)
    return Finding(every(rows), f"{words}, {few} too few to tell" if few else words)


def _detours(numbers: Numbers, given: tuple[Method, str]) -> Finding:
    method, label = given
    rows = numbers["lengths"][label][method.name][1:]
    means = listed((row["over_straight"]["value"] for row in rows), 3)
    return _inside([row["rank_p"] for row in rows], [row["n"] for row in rows], f"means {means}")


def _takes_less(numbers: Numbers, given: tuple[Method, str]) -> Finding:
    method, how = given
    timed = numbers["timing"][how]
    rows = timed[1:] if how == "single" else [timed]
    less = [_quicker(row["less"][method.name], row["repeats"]) for row in rows]
    return Finding(every(less), f"ratios {listed((row['ratio'][method.name] for row in rows), 2)}")


def _quicker(times: int, repeats: int) -> bool | None:
    """Whether it took less time, by a sign test; None where the repeats do not tell."""
    for count, word in ((times, True), (repeats - times, False)):
        if binomtest(count, repeats, alternative="greater").pvalue < ALPHA:
            return word
    return None
