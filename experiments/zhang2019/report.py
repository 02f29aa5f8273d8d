"""The report on Zhang et al. 2019 as Markdown: a summary first, then every table."""

from collections.abc import Mapping
from typing import Any

from experiments.markdown import bullets, grid, interval
from experiments.verdicts import verdict_table
from experiments.zhang2019.compare import WINDOW
from experiments.zhang2019.published import IMPROVED, TIMES, TRADITIONAL
from experiments.zhang2019.runs import SHOWN_DENSITY, SIDE
from experiments.zhang2019.verdicts import MOST_SLOWDOWN

Found = Mapping[str, Any]


def markdown(found: Found) -> str:
    """Write the report.

    Args:
        found: all results, as in results.json.

    Returns:
        The text, ending in a newline.
    """
    settings = found["settings"]
    parts = [
        "# Zhang et al. 2019: A* with a turning cost",
        "The paper's Figs. 9 and 10 and Tables 3 and 4 on a map of ours, then on "
        f"{settings['maps']:,} random maps per density; the exact optimum of length and turning "
        "cost beside them. Written by `usvjax reproduce zhang2019`; all numbers are in "
        "`results.json`.",
        "## Summary\n\n" + bullets(_summary(found)),
        "## Verdict on each table and claim\n\n" + _verdicts(found),
        "## How the paper was read\n\n" + bullets(_readings(found)),
        "## Table 3 on one map (Figs. 9 and 10)\n\n" + _shown(found),
        "## Maps like the paper's\n\n" + _alike(found),
        "## All maps: paired differences to the traditional search\n\n" + _against(found),
        "## What ties explain\n\n" + _ties(found),
        "## Time (Table 4)\n\n" + _time(found),
        "## The size of the paper's map\n\n" + _sizes(found),
        "## The paper's own arithmetic\n\n" + _arithmetic(found),
        "## Figures\n\n"
        + bullets(
            [
                "`figures/fig9_10.png`: the map of Table 3 with all four paths.",
                "`figures/maps_alike.png`: total cost on the maps like the paper's.",
                "`figures/changes.png`: change of the total cost, map by map, at each density.",
            ]
        ),
    ]
    return "\n\n".join(parts) + "\n"


def _summary(found: Found) -> list[str]:
    batched = found["batched"]
    alike = batched["alike"]
    rows = batched["against"][str(SHOWN_DENSITY)]
    lines = []
    for word in ("reproduces", "depends on the reading", "does not reproduce", "too few maps"):
        claims = [v["claim"] for v in found["verdicts"] if v["verdict"] == word]
        if claims:
            lines.append(f"**{word[0].upper()}{word[1:]}**: {'; '.join(claims)}.")
    if alike["printed"]["n"]:
        parts = [
            f"{_saved(alike[method])} with {words}"
            for method, words in (
                ("printed", "Eq. 7 as printed"),
                ("accumulated", "e(n) accumulated in g(n)"),
                ("exact", "the exact optimum"),
            )
        ]
        lines.append(
            f"**What explains Table 3**: the published saving is 5.0 at equal length. On the "
            f"{alike['printed']['n']:,} maps like the paper's the mean saving is "
            f"{'; '.join(parts)}. Of {alike['printed']['same']} maps with exactly the published "
            f"traditional costs, the improved path has exactly the published ones in "
            f"{alike['printed']['hits']} as printed and in {alike['accumulated']['hits']} "
            "accumulated."
        )
    lines.append(
        f"**Not every map gains**: at density {SHOWN_DENSITY:g} the improved path costs more in "
        f"total than the traditional one on {interval(rows['printed']['worse'], 100, 1)} % of "
        f"maps as printed, on {interval(rows['accumulated']['worse'], 100, 1)} % accumulated; it "
        f"costs the same on {interval(rows['printed']['equal'], 100, 1)} % and "
        f"{interval(rows['accumulated']['equal'], 100, 1)} %."
    )
    best = batched["excess"][str(SHOWN_DENSITY)]
    lines.append(
        "**Over the exact optimum** (true diagonals) the totals lie on average by "
        + ", ".join(
            f"{100 * (best[m]['mean'] - 1):.1f} % ({m})"
            for m in ("traditional", "printed", "accumulated")
            if best[m]["mean"] is not None
        )
        + f" at density {SHOWN_DENSITY:g}; the exact search expands "
        f"{_ratio(rows['exact']['metrics']['expanded']):.0f} times as many states as the "
        "traditional one cells."
    )
    return lines


def _saved(row: Found) -> str:
    return f"{row['saved']:.2f} (5.0 or more on {100 * row['as_published']['value']:.0f} %)"


def _ratio(metric: Found) -> float:
    return float(metric["mean"] / metric["traditional"])


