"""Paths before and after smoothing, scene by scene."""

from typing import Any

import numpy as np

from experiments.estimates import mean, rank_p, share, spread
from experiments.runs import Columns, Found
from experiments.wei2023.mission import MEASURES, STAGES
from experiments.wei2023.published import AFTER, BEFORE, COLLISION_RADIUS
from experiments.wei2023.runs import FITTED, KINDS, SEARCHES, study_of

SHOWN = "euclidean"
WINDOW = 3
"""By how many turning points a path may differ from the paper's and count as one like it."""
_ALIKE = 1e-5


def measure(found: Found) -> dict[str, Any]:
    """All tables: kind of scenes, then search, then stage."""

    def columns(kind: str, search: str) -> Columns:
        return found.studies[study_of(search)].columns(kind, search)

    shown = columns(FITTED, SHOWN)
    job = nearest(shown)
    return {
        "scenes": found.studies["batched"].spec.episodes,
        "tables": {
            kind: {search: compare(columns(kind, search)) for search in SEARCHES} for kind in KINDS
        },
        "as_many": as_many(shown),
        "shown": {
            "scene": job,
            "stages": {
                stage: {name: float(shown[f"{name}_{stage}"][job]) for name in MEASURES}
                for stage in STAGES
            },
        },
    }


def compare(own: Columns) -> dict[str, Any]:
    """Compare every stage with the path before.

    Returns:
        Number of scenes; per stage the spread of every measure over scenes and its paired
        difference; the p of the rank of the published turns among ours; the share of scenes with
        fewer turns, a longer path, less clearance, and less clearance than the collision radius.
    """
    stages = {}
    for stage in STAGES:
        pairs = {name: (own[f"{name}_{stage}"], own[f"{name}_before"]) for name in MEASURES}
        stages[stage] = _stage(pairs, BEFORE if stage == "before" else AFTER)
    return {"n": len(own["turns_before"]), "stages": stages}


def _stage(pairs: dict[str, tuple[np.ndarray, np.ndarray]], published: int) -> dict[str, Any]:
    """Of each measure, the values now and before, and the turns that the paper has now."""
    turns, old_turns = pairs["turns"]
    length, old_length = pairs["length"]
    clear, old_clear = pairs["clearance"]
    return {
        "spread": {name: spread(new) for name, (new, _) in pairs.items()},
        "difference": {name: mean(new - old) for name, (new, old) in pairs.items()},
        "rank_p": rank_p(turns, published),
        "fewer_turns": share(turns < old_turns),
        "longer": share(length > old_length * (1 + _ALIKE)),
        "closer": share(clear < old_clear - _ALIKE),
        "too_close": share(clear < COLLISION_RADIUS),
        "as_published": share(turns <= AFTER),
    }


def nearest(own: Columns) -> int:
    """Choose the scene whose path before has as many turns as the paper's, or nearly; first."""
    return int(np.abs(own["turns_before"] - BEFORE).argmin())


def as_many(own: Columns) -> dict[str, Any]:
    """What becomes of paths with about the published number of turns.

    Returns:
        Number of such paths, and of those with at most the published number afterwards.
    """
    same = np.abs(own["turns_before"] - BEFORE) <= WINDOW
    return {"n": int(same.sum()), "after": int((own["turns_keys"][same] <= AFTER).sum())}
