"""The page on path planning in Chen et al. 2023: its tables, readings and findings, written."""

from collections.abc import Mapping
from math import pi, tan
from typing import Any

from experiments.chen2023.angles import DIGITS, ratio
from experiments.chen2023.angles import turning as angle_of
from experiments.chen2023.claims import LITERAL
from experiments.chen2023.published import (
    ALGORITHMS,
    EXPANSION,
    SAFETY_RANGE,
    SPEED,
    TABLE_3,
    YAW_RATE,
)
from experiments.chen2023.routes import (
    ARCS,
    ARCS_3,
    ASTAR,
    CONTACTS,
    MARGIN,
    METHODS,
    SHORT_ARCS,
    SPLINE,
)
from experiments.chen2023.scenes import CLEAR, SIDE
from experiments.chen2023.studies import MAIN, PRINTED
from experiments.chen2023.tables import METRICS
from experiments.claims import Numbers
from usvjax.report import Section, Sheet
from usvjax.report.numbers import ends, fixed, interval, listed, p_value, percent

PLACES = ("Scene 1", "Row 1 (Scene 2)", "Row 2", "Row 3", "Row 4")
Row = Mapping[str, Any]
_STAGES = {
    "search": "A*",
    "shortening": "Shortening",
    "spline": "B-spline",
    "arcs": "Algorithm 1, R = 15 m",
    "arcs_3": "Algorithm 1, R = 3 m",
    "arcs_shortened": "Algorithm 1 after shortening, R = 15 m",
}
_WHOLE = {"bspline": "A* + B-spline"} | {m.name: m.words for m in (ARCS, ARCS_3, SHORT_ARCS)}


def sections(numbers: Numbers) -> list[Section]:
    """All tables."""
    found = [
        _sailing(numbers),
        _expansions(numbers),
        _corners(numbers),
        _values(numbers),
        _differences(numbers),
        _timing(numbers),
    ]
    return [*found, _waters(numbers)]


def _sailing(numbers: Numbers) -> Section:
    rows = [
        [
            METHODS[name].words,
            f"{row['ok']:,} of {row['routes']:,}",
            *(interval(row["contacts"][kind]["scenes"], 100, digits=2) for kind in CONTACTS),
            f"{row['not_arrived']:,}",
            interval(row["error"], digits=2),
            fixed(row["most_error"], 1),
        ]
        for name, row in numbers["sailing"][EXPANSION].items()
    ]
    header = ["Path", "Routes", *(f"On or in {words} (%)" for words in CONTACTS.values())]
    header += ["Not arrived", "Largest distance from the path, mean (m)", "of all (m)"]
    by_pair = [
        [
            METHODS[name].words,
            *(interval(p, 100, digits=1) for p in row["contacts"]["left"]["pairs"]),
        ]
        for name, row in numbers["sailing"][EXPANSION].items()
    ]
    paired = [
        [
            f"{METHODS[name].words}: {CONTACTS[kind]}",
            *(
                f"{interval(entry['difference'], 100, True, 1)}, p {p_value(entry['p_holm'])}"
                for entry in entries
            ),
        ]
        for name, kinds in numbers["against_astar"].items()
        for kind, entries in kinds.items()
    ]
    return Section(
        "Figs. 15 and 16: sailing the paths",
        [
            f"{_scenes(numbers):,} scenes, five pairs of ends, islands searched at E = "
            f"{EXPANSION:g}. Routes are those found and, for the proposed ones, smoothed whole.",
            Sheet("", header, rows),
            Sheet("On a cell kept clear of, by pair of ends (%):", ["Path", *PLACES], by_pair),
            Sheet(
                "Proposed against A*, in the scenes where it is whole: difference in points with "
                "the Agresti-Min interval, p of McNemar's test, Holm-corrected over the pairs.",
                ["On or in", *PLACES],
                paired,
            ),
        ],
    )


def _scenes(numbers: Numbers) -> int:
    return int(numbers["sailing"][EXPANSION][ASTAR.name]["scenes"])


def _expansions(numbers: Numbers) -> Section:
    names = list(dict.fromkeys(name for own in numbers["sailing"].values() for name in own))
    swept = [name for name in names if all(name in own for own in numbers["sailing"].values())]
    rows = [
        [
            METHODS[name].words,
            f"{expansion:g}",
            f"{row['scenes']:,}",
            f"{row['ok']:,} of {row['routes']:,}",
            *(interval(row["contacts"][kind]["scenes"], 100, digits=2) for kind in CONTACTS),
            interval(row["error"], digits=2),
        ]
        for name in swept
        for expansion in sorted(numbers["sailing"])
        for row in [numbers["sailing"][expansion][name]]
    ]
    header = ["Path", "E", "Scenes", "Routes", *(f"On or in {w} (%)" for w in CONTACTS.values())]
    header += ["Largest distance, mean (m)"]
    return Section("Which expansion lets the vessel hit an island", [Sheet("", header, rows)])