def _verdicts(found: Found) -> str:
    note = (
        "Table 3 holds when both costs lie between the 2.5 and 97.5 % quantiles of ours: the "
        f"traditional ones of all maps at density {SHOWN_DENSITY:g}, the improved ones of the "
        f"maps whose traditional path is within {WINDOW:g} of the paper's in length and in "
        "turning cost. A cost is reduced when the mean paired difference lies below 0 with its "
        "95 % interval at every density (differences at 0.1, 0.2, 0.3). Table 4 holds up to a "
        f"ratio of {MOST_SLOWDOWN:g}."
    )
    return verdict_table(found["verdicts"]) + "\n\n" + note


def _readings(found: Found) -> list[str]:
    settings = found["settings"]
    return [
        f"Map: not published. Ours are {SIDE} x {SIDE} cells, each blocked with the density as "
        "probability, from the upper left to the lower right corner; side and density are "
        "chosen after the fact so that the traditional path costs about as much as the paper's "
        "(last section). A diagonal step needs both cells beside it free.",
        "Costs: 1 and 1.4 per step, 0.5 per 45 deg, counted along the path. The batched search "
        "itself takes the square root of 2 for a diagonal step; its totals with that are in "
        "`results.json` as `total_sqrt2`. The textbook program searches with 1.4.",
        "Traditional: Manhattan distance (Eq. 5) although diagonal steps are allowed. It "
        "overestimates, so paths need not be shortest.",
        "Improved, *printed*: e(n) enters F(n) given the cell's parent, and the way to what "
        "follows is g(n) without it (Eq. 7). *Accumulated*: it counts in g(n) from there on.",
        "Ties: the paper takes the cell that entered the open list first and, in its figures, "
        'the "lower" one. The batched search takes of equal f that with the least h (on these '
        "maps to within half a cell), then the first row by row; it opens closed cells again "
        "when a shorter way to them is found (not as printed). The textbook program takes equal "
        "values in order of entry, neighbours from the lowest row up, and leaves closed cells "
        "closed; other orders stand beside it.",
        f"Maps: {settings['maps']:,} per density for the batched search, the first "
        f"{settings['textbook_maps']:,} of them for the textbook program; maps without a path "
        "are left out (all methods find one or none does).",
    ]


def _shown(found: Found) -> str:
    shown = found["shown"]
    rows = [
        [
            method,
            published,
            f"{own['total']:.1f}",
            f"{own['turning']:.1f}",
            f"{own['length']:.1f}",
            f"{own['total_sqrt2']:.2f}",
            str(own["expanded"]),
        ]
        for method, own in shown["paths"].items()
        for published in (_published(method),)
    ]
    text = (
        f"Map {shown['map']} of density {SHOWN_DENSITY:g}: of {found['settings']['maps']:,} the "
        "one whose traditional path comes nearest to Table 3 in length and turning cost, the "
        "first of equals. Chosen after the fact, and by the traditional path alone."
    )
    header = ["Path", "Published total, turning", "Total", "Turning", "Length"]
    return text + "\n\n" + grid([*header, "Total, sqrt 2", "Expanded"], rows)


def _published(method: str) -> str:
    row = {"traditional": TRADITIONAL, "printed": IMPROVED, "accumulated": IMPROVED}.get(method)
    return f"**{row.total}, {row.turning}**" if row else "-"


def _alike(found: Found) -> str:
    text = (
        f"Maps of density {SHOWN_DENSITY:g} whose traditional path is within {WINDOW:g} of Table "
        "3 in length (43.8) and turning cost (15.5). Mean with 2.5 and 97.5 % quantiles of the "
        "maps. Published: 54.3 and 10.5, a saving of 5.0."
    )
    rows = [
        [
            program,
            method,
            f"{own['n']:,}",
            interval(own["spread"]["total"], 1, 1),
            interval(own["spread"]["turning"], 1, 1),
            "-" if own["saved"] is None else f"{own['saved']:.2f}",
            interval(own["as_published"], 100, 1),
            str(own["same"]),
            str(own["hits"]),
        ]
        for program in ("batched", "textbook")
        for method, own in found[program]["alike"].items()
    ]
    header = ["Program", "Method", "Maps", "Total", "Turning", "Mean saving"]
    header += ["Saves 5.0 or more (%)", "Exactly 59.3, 15.5", "Then exactly 54.3, 10.5"]
    return text + "\n\n" + grid(header, rows)


