"""The report on Wei & Zhang 2023 as Markdown: a summary first, then every table."""

from collections.abc import Mapping
from typing import Any

from experiments.markdown import bullets, grid, interval
from experiments.verdicts import verdict_table
from experiments.wei2023.compare import WINDOW
from experiments.wei2023.published import AFTER, BEFORE, COLLISION_RADIUS, UNIT
from experiments.wei2023.scenes import SHOWN
from experiments.wei2023.verdicts import SEARCHES

Found = Mapping[str, Any]


def markdown(found: Found) -> str:
    """Write the report.

    Args:
        found: all results, as in results.json.

    Returns:
        The text, ending in a newline.
    """
    scenes = f"{found['settings']['scenes']:,}"
    parts = [
        "# Wei & Zhang 2023: key points of the global path",
        f"The paper's Figs. 7 and 8 on a scene of ours, then on {scenes} scenes of each kind. "
        "Written by `usvjax reproduce wei2023`; all numbers are in `results.json`.",
        "## Summary\n\n" + bullets(_summary(found)),
        "## Verdict on each figure and claim\n\n" + _verdicts(found),
        "## How the paper was read\n\n" + bullets(_readings(found)),
        "## Figs. 7 and 8 on one scene\n\n" + _shown(found),
        f"## Before and after on {scenes} scenes of each kind\n\n" + _tables(found),
        "## Scene by scene\n\n" + _changes(found),
        "## Figures\n\n"
        + bullets(
            [
                "`figures/fig7_8.png`: one path before and after, with its turning points.",
                f"`figures/turning_points.png`: turning points, length and clearance, "
                f"{SHOWN.label}.",
            ]
        ),
    ]
    return "\n\n".join(parts) + "\n"


def _summary(found: Found) -> list[str]:
    lines = []
    for word in ("reproduces", "depends on the reading", "does not reproduce", "too few maps"):
        claims = [v["claim"] for v in found["verdicts"] if v["verdict"] == word]
        if claims:
            lines.append(f"**{word[0].upper()}{word[1:]}**: {'; '.join(claims)}.")
    tables = found["tables"][SHOWN.label]
    parts = [
        f"{tables[search]['stages']['before']['spread']['turns']['value']:.1f} with {label}"
        for search, label in SEARCHES.items()
        if search in tables
    ]
    lines.append(
        f"**Where {BEFORE} turning points come from**: which of the shortest paths is found. Mean "
        f"number before smoothing: {'; '.join(parts)}. On each scene all these paths are equally "
        "short; heuristic and ties decide whether a program goes straight on or zigzags."
    )
    own = tables["euclidean"]["stages"]["key points"]
    lines.append(
        "**What smoothing does besides** (Euclidean distance): the path is "
        f"{-100 * _relative(tables['euclidean'], 'length'):.1f} % shorter; its clearance "
        f"{interval(own['difference']['clearance'], 1, 3, True)} nm, less than before on "
        f"{interval(own['closer'], 100, 1)} % of scenes. It comes nearer to an obstacle than the "
        f"collision radius on {interval(own['too_close'], 100, 1)} % of scenes; before on "
        f"{interval(tables['euclidean']['stages']['before']['too_close'], 100, 1)} % (the grid "
        "inflates obstacles by cells' centres, and segments pass between these)."
    )
    return lines


def _relative(table: Found, metric: str) -> float:
    stage = table["stages"]["key points"]
    before = table["stages"]["before"]["spread"][metric]["value"]
    return float(stage["difference"][metric]["value"] / before)


def _verdicts(found: Found) -> str:
    kinds = "; ".join(found["tables"])
    note = (
        f"A number holds when it lies between the 2.5 and 97.5 % quantiles of our scenes, "
        f"{SHOWN.label} (mean and these quantiles are given). Reduced: the mean paired "
        f"difference lies below 0 with its 95 % interval on every kind of scenes ({kinds}; the "
        "textbook program runs on the first kind only)."
    )
    return verdict_table(found["verdicts"]) + "\n\n" + note


