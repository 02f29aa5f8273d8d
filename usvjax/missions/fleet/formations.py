"""Formations, and which vessel takes which of their slots."""

from itertools import combinations
from math import ceil, pi, sin
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from usvjax.checks import float_array, one_of, positive
from usvjax.errors import BadInputError

FORMATIONS = ("wedge", "line", "column", "circle")
ASSIGNMENTS = ("hungarian", "nearest", "given")


def slots_of(formation: Any, n: int, spacing: float) -> np.ndarray:
    """Slots in the frame of the formation, float64[S, 2]: m ahead of its centre and to port.

    Args:
        formation: "wedge" (a leader, the others abaft it to both sides, 45 deg), "line" (abreast),
            "column" (in line ahead), "circle", or float[S, 2], slots of one's own.
        n: vessels.
        spacing: between neighbouring slots (m).

    Raises:
        BadTypeError, BadInputError: no such formation, or fewer slots than vessels.
    """
    if not isinstance(formation, str):
        slots = float_array("formation", formation, (None, 2))
        if len(slots) < n:
            raise BadInputError(f"formation: got {len(slots)} slots; wanted {n}, one per vessel")
        return slots
    one_of("formation", formation, FORMATIONS)
    spacing = positive("spacing", spacing)
    place = np.arange(n) - (n - 1) / 2
    if formation == "line":
        return np.stack([np.zeros(n), -spacing * place], axis=1)
    if formation == "column":
        return np.stack([-spacing * place, np.zeros(n)], axis=1)
    if formation == "circle":
        radius = 0.0 if n == 1 else spacing / (2 * sin(pi / n))
        angle = 2 * pi * np.arange(n) / n
        return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    rank = np.array([ceil(i / 2) for i in range(n)])
    side = np.array([0 if i == 0 else 1 - 2 * (i % 2) for i in range(n)])
    slots = spacing * np.sqrt(0.5) * np.stack([-rank, side * rank], axis=1)
    centred: np.ndarray = slots - slots.mean(axis=0)
    return centred


def placed(slots: np.ndarray, centre: np.ndarray, heading: np.ndarray) -> np.ndarray:
    """Slots in the world, float64[B, S, 2] (m).

    Args:
        slots: float64[S, 2], ahead and to port (m).
        centre: float64[B, 2] (m).
        heading: float64[B] (rad).
    """
    cos, sin_ = np.cos(heading)[:, None], np.sin(heading)[:, None]
    ahead, port = slots[:, 0], slots[:, 1]
    east, north = cos * ahead - sin_ * port, sin_ * ahead + cos * port
    return np.stack([east, north], axis=-1) + centre[:, None]


def check_tight(slots: np.ndarray, hull: np.ndarray) -> None:
    """Refuse slots that hulls, float64[B, n] (m), do not fit into side by side."""
    largest = np.sort(hull, axis=1)[:, ::-1][:, :2].sum(axis=1).max() if hull.shape[1] > 1 else 0.0
    for i, j in combinations(range(len(slots)), 2):
        apart = float(np.hypot(*(slots[i] - slots[j])))
        if apart < largest:
            raise BadInputError(
                f"formation: slots {i} and {j} are {apart:g} m apart; wanted at least "
                f"{largest:g} m, the hulls of two vessels: a larger spacing"
            )


def assigned(how: str, start: np.ndarray, slots: np.ndarray) -> np.ndarray:
    """Which slot each vessel takes, int32[B, n].

    Args:
        how: "hungarian" (the least sum of straight distances), "nearest" (pair by pair, of all the
            nearest first), or "given" (vessel i takes slot i).
        start: float64[B, n, 2] (m).
        slots: float64[B, S, 2] (m), at least n.
    """
    one_of("assignment", how, ASSIGNMENTS)
    fleets, n = start.shape[:2]
    if how == "given":
        return np.broadcast_to(np.arange(n, dtype=np.int32), (fleets, n)).copy()
    apart = np.linalg.norm(start[:, :, None] - slots[:, None], axis=-1)
    if how == "hungarian":
        return np.array([linear_sum_assignment(own)[1] for own in apart], np.int32)
    slot = np.zeros((fleets, n), np.int32)
    row = np.arange(fleets)
    for _ in range(n):
        vessel, taken = np.unravel_index(apart.reshape(fleets, -1).argmin(axis=1), apart.shape[1:])
        slot[row, vessel] = taken
        apart[row, vessel], apart[row, :, taken] = np.inf, np.inf
    return slot
