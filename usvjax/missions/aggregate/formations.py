"""Formations, and which vessel takes which of their slots."""

from math import ceil, pi, sin
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from usvjax.checks import float_array, one_of, positive
from usvjax.errors import BadInputError
from usvjax.maps.sensed import MOST_REMOTE
from usvjax.memory import check_memory

FORMATIONS = ("wedge", "line", "column", "circle")
ASSIGNMENTS = ("hungarian", "nearest", "given")

MOST_SLOTS = 1024
"""Of a formation of one's own."""

BYTES = 40
"""Of memory that a vessel's distance to a slot takes while it is measured."""


def slots_of(formation: Any, n: int, spacing: np.ndarray) -> np.ndarray:
    """Slots in the frames of formations, float64[B, S, 2]: m ahead of the centre and to port.

    Args:
        formation: "wedge" (a leader, the others abaft it to both sides, 45 deg), "line" (abreast),
            "column" (in line ahead), "circle", or float[S, 2], slots of one's own.
        n: vessels.
        spacing: float64[B], between neighbouring slots (m).

    Raises:
        BadTypeError, BadInputError: no such formation, or fewer slots than vessels.
    """
    if not isinstance(formation, str):
        slots = float_array("formation", formation, (None, 2), MOST_REMOTE)
        if not n <= len(slots) <= MOST_SLOTS:
            raise BadInputError(
                f"formation: got {len(slots):,} slots; wanted at least {n}, one per vessel, and at "
                f"most {MOST_SLOTS:,}"
            )
        return np.broadcast_to(slots, (len(spacing), *slots.shape))
    one_of("formation", formation, FORMATIONS)
    return spacing[:, None, None] * _unit_slots(formation, n)


def check_spacing(spacing: Any) -> float:
    """A distance between slots (m) that single precision can hold."""
    found = positive("spacing", spacing)
    if found > MOST_REMOTE:
        raise BadInputError(f"spacing: got {found:g} m; wanted at most {MOST_REMOTE:g} m")
    return found


def _unit_slots(formation: str, n: int) -> np.ndarray:
    """Slots of n vessels at a spacing of 1, float64[n, 2]."""
    place = np.arange(n) - (n - 1) / 2
    if formation == "line":
        return np.stack([np.zeros(n), -place], axis=1)
    if formation == "column":
        return np.stack([-place, np.zeros(n)], axis=1)
    if formation == "circle":
        radius = 0.0 if n == 1 else 1 / (2 * sin(pi / n))
        angle = 2 * pi * np.arange(n) / n
        return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    rank = np.array([ceil(i / 2) for i in range(n)])
    side = np.array([0 if i == 0 else 1 - 2 * (i % 2) for i in range(n)])
    slots = np.sqrt(0.5) * np.stack([-rank, side * rank], axis=1)
    centred: np.ndarray = slots - slots.mean(axis=0)
    return centred


def placed(slots: np.ndarray, centre: np.ndarray, heading: np.ndarray) -> np.ndarray:
    """Slots in the world, float64[B, S, 2] (m).

    Args:
        slots: float64[B, S, 2], ahead and to port (m).
        centre: float64[B, 2] (m).
        heading: float64[B] (rad).
    """
    cos, sin_ = np.cos(heading)[:, None], np.sin(heading)[:, None]
    ahead, port = slots[..., 0], slots[..., 1]
    east, north = cos * ahead - sin_ * port, sin_ * ahead + cos * port
    return np.stack([east, north], axis=-1) + centre[:, None]


def check_tight(slots: np.ndarray, hull: np.ndarray) -> None:
    """Refuse slots that hulls do not fit into side by side.

    Args:
        slots: float64[B, S, 2] (m), of one shape in all fleets.
        hull: float64[B, n] (m).
    """
    if hull.shape[1] < 2:
        return
    largest = np.sort(hull, axis=1)[:, -2:].sum(axis=1)
    size = np.maximum(np.abs(slots).max(axis=(1, 2)), 1e-300)
    tightest = int(np.argmax(largest / size))
    own, need = slots[tightest], largest[tightest]
    apart = np.linalg.norm(own[:, None] - own, axis=-1)
    near = np.argwhere(np.triu(apart < need, 1))
    if len(near):
        i, j = (int(k) for k in near[0])
        raise BadInputError(
            f"formation: slots {i} and {j} are {apart[i, j]:g} m apart; wanted at least "
            f"{need:g} m, the hulls of two vessels: a larger spacing"
        )


def assigned(how: str, start: np.ndarray, slots: np.ndarray, present: np.ndarray) -> np.ndarray:
    """Which slot each vessel takes, int32[B, n].

    Args:
        how: "hungarian" (the least sum of straight distances), "nearest" (pair by pair, of all the
            nearest first), or "given" (vessel i takes slot i).
        start: float64[B, n, 2] (m).
        slots: float64[B, S, 2] (m), at least n.
        present: bool[B, n]; who is absent takes what is left.
    """
    one_of("assignment", how, ASSIGNMENTS)
    fleets, n = start.shape[:2]
    if how == "given":
        return np.broadcast_to(np.arange(n, dtype=np.int32), (fleets, n)).copy()
    what = f"assignment: {fleets:,} fleets of {n} vessels to {slots.shape[1]:,} slots"
    check_memory(BYTES * fleets * n * slots.shape[1], what)
    apart = np.linalg.norm(start[:, :, None] - slots[:, None], axis=-1)
    apart[~present] = apart.max() + 1.0
    if how == "hungarian":
        return np.array([linear_sum_assignment(own)[1] for own in apart], np.int32)
    slot = np.zeros((fleets, n), np.int32)
    row = np.arange(fleets)
    for _ in range(n):
        vessel, taken = np.unravel_index(apart.reshape(fleets, -1).argmin(axis=1), apart.shape[1:])
        slot[row, vessel] = taken
        apart[row, vessel], apart[row, :, taken] = np.inf, np.inf
    return slot
