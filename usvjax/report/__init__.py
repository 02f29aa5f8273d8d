"""Documents: what is found, as one tree, and how it is written for a terminal or as Markdown.

Whoever reports something makes a `Section` of paragraphs, lists, tables and pictures; how it looks
is decided here and nowhere else.
"""

from usvjax.report.document import Bullets, Part, Picture, Section
from usvjax.report.markdown import markdown
from usvjax.report.sheets import Sheet, text_of
from usvjax.report.terminal import terminal

__all__ = [
    "Bullets",
    "Part",
    "Picture",
    "Section",
    "Sheet",
    "markdown",
    "terminal",
    "text_of",
]
