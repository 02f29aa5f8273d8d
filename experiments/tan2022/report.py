"""The report on Tan et al. 2022 as Markdown: a summary first, then every table."""

from typing import Any

from experiments.markdown import bullets, ends, grid, interval, share
from experiments.tan2022.appendix import arithmetic, ranking, sensitivities
from experiments.tan2022.markdown import ENDINGS, UNITS, WORDS
from experiments.tan2022.published import (
    METHODS,
    METRICS,
    RADII,
    TABLE2,
    TABLE3,
    TABLE4,
    PublishedTable,
)
from experiments.tan2022.summary import summary, why
from experiments.verdicts import verdict_table
from usvjax.report.numbers import p_value


def markdown(found: dict[str, Any]) -> str:
    """Write the report.

    Args:
        found: all results, as in results.json.

    Returns:
        The text, ending in a newline.
    """
    maps = f"{found['settings']['paired']['maps']:,}"
    parts = [
        "# Tan et al. 2022: DWA with an obstacle search angle",
        "The paper's Tables 2 to 4 and Figs. 2 to 7 on maps of ours, published values beside "
        f"them; then both methods on {maps} paired maps per radius; then what the result owes to "
        "everything that the paper does not print. Written by `usvjax reproduce tan2022`; all "
        "numbers are in `results.json`.",
        "## Summary\n\n" + summary(found),
        "## Verdict on each table and claim\n\n" + _verdicts(found),
        "## Why\n\n" + bullets(why(found)),
        "## How the paper was read\n\n" + bullets(_readings(found)),
        "## Tables 2, 3 and 4\n\n" + _tables(found),
        f"## Both methods on {maps} paired maps per radius\n\n" + _paired(found),
        "## What the paper does not print\n\n" + sensitivities(found),
        "## Which reading comes nearest\n\n" + ranking(found),
        "## The paper's own arithmetic\n\n" + arithmetic(found),
        "## Figures\n\n" + _figures(found),
    ]
    return "\n\n".join(parts) + "\n"


def _verdicts(found: dict[str, Any]) -> str:
    note = (
        "Values are for r = 0.2, 0.5 and 0.7 m. A table holds when 95 % of its values lie "
        "where ours do: for Tables 2 and 3 between the 2.5 and 97.5 % quantiles of the maps on "
        "which both methods succeed, for Table 4 where the mean over 20 such maps lies in 95 % "
        "of draws. A change holds when each published rate lies there. The verdict is over the "
        "readings that both methods share; the hybrid stands beside them. Radii with fewer than "
        "20 common successes are left out."
    )
    return verdict_table(found["verdicts"]) + "\n\n" + note


def _readings(found: dict[str, Any]) -> list[str]:
    one_map = found["settings"]["one_map"]
    return [
        "Maps: obstacle centres on the integer points 0 to 10, each with the obstacle rate as "
        "probability; start (0, 0) at rest heading for the goal (10, 10). Control period 0.1 s, "
        "speed resolution 0.01 m/s, yaw-rate resolution 1 deg/s, goal tolerance 0.5 m. None of "
        "this is printed; Table 1 is followed to the letter. `docs/equations.md` has the rest.",
        '"no cap": dist is not capped and is 2 m where no obstacle counts. "cap 2r": dist is '
        "at most twice the radius, the rule of a widely used demo whose weights, accelerations "
        'and resolutions Table 1 repeats. "cap 2r, start 90 deg": that demo\'s start as well. '
        '"hybrid": the traditional method with cap 2r against the improved one without a cap.',
        "An episode ends as collided when an executed position lies inside an obstacle's "
        "circle, as stuck after 20 s within 0.2 m of one place, as timed out after 150 s. "
        "Times, lengths and speeds are compared on the maps where both methods reach the goal, "
        "and every table says how many those are.",
        "The paper shows maps on which both methods arrive and does not say how they were "
        "chosen. Ours are the first ones of a fixed sequence on which both do, and the tables "
        "say how many were passed over. Table 2 takes the first map that both methods cross at "
        f"all three radii, out of {one_map['maps']:,}.",
    ]


def _tables(found: dict[str, Any]) -> str:
    parts = []
    for printed in (TABLE2, TABLE3, TABLE4):
        ours = {name: tables[str(printed.number)] for name, tables in found["tables"].items()}
        parts.append(f"### Table {printed.number}")
        parts += [_published_beside(printed, ours), _chosen(ours)]
    return "\n\n".join(parts)


def _published_beside(printed: PublishedTable, ours: dict[str, list[dict[str, Any]]]) -> str:
    """Lay one table out as the paper does: radius by radius, published then ours."""
    header = ["", "Method"]
    for radius in RADII:
        header += [f"r = {radius:g} m: published", *ours]
    rows = []
    for metric in METRICS:
        for method in METHODS:
            row = [f"{WORDS[metric]} ({UNITS[metric]})", method]
            for place, radius in enumerate(RADII):
                row.append(f"**{printed.values[method, metric][place]:.2f}**")
                row += [_cell(rows_of, radius, method, metric) for rows_of in ours.values()]
            rows.append(row)
        rows.append(_change_row(printed, metric, ours))
    return grid(header, rows)


