"""Each heuristic against the traditional one on the same maps."""

from dataclasses import asdict
from typing import Any

import numpy as np

from experiments.estimates import LEVEL, ratio, share
from experiments.yu2022.heuristic.plans import Replanned
from experiments.yu2022.heuristic.published import HEURISTICS, TRADITIONAL
from usvjax.statistics import averages
from usvkernels.status import Status

_ALIKE = 1e-6


def first_plans(sailed: dict[str, Replanned], seed: int) -> dict[str, Any]:
    """Compare the first plans on maps that do not change; a row per heuristic.

    The lengths are ratios to the shortest, which the traditional heuristic finds: it never
    overestimates.
    """
    reached = np.logical_and.reduce([own.reached for own in sailed.values()])
    old = sailed[TRADITIONAL]
    rows = {}
    for heuristic in HEURISTICS:
        own = sailed[heuristic]
        excess = own.length[reached] / old.length[reached]
        same_cells = (own.position == old.position).all(axis=(1, 2))[reached]
        rows[heuristic] = {
            "expanded": _mean(own.first[reached], seed),
            "times": ratio(own.first[reached], old.first[reached]),
            "length_ratio": _mean(excess, seed),
            "longest_ratio": float(excess.max()) if len(excess) else None,
            "same_length": share(np.abs(excess - 1.0) < _ALIKE),
            "same_cells": share(same_cells),
        }
    return {"n": int(reached.sum()), "heuristics": rows}


def episodes(sailed: dict[str, Replanned], seed: int) -> dict[str, Any]:
    """Compare whole episodes on maps that change; a row per heuristic.

    Expansions and lengths are compared where the vessel arrives with every heuristic.
    """
    reached = np.logical_and.reduce([own.reached for own in sailed.values()])
    old = sailed[TRADITIONAL]
    rows = {}
    for heuristic in HEURISTICS:
        own = sailed[heuristic]
        rows[heuristic] = {
            "reached": share(own.reached),
            "out_of_budget": share(own.status == int(Status.OUT_OF_BUDGET)),
            "expanded": _mean(own.expanded[reached], seed),
            "times": ratio(own.expanded[reached], old.expanded[reached]),
            "replanning": _mean((own.expanded - own.first)[reached], seed),
            "length_ratio": _mean(own.length[reached] / old.length[reached], seed),
        }
    return {"n": int(reached.sum()), "heuristics": rows}


def _mean(values: np.ndarray, seed: int) -> dict[str, Any]:
    """Mean with its bootstrap interval: expansions are skewed."""
    return asdict(averages(values[:, None].astype(float), LEVEL, [seed])[0].mean)
