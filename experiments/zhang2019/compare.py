"""Each method against the traditional one on the same maps, and on maps like the paper's."""

from typing import Any

import numpy as np

from experiments.estimates import mean, share, spread
from experiments.zhang2019.published import IMPROVED, TRADITIONAL
from experiments.zhang2019.runs import EXACT_DIAGONAL, Paths

WINDOW = 1.0
"""Squares by which length and turning cost of the traditional path may differ from the paper's
on a map that counts as one like it."""
LEAST_MATCHES = 20
_ALIKE = 1e-6


def against(new: Paths, old: Paths) -> dict[str, Any]:
    """Compare a method with the traditional one, map by map, where there is a path.

    Returns:
        Number of maps, means, paired differences with t intervals, and the shares of maps on
        which the total cost is lower, equal and higher.
    """
    both = new.found & old.found
    new, old = new.some(both), old.some(both)
    change = new.total() - old.total()
    columns = {
        "total": (new.total(), old.total()),
        "turning": (new.turning, old.turning),
        "length": (new.length(), old.length()),
        "total_sqrt2": (new.total(EXACT_DIAGONAL), old.total(EXACT_DIAGONAL)),
        "expanded": (new.expanded, old.expanded),
    }
    return {
        "n": len(change),
        "metrics": {name: _compared(*pair) for name, pair in columns.items()},
        "better": share(change < -_ALIKE),
        "equal": share(np.abs(change) <= _ALIKE),
        "worse": share(change > _ALIKE),
    }


def _compared(new: np.ndarray, old: np.ndarray) -> dict[str, Any]:
    return {
        "mean": float(new.mean()) if len(new) else None,
        "traditional": float(old.mean()) if len(old) else None,
        "difference": mean(new - old),
    }


def excess(paths: Paths, exact: Paths) -> dict[str, Any]:
    """By how much the total, with true diagonals, exceeds the least there is.

    Returns:
        Number of maps, mean and largest ratio, and the share of maps with the least itself.
    """
    both = paths.found & exact.found
    if not both.any():
        return {"n": 0, "mean": None, "largest": None, "optimal": share(both[:0])}
    best = exact.some(both).total(EXACT_DIAGONAL)
    ratio = paths.some(both).total(EXACT_DIAGONAL) / best
    return {
        "n": int(both.sum()),
        "mean": float(ratio.mean()),
        "largest": float(ratio.max()),
        "optimal": share(ratio < 1.0 + _ALIKE),
    }


def alike(old: Paths) -> np.ndarray:
    """Which maps are like the paper's: the traditional path costs about what Table 3 says."""
    close: np.ndarray = (
        old.found
        & (np.abs(old.length() - TRADITIONAL.length) <= WINDOW + _ALIKE)
        & (np.abs(old.turning - TRADITIONAL.turning) <= WINDOW + _ALIKE)
    )
    return close


def same(old: Paths) -> np.ndarray:
    """Which maps have exactly the traditional path's costs of Table 3."""
    exactly: np.ndarray = (
        old.found
        & (np.abs(old.length() - TRADITIONAL.length) <= _ALIKE)
        & (np.abs(old.turning - TRADITIONAL.turning) <= _ALIKE)
    )
    return exactly


def nearest(old: Paths) -> int:
    """Choose the map whose traditional path comes nearest to Table 3, the first of equals."""
    apart = np.abs(old.length() - TRADITIONAL.length) + np.abs(old.turning - TRADITIONAL.turning)
    return int(np.where(old.found, np.round(apart, 6), np.inf).argmin())


def on_maps_alike(new: Paths, old: Paths) -> dict[str, Any]:
    """What a method makes of the maps that are like the paper's.

    Returns:
        Number of such maps, of those with exactly the published costs and of those where the
        method then has exactly the published costs as well; mean, 2.5 and 97.5 % quantiles of
        total and turning cost; share of maps with at least the published saving.
    """
    chosen, exactly = alike(old), same(old)
    own, before = new.some(chosen), old.some(chosen)
    hits = (
        exactly
        & np.isclose(new.total(), IMPROVED.total)
        & np.isclose(new.turning, IMPROVED.turning)
    )
    saved = before.total() - own.total()
    published = TRADITIONAL.total - IMPROVED.total
    columns = {"total": own.total(), "turning": own.turning}
    return {
        "n": int(chosen.sum()),
        "same": int(exactly.sum()),
        "hits": int(hits.sum()),
        "spread": {name: spread(values) for name, values in columns.items()},
        "saved": float(saved.mean()) if len(saved) else None,
        "as_published": share(saved >= published - _ALIKE),
    }


def spread_of_all(old: Paths) -> dict[str, Any]:
    """Mean and quantiles of what the traditional paths cost, on all maps."""
    some = old.some(old.found)
    columns = {"total": some.total(), "turning": some.turning, "length": some.length()}
    return {"n": len(some.found), **{name: spread(values) for name, values in columns.items()}}


def slowdown(new: list[float], old: list[float]) -> dict[str, Any]:
    """Time of a method over that of the traditional one, from runs that took turns.

    Returns:
        s per query of the fastest run each; their ratio, and the range of ratios run by run.
    """
    ratios = np.array(new) / np.array(old)
    return {
        "seconds": min(new),
        "traditional": min(old),
        "ratio": {
            "value": min(new) / min(old),
            "low": float(ratios.min()),
            "high": float(ratios.max()),
        },
    }