def _corners(numbers: Numbers) -> Section:
    rows = [
        [
            f"{METHODS[name].words}{_grid(label)}",
            f"{row['corners']:,}",
            *(percent(count / max(row["corners"], 1)) for count in row["templates"].values()),
            f"{row['fitted']:,} of {row['found']:,}",
            interval(row["fitted_scenes"], 100, digits=1),
            interval(row["all_five"], 100, digits=1),
        ]
        for label, own in numbers["corners"].items()
        for name, row in own.items()
    ]
    words = [f"{name} (%)" for name in ("Template 1", "Template 2", "Template 3", "None")]
    header = ["Path", "Corners", *words, "Paths whole", "(%)", "All five of a scene (%)"]
    bends = [
        [
            METHODS[name].words,
            fixed(row["median_15"], 2),
            fixed(row["most"] * 15 / METHODS[name].radius, 3),
            fixed(row["most"], 6) if METHODS[name].smoothing == "arcs" else "-",
            interval(row["too_tight_share"], 100, digits=1),
        ]
        for name, row in numbers["bends"].items()
    ]
    bend_header = ["Path", "Largest curvature x 15 m: median", "of all"]
    bend_header += ["Largest of all x its own R", "Paths above r/u = 1/15 m (%)"]
    return Section(
        "Corners and curvature",
        [
            "Template 1 is the arc inside the corner, 2 the late wide turn, 3 the early one.",
            Sheet("", header, rows),
            "Straight segments have no curvature at their corners that a bound could hold for; "
            "of the others:",
            Sheet("", bend_header, bends),
        ],
    )


def _grid(label: str) -> str:
    """What a condition adds to the words of a method."""
    return "" if label == MAIN else f", {label}"


def _values(numbers: Numbers) -> Section:
    lengths, turning = [], []
    for name in ALGORITHMS:
        words = f"**{'B-spline' if name == 'bspline' else 'Proposed'}, published**"
        printed = [row.of(name) for row in TABLE_3]
        over = [own.length / row.straight for own, row in zip(printed, TABLE_3, strict=True)]
        lengths.append([words, "-", *(fixed(value, 3) for value in over)])
        turning += [
            [f"{words}, digits as {d}", "-", *(fixed(angle_of(own, d), 0) for own in printed)]
            for d in DIGITS
        ]
    for name, own in numbers["turning"].items():
        words = METHODS[name].words
        entries = numbers["lengths"][MAIN][name]
        lengths.append([words, *(_spread(entry["over_straight"], 3) for entry in entries)])
        turning.append([words, *(_spread(figure, 0) for figure in own)])
    counts = [
        [METHODS[name].words, *(f"{row['n']:,}" for row in numbers["lengths"][MAIN][name])]
        for name in numbers["turning"]
    ]
    return Section(
        "Tables 2 and 3: length and turning",
        [
            "Means over the scenes in which a path is whole, and in brackets the range of 95 % of "
            "these scenes. Where few paths are smoothed whole, those have few corners: their "
            "means are of other scenes than the rest.",
            Sheet("Length over the straight line:", ["Path", *PLACES], lengths),
            Sheet("Total turning angle (deg):", ["Path", *PLACES], turning),
            Sheet("Scenes:", ["Path", *PLACES], counts),
        ],
    )


def _spread(figure: Row, digits: int) -> str:
    return f"{fixed(figure['value'], digits)} {ends(figure, digits)}"


def _differences(numbers: Numbers) -> Section:
    parts: list[str | Sheet] = [
        "The same route by both, in the scenes in which the proposed path is whole: geometric "
        "mean of the ratios with its t interval, scenes in brackets. Differences, p-values "
        "(t and Wilcoxon, Holm-corrected over the pairs) and shares are in `results.json`."
    ]
    for metric, digits in (("length", 3), ("turning", 2)):
        table = [
            [f"**Published**{_as(metric, d)}", "-", "-", *_printed_ratios(metric, d, digits)]
            for d in METRICS[metric]
        ]
        table += [
            [
                f"{METHODS[ours].words}{_grid(label)}",
                METHODS[spline].words,
                *(f"{interval(e[metric]['ratio'], digits=digits)} ({e['n']:,})" for e in entries),
            ]
            for label, compared in numbers["compared"].items()
            for ours, splines in compared.items()
            for spline, entries in splines.items()
        ]
        title = f"Ratio of {'lengths' if metric == 'length' else 'turning angles'}:"
        parts.append(Sheet(title, ["Path", "over", *PLACES], table, words=2))
    return Section("Tables 2 and 3: proposed over B-spline", parts)


