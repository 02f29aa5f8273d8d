"""The mission "wei2023_paths": A* between round obstacles, and what key points make of its paths.

`[waters]` says how large the waters are, and what lies in them. Scenes are of the paper's kind: a
few round obstacles between one corner and the opposite one.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from scipy import ndimage

from experiments import textbook
from experiments.missions import PaperMission
from experiments.textbook import STRAIGHTS_FIRST, Rules
from experiments.wei2023.published import COLLISION_RADIUS, OBSTACLES, UNIT
from usvjax.maps import GridMap
from usvjax.mission import Case, Files, Ground, Metric, Outcome, Recording, Track
from usvjax.paths.metrics import path_metrics
from usvjax.paths.smoothing import key_points, shorten
from usvjax.search.astar import astar
from usvjax.sections import Table
from usvjax.tables import read_table
from usvkernels.status import Status

TEXTBOOK = {
    "textbook": Rules(10_000, 14_142, heuristic="euclidean", order=STRAIGHTS_FIRST),
    "textbook_octile": Rules(10_000, 14_142, heuristic="octile", order=STRAIGHTS_FIRST),
    "textbook_octile_last_in": Rules(
        10_000, 14_142, heuristic="octile", order=STRAIGHTS_FIRST, last_in=True
    ),
}
"""A* as Python programs have it: straight moves first, and of equal f the first one in, or the
last; with the Euclidean distance hardly any are equal."""
STAGES = {"before": "before", "keys": "key points", "sight": "one pass of line of sight"}
"""The path found, Wei & Zhang's smoothing, and another that their words may mean."""
MEASURES = {
    "turns": Metric("turns", "", "Turning points", integer=True),
    "points": Metric("points", "", "Points between the ends", integer=True),
    "turning": Metric("turning", "rad", "Turning"),
    "length": Metric("length", "", "Length (nm)"),
    "clearance": Metric("clearance", "", "Clearance (nm)"),
}
CELLS = 200
"""Of a side of every grid: one size, so that one program does; smaller waters have a rim."""
NAUTICAL_MILE = 1852.0  # m


@dataclass(frozen=True)
class Waters:
    """A kind of scene.

    Attributes:
        side: nm, at most 10.
        obstacles: how many.
        least, most: nm, radii of obstacles.
    """

    side: float = 5.0
    obstacles: int = OBSTACLES
    least: float = 0.25
    most: float = 0.75

    @property
    def cells(self) -> int:
        """Of a side of the waters, at the paper's unit length."""
        return round(self.side / UNIT)


class Scenes(NamedTuple):
    """Scenes of some jobs.

    Attributes:
        blocked: bool[J, CELLS, CELLS], cells whose centre lies within the collision radius of an
            obstacle, and all beyond the waters.
        starts, goals: int[J, 2], cells (x, y), connected but out of sight of each other.
        circles: float[J, obstacles, 3], centre (x, y) and radius, nm.
    """

    blocked: np.ndarray
    starts: np.ndarray
    goals: np.ndarray
    circles: np.ndarray


class PathMission(PaperMission):
    """Search and smooth; see `usvjax.mission.Mission`."""

    tables = MappingProxyType({"waters": Table("where paths are sought", {"": Waters})})
    methods = MappingProxyType(
        {
            "euclidean": "A*, Euclidean distance",
            "octile": "A*, octile distance",
            "textbook": "textbook A*, Euclidean distance",
            "textbook_octile": "textbook A*, octile distance",
            "textbook_octile_last_in": "textbook A*, octile distance, last in first out",
        }
    )
    metrics = tuple(
        Metric(f"{name}_{stage}", one.unit, f"{one.label}, {words}", integer=one.integer)
        for stage, words in STAGES.items()
        for name, one in MEASURES.items()
    )
    endings = (Status.FOUND,)

    def case(self, tables: Mapping[str, Mapping[str, Any]], files: Files) -> Case:
        """Check one condition; see `Mission.case`."""
        waters = read_table(Waters, tables["waters"], files.table("waters"))
        return Case({"waters": asdict(waters)}, {}, waters)

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> Scenes:
        """Draw scenes in which the straight course is barred and another one is open."""
        waters: Waters = case.given
        key = [seed, waters.cells, waters.obstacles]
        found = [_scene(waters, np.random.default_rng([*key, int(job)])) for job in jobs]
        return Scenes(*(np.array(column) for column in zip(*found, strict=True)))

    def run(self, scene: Scenes, method: str, record: bool = False) -> Outcome:
        """Search, smooth and measure every stage; see `Mission.run`."""
        if method in TEXTBOOK:
            cells, counts = by_textbook(scene, TEXTBOOK[method])
        else:
            found = astar(
                scene.blocked, scene.starts, scene.goals, heuristic=method, engine="queue"
            )
            cells, counts = found.path, found.path_cells
        keys, sight = (one(cells, counts, scene.blocked) for one in (key_points, shorten))
        stages = {
            "before": (cells, counts),
            "keys": (keys.path, keys.path_cells),
            "sight": (sight.path, sight.path_cells),
        }
        columns = {"status": np.full(len(counts), int(Status.FOUND))}
        for stage, path in stages.items():
            measured = _measured(scene, *path)
            columns |= {f"{name}_{stage}": values for name, values in measured.items()}
        return Outcome(columns, _recorded(scene, stages) if record else None)


