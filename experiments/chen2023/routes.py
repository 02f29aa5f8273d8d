"""Routes through scenes: searched, smoothed in every way compared, and sailed."""

from dataclasses import dataclass, fields, replace
from math import pi
from typing import Any, TypeVar

import numpy as np

from experiments.chen2023.published import ENDS, PRINTED_RADIUS, SPEED, TURNING_RADIUS, YAW_RATE
from experiments.chen2023.scenes import CELL, ORIGIN, Scenes, on_blocked, to_cells, to_points
from usvjax.paths.metrics import path_metrics
from usvjax.paths.smoothing import KeyPaths, bspline, shorten
from usvjax.paths.tracking import Tracks, track_paths
from usvjax.paths.turns import SmoothTurns, smooth_turns
from usvjax.search.astar import AstarResult, astar
from usvkernels.paths.tracking import TrackParams
from usvkernels.paths.turning import Turn
from usvkernels.status import Status

SPACING = 1.0  # m, of samples along smoothed paths
SPLINE_SAMPLES = 1000
MARGIN = 0.5  # m, that arcs keep to blocked cells
NO_TURN = 1e-6  # rad

Record = TypeVar("Record", AstarResult, KeyPaths)

TEMPLATES = (Turn.INSIDE, Turn.LATE, Turn.EARLY, Turn.UNFITTED)
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
        name: short, for results.json and the looks of figures.
        words: for tables.
        base: "astar", the cells that A* returns; "corners", those at which it turns; or
            "shortened" by lines of sight.
        smoothing: "none", "bspline" or "arcs".
        radius: R of the arcs, m; R_s is twice that, as in Table 1.
        yaw_rate: of the vessel that sails it, rad/s.
    """

    name: str
    words: str
    base: str
    smoothing: str
    radius: float = TURNING_RADIUS
    yaw_rate: float = YAW_RATE


ASTAR = Method("astar", "A*", "astar", "none")
SHORTENED = Method("shortened", "A*, shortened", "shortened", "none")
SPLINE = Method("bspline", "A* + B-spline", "astar", "bspline")
CORNER_SPLINE = Method("bspline_corners", "A* + B-spline of corners", "corners", "bspline")
KEY_SPLINE = Method("bspline_shortened", "A*, shortened + B-spline", "shortened", "bspline")
PROPOSED = Method("smoothed", "Proposed, R = 15 m", "shortened", "arcs")
PRINTED = Method("smoothed_3", "Proposed, R = 3 m", "shortened", "arcs", radius=PRINTED_RADIUS)
AGILE = Method(
    "smoothed_3_agile",
    "Proposed, R = 3 m, vessel of 5 rad/s",
    "shortened",
    "arcs",
    radius=PRINTED_RADIUS,
    yaw_rate=SPEED / PRINTED_RADIUS,
)
DIRECT = Method("direct", "Proposed on A* itself, R = 15 m", "astar", "arcs")
DIRECT_PRINTED = Method(
    "direct_3", "Proposed on A* itself, R = 3 m", "astar", "arcs", radius=PRINTED_RADIUS
)
METHODS = (
    ASTAR,
    SHORTENED,
    SPLINE,
    CORNER_SPLINE,
    KEY_SPLINE,
    PROPOSED,
    PRINTED,
    AGILE,
    DIRECT,
    DIRECT_PRINTED,
)
SWEPT = (ASTAR, SPLINE, PROPOSED, PRINTED)
"""Methods that are compared over expansion coefficients."""


@dataclass(frozen=True)
class Search:
    """What A* found for every scene and pair of ends, B = n x pairs, pairs running fastest.

    Attributes:
        scenes: the islands.
        expansion: E.
        bare: bool[n, H, W], cells of islands.
        maps: bool[B, H, W], cells of expanded islands, which paths keep clear of.
        found: of A*, cells.
        short: the same shortened.
        straight: float64[B], from the centre of the first cell to that of the last, m.
    """

    scenes: Scenes
    expansion: float
    bare: np.ndarray
    maps: np.ndarray
    found: AstarResult
    short: KeyPaths
    straight: np.ndarray

    @property
    def ok(self) -> np.ndarray:
        """bool[B], whether there is a path."""
        arrived: np.ndarray = self.found.status == Status.FOUND
        return arrived

    def row(self, i: int) -> "Search":
        """One row alone."""
        scene = i // (len(self.straight) // len(self.scenes))
        return Search(
            self.scenes.one(scene),
            self.expansion,
            self.bare[scene : scene + 1],
            self.maps[i : i + 1],
            _row(self.found, i),
            _row(self.short, i),
            self.straight[i : i + 1],
        )

    def cells(self, base: str) -> tuple[np.ndarray, np.ndarray]:
        """Cells int32[B, P, 2] and their number int32[B]."""
        if base == "shortened":
            return self.short.path, self.short.path_cells
        found = self.found.path, self.found.path_cells
        return found if base == "astar" else corners_of(*found)


def _row(record: Record, i: int) -> Record:
    values = {f.name: getattr(record, f.name) for f in fields(record)}
    cut: dict[str, Any] = {
        name: value[i : i + 1] for name, value in values.items() if isinstance(value, np.ndarray)
    }
    return replace(record, **cut)


def search(scenes: Scenes, expansion: float) -> Search:
    """Search all pairs of ends in all scenes, islands expanded by 1 + E."""
    starts, goals = (np.tile(cells, (len(scenes), 1)) for cells in end_cells())
    maps = np.repeat(scenes.blocked(expansion), len(ENDS), axis=0)
    found = astar(maps, starts, goals)
    straight = np.linalg.norm(to_points(goals) - to_points(starts), axis=-1)
    short = shorten(found.path, found.path_cells, maps)
    return Search(scenes, expansion, scenes.blocked(0.0), maps, found, short, straight)


def end_cells() -> tuple[np.ndarray, np.ndarray]:
    """Cells of the five starts and of the five ends, int32[5, 2] each."""
    ends = to_cells(np.array(ENDS))
    return ends[:, 0], ends[:, 1]


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
        corners: int[B, 4], how many of each of TEMPLATES; None without arcs.
    """

    ok: np.ndarray
    points: np.ndarray
    counts: np.ndarray
    curvature: np.ndarray | None
    bend: np.ndarray
    corners: np.ndarray | None = None