def _as(metric: str, digits: str) -> str:
    return f", digits as {digits}" if metric == "turning" else ""


def _printed_ratios(metric: str, reading: str, digits: int) -> list[str]:
    return [fixed(ratio(row, metric, reading), digits) for row in TABLE_3]


def _timing(numbers: Numbers) -> Section:
    times = numbers["timing"]
    columns = [times["batch"], *times["single"]]
    alone = 1000.0 / times["paths"]
    scales = [alone, *[1000.0] * len(times["single"])]

    def line(words: str, of: str, name: str) -> list[str]:
        found = (fixed(c[of][name], 3, s) for c, s in zip(columns, scales, strict=True))
        return [words, *found]

    rows = [line(words, "stages", stage) for stage, words in _STAGES.items()]
    rows += [line(f"**{words}**", "whole", name) for name, words in _WHOLE.items()]
    rows += [
        [f"{words} over A* + B-spline", *(fixed(c["ratio"][name], 2) for c in columns)]
        for name, words in _WHOLE.items()
        if name != "bspline"
    ]
    for name, words in (("bspline", "A* + B-spline"), ("proposed", "Proposed")):
        printed = (fixed(row.of(name).time, 0, 1000.0) for row in TABLE_3)
        rows.append([f"**{words}, published**", "-", "-", *printed])
    ratios = (fixed(ratio(row, "time"), 2) for row in TABLE_3)
    rows.append(["**Proposed over B-spline, published**", "-", "-", *ratios])
    return Section(
        "Tables 2 and 3: planning time",
        [
            f"Milliseconds a path, medians of {times['batch']['repeats']} repeats, compilation "
            f"left out: {times['paths']:,} paths in one call, and one path a call in scene 0. "
            "Times depend on the machine and what else it does; the ratios much less. The paper's "
            "are from a Core i5-10200H inside Unity3D.",
            Sheet("", ["Stage", "Many at once", *PLACES], rows),
        ],
    )


def _waters(numbers: Numbers) -> Section:
    rows = [
        [
            f"{METHODS[name].words}; {PRINTED.words if label == MAIN else label}",
            *(f"{_spread(row['over_straight'], 3)} ({row['n']:,})" for row in own[name]),
        ]
        for name in (ASTAR.name, ARCS.name, ARCS_3.name, SHORT_ARCS.name)
        for label, own in numbers["lengths"].items()
    ]
    published = (fixed(row.proposed.length / row.straight, 3) for row in TABLE_3)
    rows.append(["**Proposed, published**", "-", *published])
    text = (
        "Length over the straight line: mean [95 % of scenes] (scenes in which the path is whole)."
    )
    return Section("Lengths on other waters", [text, Sheet("", ["Path", *PLACES], rows)])


def summary(numbers: Numbers) -> list[str]:
    """The most important findings besides the verdicts."""
    return [_literal(numbers), _sailed(numbers), _smoothing(numbers), _expansion(numbers)]


def _literal(numbers: Numbers) -> str:
    def ratios(label: str, name: str, metric: str, digits: int) -> str:
        rows = numbers["compared"][label][name][SPLINE.name][1:]
        return listed((row[metric]["ratio"]["value"] for row in rows), digits)

    def both(label: str, name: str) -> str:
        return f"{ratios(label, name, 'length', 3)}; {ratios(label, name, 'turning', 2)}"

    words = [
        f"{reading}{_grid(label)}: {both(label, method.name)}"
        for label in numbers["compared"]
        for reading, method in LITERAL.items()
    ]
    return (
        "**Length; turning**, proposed over B-spline of A*'s cells, rows 1 to 4 of Table 3. "
        f"Published: {listed((ratio(row, 'length') for row in TABLE_3), 3)}; "
        f"{listed((ratio(row, 'turning') for row in TABLE_3), 2)}. {'. '.join(words)}. With a "
        "shortening by lines of sight before Algorithm 1, of which the paper says nothing: "
        f"{both(MAIN, SHORT_ARCS.name)}."
    )


def _sailed(numbers: Numbers) -> str:
    main = numbers["sailing"][EXPANSION]
    rates = {
        method.name: listed(
            (main[method.name]["contacts"][k]["scenes"]["value"] for k in CONTACTS), 2, 100
        )
        for method in (ASTAR, ARCS, ARCS_3)
    }
    return (
        f"**Sailing**, at E = {EXPANSION:g}: shares of routes (%) on which the vessel is at some "
        f"time on or in {', '.join(CONTACTS.values())}. A*: {rates[ASTAR.name]}. Proposed with "
        f"R = u/r = 15 m: {rates[ARCS.name]}; with the printed R = 3 m, which the vessel cannot "
        f"turn: {rates[ARCS_3.name]}. Arcs keep {MARGIN:g} m off cells; straight legs may pass "
        "them by centimetres, which no helmsman holds."
    )


