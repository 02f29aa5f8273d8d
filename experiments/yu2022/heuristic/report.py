"""The part of the report about the heuristic, as Markdown."""

from collections.abc import Mapping
from typing import Any

from experiments.markdown import grid, interval
from experiments.yu2022.heuristic.plans import APART, EPISODES, PLANS
from experiments.yu2022.heuristic.published import HEURISTICS, SENSING, TRADITIONAL
from experiments.yu2022.heuristic.verdicts import SAME

Found = Mapping[str, Any]


FIGURES = (
    "`figures/fig5.png`: cells expanded (grey) and path (red) with each heuristic.",
    "`figures/heuristics.png`: expansions and lengths on all kinds of maps.",
)


def tables(found: Found) -> str:
    """Write the tables.

    Args:
        found: all results of this part, as in results.json.
    """
    maps = f"{found['maps']:,}"
    return "\n\n".join(
        [
            "### Fig. 5 on one map\n\n" + _shown(found),
            f"### First plans on {maps} maps\n\n" + _plans(found),
            f"### Episodes on {maps} maps that change\n\n" + _episodes(found),
        ]
    )


def summary(found: Found) -> list[str]:
    """Sentences for the head of the report."""
    lines: list[str] = []
    label, table = next(iter(found["plans"].items()))
    rows = table["heuristics"]
    if not table["n"]:
        return lines
    for heuristic in ("weighted", "weighted_octile"):
        row = rows[heuristic]
        lines.append(
            f"**{_capital(HEURISTICS[heuristic])}** ({label}): {row['times']['value']:.3f} times "
            f"the cells of the traditional heuristic, and a path {_longer(row)} longer on "
            f"average, {100 * (row['longest_ratio'] - 1):.0f} % at worst; it is a shortest one "
            f"on {interval(row['same_length'], 100, 1)} % of maps."
        )
    octile = rows["octile"]["times"]["value"]
    gained = rows["weighted"]["times"]["value"]
    lines.append(
        f"**Without any loss** the octile distance alone, which is exact, expands {octile:.2f} "
        "times the cells of the chess-board distance; Eq. 17 as printed makes "
        f"{gained / octile:.2f} of that, and costs the length."
    )
    return lines


def counts(found: Found) -> str:
    """How many maps there are; argument as of `tables`."""
    return f"maps of each kind for the heuristic: {found['maps']:,}"


def _capital(text: str) -> str:
    return text[0].upper() + text[1:]


def _longer(row: Found) -> str:
    return f"{100 * (row['length_ratio']['value'] - 1):.1f} %"


def note() -> str:
    """How to read the verdicts."""
    kinds = "; ".join(condition.label for condition in PLANS)
    changing = "; ".join(condition.label for condition in EPISODES)
    return (
        f"In the order: {kinds}; while the map changes: {changing}. Fewer: the geometric mean "
        "of the ratio of expansions, map by map, lies below 1 with its 95 % interval on every "
        f"kind of map. The same: the path is as short on {100 * SAME:.0f} % of the maps of every "
        "kind. The octile distance stands beside the readings of Eq. 17 and does not count."
    )


def readings(found: Found) -> list[str]:
    """How the paper was read."""
    return [
        "Fig. 5 gives no numbers and its map is not printed. Ours: each cell blocked with the "
        "density as probability, at the sizes and densities of the paper's ordinary and complex "
        f"environments and denser; start and goal drawn at least {APART:g} sides apart in x or "
        "y, connected. A diagonal step costs the square root of 2 with every heuristic and "
        "needs both cells beside it free.",
        "Traditional: the chess-board distance. It underestimates diagonal ways, so the search "
        "is exact; so is the octile one.",
        "Eq. 17 as printed adds sqrt(2) min(dx, dy) + dx + dy where the octile distance has "
        "|dx - dy| in the second term, and a weight w that grows from 1 at the vessel to 2 at "
        "the goal: it overestimates even on an empty map. *Octile with the weight*: w times the "
        "octile distance.",
        "Expanded: cells taken off the queue and made consistent in the first plan, as the grey "
        "cells of Fig. 5. The planner's counts and those of the plain search that draws them "
        f"agree on the map that is shown: {'yes' if found['shown']['counts_agree'] else 'no'}.",
        "While the map changes: with every move so many cells drawn anywhere on the map change "
        f"between free and blocked, and the vessel notices within {SENSING[0]} x {SENSING[1]} "
        "cells. The paper's 3 % per cell and move would drive the whole map to half blocked.",
    ]


def _shown(found: Found) -> str:
    shown = found["shown"]
    rows = [
        [
            HEURISTICS[heuristic],
            str(own["expanded"]),
            f"{own['expanded'] / shown['heuristics'][TRADITIONAL]['expanded']:.3f}",
            f"{own['length']:.2f}",
            f"{own['length'] / shown['heuristics'][TRADITIONAL]['length']:.3f}",
        ]
        for heuristic, own in shown["heuristics"].items()
    ]
    header = ["Heuristic", "Expanded", "of traditional", "Length", "of the shortest"]
    return f"The first map of {shown['condition']}; it was not chosen.\n\n" + grid(header, rows)


def _plans(found: Found) -> str:
    header = ["Maps", "n", "Heuristic", "Expanded", "of traditional", "Length ratio to optimal"]
    header += ["Largest", "As short (%)", "Same cells (%)"]
    rows = []
    for label, table in found["plans"].items():
        for heuristic, row in table["heuristics"].items():
            worst = row["longest_ratio"]
            rows.append(
                [
                    label,
                    f"{table['n']:,}",
                    HEURISTICS[heuristic],
                    interval(row["expanded"], 1, 0),
                    interval(row["times"], 1, 3),
                    interval(row["length_ratio"], 1, 4),
                    "-" if worst is None else f"{worst:.3f}",
                    interval(row["same_length"], 100, 1),
                    interval(row["same_cells"], 100, 1),
                ]
            )
    text = (
        "Means with bootstrap intervals; the ratio of expansions is the geometric mean over maps "
        "with its t interval; shares with Wilson intervals. As short: the path has the length of "
        "the traditional one, which is the shortest. Same cells: it is that path."
    )
    return text + "\n\n" + grid(header, rows)


def _episodes(found: Found) -> str:
    header = ["Maps", "n", "Heuristic", "Reached (%)", "Out of budget (%)", "Expanded"]
    header += ["of traditional", "of them in replanning", "Length, of traditional"]
    rows = []
    for label, table in found["episodes"].items():
        for heuristic, row in table["heuristics"].items():
            rows.append(
                [
                    label,
                    f"{table['n']:,}",
                    HEURISTICS[heuristic],
                    interval(row["reached"], 100, 1),
                    interval(row["out_of_budget"], 100, 1),
                    interval(row["expanded"], 1, 0),
                    interval(row["times"], 1, 3),
                    interval(row["replanning"], 1, 0),
                    interval(row["length_ratio"], 1, 4),
                ]
            )
    text = (
        "All expansions from start to goal, on the n maps where the vessel arrives with every "
        "heuristic. Out of budget: a single replanning took more than 16 expansions per cell of "
        "the map and was given up."
    )
    return text + "\n\n" + grid(header, rows)
