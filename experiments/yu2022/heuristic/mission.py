"""The mission "yu2022_plans": D* Lite with each heuristic from one cell to another.

`[maps]` says how large and dense maps are, and how many cells change with every move.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from types import MappingProxyType
from typing import Any
from zlib import crc32

import numpy as np
from scipy import ndimage

import usvjax as uj
from experiments.missions import PaperMission
from experiments.yu2022.heuristic.expansion import expand
from experiments.yu2022.heuristic.published import SENSING
from usvjax.maps import GridMap
from usvjax.mission import Case, Files, Ground, Metric, Outcome, Recording, Track
from usvjax.sections import Table
from usvjax.tables import read_table
from usvkernels.search.steps import STRAIGHT
from usvkernels.status import Status

TRADITIONAL, UNIT = "chebyshev", "unit"
APART = 0.5
"""Share of the side by which start and goal differ at least, in x or in y."""
SIDES = {50: 12, 100: 1}
"""Sides of grids, and columns of their tables of flips: few sizes, of which each is a program of
its own; smaller maps have a rim of blocked cells."""
MOST_FLIPS = max(SIDES.values())


@dataclass(frozen=True)
class PlanTable:
    """A kind of map.

    Attributes:
        side: cells.
        density: probability that a cell is blocked.
        flips: cells that change with every move, anywhere on the map.
        moves: after which an episode ends.
    """

    side: int = 50
    density: float = 0.1
    flips: int = 0
    moves: int = 150


@dataclass(frozen=True)
class Scenes:
    """What the episodes of some jobs begin with.

    Attributes:
        blocked: bool[J, H, W], beyond the side of the map True.
        starts, goals: int[J, 2], cells (x, y), connected with each other.
        flips: int[J, moves, C, 2], cells that change, -1 for none.
    """

    blocked: np.ndarray
    starts: np.ndarray
    goals: np.ndarray
    flips: np.ndarray

    def sail(self, heuristic: str) -> dict[str, np.ndarray]:
        """Sail all of them; changes are seen within the window only."""
        found = uj.dstar_lite(
            self.blocked,
            self.starts,
            self.goals,
            self.flips,
            heuristic=heuristic,
            sensing=SENSING,
        )
        return {
            "status": found.status,
            "first": found.expanded[:, 0],
            "expanded": found.expanded.sum(axis=1),
            "position": found.position,
        }

    def plan_by_unit_steps(self) -> dict[str, np.ndarray]:
        """First plans of the traditional heuristic where diagonal steps cost 1."""
        count, moves = len(self.blocked), self.flips.shape[1]
        position = np.repeat(self.goals[:, None], moves + 1, axis=1)
        first = np.zeros(count, int)
        for row in range(count):
            start, goal = (tuple(map(int, cells[row])) for cells in (self.starts, self.goals))
            found = expand(self.blocked[row], start, goal, TRADITIONAL, STRAIGHT)  # type: ignore[arg-type]
            first[row] = len(found.cells)
            path = found.path[: moves + 1]
            position[row, : len(path)] = path
        arrived = (position[:, -1] == self.goals).all(axis=1)
        status = np.where(arrived, int(Status.REACHED), int(Status.FOUND))
        return {"status": status, "first": first, "expanded": first, "position": position}


class PlanMission(PaperMission):
    """Plan and sail; see `usvjax.mission.Mission`."""

    tables = MappingProxyType({"maps": Table("maps and their changes", {"": PlanTable})})
    methods = MappingProxyType(
        {
            TRADITIONAL: "chess-board (traditional)",
            UNIT: "chess-board, diagonal steps of cost 1 (traditional)",
            "octile": "octile",
            "weighted": "Eq. 17 as printed",
            "weighted_octile": "octile with the weight of Eq. 17",
        }
    )
    metrics = (
        Metric("first", "", "Expanded in the first plan", integer=True),
        Metric("expanded", "", "Expanded", integer=True),
        Metric("length", "", "Length (cells)"),
        Metric("moves", "", "Moves", integer=True),
        Metric("path", "", "Checksum of the path", integer=True, summarised=False),
    )
    endings = (Status.REACHED, Status.FOUND, Status.UNREACHABLE, Status.OUT_OF_BUDGET)

    def case(self, tables: Mapping[str, Mapping[str, Any]], files: Files) -> Case:
        """Check one condition; see `Mission.case`."""
        table = read_table(PlanTable, tables["maps"], files.table("maps"))
        known = "plans on maps that do not change only"
        return Case({"maps": asdict(table)}, {}, table, None, {UNIT: known} if table.flips else {})

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> Scenes:
        """Draw maps, ends far apart in the largest water of each, and changes."""
        table: PlanTable = case.given
        side = table.side
        size = min(grid for grid in SIDES if grid >= side)
        blocked = np.ones((len(jobs), size, size), bool)
        flips = np.full((len(jobs), table.moves, SIDES[size], 2), -1)
        ends = []
        for row, job in enumerate(jobs):
            rng = np.random.default_rng([seed, int(job), side])
            # Denser maps of a job only have more blocked cells.
            blocked[row, :side, :side] = rng.random((side, side)) < table.density
            ends.append(_ends(blocked[row, :side, :side], rng))
            changes = rng.integers(0, side, (table.moves, MOST_FLIPS, 2))
            flips[row, :, : table.flips] = changes[:, : table.flips]
        starts, goals = np.array(ends).swapaxes(0, 1)
        return Scenes(blocked, starts, goals, flips)

    def run(self, scene: Scenes, method: str, record: bool = False) -> Outcome:
        """Plan and sail; see `Mission.run`."""
        found = scene.plan_by_unit_steps() if method == UNIT else scene.sail(method)
        moved = np.abs(np.diff(found["position"], axis=1)).sum(axis=2)
        straight, diagonal = ((moved == k).sum(axis=1) for k in (1, 2))
        checksums = [crc32(cells.tobytes()) for cells in found["position"]]
        columns = {
            "status": found["status"],
            "first": found["first"],
            "expanded": found["expanded"],
            "moves": straight + diagonal,
            "length": straight + np.sqrt(2.0) * diagonal,
            "path": np.array(checksums, np.uint32).view(np.int32),
        }
        return Outcome(columns, _recorded(scene, found["position"]) if record else None)


MISSION = PlanMission()


def _ends(blocked: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Start and goal; int[2, 2]. Diagonal steps need both sides free, so four ways connect."""
    water, _ = ndimage.label(~blocked)
    sizes = np.bincount(water.ravel())[1:]
    cells = np.argwhere(water == sizes.argmax() + 1)[:, ::-1]
    extent = (cells.max(axis=0) - cells.min(axis=0)).max()
    least = min(APART * len(blocked), extent)  # the water may be small
    while True:
        ends = cells[rng.integers(0, len(cells), 2)]
        if np.abs(ends[1] - ends[0]).max() >= least:
            return np.asarray(ends)


def _recorded(scene: Scenes, position: np.ndarray) -> Recording:
    grounds, tracks = [], []
    for row, blocked in enumerate(scene.blocked):
        grid = GridMap(blocked, 1.0, (0.0, 0.0))
        ends = {"start": scene.starts[row, None], "goal": scene.goals[row, None]}
        marks = {name: grid.points_of(cells) for name, cells in ends.items()}
        grounds.append(Ground(grid, np.empty((0, 2)), 0.0, marks))
        places = grid.points_of(position[row])
        steps = np.hypot(*np.diff(places, axis=0).T)
        tracks.append(Track(np.append(0.0, np.cumsum(steps)), "m", places[:, None]))
    return Recording(tuple(grounds), tuple(tracks), position)
