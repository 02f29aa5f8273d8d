"""A table of the paper against all the tables that a reading would give: one test for all values.

A table's values hang together: one slow map makes its time long and its speed low. So whole tables
are drawn from our own episodes, and the printed one is compared with them by the value that lies
farthest from what is expected, in standard deviations of that value.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

ALPHA = 0.05
LEAST_MAPS = 60
"""On which both methods succeed: with fewer, the error would not be about `ALPHA` for values as
skewed as ours (in a simulation 7.7 % of true tables of single maps at 40, 5.7 % at 60)."""
MOST_MAPS = 1000
"""That are made use of; more tell nothing more."""
TABLES = 1000
"""Drawn."""


@dataclass(frozen=True)
class Values:
    """Some values of a table that rest on the same maps.

    Attributes:
        printed: float[k], what the paper prints.
        names: of them.
        ours: float[n, k], the same from each of our maps; above 0.
    """

    printed: np.ndarray
    names: Sequence[str]
    ours: np.ndarray


def table_test(groups: Sequence[Values], maps: int, unit: float) -> dict[str, Any] | None:
    """Put a printed table to the test.

    What we do not know of the expectation and of the spread counts as well: each drawn table is
    held against a resample of our maps, and the printed one against these maps themselves. By the
    largest deviation a true table is excluded with probability `ALPHA`.

    Args:
        groups: values that rest on the same maps together, those on other maps apart.
        maps: that each printed value is the average over.
        unit: of the last digit printed, to which drawn values are rounded.

    Returns:
        "p"; the value farthest off: "worst", its "printed" value and the mean of "ours"; "maps",
        the least number that a group rests on. None where that is below `LEAST_MAPS`.
    """
    least = min(len(group.ours) for group in groups)
    if least < LEAST_MAPS:
        return None
    rng = np.random.default_rng(len(groups))
    parts = [_deviations(group, maps, unit, rng) for group in groups]
    printed, drawn = (np.abs(np.concatenate([part[i] for part in parts], -1)) for i in range(2))
    place = int(printed.argmax())
    names = [name for group in groups for name in group.names]
    return {
        "p": float((1 + (drawn.max(axis=1) >= printed[place]).sum()) / (1 + len(drawn))),
        "worst": names[place],
        "printed": float(np.concatenate([group.printed for group in groups])[place]),
        "ours": float(np.concatenate([group.ours.mean(axis=0) for group in groups])[place]),
        "maps": least,
    }


def _deviations(
    group: Values, maps: int, unit: float, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Logarithm of averages over that of what is expected, in standard deviations of our maps.

    Returns:
        float[k] of the printed values, float[TABLES, k] of drawn ones.
    """
    ours = group.ours[:MOST_MAPS]
    n = len(ours)
    rows = rng.integers(0, n, (TABLES, maps))
    tables = np.maximum(np.round(ours[rows].mean(axis=1) / unit) * unit, unit)
    # So many times each map counts in a resample; the last is that of our maps as they are.
    times = np.concatenate([rng.poisson(1.0, (TABLES, n)), np.ones((1, n))])
    times = times / times.sum(axis=1, keepdims=True)
    means = times @ ours
    variance = np.maximum(times @ ours**2 - means**2, unit**2)
    spread = np.sqrt(variance) / means
    found = np.log(np.concatenate([tables, [group.printed]]) / means) / spread
    return found[-1], found[:-1]
