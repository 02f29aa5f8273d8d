"""Each heuristic against the traditional ones on the same maps."""

from dataclasses import asdict
from typing import Any

import numpy as np

from experiments.estimates import LEVEL, ratio, share
from experiments.runs import Columns, Found, Ran
from experiments.yu2022.heuristic.mission import TRADITIONAL, UNIT
from experiments.yu2022.heuristic.published import GOAL, TIED
from usvjax.statistics import averages
from usvkernels.status import Status

COST = {TRADITIONAL: "length", UNIT: "moves"}
"""Traditional heuristics, and what their paths are shortest in."""
NEW = ("octile", "weighted", "weighted_octile")
_ALIKE = 1e-6
_SEED = 0  # of the bootstrap
VESSELS = ("A1", "B2")
"""Where it may be in Figs. 3 and 4: the nodes above row C from which the nodes that the text has
tied, and no others of their rows, are."""


def measure(found: Found) -> dict[str, Any]:
    """All tables."""
    plans, episodes = found.studies["plans"], found.studies["episodes"]
    first = plans.spec.conditions[0].label
    shown = {name: plans.columns(first, name) for name in plans.spec.methods}
    return {
        "maps": plans.spec.episodes,
        "plans": _by_label(plans, first_plans),
        "episodes": _by_label(episodes, whole_episodes),
        "shown": {
            "condition": first,
            "heuristics": {
                name: {"expanded": int(own["first"][0]), "length": float(own["length"][0])}
                for name, own in shown.items()
            },
        },
        "layers": {
            vessel: {name: layers(name, vessel) for name in (TRADITIONAL, *NEW)}
            for vessel in VESSELS
        },
    }


def _by_label(ran: Ran, compared: Any) -> dict[str, Any]:
    labels = [condition.label for condition in ran.spec.conditions]
    return {
        label: compared({name: ran.columns(label, name) for name in ran.spec.methods})
        for label in labels
    }


def first_plans(sailed: dict[str, Columns]) -> dict[str, Any]:
    """Compare the first plans on maps that do not change; a row per heuristic.

    The lengths are ratios to the shortest, which the traditional heuristic finds: it never
    overestimates. Below "against" each is compared with either of the traditional ones.
    """
    reached = _all_reached(sailed)
    best = sailed[TRADITIONAL]["length"]
    rows = {}
    for heuristic, own in sailed.items():
        excess = (own["length"] / best)[reached]
        rows[heuristic] = {
            "expanded": _mean(own["first"][reached]),
            "length_ratio": _mean(excess),
            "longest_ratio": float(excess.max()) if len(excess) else None,
            "against": {name: _against(own, sailed[name], COST[name], reached) for name in COST},
        }
    return {"n": int(reached.sum()), "heuristics": rows}


def _against(own: Columns, old: Columns, cost: str, reached: np.ndarray) -> dict[str, Any]:
    return {
        "times": ratio(own["first"][reached], old["first"][reached]),
        "as_short": share((own[cost] < old[cost] * (1.0 + _ALIKE))[reached]),
        "same_cells": share((own["path"] == old["path"])[reached]),
    }


def whole_episodes(sailed: dict[str, Columns]) -> dict[str, Any]:
    """Compare whole episodes on maps that change; a row per heuristic.

    Expansions and lengths are compared where the vessel arrives with every heuristic.
    """
    reached = _all_reached(sailed)
    old = sailed[TRADITIONAL]
    rows = {
        heuristic: {
            "reached": share(own["status"] == int(Status.REACHED)),
            "out_of_budget": share(own["status"] == int(Status.OUT_OF_BUDGET)),
            "expanded": _mean(own["expanded"][reached]),
            "times": ratio(own["expanded"][reached], old["expanded"][reached]),
            "replanning": _mean((own["expanded"] - own["first"])[reached]),
            "length_ratio": _mean((own["length"] / old["length"])[reached]),
        }
        for heuristic, own in sailed.items()
    }
    return {"n": int(reached.sum()), "heuristics": rows}


def _all_reached(sailed: dict[str, Columns]) -> np.ndarray:
    reached: np.ndarray = np.logical_and.reduce(
        [own["status"] == int(Status.REACHED) for own in sailed.values()]
    )
    return reached


def _mean(values: np.ndarray) -> dict[str, Any]:
    """Mean with its bootstrap interval: expansions are skewed."""
    return asdict(averages(values[:, None].astype(float), LEVEL, [_SEED])[0].mean)


# --- Figs. 3 and 4 ----------------------------------------------------------------------------


def layers(heuristic: str, vessel: str) -> list[int]:
    """How many of the nodes that Fig. 3 has tied hold the least key, row by row from the goal.

    With the chess-board distance a diagonal step costs 1, as those ties want it; with the others
    the square root of 2.
    """
    diagonal = 1.0 if heuristic == TRADITIONAL else 2.0**0.5
    known = {node_at(GOAL): 0.0}
    counts = []
    for row in TIED:
        nodes = [node_at(name) for name in row]
        cost = {node: min(_steps(known, node, diagonal), default=np.inf) for node in nodes}
        keys = [cost[node] + _ahead(heuristic, node, node_at(vessel)) for node in nodes]
        least = [node for node, key in zip(nodes, keys, strict=True) if key < min(keys) + _ALIKE]
        known = {node: cost[node] for node in least}
        counts.append(len(least))
    return counts


def node_at(name: str) -> tuple[int, int]:
    """Column and row of a node such as "E3"."""
    return int(name[1:]), ord(name[0]) - ord("A")


def _steps(known: dict[tuple[int, int], float], node: tuple[int, int], diagonal: float) -> Any:
    for (x, y), cost in known.items():
        apart = abs(x - node[0]), abs(y - node[1])
        if max(apart) == 1:
            yield cost + (diagonal if min(apart) else 1.0)


def _ahead(heuristic: str, node: tuple[int, int], vessel: tuple[int, int]) -> float:
    """The heuristic of a node, in cells; as printed, where the planner's are whole numbers."""
    (x, y), (goal_x, goal_y) = vessel, node_at(GOAL)
    across, along = sorted((abs(node[0] - x), abs(node[1] - y)))
    if heuristic == TRADITIONAL:
        return along
    octile = 2.0**0.5 * across + along - across
    weight = 1.0 + np.hypot(across, along) / np.hypot(goal_x - x, goal_y - y)
    return {
        "octile": octile,
        "weighted_octile": weight * octile,
        "weighted": weight * (octile + 2 * across),
    }[heuristic]
