"""What became of the encounters, by kind and strategy."""

from typing import Any

import jax
import numpy as np

from experiments.estimates import difference, mean, share
from experiments.runs import Columns, Found, Ran
from experiments.wei2023.encounters.runs import (
    DUEL_SCENES,
    READINGS,
    SIGHTS,
    label,
)
from usvjax.missions.fleet.params import STRATEGIES
from usvjax.missions.fleet.scenes import ENCOUNTERS
from usvjax.missions.fleet.situations import HEADINGS
from usvkernels.status import Status

OTHERS = ("rules", "orca")
"""What the paper's coordination is compared with."""


def measure(found: Found) -> dict[str, Any]:
    """All tables: the study, then the kind of encounter, then the strategy."""
    studies = found.studies
    return {
        "kinds": _by_strategy(studies["kinds"], ENCOUNTERS, sailed),
        "watched": _by_strategy(studies["watched"], ENCOUNTERS, watched),
        "sights": _by_strategy(studies["sights"], [f"{least} s" for least in SIGHTS], sailed),
        "duels": {
            scene: {name: duel(studies["duels"].columns(scene, name)) for name in ("none", *OTHERS)}
            for scene in DUEL_SCENES
        },
        "readings": {
            scene: {words: _reading(found, scene, words) for words in READINGS}
            for scene in DUEL_SCENES
        },
        "imazu": jax.tree.map(np.ndarray.tolist, found.made["imazu"]),
        "others": {str(number): list(own) for number, own in HEADINGS.items()},
    }


def _by_strategy(ran: Ran, kinds: Any, of: Any) -> dict[str, Any]:
    return {kind: {name: of(ran.columns(kind, name)) for name in STRATEGIES} for kind in kinds}


def sailed(own: Columns) -> dict[str, Any]:
    """How encounters ended, and what those that arrived took beyond sailing alone."""
    reached = own["status"] == int(Status.REACHED)
    return {
        "n": len(reached),
        "collided": share(own["status"] == int(Status.COLLIDED)),
        "reached": share(reached),
        "extra_distance": mean(own["extra_distance"][reached]),
        "delay": mean(own["delay"][reached]),
        "least": float(own["min_separation"].min()),
        "median_least": float(np.median(own["min_separation"])),
    }


def watched(own: Columns) -> dict[str, Any]:
    """What an observer noted of those that would have passed too close."""
    meets = own["meets"] > 0
    return {"n": len(meets), "meets": int(meets.sum()), "kept": share(own["kept"][meets] > 0)}


def duel(own: Columns) -> dict[str, Any]:
    """Of vessels on a collision course."""
    return sailed(own) | {"turned": mean(own["turned"]), "slowed": share(own["slowed"] > 0.1)}


def _reading(found: Found, scene: str, words: str) -> dict[str, Any]:
    """Of the coordination, and how much more way than by other strategies, encounter by encounter.

    The differences are over those that arrive by both, percentage points of the route.
    """
    own = found.studies["readings"].columns(label(scene, words), "wei2023")
    table = duel(own)
    for name in OTHERS:
        other = found.studies["duels"].columns(scene, name)
        both = (own["status"] == int(Status.REACHED)) & (other["status"] == int(Status.REACHED))
        more = own["extra_distance"][both] - other["extra_distance"][both]
        table[f"more_than_{name}"] = difference(more) | {"n": int(both.sum())}
    return table
