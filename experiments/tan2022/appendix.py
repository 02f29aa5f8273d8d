"""The back of the report on Tan et al. 2022: sensitivities, ranking, the paper's arithmetic."""

from typing import Any

from experiments.markdown import grid, interval
from experiments.tan2022.markdown import ENDINGS, WORDS
from experiments.tan2022.published import METHODS, METRICS, RADII, TABLE4
from experiments.tan2022.ranking import LEAST_COMMON


def sensitivities(found: dict[str, Any]) -> str:
    """Write the table of everything that is varied one at a time."""
    varied = found["settings"]["varied"]
    header = ["Varied", "Reading", "r (m)", "Maps", "Traditional", "Improved", "n"]
    header += ["Time (s)", "Length (m)", "Speed (m/s)", "Time ratio"]
    rows = []
    group = ""
    for row in found["sensitivities"]:
        rows.append(["" if row["group"] == group else row["group"], *_sensitivity(row)])
        group = row["group"]
    text = (
        f"One choice at a time on {varied['maps']:,} maps per radius ({varied['few_maps']:,} "
        "where dist is taken along the trajectory, which costs thirty times as much), other maps "
        "than above. Endings: % reached / collided / stuck / timed out. Time, length and speed: "
        "traditional / improved on the n maps where both succeed; the time ratio is improved "
        "over traditional with its bootstrap interval. `figures/cap.png` shows the rows of the cap."
    )
    return text + "\n\n" + grid(header, rows)


def _sensitivity(row: dict[str, Any]) -> list[str]:
    line = [row["reading"], f"{row['radius']:g}", f"{row['maps']:,}"]
    for method in METHODS:
        rates = (row["endings"][method][ending]["value"] for ending in ENDINGS)
        line.append(" / ".join(f"{100 * rate:.0f}" for rate in rates))
    line.append(str(row["both"]))
    if row["means"] is None:
        return [*line, "-", "-", "-", "-"]
    for metric, digits in zip(METRICS, (1, 1, 2), strict=True):
        line.append(" / ".join(f"{row['means'][m][metric]:.{digits}f}" for m in METHODS))
    return [*line, interval(row["time_ratio"])]


def ranking(found: dict[str, Any]) -> str:
    """Write which readings and hybrids come nearest to Table 4."""
    ranked = found["ranking"]
    maps = found["settings"]["ranked"]["maps"]
    text = (
        "After the fact, and without tuning: all combinations of the cap (2r, 1 m, 2 m, 5 m, "
        "none), the start (towards the goal, 90 deg), sailing astern (allowed, not) and Eq. 4 "
        f"(applied, not), {ranked['readings']} readings on {maps:,} maps per radius, and every "
        "pair of them from the same start with the traditional method under one and the improved "
        f"under the other. Of these, {ranked['ranked']:,} have at least {LEAST_COMMON} common "
        "successes at each radius and are ranked, by the root mean square of "
        "ln(ours / published) over the 18 averages of Table 4. The factor is its exponential: "
        'at 1.3 an average is typically 30 % off. "Within" counts the averages that a mean over '
        "20 of our maps could give. Values are traditional / improved at r = "
        f"{', '.join(f'{r:g}' for r in RADII)} m. With this many pairs the first place is "
        "partly luck."
    )
    header = ["Traditional", "Improved", "Factor", "Within (of 18)", "Maps where both succeed"]
    header += [WORDS[metric] for metric in METRICS]
    parts = [text]
    for title, key in (("One reading for both methods", "single"), ("Hybrids", "hybrid")):
        rows = [_rank(line) for line in ranked[key]] or [["none", *["-"] * 7]]
        parts += [f"### {title}", grid(header, [_published_rank(), *rows])]
    return "\n\n".join(parts)


def _published_rank() -> list[str]:
    cells = []
    for metric in METRICS:
        pairs = zip(*(TABLE4.values[m, metric] for m in METHODS), strict=True)
        cells.append(", ".join(f"{old:g} / {new:g}" for old, new in pairs))
    return ["*published*", "", "", "", "", *cells]


def _rank(line: dict[str, Any]) -> list[str]:
    cells = []
    for i, digits in enumerate((1, 1, 2)):
        pairs = [(values[0][i], values[1][i]) for values in line["values"]]
        cells.append(", ".join(f"{old:.{digits}f} / {new:.{digits}f}" for old, new in pairs))
    improved = "the same" if line["traditional"] == line["improved"] else line["improved"]
    counts = ", ".join(map(str, line["common"]))
    factor = f"{line['typical_factor']:.2f}"
    return [line["traditional"], improved, factor, str(line["within"]), counts, *cells]


def arithmetic(found: dict[str, Any]) -> str:
    """Write whether the paper's numbers agree with each other, and what Eq. 4 asks of them."""
    checks = found["arithmetic"]
    agreeing, possible, against = (
        sum(check["verdict"] == word for check in checks)
        for word in ("agrees", "can agree", "contradicts")
    )
    rows = [
        [check["where"], check["printed"], check["recomputed"], check["verdict"]]
        for check in checks
        if check["verdict"] != "agrees"
    ]
    bounds = [
        [
            f"Table {bound['table']}, r = {bound['radius']:g} m",
            f"{bound['speed']:.2f}",
            f"{bound['dist']:.2f}",
            f"{bound['demo_cap']:.1f}",
            f"{bound['top_speed']:.2f}",
            "yes" if bound["excludes_demo_cap"] else "no",
        ]
        for bound in found["cap_bounds"]
    ]
    header = ["Improved method", "Mean speed (m/s)", "dist that Eq. 4 asks for (m)", "2r (m)"]
    header += ["Most that a cap of 2r admits (m/s)", "Excludes that cap"]
    return "\n\n".join(
        [
            f"Of {len(checks)} checks of the paper's numbers against each other {agreeing} agree, "
            f'{possible} can agree and {against} contradict. "Can agree": an average of ratios '
            "over maps need not be the ratio of the averages. Those that agree are left out.",
            grid(["Where", "Printed", "From the other numbers", "Verdict"], rows),
            "Eq. 4 admits v only up to sqrt(2 dist v_b), so a mean speed bounds the cap on dist "
            "from below:",
            grid(header, bounds),
        ]
    )
