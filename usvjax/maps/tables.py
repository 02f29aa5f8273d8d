"""Maps that studies read: found beside the study or in the package, and their digests."""

import hashlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol, TypeVar

from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import GridMap, find_map
from usvjax.suggest import did_you_mean
from usvjax.tables import read_table

T = TypeVar("T")

MOST_CELLS = 10**8
"""Of a refined map: a byte each, and eight while it is refined."""


class MapSource(Protocol):
    """What every `[maps]` table of a study generates its episodes from."""

    @property
    def cell_size(self) -> float:
        """Edge of a cell, m."""
        ...

    @property
    def origin(self) -> tuple[float, float]:
        """South-west corner of cell (0, 0), m."""
        ...

    @property
    def chart(self) -> GridMap | None:
        """The map that all jobs share, before it was inflated; None where each has its own."""
        ...

    def check(self, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        ...


class OnChart:
    """A `MapSource` whose jobs share a map."""

    chart: GridMap

    @property
    def shape(self) -> tuple[int, int]:
        """(H, W): rows and columns."""
        return self.chart.shape

    @property
    def cell_size(self) -> float:
        """Edge of a cell, m."""
        return self.chart.cell_size

    @property
    def origin(self) -> tuple[float, float]:
        """South-west corner of cell (0, 0), m."""
        return self.chart.origin


def read_source(
    table: Mapping[str, Any], sources: Mapping[str, type[T]], default: str, where: str
) -> tuple[str, T]:
    """Read the `source` of a `[maps]` table and the options that go with it.

    Args:
        table: the TOML table.
        sources: name of a source to its dataclass of options.
        default: the source where none is named.
        where: the study file and table, for the messages.

    Returns:
        The source's name and its options.

    Raises:
        BadInputError: no such source, or a key or value that it cannot use.
        BadTypeError: a value of the wrong type.
    """
    name = table.get("source", default)
    if not isinstance(name, str):
        raise BadTypeError(f"{where}: 'source' must be a string, got {name!r}")
    if name not in sources:
        raise BadInputError(f"{where}: unknown source {name!r}; {did_you_mean(name, sources)}")
    rest = {k: v for k, v in table.items() if k != "source"}
    return name, read_table(sources[name], rest, where)


def read_map(
    name: str, cell_size: float | None, refine: int, folder: Path, where: str
) -> tuple[GridMap, str]:
    """Find the map that a `[maps]` table names.

    Args:
        name: of a packaged map, or a file; one beside the study comes first.
        cell_size: m, for a plain image.
        refine: into how many parts the edge of a cell is divided.
        folder: what a relative path is relative to.
        where: the study file and table, for the messages.

    Returns:
        The map, and the SHA-256 of what its cells mean, whatever file they came from.

    Raises:
        BadInputError: there is no such map, or it cannot be read.
    """
    if refine < 1:
        raise BadInputError(f"{where}: 'refine' must be at least 1, got {refine}")
    beside = folder / name
    with saying_where(where):
        grid = find_map(str(beside) if beside.is_file() else name, cell_size=cell_size)
        cells = grid.blocked.size * refine**2
        if cells > MOST_CELLS:
            raise BadInputError(
                f"'refine' of {refine} makes {cells:,} cells; wanted at most {MOST_CELLS:,}"
            )
        grid = grid.refined(refine)
    return grid, map_digest(grid)


def map_digest(grid: GridMap) -> str:
    """SHA-256 of what a map's cells mean, whatever file they came from."""
    header = f"{grid.shape} {grid.cell_size!r} {grid.origin!r} ".encode()
    return hashlib.sha256(header + grid.blocked.tobytes()).hexdigest()


@contextmanager
def saying_where(where: str) -> Iterator[None]:
    """Put the study file's name in front of messages that do not know it."""
    try:
        yield
    except BadInputError as error:
        raise BadInputError(_prefixed(where, error)) from error
    except BadTypeError as error:
        raise BadTypeError(_prefixed(where, error)) from error


def _prefixed(where: str, error: Exception) -> str:
    text = str(error)
    return text if text.startswith(where) else f"{where}: {text}"
