"""The mission "zhang2019_searches": paths from corner to corner of random grids.

The batched search of usvjax, and a textbook's program for what the order of equal cells does; each
with its traditional rules and with the turning cost of the paper, in both ways to read Eq. 7.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from experiments import textbook
from experiments.missions import PaperMission
from experiments.textbook import UPPER_FIRST, Rules
from experiments.zhang2019.paths import counted
from experiments.zhang2019.published import DIAGONAL, GAMMA
from usvjax.errors import BadInputError
from usvjax.maps.cells import check_cells, maps_of_jobs
from usvjax.mission import Case, Files, Ground, Metric, Outcome, Recording, Track
from usvjax.search.astar import astar
from usvjax.sections import Table
from usvjax.tables import read_table
from usvkernels.status import Status

LARGEST = 31
"""Cells of a side at most; smaller maps lie in one of this size, so that all share a program."""

UNIT = 1000
"""Of the textbook's whole numbers, in one square."""

_TURN = round(UNIT * GAMMA)
_PLAIN = Rules(straight=UNIT, diagonal=round(UNIT * DIAGONAL))

BATCHED: Mapping[str, Mapping[str, Any]] = {
    "traditional": {"heuristic": "manhattan"},
    "printed": {"heuristic": "manhattan", "turn_cost": GAMMA, "turn_mode": "parent"},
    "accumulated": {"heuristic": "manhattan", "turn_cost": GAMMA, "turn_mode": "accumulated"},
    "exact": {"turn_cost": GAMMA, "turn_mode": "exact"},
}
"""What `astar` is told."""

ORDERS: Mapping[str, Rules] = {
    "textbook": _PLAIN,
    "textbook, upper first": replace(_PLAIN, order=UPPER_FIRST),
    "textbook, last in": replace(_PLAIN, last_in=True),
}
"""Which of equal cells comes first: in the order of entry, lower neighbours first, unless the name
says otherwise."""

_IMPROVED: Mapping[str, Mapping[str, Any]] = {
    "traditional": {},
    "printed": {"turn": _TURN},
    "accumulated": {"turn": _TURN, "accumulate": True},
}


def named(rule: str, program: str) -> str:
    """What the study calls the rule of a program."""
    return f"{rule} ({program})"


def _batched(rule: str) -> str:
    return named(rule, "batched")


def _split(method: str) -> tuple[str, str]:
    """Rule and program of a method."""
    rule, _, program = method.removesuffix(")").partition(" (")
    return rule, program


TEXTBOOK: Mapping[str, Rules] = {
    **{
        named(rule, program): replace(order, **settings)
        for program, order in ORDERS.items()
        for rule, settings in _IMPROVED.items()
    },
    # A turning cost so small that only ties feel it.
    named("ties only", "textbook"): replace(_PLAIN, turn=1),
}

_WORDS = {
    "traditional": "A* with Manhattan distance",
    "printed": "turning cost in the choice of the next cell, Eq. 7 as printed",
    "accumulated": "turning cost that counts in g from there on",
    "exact": "the least sum of length and turning cost",
    "ties only": "turning cost that decides between equal f only",
}


@dataclass(frozen=True)
class Maps:
    """The `[maps]` table of a study.

    Attributes:
        side: cells of a side, 2 to 31.
        density: probability that a cell is blocked, in [0, 1]; start and goal never are.
        corner_cutting: whether a diagonal step may pass a blocked cell beside it.
    """

    side: int = 25
    density: float = 0.3
    corner_cutting: bool = False


class Scene(NamedTuple):
    """The maps of J jobs, bool[J, LARGEST, LARGEST], blocked beyond their side."""

    maps: Maps
    blocked: np.ndarray

    @property
    def corner(self) -> int:
        """Both coordinates of the goal; the start is (0, 0)."""
        return self.maps.side - 1