MISSION = PathMission()


def _scene(waters: Waters, rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    side, cells = waters.side, waters.cells
    while True:
        centres = rng.uniform(0.2, 0.8, (waters.obstacles, 2)) * side
        radii = rng.uniform(waters.least, waters.most, waters.obstacles)
        circles = np.column_stack([centres, radii])
        start, goal = rng.uniform([[0.04], [0.82]], [[0.18], [0.96]], (2, 2))
        ends = np.floor(np.array([start, goal]) * cells).astype(int)
        line = np.array([centre_of(ends)])
        if clearance(line, circles[None])[0] > COLLISION_RADIUS:
            continue
        blocked = barred(circles, cells)
        water, _ = ndimage.label(~blocked)
        at = water[ends[:, 1], ends[:, 0]]
        if at[0] and at[0] == at[1]:
            return blocked, ends[0], ends[1], circles


def barred(circles: np.ndarray, cells: int) -> np.ndarray:
    """Cells too near to an obstacle, float[K, 3] (nm), or beyond the waters; bool[CELLS, CELLS]."""
    centres = (np.arange(cells) + 0.5) * UNIT
    x, y, radius = circles.T[:, :, None, None]
    apart = np.hypot(centres[None, None, :] - x, centres[None, :, None] - y)
    blocked = np.ones((CELLS, CELLS), bool)
    blocked[:cells, :cells] = (apart < radius + COLLISION_RADIUS).any(axis=0)
    return blocked


def centre_of(cells: np.ndarray) -> np.ndarray:
    """Centres of cells (x, y), nm."""
    centres: np.ndarray = (cells + 0.5) * UNIT
    return centres


def clearance(points: np.ndarray, circles: np.ndarray) -> np.ndarray:
    """Least distance of polylines to obstacles, exact.

    Args:
        points: float[n, P, 2], nm; the last point may be repeated.
        circles: float[n, K, 3], nm.

    Returns:
        float[n], nm.
    """
    begin, end = points[:, :-1, None], points[:, 1:, None]
    centre = circles[:, None, :, :2]
    step = end - begin
    length2 = (step**2).sum(axis=-1)
    along = ((centre - begin) * step).sum(axis=-1) / np.where(length2 > 0, length2, 1.0)
    foot = begin + np.clip(along, 0.0, 1.0)[..., None] * step
    apart = np.sqrt(((centre - foot) ** 2).sum(axis=-1)) - circles[:, None, :, 2]
    least: np.ndarray = apart.min(axis=(1, 2))
    return least


def by_textbook(scene: Scenes, rules: Rules) -> tuple[np.ndarray, np.ndarray]:
    """Paths of the textbook program as `astar` returns them: cells int32[J, P, 2], and counts."""
    paths = []
    for grid, *ends in zip(scene.blocked, scene.starts, scene.goals, strict=True):
        start, goal = (tuple(map(int, cell)) for cell in ends)
        paths.append(textbook.search(grid, start, goal, rules)[0])  # type: ignore[arg-type]
    counts = np.array([len(path) for path in paths], np.int32)
    cells = np.zeros((len(paths), int(counts.max()), 2), np.int32)
    for row, path in zip(cells, paths, strict=True):
        row[:] = path[-1]
        row[: len(path)] = path
    return cells, counts


def _measured(scene: Scenes, cells: np.ndarray, counts: np.ndarray) -> dict[str, np.ndarray]:
    measures = path_metrics(cells, counts, cell_size=UNIT)  # in nm, as UNIT is
    return {
        "turns": measures.inflections,
        "points": counts - 2,
        "turning": measures.turning,
        "length": measures.length,
        "clearance": clearance(centre_of(cells), scene.circles),
    }


def _recorded(scene: Scenes, stages: Mapping[str, tuple[np.ndarray, np.ndarray]]) -> Recording:
    """The path found, as a track; the points of every stage, nm, as what figures need besides."""
    points = {stage: centre_of(cells) for stage, (cells, _) in stages.items()}
    grounds, tracks = [], []
    for row, blocked in enumerate(scene.blocked):
        grid = GridMap(blocked, UNIT * NAUTICAL_MILE)
        ends = {"start": scene.starts[row, None], "goal": scene.goals[row, None]}
        marks = {name: grid.points_of(cells) for name, cells in ends.items()}
        grounds.append(Ground(grid, np.empty((0, 2)), 0.0, marks))
        places = NAUTICAL_MILE * points["before"][row]
        steps = np.hypot(*np.diff(places, axis=0).T)
        tracks.append(Track(np.append(0.0, np.cumsum(steps)), "m", places[:, None]))
    return Recording(tuple(grounds), tuple(tracks), points)
