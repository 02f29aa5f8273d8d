"""Paths before and after smoothing, scene by scene."""

from typing import Any

import numpy as np

from experiments.estimates import mean, share, spread
from experiments.wei2023.paths import STAGES, Measured, Stages
from experiments.wei2023.published import AFTER, BEFORE, COLLISION_RADIUS

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
        "spread": {name: spread(values) for name, (values, _) in columns.items()},
        "difference": {name: mean(own - before) for name, (own, before) in columns.items()},
        "fewer_turns": share(new.turns < old.turns),
        "longer": share(new.length > old.length * (1 + _ALIKE)),
        "closer": share(new.clearance < old.clearance - _ALIKE),
        "too_close": share(new.clearance < COLLISION_RADIUS),
        "as_published": share(new.turns <= AFTER),
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
