"""The arguments of commands that write figures."""

from typing import Annotated, Literal

import tyro

Formats = Annotated[tuple[Literal["png", "pdf", "svg"], ...], tyro.conf.arg(name="format")]
Dpi = Annotated[int, tyro.conf.arg(metavar="N")]
