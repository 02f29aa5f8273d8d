"""Tables of text for people: whole at any width, never cut.

A table that does not fit wraps its words at spaces, then lifts its first column into headings,
and at last becomes one block of lines per row. Numbers are never broken, and what cannot be
broken sticks out rather than being clipped.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from rich.cells import cell_len

from usvjax.errors import printable

_SHAPES = ((False, 2, 16), (False, 1, 16), (True, 2, 16), (True, 1, 16), (True, 1, 0))
"""Shapes to try in turn: whether headed, the gap between columns, and what words get at least."""


@dataclass(frozen=True)
class Sheet:
    """A table of text.

    Attributes:
        title: stands above; "" for none.
        header: name of every column; empty for a table of names and values.
        rows: cells; a first cell that is empty means the one above it.
        words: so many columns, from the first, hold words; the others hold figures.
        headed: whether the first column always stands as headings above its rows.
    """

    title: str
    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    words: int = 1
    headed: bool = False


def text_of(parts: Sequence[Sheet | str], width: int | None) -> str:
    """Lay out tables and paragraphs, an empty line after every table.

    Args:
        parts: what to lay out.
        width: columns that a line may take; None for as many as it needs.

    Returns:
        Lines, each ended; none is longer than `width` unless a single word or figure is.
    """
    lines: list[str] = []
    for part in parts:
        if isinstance(part, Sheet):
            lines += [*_laid_out(part, width), ""]
        else:
            lines += folded(printable(part), width)
    return "".join(f"{line}\n" for line in lines)


def folded(text: str, width: int | None, indent: str = "") -> list[str]:
    """Fold text at spaces.

    Args:
        text: one paragraph.
        width: columns that a line may take; None for as many as it needs.
        indent: of all lines but the first.
    """
    if width is None or cell_len(text) <= width:
        return [text]
    lead = text[: len(text) - len(text.lstrip(" "))]
    lines = [lead]
    for word in text.split():
        grown = f"{lines[-1]} {word}" if lines[-1].strip() else f"{lines[-1]}{word}"
        if lines[-1].strip() and cell_len(grown) > width:
            lines.append(f"{indent}{word}")
        else:
            lines[-1] = grown
    return lines


def _laid_out(sheet: Sheet, width: int | None) -> list[str]:
    rows = [[printable(cell) for cell in row] for row in sheet.rows]
    sheet = replace(sheet, header=[printable(name) for name in sheet.header], rows=rows)
    lines = folded(printable(sheet.title), width) if sheet.title else []
    for headed, gap, readable in _SHAPES:
        if headed or not sheet.headed:
            table = _table(replace(sheet, headed=headed), width, gap, readable)
            if table is not None:
                return [*lines, *table]
    return [*lines, *_blocks(sheet, width)]


def _table(sheet: Sheet, width: int | None, gap: int, readable: int) -> list[str] | None:
    """Rows below one another; None where they do not fit."""
    first = 1 if sheet.headed else 0
    header = list(sheet.header[first:])
    rows = [list(row[first:]) for row in sheet.rows]
    words = sheet.words - first
    if not any(rows):
        return None
    widths = _widths(header, rows, words, width, gap, readable)
    if widths is None:
        return None
    lines = []
    if header:
        lines += _joined(header, widths, words, gap)
        lines.append("\u2500" * (sum(widths) + gap * (len(widths) - 1)))
    for number, (heading, row) in enumerate(zip(_headings(sheet), rows, strict=True)):
        if heading and number and sheet.header:
            lines.append("")
        if heading and sheet.headed:
            lines += folded(heading, width)
        lines += _joined(row, widths, words, gap)
    return lines


def _is_grouped(sheet: Sheet) -> bool:
    return any(not row[0] for row in sheet.rows)


def _headings(sheet: Sheet) -> Iterator[str]:
    """The first cell of every row, "" where it is that of the row above and rows are grouped."""
    last = None
    grouped = sheet.headed or _is_grouped(sheet)
    for row in sheet.rows:
        yield row[0] if grouped and row[0] not in ("", last) else ""
        last = row[0] or last


def _widths(
    header: Sequence[str],
    rows: Sequence[Sequence[str]],
    words: int,
    width: int | None,
    gap: int,
    readable: int,
) -> list[int] | None:
    """Width of every column; None where they do not fit."""
    grouped = any(not row[0] for row in rows)
    widest, least = [], []
    for place, cells in enumerate(zip(*([header] if header else []), *rows, strict=True)):
        full = max(map(cell_len, cells))
        name, body = (cells[0], cells[1:]) if header else ("", cells)
        broken = max((cell_len(word) for word in name.split()), default=0)
        if place < words:
            longest = max((cell_len(w) for cell in body for w in cell.split()), default=0)
            # Wrapped, a name of several rows would run into the second of them.
            broken = max(broken, longest, full if grouped and place == 0 else min(full, readable))
        else:
            broken = max(broken, *map(cell_len, body))
        widest.append(full)
        least.append(broken)
    if width is None:
        return widest
    room = width - gap * (len(widest) - 1)
    if sum(least) > room:
        return None
    while sum(widest) > room:
        spare = [a - b for a, b in zip(widest, least, strict=True)]
        widest[spare.index(max(spare))] -= 1
    return widest


def _joined(cells: Sequence[str], widths: Sequence[int], words: int, gap: int) -> list[str]:
    """One row, of as many lines as its cells need."""
    blocks = [folded(cell, size) for cell, size in zip(cells, widths, strict=True)]
    lines = []
    for line in range(max(map(len, blocks))):
        parts = []
        for place, (block, size) in enumerate(zip(blocks, widths, strict=True)):
            text = block[line] if line < len(block) else ""
            space = " " * (size - cell_len(text))
            parts.append(f"{text}{space}" if place < words else f"{space}{text}")
        lines.append((" " * gap).join(parts).rstrip())
    return lines


def _blocks(sheet: Sheet, width: int | None) -> list[str]:
    """One block of lines per row: its first cell, then every other with the name of its column."""
    names = list(sheet.header) or [""] * max(len(row) for row in sheet.rows)
    lines: list[str] = []
    grouped = sheet.words > 1 and _is_grouped(sheet)
    heading = ""
    for row in sheet.rows:
        if row[0] and row[0] != heading:
            heading = row[0]
            lines += folded(heading, width, "  ")
        for place, (name, cell) in enumerate(zip(names[1:], row[1:], strict=True)):
            # Under one heading several rows begin each with a name, which what follows is of.
            lead = "    " if place and grouped else "  "
            named = f"{name}: {cell}" if name else cell
            if cell:
                lines += folded(f"{lead}{named}", width, f"{lead}  ")
    return lines
