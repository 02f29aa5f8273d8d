"""Pieces of Markdown that all reports are made of: lists, tables, figures with intervals."""

from collections.abc import Sequence
from typing import Any


def bullets(lines: Sequence[str]) -> str:
    """Lay out lines as a list."""
    return "\n".join(f"- {line}" for line in lines)


def grid(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Lay out rows as a table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def interval(
    figure: dict[str, Any], scale: float = 1.0, digits: int = 2, sign: bool = False
) -> str:
    """Write a figure with its interval; "-" where the sample does not determine it."""
    if figure["value"] is None:
        return "-"
    plus = "+" if sign else ""
    text = f"{scale * figure['value']:{plus}.{digits}f}"
    if figure["low"] is None:
        return text
    return f"{text} [{scale * figure['low']:.{digits}f}, {scale * figure['high']:.{digits}f}]"


def ends(figure: dict[str, Any], digits: int = 2) -> str:
    """Write an interval alone."""
    if figure["low"] is None:
        return "-"
    return f"[{figure['low']:.{digits}f}, {figure['high']:.{digits}f}]"


def share(value: float | None, digits: int = 1) -> str:
    """Write a change as a signed percentage."""
    return "-" if value is None else f"{100 * value:+.{digits}f} %"
