"""Documents as Markdown."""

from collections.abc import Iterator, Sequence

from usvjax.errors import printable
from usvjax.report.document import Bullets, Part, Picture, Section
from usvjax.report.sheets import Sheet


def markdown(document: Section) -> str:
    """Write a document.

    Args:
        document: the outermost section.

    Returns:
        The text, ending in a newline.
    """
    return "\n\n".join(_blocks(document, 1)) + "\n"


def _blocks(part: Part, level: int) -> Iterator[str]:
    if isinstance(part, Section):
        yield f"{'#' * level} {_line(part.title)}"
        for below in part.parts:
            yield from _blocks(below, level + 1)
    elif isinstance(part, Bullets):
        if part.lines:
            yield "\n".join(f"- {_line(line)}" for line in part.lines)
    elif isinstance(part, Picture):
        yield f"![{_line(part.caption)}]({part.file})\n\n{_line(part.caption)}"
    elif isinstance(part, Sheet):
        if part.title:
            yield _line(part.title)
        if part.rows:
            yield _table(part.header, part.rows)
    elif part:
        yield _line(part)


def _table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(
        "| " + " | ".join(_line(cell).replace("|", r"\|") for cell in row) + " |" for row in lines
    )


def _line(text: str) -> str:
    return printable(text)
