"""Paths before and after smoothing, scene by scene."""

from dataclasses import asdict
from typing import Any

import numpy as np

from experiments.wei2023.paths import STAGES, Measured, Stages
from experiments.wei2023.published import AFTER, BEFORE, COLLISION_RADIUS
from usvjax.study.statistics import paired_difference, wilson

LEVEL = 0.95
METRICS = ("turns", "points", "turning", "length", "clearance")
WINDOW = 3
"""By how many turning points a path may differ from the paper's and count as one like it."""
_ALIKE = 1e-5


def compare(stages: Stages) -> dict[str, Any]:
    """Compare every stage with the path before.

    Returns:
        Number of scenes; per stage the spread of every metric over scenes and its paired
        difference; the share of scenes with fewer turns, a longer path, less clearance, and
        less clearance than the collision radius.
    """
    old = stages["before"]
    return {
        "n": len(old.turns),
        "stages": {stage: _stage(stages[stage], old) for stage in STAGES},
    }


def _stage(new: Measured, old: Measured) -> dict[str, Any]:
    columns = {name: (getattr(new, name), getattr(old, name)) for name in METRICS}
    return {
        "spread": {name: _spread(values) for name, (values, _) in columns.items()},
        "difference": {
            name: asdict(paired_difference(*pair, LEVEL).mean) for name, pair in columns.items()
        },
        "fewer_turns": _share(new.turns < old.turns),
        "longer": _share(new.length > old.length * (1 + _ALIKE)),
        "closer": _share(new.clearance < old.clearance - _ALIKE),
        "too_close": _share(new.clearance < COLLISION_RADIUS),
        "as_published": _share(new.turns <= AFTER),
    }


def nearest(stages: Stages) -> int:
    """Choose the scene whose path before has as many turns as the paper's, or nearly; first."""
    return int(np.abs(stages["before"].turns - BEFORE).argmin())


def as_many(stages: Stages) -> dict[str, Any]:
    """What becomes of paths with about the published number of turns.

    Returns:
        Number of such paths, and of those with at most the published number afterwards.
    """
    same = np.abs(stages["before"].turns - BEFORE) <= WINDOW
    after = stages["key points"].turns[same]
    return {"n": int(same.sum()), "after": int((after <= AFTER).sum())}


def _share(which: np.ndarray) -> dict[str, Any]:
    return asdict(wilson(int(which.sum()), len(which), LEVEL))


def _spread(values: np.ndarray) -> dict[str, float]:
    low, high = np.quantile(values, [0.025, 0.975])
    return {"value": float(values.mean()), "low": float(low), "high": float(high)}