def make_route(searched: Search, method: Method) -> Route:
    """Turn what A* found into the paths of a method."""
    cells, counts = searched.cells(method.base)
    frame: dict[str, Any] = {"cell_size": CELL, "origin": ORIGIN}
    if method.smoothing == "bspline":
        spline = bspline(cells, counts, samples=SPLINE_SAMPLES, **frame)
        bend = np.abs(spline.curvature).max(axis=1)
        return Route(searched.ok, spline.points, spline.counts, spline.curvature, bend)
    if method.smoothing == "arcs":
        smooth: SmoothTurns = smooth_turns(
            cells,
            counts,
            searched.maps,
            turning_radius=method.radius,
            spacing=SPACING,
            margin=MARGIN,
            **frame,
        )
        corners = np.stack([(smooth.turns == turn).sum(axis=1) for turn in TEMPLATES], axis=1)
        return Route(
            smooth.fitted,
            smooth.points,
            smooth.counts,
            smooth.curvature,
            smooth.curvature_bound,
            corners,
        )
    turning = path_metrics(cells, counts, **frame).turning
    return Route(
        searched.ok, to_points(cells), counts, None, np.where(turning > NO_TURN, np.inf, 0.0)
    )


def sail(searched: Search, method: Method, route: Route) -> Tracks:
    """Let the method's vessel follow its paths."""
    return track_paths(
        route.points,
        route.counts,
        searched.maps,
        curvature=route.curvature,
        params=TrackParams(speed=SPEED, yaw_rate=method.yaw_rate),
        cell_size=CELL,
        origin=ORIGIN,
    )


@dataclass(frozen=True)
class Measures:
    """What is kept of paths, each [B]; lengths in m, angles in rad.

    Attributes:
        found: bool, whether A* found a path.
        ok: bool, whether the method has one that can be judged: all corners smoothed.
        straight: distance from start to end.
        length, turning: of the path.
        bend: its largest curvature, 1/m.
        error: largest distance of the vessel from the path; nan where none sailed.
        contact: bool[B, 4], whether the vessel was ever on or in each of CONTACTS.
        arrived: bool, whether it reached the path's end.
        corners: int[B, 4], corners by TEMPLATES; zeros without arcs.
    """

    found: np.ndarray
    ok: np.ndarray
    straight: np.ndarray
    length: np.ndarray
    turning: np.ndarray
    bend: np.ndarray
    error: np.ndarray
    contact: np.ndarray
    arrived: np.ndarray
    corners: np.ndarray

    def in_contact(self, kind: str) -> np.ndarray:
        """bool[B], of one of CONTACTS."""
        chosen: np.ndarray = self.contact[:, list(CONTACTS).index(kind)]
        return chosen


def measure(searched: Search, method: Method, sailed: bool = True) -> Measures:
    """Route all pairs of ends by a method, sail the routes, and keep the figures."""
    route = make_route(searched, method)
    metrics = path_metrics(route.points, route.counts)
    rows = len(route.ok)
    corners = np.zeros((rows, len(TEMPLATES)), int) if route.corners is None else route.corners
    error, arrived = np.full(rows, np.nan), np.zeros(rows, bool)
    contact = np.zeros((rows, len(CONTACTS)), bool)
    if sailed:
        tracks = sail(searched, method, route)
        error, arrived = tracks.error, tracks.arrived
        contact = np.logical_or.reduce(contacts(tracks, searched), axis=1)
    return Measures(
        found=searched.ok,
        ok=route.ok,
        straight=searched.straight,
        length=metrics.length,
        turning=metrics.turning,
        bend=route.bend,
        error=error,
        contact=np.where(searched.ok[:, None], contact, False),
        arrived=arrived,
        corners=corners,
    )


def contacts(tracks: Tracks, searched: Search) -> np.ndarray:
    """What vessels are on or in at every control period; beyond the map's edge is water.

    Returns:
        bool[B, T, 4], of CONTACTS.
    """
    places = tracks.poses[..., :2]
    left = on_blocked(searched.maps, np.arange(len(places)), places)
    found = np.zeros((*left.shape, len(CONTACTS)), bool)
    # Islands lie on their cells, and these among the cells that are kept clear of.
    at = places[left]
    scene = np.nonzero(left)[0] // (len(places) // len(searched.scenes))
    found[left] = np.stack(
        [
            np.ones(len(at), bool),
            searched.scenes.inside(searched.expansion, scene, at),
            on_blocked(searched.bare, scene, at[:, None])[:, 0],
            searched.scenes.inside(0.0, scene, at),
        ],
        axis=1,
    )
    return found


def joined(parts: list[Measures]) -> Measures:
    """Put the measures of several blocks of scenes together."""
    return Measures(
        **{f.name: np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Measures)}
    )


def of_pair(measures: Measures, pair: int) -> Measures:
    """The measures of one pair of ends, one row a scene."""
    chosen = slice(pair, None, len(ENDS))
    return Measures(**{f.name: getattr(measures, f.name)[chosen] for f in fields(Measures)})


def degrees(angle: np.ndarray) -> np.ndarray:
    """Radians to degrees."""
    converted: np.ndarray = angle * (180.0 / pi)
    return converted
