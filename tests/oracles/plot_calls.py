"""A small, valid call of every public function that draws."""

from pathlib import Path

import numpy as np
import polars as pl
from public_calls import Call

from usvjax import plots
from usvjax.maps import GridMap
from usvjax.missions.route import expanded, replanning
from usvkernels.status import Status

LINE = np.array([[11.0, 21.0], [15.0, 21.0], [19.0, 25.0]])
TABLE = pl.DataFrame(
    {
        "condition": [0, 0, 0, 0, 1, 1, 1, 1],
        "job": [0, 0, 1, 1, 0, 0, 1, 1],
        "method": ["a", "b"] * 4,
        "status": [int(Status.REACHED)] * 7 + [int(Status.STUCK)],
        "time": [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0],
    }
)


def plot_calls(folder: Path | None) -> dict[str, Call]:
    """By name.

    Args:
        folder: where figures are written to; None to have only the names.
    """
    blocked = np.zeros((6, 8), bool)
    blocked[2, 3:6] = True
    pond = GridMap(blocked, 2.0, (10.0, 20.0), "pond", "survey")
    tracks = np.stack([LINE, LINE + 1.0])
    view = (10.0, 20.0, 20.0, 30.0)
    bends = plots.bends_of(LINE)
    searches = expanded.expanded_cells(pond, [0, 0], [7, 5], heuristics=("zero",))
    episode = {
        "grid_map": pond,
        "flips": np.array([[[4, 4]], [[6, 1]]]),
        "position": np.array([[0, 0], [1, 1], [2, 1]]),
        "goal": np.array([7, 5]),
        "cost_to_go": np.array([8.2, 6.8, 5.8]),
        "expanded": np.array([9, 1, 0]),
    }
    settled = {"title": "ponds"}
    charted = {"view": view, **settled}
    return {
        "plot_chart": Call(
            plots.plot_chart,
            {
                "grid_map": pond,
                "trajectories": tracks,
                "status": np.array([int(Status.REACHED), int(Status.STUCK)]),
            },
            {"max_paths": 2, "sample_of": np.array([1, 1, 3]), "attribution": "me", **charted},
        ),
        "bends_of": Call(
            plots.bends_of,
            {"points": LINE},
            {"curvature": np.array([0.0, 0.1, 0.0]), "left": LINE[1:2]},
        ),
        "plot_curvature": Call(
            plots.plot_curvature,
            {"routes": {"a": bends, "b": bends}, "turning_radius": 3.0},
            settled,
        ),
        "both_reached": Call(plots.both_reached, {"table": TABLE}, {"success": Status.REACHED}),
        "plot_distributions": Call(
            plots.plot_distributions,
            {"table": TABLE},
            {"labels": {0: "calm", 1: "rough"}, "metrics": ["time"], **settled},
        ),
        "plot_map": Call(plots.plot_map, {"grid_map": pond}, settled),
        "plot_overview": Call(
            plots.plot_overview,
            {
                "table": TABLE,
                "varied": {0: {"params.rate": 0.1}, 1: {"params.rate": 0.2}},
                "success": int(Status.REACHED),
                "methods": ["a", "b"],
                "labels": {0: "calm", 1: "rough"},
            },
            {"words": "success", "units": {"params.rate": "1"}, "confidence": 0.95, **settled},
        ),
        "plot_paths": Call(
            plots.plot_paths,
            {
                "obstacles": np.array([[14.0, 24.0], [17.0, 20.0]]),
                "radius": 0.5,
                "trajectories": {"a": LINE},
                "start": LINE[0],
                "goal": LINE[-1],
            },
            {
                "endings": {"a": plots.Ending(int(Status.REACHED), 5.0, 9.7)},
                "goal_tolerance": 0.5,
                **settled,
            },
        ),
        "plot_success": Call(
            plots.plot_success,
            {"table": TABLE},
            {
                "radius": {0: 0.5, 1: 1.0},
                "rate": {0: 0.1, 1: 0.1},
                "labels": {0: "calm", 1: "rough"},
                "confidence": 0.95,
                "endings": [Status.REACHED, Status.STUCK],
                "methods": ["a", "b"],
                **settled,
            },
        ),
        "wilson_rates": Call(
            plots.wilson_rates,
            {"table": TABLE},
            {"confidence": 0.95, "endings": [Status.REACHED, Status.STUCK]},
        ),
        "plot_routes": Call(
            plots.plot_routes,
            {"grid_map": pond, "routes": {"a": LINE}},
            {"labels": {"a": "first"}, "closeup": 4.0, "turning_radius": 0.5, **charted},
        ),
        "plot_route_chart": Call(
            plots.plot_route_chart, {"grid_map": pond, "routes": [LINE, LINE[::-1]]}, charted
        ),
        "save": Call(
            plots.save,
            {"fig": plots.plot_map(pond), "path": (folder or Path()) / "pond.png"},
            {"dpi": 30},
        ),
        "expanded_cells": Call(
            expanded.expanded_cells,
            {"grid_map": pond, "start": np.array([0, 0]), "goal": np.array([7, 5])},
            {"heuristics": ["octile"], "corner_cutting": False},
        ),
        "plot_expanded": Call(
            expanded.plot_expanded, {"grid_map": pond, "searches": searches}, settled
        ),
        "replanning_of": Call(
            replanning.replanning_of,
            episode,
            {"sensing": (5, 5), "corner_cutting": False, **settled},
        ),
        "replanning_film": Call(
            replanning.replanning_film, {"episode": replanning.replanning_of(**episode)}
        ),
    }
