"""File formats and resolution of figures, said where matplotlib need not be loaded."""

from pathlib import Path

from usvjax.checks import one_of, shown, whole_number
from usvjax.errors import BadInputError

FORMATS = ("png", "pdf", "svg")
SUFFIXES = tuple(f".{name}" for name in FORMATS)
DPI, LEAST_DPI, MOST_DPI = 200, 20, 1200


def check_pictures(formats: tuple[str, ...], dpi: int) -> None:
    """Check formats and resolution before anything is computed.

    Raises:
        BadInputError: no format or another than `FORMATS`, or dots per inch out of range.
    """
    if not formats:
        raise BadInputError(f"formats is empty; at least one of {', '.join(FORMATS)} was wanted")
    for name in formats:
        one_of("formats", name, FORMATS)
    check_dpi("dpi", dpi)


def check_dpi(name: str, dpi: int) -> None:
    """Raise BadInputError unless there are `LEAST_DPI` to `MOST_DPI` dots per inch."""
    if not LEAST_DPI <= whole_number(name, dpi, 0) <= MOST_DPI:
        raise BadInputError(f"{name} is {shown(dpi)}; {LEAST_DPI} to {MOST_DPI} was wanted")


def check_suffix(path: Path, allowed: tuple[str, ...] = SUFFIXES) -> None:
    """Raise BadInputError unless the file name ends in one of `allowed`."""
    if path.suffix.lower() not in allowed:
        wanted = ", ".join(allowed)
        raise BadInputError(f"{path}: suffix {shown(path.suffix)} is not one of {wanted}")
