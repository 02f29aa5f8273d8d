"""A small, valid call of every public function of studies and of the methods of maps."""

from functools import partial
from pathlib import Path

import numpy as np
from public_calls import Call
from study_fake import ToyMission, toy_study

import usvjax as uj
from usvjax.maps import GridMap, find_map, packaged_names
from usvjax.study import load_spec, parse_spec, run_study
from usvjax.study.runner import Silent

BRIEF = {
    "name": "brief",
    "kind": "toy",
    "episodes": 2,
    "methods": ["plain", "better"],
    "params": {"rate": 0.5},
}
IN_TOML = """name = "brief"
kind = "toy"
episodes = 2
"""


def study_calls(folder: Path | None) -> dict[str, Call]:
    """By name.

    Args:
        folder: where a run and a study file are written to; None to have only the names.
    """
    spec = parse_spec(BRIEF)
    if folder is None:
        folder = Path()
    else:
        run_study(spec, folder / "runs")
        (folder / "brief.toml").write_text(IN_TOML)
    blocked = np.zeros((6, 8), bool)
    blocked[2, 3:6] = True
    pond = GridMap(blocked, 2.0, (10.0, 20.0), "pond", "survey")
    places = {"points": np.array([[11.0, 21.0], [15.5, 25.0], [-3.0, 40.0]])}
    return {
        "load_run": Call(uj.load_run, {"path": folder / "runs" / "brief"}),
        "load_spec": Call(load_spec, {"path": folder / "brief.toml"}),
        "parse_spec": Call(
            parse_spec, {"tables": toy_study()}, {"folder": folder, "where": "the study"}
        ),
        "run_study": Call(
            run_study,
            {"study": spec},
            {"out": folder / "runs", "devices": 1, "listener": Silent()},
        ),
        "register_mission": Call(
            uj.register_mission, {"kind": "toy_again", "mission": ToyMission()}
        ),
        "use_all_cores": Call(uj.use_all_cores, {}, {"count": 2}),
        "find_map": Call(find_map, {"name": "hongze-1000"}),
        "packaged_names": Call(packaged_names, {}),
        "GridMap": Call(
            GridMap,
            {"blocked": blocked},
            {"cell_size": 2.0, "origin": (1.0, 2.0), "name": "pond", "attribution": "survey"},
        ),
        "GridMap.cells_of": Call(pond.cells_of, places),
        "GridMap.is_blocked": Call(pond.is_blocked, places),
        "GridMap.points_of": Call(pond.points_of, {"cells": np.array([[0, 0], [3, 2], [-1, 9]])}),
        "GridMap.inflated": Call(pond.inflated, {"radius_m": 3.0}),
        "GridMap.expanded": Call(pond.expanded, {"expansion": 0.5}),
        "GridMap.refined": Call(pond.refined, {"factor": 3}),
        "GridMap.clearance": Call(pond.clearance, {}),
        "GridMap.components": Call(pond.components, {}),
        "GridMap.largest_component": Call(pond.largest_component, {}),
        "GridMap.__eq__": Call(partial(GridMap.__eq__, pond), {"other": pond}),
    }
