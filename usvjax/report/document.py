"""What a document is made of: sections of paragraphs, lists, tables and pictures."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from usvjax.report.sheets import Sheet


@dataclass(frozen=True)
class Bullets:
    """A list.

    Attributes:
        lines: one entry each; in them, as in paragraphs, `code` and **what is important** may be
            marked as Markdown has it.
    """

    lines: Sequence[str]


@dataclass(frozen=True)
class Picture:
    """A figure in a file.

    Attributes:
        file: where it is, relative to the document.
        caption: what it shows, a sentence.
    """

    file: str
    caption: str


@dataclass(frozen=True)
class Section:
    """A heading and what stands below it; the outermost is the whole document.

    Attributes:
        title: of the heading.
        parts: in their order; a plain string is a paragraph. What is empty is left out.
    """

    title: str
    parts: Sequence["Part"]


Part: TypeAlias = str | Bullets | Sheet | Picture | Section
