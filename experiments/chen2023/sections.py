"""The tables of the report on Chen et al. 2023, in Markdown."""

from collections.abc import Sequence
from typing import Any

from experiments.chen2023.published import ALGORITHMS, TABLE_3
from experiments.chen2023.routes import CONTACTS, PROPOSED
from experiments.chen2023.verdicts import SPLINE_READINGS
from experiments.markdown import grid, interval
from usvjax.report.numbers import p_value

Row = dict[str, Any]
_TEMPLATES = {
    "INSIDE": "Template 1 (%)",
    "LATE": "Template 2 (%)",
    "EARLY": "Template 3 (%)",
    "UNFITTED": "None (%)",
}
_STAGES = {
    "search": "A*",
    "shorten": "Shortening",
    "bspline": "B-spline",
    "arcs": "Arcs",
    "a_bspline": "**A* + B-spline**",
    "a_proposed": "**Proposed**",
}
_PLACES = ("Scene 1", "Row 1 (Scene 2)", "Row 2", "Row 3", "Row 4")


def of_method(rows: Sequence[Row], method: str) -> Row:
    """The row of a method."""
    return next(row for row in rows if row["method"] == method)


def percent(figure: Row, digits: int = 1) -> str:
    """Write a share and its interval in per cent."""
    return interval(figure, 100, digits)


def sailing(found: Row) -> str:
    """Contacts and distances of Figs. 15 and 16."""
    main = found["settings"]["main"]
    head = (
        f"{main['scenes']:,} scenes, five pairs of ends, islands searched at E = "
        f"{main['expansion']:g}. Routes are those found and, for the proposed ones, smoothed "
        "whole. Shares in % of routes."
    )
    rows = [
        [
            row["words"],
            f"{row['ok']:,} of {row['routes']:,}",
            *(percent(row[f"{kind}_scenes"], 2) for kind in CONTACTS),
            f"{row['ok'] - row['arrived']:,}",
            interval(row["error"]),
            f"{row['most_error']:.2f}",
        ]
        for row in found["sailing"]
    ]
    header = ["Path", "Routes", *(f"On or in {words}" for words in CONTACTS.values())]
    header += ["Not arrived", "Largest distance from the path, mean (m)", "of all (m)"]
    by_pair = [
        [row["words"], *(f"{percent(rate)} ({rate['n']:,})" for rate in row["left"])]
        for row in found["sailing"]
    ]
    return "\n\n".join(
        [
            head,
            grid(header, rows),
            "On a cell kept clear of, by pair of ends (routes in brackets):",
            grid(["Path", *_PLACES], by_pair),
            "Proposed (R = 15 m) against A*, in the scenes where it is whole: difference in points "
            "with the Agresti-Min interval, p of McNemar's test, Holm-corrected.",
            _paired(found),
        ]
    )


def _paired(found: Row) -> str:
    rows = [
        [
            CONTACTS[kind],
            *(
                f"{interval(entry['difference'], 100, 1, True)}, p {p_value(entry['p_holm'])}"
                for entry in found["paired_contacts"][kind]
            ),
        ]
        for kind in found["paired_contacts"]
    ]
    return grid(["On or in", *_PLACES], rows)


def expansions(found: Row) -> str:
    """Contacts against the expansion coefficient."""
    main = found["settings"]["main"]
    methods = list(dict.fromkeys(row["method"] for row in found["expansions"]))
    printed = {"expansion": main["expansion"], "scenes": main["scenes"]}
    rows = [*found["expansions"], *({**row, **printed} for row in found["sailing"])]
    lines = [
        [
            f"{row['expansion']:g}",
            f"{row['scenes']:,}",
            row["words"],
            f"{row['ok']:,} of {row['routes']:,}",
            *(percent(row[f"{kind}_scenes"], 2) for kind in CONTACTS),
            interval(row["error"]),
        ]
        for method in methods
        for row in sorted(rows, key=lambda r: r["expansion"])
        if row["method"] == method
    ]
    header = ["E", "Scenes", "Path", "Routes", *(f"On or in {w} (%)" for w in CONTACTS.values())]
    header += ["Largest distance, mean (m)"]
    return grid(header, lines)


