"""Figures as reports write them: with their intervals, and to the digits that these earn."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any

from usvjax.statistics import Estimate

NONE = "-"
"""Where the sample does not determine a figure."""

Figure = Estimate | Mapping[str, Any]
"""A value with its interval; a mapping, such as read back from JSON, has the same names."""


def number(value: float | None) -> str:
    """Four significant digits without an exponent."""
    if value is None:
        return NONE
    if value == 0:
        return "0"
    digits = 3 - math.floor(math.log10(abs(value)))
    return f"{value:.{min(max(digits, 0), 8)}f}"


def fixed(value: float | None, digits: int = 1, scale: float = 1.0, sign: bool = False) -> str:
    """So many decimals."""
    return NONE if value is None else f"{scale * value:{'+' if sign else ''}.{digits}f}"


def listed(
    values: Iterable[float | None], digits: int = 1, scale: float = 1.0, sign: bool = False
) -> str:
    """Several values of a kind, such as one per radius."""
    return ", ".join(fixed(value, digits, scale, sign) for value in values)


def interval(
    figure: Figure, scale: float = 1.0, sign: bool = False, digits: int | None = None
) -> str:
    """A figure with its interval.

    Args:
        figure: the value may be None, as may both ends of the interval.
        scale: that all three are multiplied by, such as 100 for a share in per cent.
        sign: whether a plus is written.
        digits: decimals; as many as the interval earns when None.
    """
    found = asdict(figure) if isinstance(figure, Estimate) else figure
    value, low, high = (
        None if found[name] is None else scale * found[name] for name in ("value", "low", "high")
    )
    if value is None:
        return NONE
    plus = "+" if sign else ""
    if low is None or high is None:
        if digits is not None:
            return fixed(value, digits, 1.0, sign)
        return f"{plus}{number(value)}" if value > 0 else number(value)
    if digits is None:
        digits = _earned(value, high - low)
    return f"{value:{plus}.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"


def _earned(value: float, spread: float) -> int:
    """Decimals that an interval of this width earns."""
    digits = min(max(1 - math.floor(math.log10(spread)), 0), 8) if spread > 0 else 4
    if value == 0:
        return digits
    # An interval far narrower than the value earns no more than five significant digits.
    return min(digits, max(4 - math.floor(math.log10(abs(value))), 0))


def ends(figure: Figure, digits: int = 2) -> str:
    """An interval alone."""
    found = asdict(figure) if isinstance(figure, Estimate) else figure
    if found["low"] is None:
        return NONE
    return f"[{found['low']:.{digits}f}, {found['high']:.{digits}f}]"


def percent(rate: float | None, digits: int = 2) -> str:
    """A share from 0 to 1, in per cent, without the sign of it."""
    return fixed(rate, digits, 100.0)


def change(relative: float | None, digits: int = 1) -> str:
    """A relative change, signed."""
    return NONE if relative is None else f"{100 * relative:+.{digits}f} %"


def p_value(p: float | None) -> str:
    """Two significant digits, or a bound where it is too small to matter."""
    if p is None:
        return NONE
    return "<1e-16" if p < 1e-16 else f"{p:.2g}"


def duration(seconds: float) -> str:
    """A time in s, in min from 90 s up, or in h from 90 min up."""
    if seconds < 90:
        return f"{seconds:.0f} s" if seconds >= 1 else f"{seconds:.1f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
