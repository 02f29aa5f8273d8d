"""DWA's parameter sets: the papers', and those of demos that users know."""

from math import inf, radians
from typing import Any

from usvjax.missions.dwa.params import DwaParams, DwaStatic, fit_window
from usvjax.presets import Preset
from usvjax.units import KNOT, NAUTICAL_MILE


def _preset(params: DwaParams, source: str, **choices: Any) -> Preset:
    return Preset(params, fit_window(params, DwaStatic(**choices)), source)


PRESETS: dict[str, Preset] = {
    "tan2022": _preset(
        DwaParams(), "Tan et al. 2022, Table 1; control period, resolutions and caps not printed"
    ),
    "wei2023": _preset(
        DwaParams(
            v_min=0.0,
            v_max=20 * KNOT,
            w_min=-radians(15),
            w_max=radians(15),
            v_acc=2 * KNOT,
            v_dec=2 * KNOT,
            w_acc=radians(5),
            w_dec=radians(5),
            v_step=0.1 * KNOT,
            w_step=radians(1),
            heading_weight=0.1,
            clearance_weight=0.1,
            velocity_weight=0.7,
            # Table 2 prints 0.01 h = 36 s, in which 15 deg/s would turn the vessel by 540 deg.
            dt=1.0,
            clearance_cap=2 * 0.25 * NAUTICAL_MILE,
            clear_distance=2 * 0.25 * NAUTICAL_MILE,
            radius=0.25 * NAUTICAL_MILE,
            goal_tolerance=0.05 * NAUTICAL_MILE,
            stuck_distance=50.0,
            stuck_time=300.0,
        ),
        "Wei & Zhang 2023, Tables 1 and 2; control period 1 s, see docs/equations.md",
        horizon=120,
        max_steps=3600,
    ),
    "lake": _preset(
        DwaParams(
            v_min=0.0,
            v_max=5.0,
            w_min=-0.05,
            w_max=0.05,
            v_acc=0.1,
            v_dec=0.1,
            w_acc=0.01,
            w_dec=0.01,
            v_step=0.1,
            w_step=0.004,
            dt=2.0,
            clearance_cap=500.0,
            clear_distance=500.0,
            radius=150.0,
            goal_tolerance=100.0,
            stuck_distance=50.0,
            stuck_time=200.0,
        ),
        "a survey vessel of 5 m/s on a chart with cells up to 200 m; weights of Tan et al. 2022",
        max_steps=2000,
    ),
    "pythonrobotics": _preset(
        DwaParams(
            v_min=-0.5,
            v_max=1.0,
            w_min=-radians(40),
            w_max=radians(40),
            v_acc=0.2,
            v_dec=0.2,
            w_acc=radians(40),
            w_dec=radians(40),
            v_step=0.01,
            w_step=radians(0.1),
            heading_weight=0.15,
            clearance_weight=1.0,
            velocity_weight=1.0,
            dt=0.1,
            clearance_cap=inf,
            clear_distance=1e5,
            radius=1.0,
            goal_tolerance=1.0,
        ),
        "the dynamic window demo of PythonRobotics: a circular robot of 1 m among point obstacles",
        clearance="trajectory_and_start",
        clearance_score="reciprocal",
        normalise="none",
        braking=False,
        plant="heading_first",
    ),
}