def corners(found: Row) -> str:
    """Corners by template, and curvature."""
    rows = []
    for row in found["corners"]:
        shares = [f"{100 * row['templates'][t] / max(row['corners'], 1):.2f}" for t in _TEMPLATES]
        whole = f"{row['fitted']:,} of {row['found']:,}"
        rows.append(
            [row["words"], f"{row['corners']:,}", *shares, whole, percent(row["fitted_scenes"])]
        )
    bends = [
        [
            row["words"],
            f"{row['median_15']:.2f}",
            f"{row['most'] * 15 / row['radius']:.3f}",
            f"{row['most']:.6f}" if row["method"] in _with_arcs(found) else "-",
            percent(row["too_tight_15"]),
        ]
        for row in found["bends"]
    ]
    header = ["Path", "Corners", *_TEMPLATES.values()]
    bend_header = ["Path", "Largest curvature x 15 m: median", "of all"]
    bend_header += ["Largest of all x its own R", "Paths above r/u = 1/15 m (%)"]
    return "\n\n".join(
        [
            "Template 1 is the arc inside the corner, 2 the late wide turn, 3 the early one.",
            grid([*header, "Paths whole", "(%)"], rows),
            "Straight segments have no curvature at their corners that a bound could hold for; "
            "of the others:",
            grid(bend_header, bends),
        ]
    )


def _with_arcs(found: Row) -> set[str]:
    return {row["method"] for row in found["corners"]}


def compared(found: Row) -> str:
    """Length and turning beside Tables 2 and 3."""
    parts = [
        "Means over n scenes with bootstrap intervals; in brackets, the range of 95 % of the "
        "scenes. Published values in bold, digits of the angles as decimals of a degree.",
        _values(found, "over_straight", "Length over the straight line", 3),
        _values(found, "turning_deg", "Total turning angle (deg)", 0),
        "Proposed against B-spline: mean ratio [interval] (95 % of scenes), share of scenes in "
        "which it is less, mean paired difference with its t interval, and p-values, "
        "Holm-corrected over the five pairs.",
        _differences(found, "length", "length", "m", 3),
        _differences(found, "turning", "turning_deg", "deg", 2),
    ]
    return "\n\n".join(parts)


def _values(found: Row, key: str, words: str, digits: int) -> str:
    rows = []
    for place, row in zip(_PLACES, found["compared"], strict=True):
        line = [place, f"{row['n']:,}"]
        for name in ALGORITHMS:
            published = row["published"]
            line.append(f"**{published[name][key]:.{digits}f}**" if published else "-")
        own = [row["astar"], row["proposed"]]
        own += [row["splines"][method.name]["values"] for method in SPLINE_READINGS.values()]
        line += [_spread(values[key], digits) for values in own]
        rows.append(line)
    header = ["Ends", "n", "B-spline, published", "Proposed, published", "A*", "Proposed"]
    return f"{words}:\n\n" + grid([*header, *_spline_words()], rows)


def _spline_words() -> list[str]:
    return [f"B-spline: {label.removeprefix('spline ')}" for label in SPLINE_READINGS]


def _spread(figure: Row, digits: int) -> str:
    if figure["median"] is None:
        return "-"
    low, high = figure["range"]
    return f"{interval(figure['mean'], 1, digits)} ({low:.{digits}f} to {high:.{digits}f})"


