"""The one look of all figures: sizes, colours, names of outcomes, and saving.

Colours are the Okabe-Ito set (Okabe & Ito 2008, "Color universal design"), told apart with any
common colour vision; line styles and markers repeat what colour says, for print in grey.
"""

import os
import tempfile
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import wraps
from pathlib import Path
from typing import Any, Literal, NamedTuple, ParamSpec, TypeVar

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogFormatter

from usvjax.checks import file_path, one_of, shown
from usvjax.errors import BadInputError
from usvjax.pictures import DPI, FORMATS, SUFFIXES, check_dpi, check_suffix
from usvjax.public import public
from usvkernels.status import Status

BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
YELLOW, BLUE, VERMILLION, PURPLE = "#F0E442", "#0072B2", "#D55E00", "#CC79A7"
GREY, LIGHT_GREY = "#8C8C8C", "#D9D9D9"
LAND, WATER, SHORE = "#E9E2D0", "#CBE3F2", "#8A8168"

SINGLE_MM, DOUBLE_MM = 85.0, 170.0

_RC: dict[str, Any] = {
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.labelsize": 8.0,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "figure.titlesize": 9.0,
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#E4E4E4",
    "grid.linewidth": 0.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.4,
    "text.parse_math": False,  # a user's label may hold dollar signs
    "pdf.fonttype": 42,  # embed TrueType: text in the PDF stays text
    "svg.fonttype": "path",  # the same on a machine without our fonts
    "svg.hashsalt": "usvjax",  # the same figure gives the same bytes
}

STATUS_LABEL: dict[int, str] = {
    Status.REACHED: "reached",
    Status.COLLIDED: "collided",
    Status.STUCK: "stuck",
    Status.TIMED_OUT: "timed out",
    Status.PARTIAL: "partial",
    Status.RUNNING: "running",
    Status.FOUND: "found",
    Status.UNREACHABLE: "unreachable",
    Status.OUT_OF_BUDGET: "out of budget",
    Status.BLOCKED: "blocked",
    Status.NO_APPROACH: "no approach",
}
STATUS_COLOUR: dict[int, str] = {
    Status.REACHED: GREEN,
    Status.COLLIDED: VERMILLION,
    Status.STUCK: PURPLE,
    Status.TIMED_OUT: BLACK,
    Status.PARTIAL: ORANGE,
    Status.RUNNING: GREY,
    Status.FOUND: GREEN,
    Status.UNREACHABLE: PURPLE,
    Status.OUT_OF_BUDGET: BLACK,
    Status.BLOCKED: VERMILLION,
    Status.NO_APPROACH: ORANGE,
}
STATUS_MARKER: dict[int, str] = {
    Status.REACHED: "o",
    Status.COLLIDED: "X",
    Status.STUCK: "s",
    Status.TIMED_OUT: "^",
    Status.PARTIAL: "D",
    Status.RUNNING: ".",
    Status.FOUND: "o",
    Status.UNREACHABLE: "s",
    Status.OUT_OF_BUDGET: "^",
    Status.BLOCKED: "X",
    Status.NO_APPROACH: "D",
}


class Look(NamedTuple):
    """How the lines of one method look."""

    colour: str
    line: Literal["-", "--", "-.", ":"]
    marker: str

    @property
    def fill(self) -> str:
        """Filling of a box; a black one would hide its median."""
        return GREY if self.colour == BLACK else self.colour

    @property
    def mark(self) -> dict[str, Any]:
        """How its marker looks on a box of its colour, which alone would not do in grey."""
        size = 5.0 if self.marker == "*" else 3.2
        edge = {"markeredgecolor": BLACK, "markeredgewidth": 0.5}
        return {"marker": self.marker, "markersize": size, "markerfacecolor": "white", **edge}

    @property
    def zorder(self) -> float:
        """Broken lines lie above solid ones, which show through the gaps."""
        return 3.0 if self.line == "-" else 3.1


_METHODS: dict[str, Look] = {}
_OTHERS: tuple[Look, ...] = (
    Look(GREEN, "-.", "^"),
    Look(PURPLE, ":", "D"),
    Look(VERMILLION, "-", "v"),
    Look(SKY, "--", "P"),
    Look(BLACK, "-.", "X"),
)

P = ParamSpec("P")
R = TypeVar("R")


def register_looks(looks: Mapping[str, Look]) -> None:
    """Fix how methods look, the same in every figure; a mission does so before it draws.

    Args:
        looks: by name of the method, in the order in which figures show them.
    """
    _METHODS.update(looks)


def method_looks(methods: Iterable[str]) -> dict[str, Look]:
    """Colour, line style and marker of each method, the same in every figure.

    Args:
        methods: names of methods, in any order.

    Returns:
        A dict from name to its look; registered ones keep theirs whatever stands beside them.
    """
    names = list(methods)
    others = sorted(set(names) - _METHODS.keys())
    looks = {name: _OTHERS[i % len(_OTHERS)] for i, name in enumerate(others)}
    return {name: _METHODS.get(name) or looks[name] for name in names}


def method_handle(look: Look, label: str, *, joined: bool = True) -> Line2D:
    """Return the legend handle of a method: its marker, on its line where its marks are joined."""
    line = look.line if joined else ""
    marks: dict[str, Any] = {"marker": look.marker, "markersize": 4}
    return Line2D([], [], color=look.colour, linestyle=line, label=label, **marks)


def box_handle(look: Look, label: str) -> Line2D:
    """Return the legend handle of a method that is drawn as boxes: their filling and its mark."""
    return Line2D([], [], color=look.fill, linewidth=7, label=label, **look.mark)


