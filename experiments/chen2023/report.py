"""The report on path planning in Chen et al. 2023 as Markdown: a summary first, then all tables."""

from typing import Any

from experiments.chen2023.published import EXPANSION, TABLE_3
from experiments.chen2023.routes import ASTAR, MARGIN, PRINTED, PROPOSED, SPLINE
from experiments.chen2023.sections import (
    arithmetic,
    compared,
    corners,
    expansions,
    of_method,
    percent,
    sailing,
    timing,
    waters,
)
from experiments.markdown import bullets, grid

Row = dict[str, Any]


def markdown(found: Row) -> str:
    """Write the report.

    Args:
        found: all results, as in results.json.

    Returns:
        The text, ending in a newline.
    """
    scenes = f"{found['settings']['main']['scenes']:,}"
    parts = [
        "# Chen et al. 2023: A* smoothed to a vessel's turning circle",
        "Figs. 15 to 18 and Tables 1 to 3 on scenes of ours with the printed start and end "
        f"points, published values beside them; then the same on {scenes} scenes. Hunting (Figs. "
        "19 to 25) is not part of this report. Written by `usvjax reproduce chen2023`; all "
        "numbers are in `results.json`.",
        "## Summary\n\n" + bullets(_summary(found)),
        "## Verdict on each figure and table\n\n" + _verdicts(found),
        "## How the paper was read\n\n" + bullets(_readings(found)),
        "## Figs. 15 and 16: sailing the paths\n\n" + sailing(found),
        "## Which expansion lets the vessel hit an island\n\n" + expansions(found),
        "## Corners and curvature\n\n" + corners(found),
        "## Tables 2 and 3: length and turning\n\n" + compared(found),
        "## Tables 2 and 3: planning time\n\n" + timing(found),
        "## Lengths on other waters\n\n" + waters(found),
        "## The paper's own arithmetic\n\n" + arithmetic(found),
        "## Figures\n\n" + _figures(found),
    ]
    return "\n\n".join(parts) + "\n"


def _summary(found: Row) -> list[str]:
    lines = [
        _sailed(found),
        _why_no_hit(found),
        _smoothing(found),
        _ratios(found),
        _time_words(found),
        _contradictions(found),
    ]
    return [line for line in lines if line]


def _sailed(found: Row) -> str:
    rates = {
        method.name: ", ".join(
            percent(of_method(found["sailing"], method.name)[f"{kind}_scenes"], 2)
            for kind in ("left", "entered", "hit")
        )
        for method in (ASTAR, PROPOSED, PRINTED)
    }
    return (
        f"**Sailing**, at E = {EXPANSION:g}. On the path of A* the vessel is at some time on a "
        "cell kept clear of, in an expanded island, in an island itself on "
        f"{rates[ASTAR.name]} % of routes. On the proposed path with R = u/r = 15 m it is "
        f"{rates[PROPOSED.name]} %, and with the printed R = 3 m, which the vessel cannot turn, "
        f"{rates[PRINTED.name]} %. Arcs keep {MARGIN:g} m off cells; straight legs may pass "
        "them by centimetres, which no helmsman holds."
    )


def _why_no_hit(found: Row) -> str:
    rows = [row for row in found["expansions"] if row["method"] == ASTAR.name]
    shown = [
        f"{100 * row['touched_scenes']['value']:.1f} % ({100 * row['hit_scenes']['value']:.1f} %) "
        f"at E = {row['expansion']:g}"
        for row in rows
        if row["hit_scenes"]["value"] is not None
    ]
    if not shown:
        return ""
    return (
        f"**Expansion.** The printed E = {EXPANSION:g} makes islands {1 + EXPANSION:g} times as "
        "wide, more room than a vessel needs that cannot follow a corner. Searched with less, it "
        "is on a cell of an island (in the island, which is narrower than its cells) on "
        f"{', '.join(shown)} of routes: the collision of Fig. 15 needs obstacles that are hardly "
        "expanded or very small, or a map whose cells count as obstacle."
    )


def _smoothing(found: Row) -> str:
    rows = {row["method"]: row for row in found["corners"]}
    shortened, direct = rows[PROPOSED.name], rows["direct"]
    return (
        f"**Smoothing.** With R = 15 m Algorithm 1 smooths {percent(shortened['fitted_scenes'])} "
        f"% of paths whole once they are shortened by lines of sight, and "
        f"{percent(direct['fitted_scenes'])} % of A*'s own, whose corners stand a cell or two "
        "apart. No path that it makes bends more than 1/R."
    )


def _ratios(found: Row) -> str:
    rows = [row for row in found["compared"] if row["published"] is not None]
    if any(row["n"] == 0 for row in rows):
        return ""

    def means(metric: str, digits: int) -> str:
        own = [row["splines"][SPLINE.name][metric]["ratio"]["mean"]["value"] for row in rows]
        return ", ".join(f"{value:.{digits}f}" for value in own)

    lengths = ", ".join(f"{row['published']['ratio']['length']:.3f}" for row in rows)
    angles = ", ".join(f"{row['published']['ratio']['turning_deg']:.2f}" for row in rows)
    both = _readings_of_both(found)
    return (
        f"**Length and turning.** Proposed over B-spline (of all of A*'s cells): length "
        f"{means('length', 3)} on average, published {lengths}; turning {means('turning', 2)}, "
        f"published {angles}. With a spline of fewer points the length is much the same or the "
        "spline is the shorter one, and it leaves the water that was searched. Readings under "
        f"which both printed ratios are met: {', '.join(both) if both else 'none'}."
    )


