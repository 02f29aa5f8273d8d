"""Episodes on Hongze Lake in which the dynamic window alone fails, sailed along routes."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.markdown import table, verdict
from benchmarks.timing import seconds_of
from usvjax.missions.fleet.params import FleetParams, FleetStatic
from usvjax.missions.fleet.run import FleetResult, navigate
from usvjax.study import load_spec
from usvkernels.status import Status

TITLE = "Hongze Lake: what the dynamic window alone does not reach, along routes"

STUDY = Path(__file__).parents[1] / "studies" / "hongze.toml"
EPISODES = 20_000
BAR = 0.95
STATIC = FleetStatic(n_v=5, n_w=11, max_steps=20_000)
"""Bounded by the longest ways round: 88 km at 5 m/s."""


def measure(quick: bool) -> dict[str, Any]:
    """Sail all episodes by the window, and those that fail along routes."""
    spec = load_spec(STUDY)
    posed = spec.mission.pose(
        spec.conditions[0].case, spec.seed, np.arange(2_000 if quick else EPISODES)
    )
    alone = spec.mission.run(posed, "traditional").columns["status"]
    fails = np.flatnonzero(alone != int(Status.REACHED))
    found: list[FleetResult] = []
    scenes, p = posed.scenes, posed.params
    # Circles about cells cover them: a hull is what the window keeps beyond.
    hull = float(p.radius) - scenes.obstacles.cell_size * math.sqrt(0.5)
    params = FleetParams(
        v_max=p.v_max,
        w_max=p.w_max,
        v_acc=p.v_acc,
        v_dec=p.v_dec,
        w_acc=p.w_acc,
        v_step=p.v_step,
        w_step=p.w_step,
        dt=p.dt,
        clearance_cap=p.clearance_cap,
        goal_tolerance=p.goal_tolerance,
        hull_radius=hull,
    )
    ends = scenes.starts[fails][:, None], scenes.goals[fails][:, None]
    seconds = seconds_of(
        lambda: found.append(navigate(scenes.obstacles, *ends, params=params, static=STATIC))
    )
    (r,) = found
    return {
        "episodes": len(alone),
        "fails": len(fails),
        "endings": {s.name: int(np.sum(r.vessel_status == int(s))) for s in Status},
        "arrive": float(np.mean(r.vessel_status == int(Status.REACHED))),
        "seconds": seconds,
        "over_route": float(np.median(r.path_length / r.route_length)),
        "longest": float(r.route_length.max()),
        "clearance": float(r.min_clearance.min()),
    }


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    endings = {name: count for name, count in found["endings"].items() if count}
    rows = [(name, count) for name, count in endings.items()]
    return "\n\n".join(
        [
            f"Of the {found['episodes']:,} episodes of 1 to 5 km of studies/hongze.toml "
            f"{found['fails']:,} end elsewhere than at the goal by the traditional dynamic window "
            "alone. The same starts and goals, on the same cells with the same vessel, by "
            "`uj.navigate`:",
            table(("ending", "episodes"), rows),
            f"Ways are {found['over_route']:.3f} of their routes (median; passages end within the "
            f"goal's tolerance), the longest {found['longest'] / 1e3:.0f} km round; the least room "
            f"between a hull and a cell's circle is {found['clearance']:.1f} m. "
            f"{found['seconds']:.0f} s, routes and compilation included.",
            verdict(
                f"at least {BAR:.0%} of them arrive: {found['arrive']:.2%}", found["arrive"] >= BAR
            ),
        ]
    )
