"""The part of the page about the heuristic."""

from experiments.claims import Numbers
from experiments.yu2022.heuristic.compare import VESSELS
from experiments.yu2022.heuristic.mission import APART, MISSION, TRADITIONAL, UNIT
from experiments.yu2022.heuristic.published import GOAL, SENSING
from usvjax.report import Section, Sheet
from usvjax.report.numbers import fixed, interval, percent

WORDS = MISSION.methods


def summary(numbers: Numbers) -> list[str]:
    """Sentences for the head of the page."""
    label, table = next(iter(numbers["plans"].items()))
    if not table["n"]:
        return []
    rows = table["heuristics"]
    times = {name: row["against"][TRADITIONAL]["times"]["value"] for name, row in rows.items()}
    lines = [
        f"**{WORDS[name][0].upper()}{WORDS[name][1:]}** ({label}): {fixed(times[name], 3)} times "
        f"the cells of the traditional heuristic, and a path "
        f"{percent(rows[name]['length_ratio']['value'] - 1, 1)} % longer on average, "
        f"{percent(rows[name]['longest_ratio'] - 1, 0)} % at worst; it is a shortest one on "
        f"{interval(rows[name]['against'][TRADITIONAL]['as_short'], 100, digits=1)} % of maps."
        for name in ("weighted", "weighted_octile")
    ]
    lines.append(
        f"**The octile distance alone**, which is exact: {fixed(times['octile'], 2)} times the "
        "cells of the chess-board distance; Eq. 17 as printed "
        f"{fixed(times['weighted'] / times['octile'], 2)} times those of the octile distance."
    )
    unit = rows[UNIT]
    lines.append(
        "**If a diagonal step of the traditional algorithm costs 1**, as the ties of Fig. 3 want "
        f"it, its own paths are {percent(unit['length_ratio']['value'] - 1, 1)} % longer than the "
        f"shortest, and it expands {fixed(times[UNIT], 2)} times the cells."
    )
    return lines


def readings(numbers: Numbers) -> list[str]:
    """How the paper was read."""
    return [
        "Fig. 5 gives no numbers, and neither its map nor its size is printed. Ours: each cell "
        "blocked with the density as probability, at the sizes and densities of the paper's "
        "ordinary and complex environments, denser and smaller; start and goal drawn at least "
        f"{APART:g} sides apart in x or y, connected. A diagonal step needs both cells beside it "
        "free.",
        "Traditional: the chess-board distance. Where a diagonal step costs the square root of 2 "
        "it underestimates diagonal ways, so the search is exact, as it is with the octile "
        "distance. The paper defines that cost among its improvements, and the ties of Fig. 3 are "
        "ties where it is 1: that is the other reading, for first plans.",
        "Eq. 17 as printed adds sqrt(2) min(dx, dy) + dx + dy where the octile distance has "
        "|dx - dy| in the second term, and a weight w that grows from 1 at the vessel to 2 at "
        "the goal: it overestimates even on an empty map. *Octile with the weight*: w times the "
        "octile distance.",
        "Figs. 3 and 4: neither the vessel nor the obstacles are in the text. The vessel is at "
        f"{' or '.join(VESSELS)}, the only nodes above row C from which the nodes that the text "
        f"has tied are tied, the goal at {GOAL}; no obstacles.",
        "Expanded: cells taken off the queue and made consistent in the first plan, as the grey "
        "cells of Fig. 5.",
        "While the map changes: with every move so many cells drawn anywhere on the map change "
        f"between free and blocked, and the vessel notices within {SENSING[0]} x {SENSING[1]} "
        "cells. The paper's 3 % per cell and move would drive the whole map to half blocked.",
    ]


def sections(numbers: Numbers) -> list[Section]:
    """The tables."""
    maps = f"{numbers['maps']:,}"
    return [
        Section("Fig. 5 on one map", [_shown(numbers)]),
        Section(
            f"First plans on {maps} maps",
            [
                "Means with bootstrap intervals; the ratio of expansions is the geometric mean "
                "over maps with its t interval; shares with Wilson intervals. *Of traditional*, "
                "*as short* and *same cells* are against the chess-board distance with diagonal "
                "steps of the square root of 2, whose path is a shortest one; in brackets against "
                "that with diagonal steps of 1, whose path has the fewest moves.",
                _plans(numbers),
            ],
        ),
        Section(
            f"Episodes on {maps} maps that change",
            [
                "All expansions from start to goal, on the n maps where the vessel arrives with "
                "every heuristic. Out of budget: a single replanning took more than 16 "
                "expansions per cell of the map and was given up.",
                _episodes(numbers),
            ],
        ),
    ]


def _shown(numbers: Numbers) -> Sheet:
    shown = numbers["shown"]["heuristics"]
    old = shown[TRADITIONAL]
    rows = [
        [
            WORDS[name],
            str(own["expanded"]),
            fixed(own["expanded"] / old["expanded"], 3),
            fixed(own["length"], 2),
            fixed(own["length"] / old["length"], 3),
        ]
        for name, own in shown.items()
    ]
    title = f"The first map of {numbers['shown']['condition']}; it was not chosen."
    header = ["Heuristic", "Expanded", "of traditional", "Length (cells)", "of the shortest"]
    return Sheet(title, header, rows)


def _plans(numbers: Numbers) -> Sheet:
    header = ["Maps", "n", "Heuristic", "Expanded", "of traditional", "Length ratio to optimal"]
    header += ["Largest", "As short (%)", "Same cells (%)"]
    rows = []
    for label, table in numbers["plans"].items():
        for name, row in table["heuristics"].items():
            old, unit = row["against"][TRADITIONAL], row["against"][UNIT]
            rows.append(
                [
                    label,
                    f"{table['n']:,}",
                    WORDS[name],
                    interval(row["expanded"], digits=0),
                    f"{interval(old['times'], digits=3)} ({fixed(unit['times']['value'], 3)})",
                    interval(row["length_ratio"], digits=4),
                    fixed(row["longest_ratio"], 3),
                    *(
                        f"{interval(old[same], 100, digits=1)} ({percent(unit[same]['value'], 1)})"
                        for same in ("as_short", "same_cells")
                    ),
                ]
            )
    return Sheet("", header, rows, words=3)


def _episodes(numbers: Numbers) -> Sheet:
    header = ["Maps", "n", "Heuristic", "Reached (%)", "Out of budget (%)", "Expanded"]
    header += ["of traditional", "of them in replanning", "Length, of traditional"]
    rows = [
        [
            label,
            f"{table['n']:,}",
            WORDS[name],
            interval(row["reached"], 100, digits=1),
            interval(row["out_of_budget"], 100, digits=1),
            interval(row["expanded"], digits=0),
            interval(row["times"], digits=3),
            interval(row["replanning"], digits=0),
            interval(row["length_ratio"], digits=4),
        ]
        for label, table in numbers["episodes"].items()
        for name, row in table["heuristics"].items()
    ]
    return Sheet("", header, rows, words=3)
