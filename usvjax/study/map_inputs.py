"""Maps that studies read: found beside the study or in the package, and their digests."""

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import GridMap, find_map

MOST_CELLS = 10**8
"""Of a refined map: a byte each, and eight while it is refined."""


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
