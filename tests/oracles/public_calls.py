"""A small, valid call of every public function, for tests that ask something of all of them."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

import usvjax as uj


@dataclass(frozen=True)
class Call:
    """A function and arguments that it takes.

    Attributes:
        function: exported by `usvjax`.
        needed: arguments without default, by name.
        options: others worth varying, by name.
    """

    function: Callable[..., Any]
    needed: dict[str, Any]
    options: dict[str, Any] = field(default_factory=dict)

    @property
    def arguments(self) -> dict[str, Any]:
        return {**self.needed, **self.options}

    def __call__(self) -> Any:
        return self.function(**self.arguments)


def calls(folder: Path | None) -> dict[str, Call]:
    """By name.

    Args:
        folder: where maps are written to; None to have only the names.
    """
    maps = np.zeros((3, 8, 8), bool)
    maps[:, 3, 2:6] = True
    maps[1, 5, 1] = True
    paths = np.array([[[0, 0], [1, 1], [1, 4], [1, 4]], [[7, 7], [7, 6], [7, 5], [6, 4]]])
    stations = np.array([[0, 0], [7, 1], [6, 7], [1, 6]])
    flips = np.full((3, 6, 2, 2), -1)
    flips[0, 1, 0] = (2, 2)
    circles = np.array([[3.0, 3.2], [5.0, 7.0]])
    along = {"paths": paths, "lengths": np.array([3, 4]), "blocked": maps[0]}
    short = {name: along[name] for name in ("paths", "lengths")}
    brief = uj.DwaStatic(n_v=41, n_w=11, horizon=5, max_steps=40)
    fleet = {
        "scene": np.array([[0.0, 120.0], [90.0, 100.0]]),
        "starts": np.array([[[-40.0, 0.0, 0.0], [40.0, 0.0, 3.0]]]),
    }
    sailing = {
        "params": uj.FleetParams(
            v_max=45.0,
            v_step=0.5,
            w_step=0.1,
            hull_radius=3.0,
            obstacle_radius=5.0,
            stuck_time=5.0,
            livelock_time=20.0,
        ),
        "static": uj.FleetStatic(
            n_v=5,
            n_w=2,
            horizon=2,
            max_steps=2,
            unit_length=50.0,
            look_ahead=50.0,
            guide_length=50.0,
        ),
        "valid": np.array([[True, True]]),
        "environment": uj.Environment(uj.UniformCurrent((0.5, 0.2)), (1.0, 2.0)),
        "encounters": "rules",
        "record": False,
    }
    lake = uj.GridMap(maps[0], 2.0, (10.0, 20.0), "pond")
    if folder is None:
        folder = Path()
    else:
        uj.save_map(lake, folder / "pond.map")
    return {
        "astar": Call(
            uj.astar,
            {"blocked": maps, "starts": np.array([0, 0]), "goals": np.array([7, 7])},
            {
                "turn_cost": 0.5,
                "heuristic": "octile",
                "corner_cutting": False,
                "connectivity": 8,
                "weight": 1.0,
                "turn_mode": "exact",
                "max_expansions": 100,
                "on_blocked": "raise",
                "engine": "auto",
                "max_lanes": 16,
            },
        ),
        "astar_swept": Call(
            uj.astar, {"blocked": maps, "starts": np.array([0, 0]), "goals": np.array([7, 7])}
        ),
        "distance_field": Call(
            uj.distance_field,
            {"blocked": maps, "goals": np.array([[7, 7]])},
            {"corner_cutting": False, "connectivity": 8, "on_blocked": "raise"},
        ),
        "dstar_lite": Call(
            uj.dstar_lite,
            {"blocked": maps, "starts": [0, 0], "goals": [7, 7], "flips": flips},
            {
                "heuristic": "octile",
                "weight": None,
                "corner_cutting": False,
                "sensing": (5, 5),
                "on_blocked": "raise",
                "max_expansions": 1000,
                "max_lanes": 16,
            },
        ),
        "bspline": Call(uj.bspline, short, {"samples": 20, "cell_size": 2.0, "origin": (0.0, 1.0)}),
        "key_points": Call(uj.key_points, along, {"corner_cutting": False}),
        "shorten": Call(uj.shorten, along, {"corner_cutting": False}),
        "redensify": Call(
            uj.redensify, {**short, "unit": 0.5}, {"cell_size": 2.0, "origin": (0.0, 1.0)}
        ),
        "smooth_turns": Call(
            uj.smooth_turns,
            {**along, "turning_radius": 0.5},
            {
                "safety_range": 1.0,
                "cell_size": 1.0,
                "origin": (0.0, 0.0),
                "margin": 0.0,
                "spacing": 0.5,
                "corner_cutting": False,
                "repair": 1,
            },
        ),
        "track_paths": Call(
            uj.track_paths,
            {**short, "blocked": maps[0]},
            {
                "curvature": None,
                "params": uj.TrackParams(),
                "spacing": 0.5,
                "cell_size": 2.0,
                "origin": (0.0, 0.0),
            },
        ),
        "path_metrics": Call(
            uj.path_metrics,
            short,
            {
                "blocked": maps[0],
                "cell_size": 2.0,
                "origin": (0.0, 0.0),
                "turn_cost": 0.5,
                "energy_unit": 100.0,
                "tolerance": 1e-3,
                "clearance_limit": 5.0,
            },
        ),
        "plan_paths": Call(
            uj.plan_paths,
            {"blocked": maps, "starts": [0, 0], "goals": [7, 7], "key": 3},
            {
                "algorithm": "aco",
                "iterations": 2,
                "population": 8,
                "params": uj.planners.AcoParams(),
                "on_blocked": "raise",
            },
        ),
        "cruise": Call(
            uj.cruise,
            {"blocked": maps[0], "stations": stations, "key": 5},
            {
                "method": "dstar_lite",
                "heuristic": "octile",
                "weight": None,
                "planner_options": None,
                "order": None,
                "tour": "recommended",
                "params": uj.CruiseParams(),
                "static": uj.CruiseStatic(),
                "runs": 2,
                "first": 1,
                "cell_size": 10.0,
                "max_lanes": 16,
            },
        ),
        "random_maps": Call(
            uj.random_maps, {"key": 7, "n": 4}, {"shape": (9, 11), "density": 0.3, "first": 2}
        ),
        "expand_obstacles": Call(uj.expand_obstacles, {"blocked": maps[0], "expansion": 0.5}),
        "obstacle_table": Call(uj.obstacle_table, {"blocked": maps[0], "k": 4, "reach_cells": 3.0}),
        "hongze_lake": Call(uj.hongze_lake, {}, {"cell_size": 1000}),
        "load_map": Call(
            uj.load_map,
            {"path": folder / "pond.map"},
            {"cell_size": 3.0, "origin": (1.0, 2.0), "unknown": "blocked", "threshold": 0.5},
        ),
        "save_map": Call(
            uj.save_map, {"grid": lake, "path": folder / "saved.map"}, {"replace": True}
        ),
        "solve_tour": Call(
            uj.solve_tour,
            {"points": stations.astype(float)},
            {
                "key": 2,
                "algorithm": "ga",
                "distances": None,
                "closed": True,
                "runs": 3,
                "iterations": 3,
                "population": 8,
                "params": uj.tours.GaParams(),
                "static": None,
                "first": 1,
            },
        ),
        "optimal_tour": Call(
            uj.optimal_tour,
            {"points": stations.astype(float)},
            {"distances": None, "closed": False},
        ),
        "tour_length": Call(
            uj.tour_length,
            {"order": [0, 1, 2, 3], "points": stations.astype(float)},
            {"distances": None, "closed": True},
        ),
        "minimise": Call(
            uj.minimise,
            {"fn": sphere, "bounds": (-5.0, 5.0), "key": 4},
            {
                "algorithm": "gwo",
                "dim": 3,
                "runs": 3,
                "iterations": 4,
                "population": 6,
                "params": uj.swarms.GwoParams(),
                "static": uj.swarms.GwoStatic(),
                "dtype": "float32",
            },
        ),
        "navigate_dwa": Call(
            uj.navigate_dwa,
            {"obstacles": circles, "starts": [0.0, 0.0, 0.8], "goals": [[9.0, 9.0], [4.0, 6.0]]},
            {
                "params": uj.DwaParams(),
                "static": brief,
                "valid": np.array([True, True]),
                "record": False,
                "sensing_range": None,
                "max_lanes": 16,
            },
        ),
        "dwa_candidates": Call(
            uj.dwa_candidates,
            {"obstacles": circles, "state": [0.0, 0.0, 0.8, 0.2, 0.0], "goal": [9.0, 9.0]},
            {"params": uj.DwaParams(), "static": brief},
        ),
        "fit_window": Call(uj.fit_window, {"params": uj.DwaParams(), "static": uj.DwaStatic()}),
        "navigate": Call(
            uj.navigate,
            {**fleet, "goals": np.array([[[40.0, 30.0], [-40.0, 30.0]]])},
            {
                **sailing,
                "headings": np.array([[0.0, 3.0]]),
                "speeds": np.array([[1.0, 2.0]]),
            },
        ),
        "aggregate": Call(
            uj.aggregate,
            {**fleet, "centre": np.array([20.0, 40.0]), "heading": 0.5},
            {
                **sailing,
                "formation": "line",
                "spacing": 30.0,
                "assignment": "nearest",
                "hold_time": 5.0,
            },
        ),
        "meetings": Call(
            uj.meetings,
            {
                "trajectory": _courses(),
                "hull_radius": np.array([[3.0, 4.0]]),
                "passing": 10.0,
                "dt": 1.0,
            },
        ),
        "preset": Call(uj.preset, {"name": "lake"}, {"mission": "dwa"}),
        "preset_names": Call(uj.preset_names, {}, {"mission": "dwa"}),
    }


def _courses() -> np.ndarray:
    """Two vessels that meet, float[1, 9, 2, 5]."""
    time = np.arange(9.0)[:, None]
    x, psi = np.array([-20.0, 20.0]) + time * [5.0, -5.0], np.array([0.0, np.pi])
    still = np.zeros_like(x)
    return np.stack([x, still, still + psi, still + 5.0, still], axis=-1)[None]


def sphere(x: Any) -> Any:
    return (x * x).sum()


def digest(found: Any) -> str:
    """Of all arrays, numbers and names in a result, their types and shapes included."""
    made = hashlib.sha256()
    _feed(made, found)
    return made.hexdigest()[:16]


def _feed(made: Any, found: Any) -> None:
    if is_dataclass(found) and not isinstance(found, type):
        for one in fields(found):
            _feed(made, getattr(found, one.name))
    elif isinstance(found, list | tuple):
        for item in found:
            _feed(made, item)
    elif hasattr(found, "dtype"):
        array = np.asarray(found)
        made.update(f"{array.dtype}{array.shape}".encode())
        # Of text, the bytes of an array are where it lies.
        made.update(repr(array.tolist()).encode() if array.dtype == object else array.tobytes())
    else:
        made.update(repr(found).encode())
