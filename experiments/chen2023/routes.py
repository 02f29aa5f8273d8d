"""Routes through scenes: searched, smoothed in every way compared, and sailed."""

from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import Any

import numpy as np

from experiments.chen2023.published import (
    ENDS,
    PRINTED_RADIUS,
    SAFETY_RANGE,
    SPEED,
    YAW_RATE,
)
from experiments.chen2023.scenes import (
    ORIGIN,
    Scenes,
    Waters,
    draw_scenes,
    on_blocked,
    to_cells,
    to_points,
)
from usvjax.missions.route.finish import length_and_turning
from usvjax.paths.smoothing import KeyPaths, bspline, shorten
from usvjax.paths.tracking import Tracks, track_paths
from usvjax.paths.turns import smooth_turns
from usvjax.search.astar import AstarResult, astar
from usvkernels.paths.tracking import TrackParams
from usvkernels.paths.turning import Turn
from usvkernels.status import Status

PAIRS = len(ENDS)
TURNING_RADIUS = SPEED / YAW_RATE  # m, of the circle that Table 1's speed and yaw rate make
SPACING = 1.0  # m, of samples along smoothed paths
SPLINE_SAMPLES = 1000
MARGIN = 0.5  # m, that arcs keep to blocked cells
NO_TURN = 1e-6  # rad
FEW_TURNS = 1e-3  # cells per 45 degrees: decides between paths that are equally long, and no more

TEMPLATES = {
    "inside": Turn.INSIDE,
    "late": Turn.LATE,
    "early": Turn.EARLY,
    "unfitted": Turn.UNFITTED,
}
"""How corners are counted."""

CONTACTS = {
    "left": "a cell kept clear of",
    "entered": "an expanded island",
    "touched": "a cell of an island",
    "hit": "an island",
}
"""What a vessel may be on or in; the cells that an island touches are wider than itself."""


@dataclass(frozen=True)
class Method:
    """A way from a grid to a path that is sailed.

    Attributes:
        name: short, for studies and results.json.
        words: for tables.
        base: "astar", the cells that A* returns; "corners", those at which it turns; or
            "shortened" by lines of sight.
        smoothing: "none", "bspline" or "arcs".
        radius: R of the arcs, m.
        safety: R_s, how far from a corner they leave the path where they can, m.
        yaw_rate: of the vessel that sails it, rad/s.
    """

    name: str
    words: str
    base: str
    smoothing: str
    radius: float = TURNING_RADIUS
    safety: float = SAFETY_RANGE
    yaw_rate: float = YAW_RATE


ASTAR = Method("astar", "A*", "astar", "none")
SHORTENED = Method("shortened", "A*, shortened", "shortened", "none")
SPLINE = Method("bspline", "A* + B-spline of its cells", "astar", "bspline")
CORNER_SPLINE = Method("bspline_corners", "A* + B-spline of its corners", "corners", "bspline")
SHORT_SPLINE = Method("bspline_shortened", "A*, shortened + B-spline", "shortened", "bspline")
ARCS = Method("arcs", "Proposed, R = 15 m", "astar", "arcs")
ARCS_WIDE = Method(
    "arcs_wide",
    "Proposed, R = 15 m, R_s = 2 R",
    "astar",
    "arcs",
    safety=TURNING_RADIUS * SAFETY_RANGE / PRINTED_RADIUS,
)
ARCS_3 = Method("arcs_3", "Proposed, R = 3 m", "astar", "arcs", radius=PRINTED_RADIUS)
AGILE = Method(
    "arcs_3_agile",
    "Proposed, R = 3 m, vessel of 5 rad/s",
    "astar",
    "arcs",
    radius=PRINTED_RADIUS,
    yaw_rate=SPEED / PRINTED_RADIUS,
)
SHORT_ARCS = Method("short_arcs", "Shortened first, R = 15 m", "shortened", "arcs")
SHORT_ARCS_3 = Method(
    "short_arcs_3", "Shortened first, R = 3 m", "shortened", "arcs", radius=PRINTED_RADIUS
)
SPLINES = (SPLINE, CORNER_SPLINE, SHORT_SPLINE)
PROPOSED = (ARCS, ARCS_WIDE, ARCS_3, SHORT_ARCS, SHORT_ARCS_3)
"""Algorithm 1 on the path of A*, as it is printed, and with a step of ours before it."""
SAILED = (ASTAR, SHORTENED, *SPLINES, *PROPOSED, AGILE)
METHODS = {method.name: method for method in SAILED}


