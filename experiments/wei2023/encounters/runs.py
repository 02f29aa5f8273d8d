"""Which encounters are sailed."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import jax
import numpy as np

import usvjax as uj
from experiments.runs import Call, Run, Study
from usvjax.missions.fleet.params import STRATEGIES
from usvjax.missions.fleet.run import navigate
from usvjax.missions.fleet.scenes import ENCOUNTERS
from usvjax.missions.fleet.situations import HEADINGS, imazu
from usvjax.registry import register_mission
from usvjax.units import KNOT, NAUTICAL_MILE

KIND = "wei2023_encounters"
register_mission(KIND, "experiments.wei2023.encounters.mission:MISSION")

SEED = 2023
SHARD = 834
"""Episodes; the sizes below are such that studies have calls of few sizes, each compiled anew."""
EACH = 4 * SHARD
"""Random encounters of each type."""
WATCHED = 700
"""So many of each type are recorded and judged by the rules."""
CLOSE = SHARD
"""Encounters for each least time of first sight, of any type."""
DUELS = 100
"""Encounters of each kind on a collision course."""

SIGHTS = (180, 120, 90, 60, 45, 30, 15)
"""s, least time from first sight to the closest point."""
LEAST_ROOM = 2.0
"""Of hull radii and stopping distances, what there is at first sight at any rate."""

HULLS = {"hulls 0.125 nm": 0.125 * NAUTICAL_MILE, "hulls 50 m": 50.0}
"""m: half the printed collision radius each; or far smaller ones, as Figs. 13 to 18 draw them."""
SPEEDS = {
    "same speed": [20 * KNOT * (1 - 1e-6), 20 * KNOT],
    "10 to 20 kn": [10 * KNOT, 20 * KNOT],
}
FIGURES = {"head-on": ("Fig. 13", "Fig. 14"), "crossing": ("Fig. 15", "Fig. 16")}
"""Of the paper, without and with coordination."""
DUEL_SCENES: dict[str, dict[str, Any]] = {
    f"{kind}, {hulls}, {speeds}": {
        "encounter": kind,
        "hulls": [radius, radius],
        "speeds": range_of_speeds,
        "largest_dcpa": 0.0,
    }
    for kind in FIGURES
    for hulls, radius in HULLS.items()
    for speeds, range_of_speeds in SPEEDS.items()
}
"""On a collision course, with the printed kinematics."""

ALONE = {"none": "the dynamic window", "orca": "reciprocal velocities"}
"""How own ship keeps clear of others that do not act; the window does so in every other strategy,
as coordination and the rules have nobody to agree with."""

EQUALS = {"first": "the first goes", "both_yield": "both yield"}
THRESHOLDS = (0.25, 0.5, 1.0)
"""nm, between guidance points that meet."""
CLEARANCES = {"guide": "", "printed": ", dist as printed"}
"""How far clearance scores, as of `FleetStatic`; the first is ours."""


def reading(equal: str, miles: float, clearance: str = "guide") -> str:
    """Words for a way to read the coordination."""
    return f"equal angles: {EQUALS[equal]}, {miles:g} nm{CLEARANCES[clearance]}"


READINGS: dict[str, dict[str, Any]] = {
    reading(equal, miles, clearance): {
        "static": {"equal": equal, "clearance": clearance},
        "params": {"threshold": miles * NAUTICAL_MILE},
    }
    for clearance in CLEARANCES
    for equal in EQUALS
    for miles in THRESHOLDS
}


def label(scene: str, words: str) -> str:
    """Of a kind of duels under a reading."""
    return f"{scene}; {words}"


def runs(options: Any) -> dict[str, Run]:
    """All encounters by every strategy."""
    kinds = {kind: {"scenes": {"encounter": kind}} for kind in ENCOUNTERS}
    sights = {
        f"{least} s": {
            "scenes": {"encounter": "any", "least_tcpa": float(least), "least_room": LEAST_ROOM}
        }
        for least in SIGHTS
    }
    duels = {name: {"scenes": scene} for name, scene in DUEL_SCENES.items()}
    readings = {
        label(name, words): {"scenes": scene, **own}
        for name, scene in DUEL_SCENES.items()
        for words, own in READINGS.items()
    }
    others = [name for name in STRATEGIES if name != "wei2023"]
    return {
        "kinds": _study("kinds", "fleet", kinds, EACH),
        "watched": _study("watched", KIND, kinds, WATCHED),
        "sights": _study("sights", "fleet", sights, CLOSE),
        "duels": _study("duels", KIND, duels, DUELS, others),
        "readings": _study("readings", KIND, readings, DUELS, ["wei2023"]),
        "imazu": Call(_imazu, (len(STRATEGIES) + len(ALONE)) * len(HEADINGS)),
    }


def _study(
    name: str,
    kind: str,
    conditions: Mapping[str, Mapping[str, Any]],
    episodes: int,
    methods: list[str] | None = None,
) -> Study:
    return Study(
        {
            "name": name,
            "kind": kind,
            "seed": SEED,
            "episodes": episodes,
            "shard": SHARD,
            "methods": methods or sorted(STRATEGIES),
            "conditions": [{"label": words, **own} for words, own in conditions.items()],
        }
    )


def _imazu(advance: Callable[[int], object]) -> dict[str, dict[str, dict[str, np.ndarray]]]:
    """Imazu's situations: all vessels by a strategy, and own ship alone where nobody else acts.

    Returns:
        "all" by strategy and "alone" by that of own ship: "status" int[22] and "least" float[22],
        m between hulls.
    """
    found: dict[str, dict[str, dict[str, np.ndarray]]] = {"all": {}, "alone": {}}
    # Each device would compile for itself.
    with jax.default_device(jax.local_devices()[0]):
        for who, sail, strategies in (
            ("all", _together, STRATEGIES),
            ("alone", _alone, tuple(ALONE)),
        ):
            for strategy in strategies:
                found[who][strategy] = sail(strategy)
                advance(len(HEADINGS))
    return found


def _together(strategy: str) -> dict[str, np.ndarray]:
    met = imazu()
    found = navigate(
        None,
        met.starts,
        met.goals,
        valid=met.valid,
        speeds=met.speeds,
        encounters=strategy,
        params=met.params,
    )
    return {"status": found.status, "least": found.min_separation}


def _alone(strategy: str) -> dict[str, np.ndarray]:
    met = imazu()
    hull = met.params.hull_radius
    found = navigate(
        met.starts[:, 1:, :2],
        met.starts[:, :1],
        met.goals[:, :1],
        speeds=met.speeds[:, :1],
        velocities=met.velocities[:, 1:],
        encounters=strategy,
        params=replace(met.params, v_max=met.speeds[0, 0], obstacle_radius=hull),
        static=uj.FleetStatic(max_steps=2000),
    )
    return {"status": found.status, "least": found.min_clearance[:, 0]}
