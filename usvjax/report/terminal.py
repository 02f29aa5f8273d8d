"""Documents for a terminal: headings, folded paragraphs, tables that are never cut."""

import re
from collections.abc import Iterator

from usvjax.report.document import Bullets, Part, Picture, Section
from usvjax.report.sheets import Sheet, folded, text_of

_MARKS = re.compile(r"\*\*|`")


def terminal(document: Section, width: int | None) -> str:
    """Lay a document out.

    Args:
        document: the outermost section.
        width: columns that a line may take; None for as many as it needs.

    Returns:
        Lines, each ended.
    """
    return "\n".join(_blocks(document, 0, width))


def _blocks(part: Part, level: int, width: int | None) -> Iterator[str]:
    if isinstance(part, Section):
        title = plain(part.title)
        yield f"{title}\n{('=' if level == 0 else '-') * len(title)}\n"
        for below in part.parts:
            yield from _blocks(below, level + 1, width)
    elif isinstance(part, Bullets):
        lines = [line for one in part.lines for line in folded(f"- {plain(one)}", width, "  ")]
        yield "".join(f"{line}\n" for line in lines)
    elif isinstance(part, Picture):
        yield text_of([f"{part.file}: {plain(part.caption)}"], width)
    elif isinstance(part, Sheet):
        yield text_of([part], width).removesuffix("\n")
    elif part:
        yield text_of([plain(part)], width)


def plain(text: str) -> str:
    """Text without the marks of Markdown."""
    return _MARKS.sub("", text)