def _readings_of_both(found: Row) -> list[str]:
    """Readings of the B-spline under which length and turning are as printed."""
    printed = [row["found"] for row in found["verdicts"] if "by as much as" in row["claim"]]
    return [label for label in printed[0] if all(row[label]["holds"] for row in printed)]


def _time_words(found: Row) -> str:
    single = found["timing"]["single"][1:]
    ratios = ", ".join(f"{row['a_proposed'] / row['a_bspline']:.2f}" for row in single)
    published = ", ".join(f"{row.proposed.time / row.bspline.time:.2f}" for row in TABLE_3)
    slowest = max(row["a_proposed"] for row in single)
    return (
        f"**Time.** Proposed over B-spline: {ratios}, published {published}. The paper's gain is "
        "its tree traversal in place of enumeration; here both follow parent pointers back from "
        f"the goal. A single path takes {1000 * slowest:.0f} ms at most, published 618 to 751 ms."
    )


def _contradictions(found: Row) -> str:
    checks = found["arithmetic"]
    against = sum(check["verdict"] == "contradicts" for check in checks)
    return (
        f"**The paper's own numbers** contradict each other in {against} of {len(checks)} checks: "
        "R = 3 m is not u/r = 15 m; with the angles' digits as decimals, row 2 of Table 3 is "
        "longer than any path of so little turning; as minutes, its proposed path turns more than "
        "the B-spline."
    )


def _verdicts(found: Row) -> str:
    words = {True: "yes", False: "no", None: "-"}
    rows = [
        [
            row["claim"],
            row["published"],
            f"**{row['verdict']}**",
            "<br>".join(
                f"{label}: {words[finding['holds']]}, {finding['numbers']}"
                for label, finding in row["found"].items()
            ),
        ]
        for row in found["verdicts"]
    ]
    note = (
        "A figure's event reproduces when it happens on at least half of the routes, and its "
        "absence when it happens on none. Printed ratios and lengths "
        "reproduce when they lie where those of 95 % of our scenes do; differences when the mean "
        "over scenes differs from 0 at 5 % (t-test, Holm-corrected). Readings that differ make "
        'the verdict "depends on the reading". Under 20 scenes nothing is judged.'
    )
    return grid(["The paper", "Published", "Verdict", "By reading"], rows) + "\n\n" + note


def _readings(found: Row) -> list[str]:
    settings = found["settings"]
    side, cell = settings["side"], settings["cell"]
    return [
        f"Scenes: {settings['main']['words']}, drawn from a seed on x, y in [-450, 450] m; an "
        "island is an octagon on an ellipse. The water reaches to "
        f"+-{side / 2:g} m, since the printed end point (347, -451) lies beyond 450. The paper "
        "prints no map, no number or size of obstacles and no cell size. Starts and ends keep "
        "20 m from every expanded island.",
        f"Grid: {cell:g} m cells, blocked where they touch an island scaled by 1 + E about its "
        f"centre (Eq. 4), E = {EXPANSION:g}. Ends are the centres of their cells, at most "
        f"{cell * 0.7071:.1f} m off. A* is exact, 8-connected, and does not cut corners.",
        "Proposed: A*, shortened by lines of sight (an arc needs room between corners), corners "
        "by Algorithm 1 with R_s = 2 R as in Table 1. R = 15 m = u/r unless said otherwise; the "
        "printed R = 3 m beside it. `docs/equations.md` has the three templates. Post-order "
        "traversal is read as following parent pointers.",
        "A* + B-spline: a clamped cubic B-spline; which points control it is not printed. Taken "
        "are all cells of A*'s path; its corners and the shortened path's points beside them.",
        "Vessel: a point at 15 m/s and at most 1 rad/s (Table 1) that steers by the path's "
        "curvature and corrects what it is off, control period 0.05 s. At every period it is asked "
        "whether the vessel is in an island, in one scaled by 1 + E, and on a cell that the "
        "search kept clear of. Beyond the map there is water.",
        "Routes of which a corner is left over are no proposed paths: they are counted, and left "
        "out of everything else. Comparisons are over scenes in which both have a path.",
        "Intervals are 95 %: Wilson for shares of scenes, bootstrap over scenes for averages and "
        "for shares of all routes (five a scene, which are not independent).",
    ]


def _figures(found: Row) -> str:
    lines = [
        f"`figures/{entry['name']}.png`: {entry['title']}, scene {entry['scene']}, the first in "
        f"which {entry['why']} and the proposed path is whole; {entry['scene']} passed over."
        for entry in found["shown"]
    ]
    lines += [
        "`figures/monte_carlo.png`: contacts by expansion, distance from the path, length and "
        "turning by pair of ends.",
        "`figures/corners.png`: corners by template.",
    ]
    return bullets(lines)
