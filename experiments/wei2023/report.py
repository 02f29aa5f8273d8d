"""The page on Wei & Zhang 2023."""

from collections.abc import Mapping
from typing import Any

from experiments.claims import Numbers
from experiments.wei2023.compare import SHOWN, WINDOW
from experiments.wei2023.mission import STAGES
from experiments.wei2023.published import AFTER, BEFORE, COLLISION_RADIUS, UNIT
from experiments.wei2023.runs import FITTED, SEARCHES
from usvjax.report import Section, Sheet
from usvjax.report.numbers import fixed, interval, percent


def summary(numbers: Numbers) -> list[str]:
    """The most important findings."""
    tables = numbers["tables"][FITTED]
    turns = [
        f"{fixed(tables[search]['stages']['before']['spread']['turns']['value'])} with {words}"
        for search, words in SEARCHES.items()
    ]
    stages = tables[SHOWN]["stages"]
    own, before = stages["keys"], stages["before"]
    shorter = -own["difference"]["length"]["value"] / before["spread"]["length"]["value"]
    return [
        f"**Where {BEFORE} turning points come from**: which of the shortest paths is found, and "
        f"how large the scene is. Mean number before smoothing, {FITTED}: {'; '.join(turns)}. On "
        "each scene all these paths are equally short; heuristic and ties decide whether a "
        "program goes straight on or zigzags.",
        f"**What smoothing does besides** ({SEARCHES[SHOWN]}, {FITTED}): the path is "
        f"{percent(shorter, 1)} % shorter; its clearance "
        f"{interval(own['difference']['clearance'], sign=True, digits=3)} nm, less than before "
        f"on {interval(own['closer'], 100, digits=1)} % of scenes. It comes nearer to an obstacle "
        f"than the collision radius on {interval(own['too_close'], 100, digits=1)} % of scenes; "
        f"before on {interval(before['too_close'], 100, digits=1)} % (the grid inflates obstacles "
        "by cells' centres, and segments pass between these).",
    ]


def readings(numbers: Numbers) -> list[str]:
    """How the paper was read."""
    return [
        "The scene of Figs. 7 and 8 is not printed, nor its size; it has three obstacles. Ours: "
        f"round obstacles, cells of the unit length {UNIT:g} nm, blocked when the centre lies "
        f"within the collision radius {COLLISION_RADIUS:g} nm of an obstacle; start and goal in "
        "opposite corners, the straight course barred. The number of turning points grows with "
        f"the side. That of 5 nm was chosen after the fact, so that {BEFORE} occur: it stands "
        "beside and does not count; half and twice that side do. Scenes with eight obstacles, more "
        "than the paper's, stand beside for the reduction.",
        "A* with eight neighbours; a diagonal step needs both cells beside it free. The heuristic "
        "is not printed: Euclidean and octile distance, both exact. Nor is it printed which of "
        "equally good cells comes first, which decides among paths of equal length: the batched "
        "search takes the least h, in steps of about a cell, then the first row by row; the "
        "textbook program the cell that entered first, or last, straight moves first.",
        "Smoothing (Fig. 4 of the paper is a flow chart): a point is dropped when its neighbours "
        "see each other, until none is left; or one pass of line of sight from the start, as Yu "
        "et al. (2022) have it. Sight is exact: the segment touches no blocked cell.",
        "Turning points: points between start and goal where the course changes.",
        "Clearance: exact distance of the path to the obstacles as they are, without inflation.",
    ]


def sections(numbers: Numbers) -> list[Section]:
    """The tables."""
    scenes = f"{numbers['scenes']:,}"
    return [
        Section("Figs. 7 and 8 on one scene", _shown(numbers)),
        Section(
            f"Before and after on {scenes} scenes of each kind",
            [
                "Means with the 2.5 and 97.5 % quantiles of scenes; the share with its Wilson "
                "interval.",
                _spreads(numbers["tables"]),
            ],
        ),
        Section(
            "Scene by scene",
            [
                "Paired differences to the path before, with 95 % t intervals; shares with "
                "Wilson's.",
                _changes(numbers["tables"]),
            ],
        ),
    ]


def _shown(numbers: Numbers) -> list[str | Sheet]:
    shown, same = numbers["shown"], numbers["as_many"]
    rows = [
        [
            STAGES[stage],
            {"before": str(BEFORE), "keys": str(AFTER)}.get(stage, "-"),
            fixed(own["turns"], 0),
            fixed(own["points"], 0),
            fixed(own["length"], 2),
            fixed(own["clearance"], 3),
        ]
        for stage, own in shown["stages"].items()
    ]
    header = ["Path", "Published", "Turning points", "Points between the ends", "Length (nm)"]
    return [
        f"Scene {shown['scene']} of {FITTED}, {SEARCHES[SHOWN]}: the first whose path before has "
        f"{BEFORE} turning points, or the nearest number; chosen after the fact and by that "
        f"number alone. Of the {same['n']} paths with {BEFORE - WINDOW} to {BEFORE + WINDOW} "
        f"turning points {same['after']} have at most {AFTER} afterwards.",
        Sheet("", [*header, "Clearance (nm)"], rows),
    ]


def _rows(tables: Mapping[str, Any]) -> list[tuple[list[str], str, Mapping[str, Any]]]:
    """The first cells of every row, its stage, and what was measured."""
    return [
        ([kind, f"{table['n']:,}", words, STAGES[stage]], stage, row)
        for kind, searches in tables.items()
        for search, words in SEARCHES.items()
        for table in [searches[search]]
        for stage, row in table["stages"].items()
    ]


def _spreads(tables: Mapping[str, Any]) -> Sheet:
    digits = {"turns": 1, "points": 1, "turning": 1, "length": 2, "clearance": 3}
    rows = [
        [
            *cells,
            *(interval(row["spread"][name], digits=count) for name, count in digits.items()),
            interval(row["as_published"], 100, digits=1),
        ]
        for cells, _, row in _rows(tables)
    ]
    header = ["Scenes", "n", "Search", "Path", "Turning points", "Points", "Turning (rad)"]
    header += ["Length (nm)", "Clearance (nm)", f"At most {AFTER} turning points (%)"]
    return Sheet("", header, rows, words=4)


def _changes(tables: Mapping[str, Any]) -> Sheet:
    digits = {"turns": 2, "length": 3, "clearance": 4}
    shares = ("fewer_turns", "longer", "closer", "too_close")
    rows = []
    for cells, stage, row in _rows(tables):
        changes = [
            interval(row["difference"][name], sign=True, digits=count)
            for name, count in digits.items()
        ] + [interval(row[name], 100, digits=1) for name in shares]
        if stage == "before":
            changes = [*["-"] * (len(changes) - 1), changes[-1]]
        rows.append([*cells, *changes])
    header = ["Scenes", "n", "Search", "Path", "Turning points", "Length (nm)", "Clearance (nm)"]
    header += ["Fewer turning points (%)", "Longer (%)", "Less clearance (%)"]
    return Sheet("", [*header, f"Nearer than {COLLISION_RADIUS:g} nm (%)"], rows, words=4)