def _readings(found: Found) -> list[str]:
    return [
        "The scene of Figs. 7 and 8 is not printed, nor its size; it has three obstacles. Ours: "
        f"round obstacles, cells of the unit length {UNIT:g} nm, blocked when the centre lies "
        f"within the collision radius {COLLISION_RADIUS:g} nm of an obstacle; start and goal in "
        "opposite corners, the straight course barred. The side of 5 nm is chosen after the fact, "
        f"so that {BEFORE} turning points occur; other sides stand beside it.",
        "A* with eight neighbours; a diagonal step needs both cells beside it free. The heuristic "
        "is not printed: Euclidean and octile distance, both exact. Of equal f the batched search "
        "takes the least h, then the first row by row; the textbook program the cell that entered "
        "first, straight moves first.",
        "Smoothing (Fig. 4 of the paper): a point is dropped when its neighbours see each other, "
        "until none is left. *Shortened* is one pass of line of sight (Yu et al. 2022). Sight is "
        "exact: the segment touches no blocked cell.",
        "Turning points: points between start and goal where the course changes.",
        "Clearance: exact distance of the path to the obstacles as they are, without inflation.",
    ]


def _shown(found: Found) -> str:
    shown = found["shown"]
    rows = [
        [
            stage,
            {"before": f"**{BEFORE}**", "key points": f"**{AFTER}**"}.get(stage, "-"),
            str(own["turns"]),
            str(own["points"]),
            f"{own['length']:.2f}",
            f"{own['clearance']:.3f}",
        ]
        for stage, own in shown["stages"].items()
    ]
    same = found["as_many"]["euclidean"]
    text = (
        f"Scene {shown['scene']} of {SHOWN.label}, Euclidean distance: the first whose path "
        f"before has {BEFORE} turning points, or the nearest number; chosen after the fact and by "
        f"that number alone. Of the {same['n']} paths with {BEFORE - WINDOW} to {BEFORE + WINDOW} "
        f"turning points {same['after']} have at most {AFTER} afterwards."
    )
    header = ["Path", "Published", "Turning points", "Points between the ends", "Length (nm)"]
    return text + "\n\n" + grid([*header, "Clearance (nm)"], rows)


def _tables(found: Found) -> str:
    header = ["Scenes", "n", "Search", "Path", "Turning points", "Points", "Turning (rad)"]
    header += ["Length (nm)", "Clearance (nm)", f"At most {AFTER} turning points (%)"]
    rows = []
    for kind, searches in found["tables"].items():
        for search, table in searches.items():
            for stage, row in table["stages"].items():
                spread = row["spread"]
                rows.append(
                    [
                        kind,
                        f"{table['n']:,}",
                        SEARCHES[search],
                        stage,
                        *(interval(spread[name], 1, 1) for name in ("turns", "points", "turning")),
                        interval(spread["length"], 1, 2),
                        interval(spread["clearance"], 1, 3),
                        interval(row["as_published"], 100, 1),
                    ]
                )
    text = "Means with the 2.5 and 97.5 % quantiles of scenes; the share with its Wilson interval."
    return text + "\n\n" + grid(header, rows)


def _changes(found: Found) -> str:
    header = ["Scenes", "Search", "Path", "Turning points", "Length (nm)", "Clearance (nm)"]
    header += ["Fewer turning points (%)", "Longer (%)", "Less clearance (%)"]
    header += [f"Nearer than {COLLISION_RADIUS:g} nm (%)"]
    rows = []
    for kind, searches in found["tables"].items():
        for search, table in searches.items():
            for stage, row in table["stages"].items():
                shares = ("fewer_turns", "longer", "closer", "too_close")
                if stage == "before":
                    changes = ["-"] * 6 + [interval(row["too_close"], 100, 1)]
                else:
                    change = row["difference"]
                    changes = [
                        interval(change["turns"], 1, 2, True),
                        interval(change["length"], 1, 3, True),
                        interval(change["clearance"], 1, 4, True),
                        *(interval(row[name], 100, 1) for name in shares),
                    ]
                rows.append([kind, SEARCHES[search], stage, *changes])
    text = "Paired differences to the path before, with 95 % t intervals; shares with Wilson's."
    return text + "\n\n" + grid(header, rows)
