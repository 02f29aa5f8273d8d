"""Checks that all grid searches share: the map, starts and goals, before anything is traced."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from usvjax.checks import any_array, one_of, shown, whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps.grid_map import GridMap

_MAP = "bool [H, W] shared or [B, H, W] (True = not navigable)"
_CELLS = "int [B, 2] or [2], cells as (x, y)"


@dataclass(frozen=True)
class SearchScene:
    """B queries on a map of their own or on one that they share; checked.

    Attributes:
        blocked: bool[1, H, W] shared by all queries, or bool[B, H, W].
        starts: int32[B, 2], cells (x, y).
        goals: int32[B, 2], cells (x, y).
        open_ends: bool[B], False where start or goal lies on a blocked cell; such rows occur only
            under `on_blocked="status"`.
    """

    blocked: np.ndarray
    starts: np.ndarray
    goals: np.ndarray
    open_ends: np.ndarray

    def __len__(self) -> int:
        return len(self.starts)

    @property
    def shared(self) -> bool:
        """Whether all queries are on one map; always true of a single query."""
        return len(self.blocked) == 1

    @property
    def shape(self) -> tuple[int, int]:
        """(H, W): rows and columns of the maps."""
        return self.blocked.shape[1], self.blocked.shape[2]


def search_scene(blocked: Any, starts: Any, goals: Any, on_blocked: str = "raise") -> SearchScene:
    """Check the arguments that every search has.

    Args:
        blocked: bool[H, W] shared by all queries, bool[B, H, W], or a `GridMap` (shared).
        starts: int[B, 2], cells (x, y); or int[2], shared.
        goals: int[B, 2], cells (x, y); or int[2], shared.
        on_blocked: "raise" refuses a start or goal on a blocked cell; "status" leaves it to the
            caller, who marks the row `Status.BLOCKED`.

    Returns:
        The queries; B comes from whichever argument has it.

    Raises:
        BadTypeError: a map that is not boolean, cells that are not whole numbers.
        BadInputError: an empty map, one without a free cell, ragged or unequal batches, a cell
            outside the map or (by default) blocked; the message names the argument and its row.
    """
    one_of("on_blocked", on_blocked, ("raise", "status"))
    grids = search_maps(blocked)
    sources = cell_rows("starts", starts)
    targets = cell_rows("goals", goals)
    count = _batch(grids, sources, targets)
    sources = np.broadcast_to(sources, (count, 2))
    targets = np.broadcast_to(targets, (count, 2))
    for name, cells in (("starts", sources), ("goals", targets)):
        check_inside(name, cells, grids.shape[1:])
    if on_blocked == "raise":
        _check_free_cells(grids)
        _check_free("starts", grids, sources)
        _check_free("goals", grids, targets)
    return SearchScene(
        blocked=grids,
        starts=sources.astype(np.int32),
        goals=targets.astype(np.int32),
        open_ends=~(blocked_at(grids, sources) | blocked_at(grids, targets)),
    )


def search_maps(blocked: Any) -> np.ndarray:
    """The maps as bool[1, H, W] or bool[B, H, W], not copied.

    Raises:
        BadTypeError: not boolean.
        BadInputError: ragged, empty or of other dimensions.
    """
    if isinstance(blocked, GridMap):
        return blocked.blocked[None]
    grids = any_array("blocked", blocked, _MAP)
    if grids.dtype != np.bool_:
        raise BadTypeError(f"blocked: got dtype {grids.dtype}; wanted {_MAP}")
    if grids.ndim not in (2, 3):
        raise BadInputError(f"blocked: got shape {grids.shape}; wanted {_MAP}")
    if grids.size == 0:
        raise BadInputError(f"blocked: got shape {grids.shape}, which has no cells; wanted {_MAP}")
    return grids if grids.ndim == 3 else grids[None]


def check_connectivity(connectivity: Any) -> None:
    """Refuse another number of neighbours than there are.

    Raises:
        BadTypeError: not a whole number.
        BadInputError: neither 4 nor 8.
    """
    if whole_number("connectivity", connectivity, 1) not in (4, 8):
        raise BadInputError(f"connectivity: got {shown(connectivity)}; wanted 4 or 8")


def cell_rows(name: str, value: Any) -> np.ndarray:
    """Cells as int[1, 2] or int[B, 2].

    Raises:
        BadTypeError: not whole numbers.
        BadInputError: ragged, of another shape, or no rows.
    """
    cells = any_array(name, value, _CELLS)
    if cells.size == 0 or cells.ndim not in (1, 2) or cells.shape[-1] != 2:
        raise BadInputError(f"{name}: got shape {cells.shape}; wanted {_CELLS}")
    if cells.dtype.kind not in "iu":
        raise BadTypeError(f"{name}: got dtype {cells.dtype}; wanted {_CELLS}")
    return cells if cells.ndim == 2 else cells[None]


def check_inside(name: str, cells: np.ndarray, shape: tuple[int, ...]) -> None:
    """Refuse cells int[B, 2] outside a map of shape (H, W).

    Raises:
        BadInputError: naming the first row.
    """
    height, width = shape
    outside = np.any((cells < 0) | (cells >= np.array([width, height])), axis=1)
    if outside.any():
        row = int(np.argmax(outside))
        raise BadInputError(
            f"{name}: {_cell(cells[row])} in row {row} lies outside the map; "
            f"wanted 0 <= x < {width} and 0 <= y < {height}"
        )


def blocked_at(grids: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Whether cells int[B, 2] are blocked in bool[1, H, W] or bool[B, H, W]; bool[B]."""
    layer = np.zeros(len(cells), np.int64) if len(grids) == 1 else np.arange(len(cells))
    return grids[layer, cells[:, 1], cells[:, 0]]


def _batch(grids: np.ndarray, starts: np.ndarray, goals: np.ndarray) -> int:
    """B, which arguments of one row follow.

    A batch of one map counts as shared: it is the same thing.
    """
    sizes = {"blocked": len(grids), "starts": len(starts), "goals": len(goals)}
    count = max(sizes.values())
    longest = max(sizes, key=lambda name: sizes[name])
    for name, size in sizes.items():
        if size not in (1, count):
            raise BadInputError(
                f"{name}: got {size} rows; wanted {count}, as {longest} has, or one for all"
            )
    return count


def _check_free_cells(grids: np.ndarray) -> None:
    full = grids.all(axis=(1, 2))
    if full.any():
        where = "" if len(grids) == 1 else f" in row {int(np.argmax(full))}"
        raise BadInputError(f"blocked: all cells are blocked{where}; wanted a free one")


def _check_free(name: str, grids: np.ndarray, cells: np.ndarray) -> None:
    bad = blocked_at(grids, cells)
    if bad.any():
        row = int(np.argmax(bad))
        raise BadInputError(
            f"{name}: {_cell(cells[row])} in row {row} is a blocked cell; "
            'wanted a free one, or on_blocked="status" to get a status for such rows'
        )


def _cell(cell: np.ndarray) -> str:
    return f"({int(cell[0])}, {int(cell[1])})"