def _cell(rows: list[dict[str, Any]], radius: float, method: str, metric: str) -> str:
    values = [row["values"] for row in rows if row["radius"] == radius]
    return f"{values[0][method][metric]:.2f}" if values and values[0] else "-"


def _change_row(
    printed: PublishedTable, metric: str, ours: dict[str, list[dict[str, Any]]]
) -> list[str]:
    """Change of one metric; where the paper prints none, that of its values in brackets."""
    row = [f"{WORDS[metric]}, change", ""]
    for place, radius in enumerate(RADII):
        if metric in printed.change:
            row.append(f"**{share(printed.change[metric][place])}**")
        else:
            old, new = (printed.values[method, metric][place] for method in METHODS)
            row.append(f"({share(new / old - 1)})")
        row += [_own_change(rows, radius, metric) for rows in ours.values()]
    return row


def _own_change(rows: list[dict[str, Any]], radius: float, metric: str) -> str:
    """Our change: averaged over maps for Table 4, as the paper seems to, else of one map."""
    entries = [row for row in rows if row["radius"] == radius and row["values"]]
    if not entries:
        return "-"
    if "change" in entries[0]:
        return share(entries[0]["change"][metric])
    old, new = (entries[0]["values"][method][metric] for method in METHODS)
    return share(new / old - 1)


def _chosen(ours: dict[str, list[dict[str, Any]]]) -> str:
    """Say which maps these are, and how many were passed over for them."""
    lines = []
    for name, rows in ours.items():
        chosen = [
            f"r = {row['radius']:g} m: "
            + (f"map {row['map']}" if "map" in row else f"{row['maps']} maps")
            + f", {row['passed_over']:,} passed over"
            for row in rows
        ]
        lines.append(f"{name}: " + ("; ".join(chosen) if chosen else "no such map was found") + ".")
    return bullets(lines)


def _paired(found: dict[str, Any]) -> str:
    parts = [
        "Endings in % with 95 % Wilson intervals. Success map by map, with the Agresti-Min "
        "interval of its difference, improved minus traditional. Time, length and mean speed on "
        "the n maps where both succeed: these are the easier maps, so the averages say nothing "
        "about the others. The last share is that of maps which change at least as much as "
        "Table 4 says they do on average. p-values are Holm-corrected over all comparisons here "
        "(t-test, Wilcoxon; McNemar for success)."
    ]
    for row in found["paired"]:
        parts.append(f"### {row['label'][0].upper()}{row['label'][1:]}")
        # A hybrid's episodes are those of the two readings that it is made of.
        if row["traditional"] == row["improved"]:
            parts.append(_endings(row))
        parts += [_success(row), _values(row)]
    return "\n\n".join(parts)


def _endings(row: dict[str, Any]) -> str:
    return grid(
        ["r (m)", "Rate", "Method", *ENDINGS.values()],
        [
            [f"{case['radius']:g}", f"{case['rate']:g}", method]
            + [interval(case["endings"][method][ending], 100, 1) for ending in ENDINGS]
            for case in row["cases"]
            for method in METHODS
        ],
    )


def _success(row: dict[str, Any]) -> str:
    header = ["r (m)", "Both succeed", "Only improved", "Only traditional", "Neither"]
    counts = ("both", "method_only", "baseline_only", "neither")
    return grid(
        [*header, "Difference (points)", "p (McNemar)"],
        [
            [
                f"{case['radius']:g}",
                *(f"{case['success'][name]:,}" for name in counts),
                interval(case["success"]["difference"], 100, 1, True),
                p_value(case["success"]["p_mcnemar_holm"]),
            ]
            for case in row["cases"]
        ],
    )


def _values(row: dict[str, Any]) -> str:
    header = ["r (m)", "n", "", "Traditional", "Improved", "Difference, t interval", "Bootstrap"]
    header += ["Change of the means", "Mean change per map", "As published", "p (t)"]
    lines = []
    for case in row["cases"]:
        for metric, compared in case["metrics"].items():
            if compared is None:
                continue
            lines.append(
                [
                    f"{case['radius']:g}",
                    f"{case['both']:,}",
                    f"{WORDS[metric]} ({UNITS[metric]})",
                    interval(compared["traditional"]),
                    interval(compared["improved"]),
                    interval(compared["difference"], 1, 2, True),
                    ends(compared["difference_bootstrap"]),
                    share(compared["change_of_means"]),
                    interval(compared["mean_change"], 100, 1, True) + " %",
                    f"{100 * case['as_much_as_published'][metric]:.1f} %",
                    p_value(compared["p_t_holm"]),
                    p_value(compared["p_wilcoxon_holm"]),
                ]
            )
    return grid([*header, "p (Wilcoxon)"], lines)


def _figures(found: dict[str, Any]) -> str:
    shown = " and ".join(f'"{name}"' for name in found["tables"])
    return bullets(
        [
            "`figures/fig2_*.png` to `figures/fig7_*.png`: the maps of Tables 2 and 3 under "
            f"{shown}, in the layout of the paper's Figs. 2 to 7.",
            "`figures/distributions_*.png`: time and length on the paired maps.",
            "`figures/endings.png`: how the paired episodes ended.",
            "`figures/cap.png`: time ratio and success against the cap on dist.",
        ]
    )