def _smoothing(numbers: Numbers) -> str:
    rows = numbers["corners"][MAIN]
    shares = {name: interval(rows[name]["fitted_scenes"], 100, digits=1) for name in rows}
    sharpest = max(numbers["bends"][name]["most"] for name in rows)
    return (
        f"**Smoothing.** Algorithm 1 smooths {shares[ARCS.name]} % of A*'s paths whole with "
        f"R = 15 m, whose corners stand a cell or two apart, and {shares[ARCS_3.name]} % with "
        f"R = 3 m; {shares[SHORT_ARCS.name]} % with R = 15 m once they are shortened. The "
        f"sharpest of all paths that it makes bends {sharpest:.6f} / R."
    )


def _expansion(numbers: Numbers) -> str:
    shown = [
        f"{percent(row['contacts']['touched']['scenes']['value'], 1)} % "
        f"({percent(row['contacts']['hit']['scenes']['value'], 1)} %) at E = {expansion:g}"
        for expansion in sorted(numbers["sailing"])
        for row in [numbers["sailing"][expansion][ASTAR.name]]
    ]
    return (
        f"**Expansion.** The printed E = {EXPANSION:g} makes islands {1 + EXPANSION:g} times as "
        "wide. Sailing A*'s path, the vessel is on a cell of an island (in the island, which is "
        f"narrower than its cells) on {', '.join(shown)} of routes."
    )


def readings(numbers: Numbers) -> list[str]:
    """How the paper was read."""
    cell = numbers["drawn"]["cell"]
    return [
        f"Scenes: {PRINTED.words}, drawn from a seed on x, y in [-450, 450] m; an island is an "
        f"octagon on an ellipse. The water reaches to +-{SIDE / 2:g} m, since the printed end "
        "point (347, -451) lies beyond 450. The paper prints no map, no number or size of "
        f"obstacles and no cell size. Starts and ends keep {CLEAR:g} m from every expanded island.",
        f"Grid: {cell:g} m cells, blocked where they touch an island scaled by 1 + E about its "
        f"centre (Eq. 4), E = {EXPANSION:g}. Ends are the centres of their cells, at most "
        f"{cell * 0.7071:.1f} m off. A* is exact, 8-connected, and does not cut corners. Readings "
        '"10 m cells" and "fewest turns" are of the same scenes on a coarser grid, and with '
        "those of the shortest paths that have the fewest turns: which of them A* takes is not "
        "printed, and its turning hangs on it.",
        "Proposed: Algorithm 1 at the corners of A*'s own path, with Table 1's R_s = "
        f"{SAFETY_RANGE:g} m; as R_s is 2 R there, with R_s = 2 R as well. "
        'Eq. 5 and the text call what is smoothed "the planning path of the traditional A* '
        'algorithm", and Algorithm 1 goes from turning point to turning point; no step removes '
        "points by lines of sight. Such a shortening before it is ours, so it stands beside and "
        "does not count. R = 15 m is Table 1's u/r, R = 3 m its R; both count. At a corner of "
        f"45 deg, R_s makes an arc of {SAFETY_RANGE / tan(pi / 8):.1f} m where there is room, and "
        f"Eq. 6 an R of {SPEED * (pi / 4) / (2 * YAW_RATE):.1f} m, between the two. "
        "`docs/equations.md` has the three templates. Post-order traversal is read as following "
        "parent pointers.",
        "A* + B-spline: a clamped cubic B-spline; which points control it is not printed. Taken "
        "are all cells of A*'s path, and its corners; the points of the shortened path beside.",
        "Total turning angles are printed like 161 deg 1548': four digits after the degree sign "
        "that are no minutes of arc. They are read as decimals of a degree and as minutes; as "
        "minutes, row 2 says that the proposed path turns more.",
        "Vessel: a point at 15 m/s and at most 1 rad/s (Table 1) that steers by the path's "
        "curvature and corrects what it is off, control period 0.05 s. At every period it is asked "
        "whether the vessel is in an island, in one scaled by 1 + E, and on a cell that the "
        "search kept clear of. Beyond the map there is water.",
        "Routes of which a corner is left over are no proposed paths: they are counted, and left "
        "out of everything else. Comparisons are over scenes in which both have a path.",
        "Intervals are 95 %: Wilson for shares of scenes, t over scenes for averages, bootstrap "
        "over scenes for shares of all routes (five a scene, which are not independent).",
    ]