def _differences(found: Row, metric: str, key: str, unit: str, digits: int) -> str:
    rows = []
    for label, method in SPLINE_READINGS.items():
        for place, row in zip(_PLACES, found["compared"], strict=True):
            entry = row["splines"][method.name][metric]
            published = row["published"]
            rows.append(
                [
                    label,
                    place,
                    f"**{published['ratio'][key]:.{digits}f}**" if published else "-",
                    _spread(entry["ratio"], digits),
                    percent(entry["less"]) if entry["less"]["n"] else "-",
                    interval(entry["difference"], 1, 2, True),
                    p_value(entry["p_t_holm"]),
                    p_value(entry["p_wilcoxon_holm"]),
                ]
            )
    header = ["B-spline", "Ends", f"Ratio of {metric}, published", "Ours", "Less in (%)"]
    return grid([*header, f"Difference ({unit})", "p (t)", "p (Wilcoxon)"], rows)


def timing(found: Row) -> str:
    """Planning time beside Tables 2 and 3."""
    times = found["timing"]
    rows = [
        [
            words,
            f"{1000 * times['batch'][stage]:.3f}",
            *(f"{1000 * pair[stage]:.1f}" for pair in times["single"]),
        ]
        for stage, words in _STAGES.items()
    ]
    own = [times["batch"], *times["single"]]
    quotients = [f"{t['a_proposed'] / t['a_bspline']:.2f}" for t in own]
    rows.append(["Proposed over B-spline", *quotients])
    published = {
        name: [f"**{1000 * row.of(name).time:.0f}**" for row in TABLE_3] for name in ALGORITHMS
    }
    rows.append(["A* + B-spline, published", "-", "-", *published["bspline"]])
    rows.append(["Proposed, published", "-", "-", *published["proposed"]])
    ratios = [f"**{row.proposed.time / row.bspline.time:.2f}**" for row in TABLE_3]
    rows.append(["Proposed over B-spline, published", "-", "-", *ratios])
    text = (
        f"Milliseconds a path, medians, compilation left out: {times['paths']:,} paths in one "
        "call, and one path a call in scene 0. Times depend on the machine and what else it does; "
        "the ratios much less. The paper's are from a Core i5-10200H inside Unity3D."
    )
    return text + "\n\n" + grid(["Stage", "Many at once", *_PLACES], rows)


def waters(found: Row) -> str:
    """Lengths against how scenes are drawn."""
    main = [row["proposed"]["over_straight"] for row in found["compared"]]
    rows = [
        [
            f"{found['settings']['main']['words']} (main)",
            f"{found['settings']['main']['scenes']:,}",
            percent(of_method(found["sailing"], PROPOSED.name)["found_scenes"]),
            percent(of_method(found["corners"], PROPOSED.name)["fitted_scenes"]),
            *(_spread(spread, 3) for spread in main),
        ]
    ]
    for row in found["waters"]:
        spreads = [_spread(pair["over_straight"], 3) for pair in row["pairs"]]
        rows.append(
            [
                row["waters"],
                f"{row['scenes']:,}",
                percent(row["found"]),
                percent(row["fitted"]),
                *spreads,
            ]
        )
    published = [f"**{row.proposed.length / row.straight:.3f}**" for row in TABLE_3]
    rows.append(["published", "1", "-", "-", "-", *published])
    text = "Length of the proposed path over the straight line: mean [interval] (95 % of scenes)."
    header = ["Waters", "Scenes", "Paths found (%)", "of these smoothed (%)", *_PLACES]
    return text + "\n\n" + grid(header, rows)


def arithmetic(found: Row) -> str:
    """What the paper's numbers say of each other."""
    rows = [
        [check["where"], check["printed"], check["wanted"], f"**{check['verdict']}**"]
        for check in found["arithmetic"]
    ]
    text = (
        "The angles are printed like 161 deg 1548': four digits after the degree sign that are "
        "no minutes of arc. Read as decimals they fit the text; read as minutes they are added "
        "as sixtieths. A curve that turns by k < 180 deg in all between points D apart is no "
        "longer than D / cos(k / 2)."
    )
    return text + "\n\n" + grid(["Number", "Printed", "Against the others", ""], rows)