def _against(found: Found) -> str:
    text = (
        "Method minus traditional on the n maps with a path, in squares, with 95 % t intervals "
        "of the paired mean; shares of maps in % with Wilson intervals. Excess: mean ratio of "
        "the total (true diagonals) to the exact optimum; that of the traditional path is "
        + ", ".join(
            f"{100 * (rows['traditional']['mean'] - 1):.1f} % at {density}"
            for density, rows in found["batched"]["excess"].items()
            if rows["traditional"]["mean"] is not None
        )
        + "."
    )
    header = ["Density", "n", "Method", "Total", "Turning", "Length", "Expanded"]
    header += ["Lower total (%)", "Equal (%)", "Higher (%)", "Excess (%)"]
    rows = []
    for density, methods in found["batched"]["against"].items():
        for method, row in methods.items():
            excess = found["batched"]["excess"][density][method]["mean"]
            changes = [row["metrics"][name] for name in ("total", "turning", "length", "expanded")]
            rows.append(
                [
                    density,
                    f"{row['n']:,}",
                    method,
                    *(_change(change) for change in changes),
                    *(interval(row[name], 100, 1) for name in ("better", "equal", "worse")),
                    "-" if excess is None else f"{100 * (excess - 1):.2f}",
                ]
            )
    return text + "\n\n" + grid(header, rows)


def _change(metric: Found) -> str:
    if metric["mean"] is None:
        return "-"
    means = f"{metric['traditional']:.1f} to {metric['mean']:.1f}"
    return f"{means}: {interval(metric['difference'], 1, 2, True)}"


def _ties(found: Found) -> str:
    text = (
        "The textbook program on the same maps; differences to its own traditional search "
        "(entry order, lower neighbours first). *Ties only*: a turning cost of 0.001, which "
        "decides between equal f and nothing else; this is the explanation that the paper gives "
        "for its gain."
    )
    rows = []
    for density, methods in found["textbook"]["against"].items():
        for label, row in methods.items():
            changes = [row["metrics"][name] for name in ("total", "turning", "length", "expanded")]
            rows.append(
                [
                    density,
                    f"{row['n']:,}",
                    label,
                    *(_change(change) for change in changes),
                    interval(row["worse"], 100, 1),
                ]
            )
    header = ["Density", "n", "Rules", "Total", "Turning", "Length", "Expanded", "Higher (%)"]
    return "\n\n".join([text, bullets(_tie_shares(found)), grid(header, rows)])


def _tie_shares(found: Found) -> list[str]:
    lines = []
    for density, methods in found["textbook"]["against"].items():
        gain = {
            label: row["metrics"]["turning"]["difference"]["value"]
            for label, row in methods.items()
        }
        if any(gain[label] is None for label in gain):
            continue
        orders = [gain["traditional, upper first"], gain["traditional, last in"]]
        lines.append(
            f"Density {density}: turning cost {gain['printed']:+.2f} as printed, of which ties "
            f"alone make {gain['ties only']:+.2f}; {gain['accumulated']:+.2f} accumulated. "
            f"Another order of ties moves the traditional search by {min(orders):+.2f} to "
            f"{max(orders):+.2f}."
        )
    return lines


def _time(found: Found) -> str:
    ratio = TIMES["improved"] / TIMES["traditional"]
    text = (
        "Published: 116 and 124 ms (VS2017, i5-6300HQ), ratio "
        f"{ratio:.2f}. Batched: per query on one core, all maps of density {SHOWN_DENSITY:g} at "
        "once, fastest of runs that take turns; in brackets the range of ratios run by run. "
        "Textbook: Python, all maps of that density, rule by rule on each map."
    )
    rows = [
        [program, method, f"{1e6 * row['seconds']:,.1f}", interval(row["ratio"])]
        for program in ("batched", "textbook")
        for method, row in found[program]["time"].items()
    ]
    return text + "\n\n" + grid(["Program", "Method", "us per query", "Ratio"], rows)


def _sizes(found: Found) -> str:
    fits = [
        f"{row['straight']} straight and {row['diagonal']} diagonal"
        + (f" (side {row['side']})" if row["side"] else "")
        for row in found["steps"]
    ]
    text = (
        "Both published paths are 43.8 long. With 1.4 per diagonal step that is, in steps: "
        f"{'; '.join(fits)}. In brackets: side of the square map that such a path crosses from "
        "corner to corner without detours. Means of the textbook's traditional search, by side "
        "and density (published: 43.8 and 15.5):"
    )
    rows = [
        [
            str(row["side"]),
            f"{row['density']:g}",
            f"{100 * row['reached']:.0f}",
            f"{row['length']:.1f}",
            f"{row['turning']:.1f}",
        ]
        for row in found["sizes"]
    ]
    header = ["Side", "Density", "With a path (%)", "Length", "Turning"]
    return text + "\n\n" + grid(header, rows)


def _arithmetic(found: Found) -> str:
    rows = [
        [row["where"], row["printed"], row["recomputed"], "agrees" if row["agrees"] else "no"]
        for row in found["arithmetic"]
    ]
    return grid(["Number", "Printed", "Recomputed", ""], rows)
