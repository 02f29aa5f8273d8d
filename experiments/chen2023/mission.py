"""The mission "chen2023_routes": routes between the printed ends through scenes of ours.

Job j is the pair of ends j % 5 in scene j // 5, so that methods are compared route by route and
scenes, of five routes each, are the sample.
"""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from experiments.chen2023.published import ENDS, EXPANSION
from experiments.chen2023.routes import (
    CONTACTS,
    METHODS,
    TEMPLATES,
    Route,
    Search,
    contacts,
    make_route,
    sail,
    search,
)
from experiments.chen2023.scenes import ORIGIN, SIDE, TURNS, Waters
from experiments.missions import PaperMission
from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.mission import Case, Files, Ground, Metric, Outcome, Recording, Replay, Track
from usvjax.missions.route.finish import length_and_turning
from usvjax.paths.tracking import Tracks
from usvjax.registry import register_mission
from usvjax.sections import Table
from usvjax.tables import read_table
from usvkernels.paths.tracking import TrackParams
from usvkernels.status import Status

KIND = "chen2023_routes"
_SHARE: dict[str, Any] = {"integer": True, "share": True}


@dataclass(frozen=True)
class Sailed:
    """What figures need of one route.

    Attributes:
        path: float64[P, 2], m.
        track: float64[T, 2], where the vessel was, m.
        contact: bool[T, 4], on or in what of CONTACTS.
        distance: float32[T], from the path, m.
    """

    path: np.ndarray
    track: np.ndarray
    contact: np.ndarray
    distance: np.ndarray


class ChenRoutes(PaperMission):
    """Plan routes and sail them; see `usvjax.mission.Mission`."""

    tables = MappingProxyType({"waters": Table("scenes and their grids", {"": Waters})})
    methods = MappingProxyType({name: method.words for name, method in METHODS.items()})
    metrics = (
        Metric("straight", "m", "Straight line"),
        Metric("path_length", "m", "Path length"),
        Metric("turning", "rad", "Turning"),
        Metric("bend", "1/m", "Largest curvature", summarised=False),
        Metric("error", "m", "Largest distance from the path"),
        Metric("whole", "", "Smoothed whole", **_SHARE),
        Metric("arrived", "", "Arrived", **_SHARE),
        *(Metric(name, "", f"On or in {words}", **_SHARE) for name, words in CONTACTS.items()),
        *(Metric(name, "", f"Corners: {name}", integer=True) for name in TEMPLATES),
    )
    endings = (Status.FOUND, Status.UNREACHABLE)

    def case(self, tables: Mapping[str, Mapping[str, Any]], files: Files) -> Case:
        """Check one condition; see `Mission.case`."""
        where = files.table("waters")
        waters = read_table(Waters, tables["waters"], where)
        for key, fits, wanted in (
            ("islands", waters.islands >= 1, "1 or more"),
            ("least_axis", waters.least_axis > 0, "above 0"),
            ("greatest_axis", waters.greatest_axis >= waters.least_axis, "at least 'least_axis'"),
            ("expansion", 0 <= waters.expansion <= EXPANSION, f"between 0 and {EXPANSION:g}"),
            ("cell", _divides(waters.cell), f"a whole part of {SIDE:g} m, of 2 to 14 m"),
            ("turns", waters.turns in TURNS, " or ".join(map(repr, TURNS))),
        ):
            if not fits:
                raise BadInputError(f"{where}: {key!r} must be {wanted}")
        return Case({"waters": asdict(waters)}, {}, waters)

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> Search:
        """Draw scenes and find the shortest paths; see `Mission.pose`."""
        return search(case.given, seed, jobs)

    def run(self, scene: Search, method: str, record: bool = False) -> Outcome:
        """Smooth the paths, sail and measure; see `Mission.run`."""
        chosen = METHODS[method]
        route = make_route(scene, chosen)
        tracks = sail(scene, chosen, route)
        touched = contacts(tracks, scene)
        length, turning = length_and_turning(route.points, route.counts)
        ever = touched.any(axis=1)
        columns = {
            "status": np.where(scene.ok, Status.FOUND, Status.UNREACHABLE).astype(np.int32),
            "straight": scene.straight,
            "path_length": length,
            "turning": turning,
            "bend": route.bend,
            "error": tracks.error,
            "whole": route.ok,
            "arrived": tracks.arrived,
            **{name: ever[:, place] for place, name in enumerate(CONTACTS)},
            **{name: route.corners[:, place] for place, name in enumerate(TEMPLATES)},
        }
        recording = _recorded(scene, route, tracks, touched) if record else None
        return Outcome(columns, recording)

    def figures(self, run: Any, replay: Replay) -> Iterator[tuple[str, Any]]:
        """How many routes are found; the page draws the rest."""
        from usvjax.plots import plot_success

        given = {"labels": run.labels, "endings": self.endings, "methods": run.methods}
        yield "success", plot_success(run.table(), title=run.name, **given)


def _divides(cell: float) -> bool:
    """Whether cells make up the side, and starts and ends stay clear of islands' cells."""
    return 2 <= cell <= 14 and abs(SIDE / cell - round(SIDE / cell)) < 1e-9


def _recorded(scene: Search, route: Route, tracks: Tracks, touched: np.ndarray) -> Recording:
    grounds, sailed, told = [], [], []
    for row, pair in enumerate(scene.pair):
        grid = GridMap(scene.maps[row], scene.waters.cell, ORIGIN)
        marks = dict(zip(("start", "goal"), np.array(ENDS[pair])[:, None], strict=True))
        grounds.append(Ground(grid, np.empty((0, 2)), 0.0, marks))
        count = route.counts[row]
        # Where there is no path, the vessel stays at the start.
        track = tracks.poses[row, :, :2] if count else marks["start"]
        path = route.points[row, :count] if count else marks["start"]
        sailed.append(Sailed(path, track, touched[row, : len(track)], tracks.distance[row]))
        time = TrackParams().dt * np.arange(len(track))
        told.append(Track(time, "s", track[:, None]))
    return Recording(tuple(grounds), tuple(told), tuple(sailed))


MISSION = ChenRoutes()
register_mission(KIND, "experiments.chen2023.mission:MISSION")