class Searches(PaperMission):
    """The mission; see `usvjax.mission.Mission`."""

    tables = MappingProxyType({"maps": Table("where paths are sought", {"": Maps})})
    methods = MappingProxyType(
        {name: _WORDS[_split(name)[0]] for name in (*map(_batched, BATCHED), *TEXTBOOK)}
    )
    metrics = tuple(
        Metric(name, "", words, integer=True, summarised=False)
        for name, words in {
            "straight": "Straight steps",
            "diagonal": "Diagonal steps",
            "turns": "Turns by 45 degrees",
            "bends": "Turns",
            "expanded": "Expanded",
        }.items()
    )
    endings = (Status.FOUND, Status.UNREACHABLE)

    def case(self, tables: Mapping[str, Mapping[str, Any]], files: Files) -> Case:
        """Read the table; see `Mission.case`."""
        where = files.table("maps")
        maps = read_table(Maps, tables["maps"], where)
        if not 2 <= maps.side <= LARGEST:
            raise BadInputError(f"{where}: 'side' must be 2 to {LARGEST}, got {maps.side}")
        check_cells((maps.side, maps.side), maps.density, 1.0, where)
        return Case({"maps": asdict(maps)}, {}, maps)

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> Scene:
        """Draw maps; see `Mission.pose`."""
        maps: Maps = case.given
        blocked = np.ones((len(jobs), LARGEST, LARGEST), bool)
        shape = (maps.side, maps.side)
        blocked[:, : maps.side, : maps.side] = maps_of_jobs(seed, jobs, shape, maps.density)
        blocked[:, 0, 0] = blocked[:, maps.side - 1, maps.side - 1] = False
        return Scene(maps, blocked)

    def run(self, scene: Scene, method: str, record: bool = False) -> Outcome:
        """Search; see `Mission.run`."""
        rule, program = _split(method)
        if program == "batched":
            cells, found, expanded = batched(scene, rule)
        else:
            cells, found, expanded = by_the_book(scene, TEXTBOOK[method])
        status = np.where(found, Status.FOUND, Status.UNREACHABLE).astype(np.int32)
        columns = {"status": status, **counted(cells), "expanded": expanded}
        return Outcome(columns, _recorded(scene, cells) if record else None)


MISSION = Searches()

Found = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Cells int[J, P, 2] with the last one repeated, whether there is a path, cells expanded."""


def batched(scene: Scene, rule: str) -> Found:
    """Search all maps at once, by one of `BATCHED`."""
    ends = (0, 0), (scene.corner, scene.corner)
    cutting = scene.maps.corner_cutting
    result = astar(scene.blocked, *ends, engine="queue", corner_cutting=cutting, **BATCHED[rule])
    return result.path, result.status == Status.FOUND, result.expanded


def by_the_book(scene: Scene, rules: Rules) -> Found:
    """Search map by map."""
    rules = replace(rules, corner_cutting=scene.maps.corner_cutting)
    ends = (0, 0), (scene.corner, scene.corner)
    found = [textbook.search(blocked, *ends, rules) for blocked in scene.blocked]
    longest = max([1, *(len(path) for path, _ in found)])
    cells = np.zeros((len(found), longest, 2), np.int32)
    for row, (path, _) in zip(cells, found, strict=True):
        row[:] = path[-1] if path else (0, 0)
        row[: len(path)] = path or row[:0]
    expanded = np.array([len(closed) for _, closed in found], np.int32)
    return cells, np.array([bool(path) for path, _ in found]), expanded


def _recorded(scene: Scene, cells: np.ndarray) -> Recording:
    """Paths in squares, y downwards as the paper's figures have it."""
    marks = {"start": np.zeros((1, 2)), "goal": np.full((1, 2), float(scene.corner))}
    grounds = tuple(Ground(None, np.empty((0, 2)), 0.0, marks) for _ in cells)
    steps = np.hypot(*np.moveaxis(np.diff(cells, axis=1), -1, 0))
    along = np.pad(np.cumsum(steps, axis=1), ((0, 0), (1, 0)))
    places = cells[:, :, None].astype(float)
    tracks = tuple(Track(way, "m", place) for way, place in zip(along, places, strict=True))
    return Recording(grounds, tracks, cells)