def ordered_methods(methods: Iterable[str]) -> list[str]:
    """Return each name once: registered ones in their order, then by alphabet."""
    known = list(_METHODS)
    return sorted(set(methods), key=lambda n: (known.index(n) if n in known else len(known), n))


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Decorate a drawing function so that it draws in the style of this package only."""

    @wraps(draw)
    def inside(*args: P.args, **kwargs: P.kwargs) -> R:
        with mpl.rc_context(_RC):  # type: ignore[arg-type]
            return draw(*args, **kwargs)

    return inside


def new_figure(width_mm: float, height_mm: float) -> Figure:
    """Return an empty figure of a size in millimetres, laid out so that nothing overlaps."""
    fig = Figure(figsize=(width_mm / 25.4, height_mm / 25.4), layout="constrained")
    FigureCanvasAgg(fig)
    return fig


def settle(fig: Figure) -> Figure:
    """Run the layout until legends outside and equal aspects agree, and return the figure.

    One pass places axes of equal aspect before it knows the room that the legend takes.
    """
    for _ in range(2):
        fig.draw_without_rendering()
    return fig


def folded(text: str, width: int) -> str:
    """Fold text into lines of at most so many letters where it has spaces."""
    return textwrap.fill(text, width, break_long_words=False, break_on_hyphens=False)


def tick_names(names: Sequence[str], room: int) -> tuple[list[str], dict[str, Any]]:
    """Fold tick labels that stand side by side; slant or turn them where they do not fit.

    Args:
        names: the labels.
        room: letters that fit side by side on the axis.

    Returns:
        The labels, and keyword arguments for `Axes.set_xticks`.
    """
    level = ["\n".join(folded(line, 14) for line in name.split("\n")) for name in names]
    longest = max((len(line) for label in level for line in label.split("\n")), default=0)
    if len(names) * (longest + 2) <= room:
        return level, {}
    lines = max(name.count("\n") + 1 for name in names)
    if len(names) * 3.5 * lines <= room:
        return list(names), {"rotation": 40, "ha": "right", "rotation_mode": "anchor"}
    return list(names), {"rotation": 90}


def plain_powers(axis: Axis) -> None:
    """Label a logarithmic axis with plain numbers: matplotlib's own labels are formulas."""
    axis.set_major_formatter(_Plain())
    axis.set_minor_formatter(_Plain(labelOnlyBase=False))


class _Plain(LogFormatter):
    """Labels where `LogFormatter` has some; its own would be 1000, 1e4 and 1e+05."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{x:,.10g}" if super().__call__(x, pos) else ""


def map_axes(ax: Axes, unit: str = "m") -> None:
    """Label axes as a map: equal aspect, x east, y north."""
    ax.set_aspect("equal")
    ax.set_xlabel(f"x, east ({unit})")
    ax.set_ylabel(f"y, north ({unit})")


def outside_legend(fig: Figure, handles: list[Any], columns: int) -> None:
    """Put one legend below the axes, where it covers no data."""
    # A mark hides the middle of its line; only a long one shows beside it that it is broken.
    lines = [handle for handle in handles if isinstance(handle, Line2D)]
    long = any(line.is_dashed() and line.get_marker() != "None" for line in lines)
    length = 4.0 if long else None  # in units of the font size
    fig.legend(handles=handles, loc="outside lower center", ncols=columns, handlelength=length)


def status_name(status: int) -> str:
    """Say a status code in words.

    Raises:
        BadInputError: the code is none of `usvkernels.status.Status`.
    """
    if int(status) not in STATUS_LABEL:
        wanted = ", ".join(f"{code.value} {code.name}" for code in map(Status, STATUS_LABEL))
        raise BadInputError(f"status is {shown(int(status))}; one of {wanted} was wanted")
    return STATUS_LABEL[int(status)]


def write_atomically(path: Path, write: Callable[[Path], object]) -> Path:
    """Let `write` fill a temporary file beside `path`, then rename it into place.

    A reader never sees half a file, and a failure leaves what was there before.

    Args:
        path: where the file shall be; missing folders are made.
        write: called with the temporary path, which has the suffix of `path`.

    Returns:
        `path`.

    Raises:
        BadInputError: the folder or the file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=".", suffix=path.suffix, dir=path.parent)
    except OSError as error:
        raise BadInputError(f"cannot write {path}: {error.strerror}") from error
    temporary = Path(name)
    try:
        write(temporary)
        os.fsync(handle)
        temporary.chmod(0o644)
        temporary.replace(path)
    except OSError as error:
        raise BadInputError(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        os.close(handle)
        temporary.unlink(missing_ok=True)
    return path


@public()
def save(fig: Figure, path: str | Path, *, format: str | None = None, dpi: int = DPI) -> Path:
    """Write a figure, whole or not at all; the same figure gives the same bytes.

    Args:
        fig: any figure of this package.
        path: file to write.
        format: "png", "pdf" or "svg", whose suffix takes the place of one of these three that
            `path` may have; None takes the format from the suffix of `path`.
        dpi: dots per inch of a PNG, 20 to 1200; the others are drawn in lines and text.

    Returns:
        The path written.

    Raises:
        BadInputError: another format, suffix or dpi, or a place that cannot be written.
    """
    target = file_path("path", path)
    if format is not None:
        one_of("format", format, FORMATS)
        stem = target.stem if target.suffix.lower() in SUFFIXES else target.name
        target = target.with_name(f"{stem}.{format}")
    check_suffix(target)
    check_dpi("dpi", dpi)
    # Without dates the same data gives the same file.
    undated = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}
    metadata = undated.get(target.suffix.lower(), {})

    def write(temporary: Path) -> None:
        with mpl.rc_context(_RC):  # type: ignore[arg-type]
            fig.savefig(temporary, dpi=dpi, metadata=metadata)

    return write_atomically(target, write)