@dataclass(frozen=True)
class Search:
    """What A* found for some jobs, B of them: pairs of ends, five in every scene.

    Attributes:
        waters: how scenes were drawn, and the grid.
        scenes: the islands, of each scene once.
        which: int[B], scene of each row among these.
        pair: int[B], of ends.
        maps: bool[B, C, C], cells of expanded islands, which paths keep clear of.
        found: of A*, cells.
        straight: float64[B], from the centre of the first cell to that of the last, m.
    """

    waters: Waters
    scenes: Scenes
    which: np.ndarray
    pair: np.ndarray
    maps: np.ndarray
    found: AstarResult
    straight: np.ndarray

    @property
    def ok(self) -> np.ndarray:
        """bool[B], whether there is a path."""
        arrived: np.ndarray = self.found.status == Status.FOUND
        return arrived

    @cached_property
    def short(self) -> KeyPaths:
        """The paths, shortened."""
        return shorten(self.found.path, self.found.path_cells, self.maps)

    @cached_property
    def bare(self) -> np.ndarray:
        """bool[n, C, C], cells of the islands of each scene."""
        return self.scenes.blocked(0.0, self.waters.cell)

    @property
    def frame(self) -> dict[str, Any]:
        """Of the grid, as paths take it."""
        return {"cell_size": self.waters.cell, "origin": ORIGIN}

    def cells(self, base: str) -> tuple[np.ndarray, np.ndarray]:
        """Cells int32[B, P, 2] and their number int32[B]."""
        if base == "shortened":
            return self.short.path, self.short.path_cells
        found = self.found.path, self.found.path_cells
        return found if base == "astar" else corners_of(*found)


def search(waters: Waters, seed: int, jobs: np.ndarray) -> Search:
    """Search the pair of ends `job % 5` in scene `job // 5`, job by job.

    Args:
        waters: how scenes are drawn, and the grid.
        seed: of the scenes.
        jobs: int[B].
    """
    numbers, which = np.unique(jobs // PAIRS, return_inverse=True)
    pair = jobs % PAIRS
    scenes = draw_scenes(numbers.tolist(), waters, seed)
    maps = scenes.blocked(waters.expansion, waters.cell)[which]
    ends = to_cells(np.array(ENDS), waters.cell)[pair]
    found = a_star(maps, ends, waters.turns)
    straight = np.linalg.norm(np.diff(to_points(ends, waters.cell), axis=1)[:, 0], axis=-1)
    return Search(waters, scenes, which, pair, maps, found, straight)


def a_star(maps: np.ndarray, ends: np.ndarray, turns: str) -> AstarResult:
    """Shortest paths between cells, int[B, 2, 2]; which of them is in `Waters`."""
    cost = {"turn_cost": FEW_TURNS} if turns == "fewest" else {}
    return astar(maps, ends[:, 0], ends[:, 1], **cost)


def corners_of(path: np.ndarray, length: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Keep the first and last cell of paths and those between at which the course changes.

    Args:
        path: int[B, P, 2], cells, padded by the last.
        length: int[B], cells of each.

    Returns:
        The same of the cells kept.
    """
    step = np.diff(path, axis=1)
    kept = np.zeros(path.shape[:2], bool)
    kept[:, 1:-1] = (step[:, 1:] != step[:, :-1]).any(axis=-1)
    kept[:, 0] = True
    place = np.arange(path.shape[1])
    kept &= place < length[:, None] - 1
    kept |= place == length[:, None] - 1
    order = np.argsort(~kept, axis=1, kind="stable")
    count = kept.sum(axis=1)
    width = max(int(count.max()), 2)
    slot = np.minimum(np.arange(width), np.maximum(count - 1, 0)[:, None])
    chosen = np.take_along_axis(order, slot, axis=1)
    return np.take_along_axis(path, chosen[..., None], axis=1), count.astype(np.int32)


@dataclass(frozen=True)
class Route:
    """Paths of one method, B of them.

    Attributes:
        ok: bool[B], found, and all corners smoothed where they were to be.
        points: float64[B, N, 2], m; the last is repeated.
        counts: int32[B], points of each, 0 where there is none.
        curvature: float32[B, N], 1/m; None of straight segments.
        bend: float[B], the largest curvature, 1/m; inf at a corner.
        corners: int[B, 4], how many of each of TEMPLATES; zeros without arcs.
    """

    ok: np.ndarray
    points: np.ndarray
    counts: np.ndarray
    curvature: np.ndarray | None
    bend: np.ndarray
    corners: np.ndarray


def make_route(searched: Search, method: Method) -> Route:
    """Turn what A* found into the paths of a method."""
    cells, counts = searched.cells(method.base)
    none = np.zeros((len(counts), len(TEMPLATES)), int)
    if method.smoothing == "bspline":
        spline = bspline(cells, counts, samples=SPLINE_SAMPLES, **searched.frame)
        bend = np.abs(spline.curvature).max(axis=1)
        return Route(searched.ok, spline.points, spline.counts, spline.curvature, bend, none)
    if method.smoothing == "arcs":
        smooth = smooth_turns(
            cells,
            counts,
            searched.maps,
            turning_radius=method.radius,
            safety_range=method.safety,
            spacing=SPACING,
            margin=MARGIN,
            **searched.frame,
        )
        corners = [(smooth.turns == turn).sum(axis=1) for turn in TEMPLATES.values()]
        return Route(
            smooth.fitted,
            smooth.points,
            smooth.counts,
            smooth.curvature,
            smooth.curvature_bound,
            np.stack(corners, axis=1),
        )
    points = to_points(cells, searched.waters.cell)
    bend = np.where(length_and_turning(points, counts)[1] > NO_TURN, np.inf, 0.0)
    return Route(searched.ok, points, counts, None, bend, none)


def sail(searched: Search, method: Method, route: Route) -> Tracks:
    """Let the method's vessel follow its paths."""
    return track_paths(
        route.points,
        route.counts,
        searched.maps,
        curvature=route.curvature,
        params=TrackParams(speed=SPEED, yaw_rate=method.yaw_rate),
        **searched.frame,
    )


def contacts(tracks: Tracks, searched: Search) -> np.ndarray:
    """What vessels are on or in at every control period; beyond the map's edge is water.

    Returns:
        bool[B, T, 4], of CONTACTS; nothing where there is no path.
    """
    places, cell = tracks.poses[..., :2], searched.waters.cell
    left = on_blocked(searched.maps, cell, np.arange(len(places)), places)
    left &= searched.ok[:, None]
    found = np.zeros((*left.shape, len(CONTACTS)), bool)
    # Islands lie on their cells, and these among the cells that are kept clear of.
    at = places[left]
    scene = searched.which[np.nonzero(left)[0]]
    found[left] = np.stack(
        [
            np.ones(len(at), bool),
            searched.scenes.inside(searched.waters.expansion, scene, at),
            on_blocked(searched.bare, cell, scene, at[:, None])[:, 0],
            searched.scenes.inside(0.0, scene, at),
        ],
        axis=1,
    )
    return found


def degrees(angle: np.ndarray) -> np.ndarray:
    """Radians to degrees."""
    converted: np.ndarray = angle * (180.0 / pi)
    return converted
