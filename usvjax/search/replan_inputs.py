"""Checks of what replanning takes beyond other searches: flips, options, sizes."""

from dataclasses import replace
from typing import Any

import numpy as np

from usvjax.checks import any_array, number, one_of, shown
from usvjax.errors import BadInputError, BadTypeError
from usvjax.search.inputs import SearchScene
from usvkernels.search.dstar_layout import INFINITE, NONE, Layout
from usvkernels.search.replan_heuristics import HEURISTICS, LONGEST_EQ_17, largest_guide
from usvkernels.search.steps import DIAGONAL

_FLIPS = "int [B, T, C, 2] or [T, C, 2], cells (x, y), padded with (-1, -1)"
_WINDOW = "(h, w), two odd whole numbers of 3 or more"
_LARGEST_WEIGHT = 100


def check_method(heuristic: object, weight: Any, sensing: Any) -> tuple[int, int] | None:
    """Check the choices of method; returns `sensing` as two Python integers, or None.

    Raises:
        BadTypeError: an option of the wrong type.
        BadInputError: an impossible one.
    """
    one_of("heuristic", heuristic, HEURISTICS)
    if weight is not None:
        if heuristic != "weighted_octile":
            raise BadInputError(
                f"weight: got {shown(weight)} with heuristic={heuristic!r}; "
                "wanted it only with 'weighted_octile'"
            )
        if not 1 <= number("weight", weight) <= _LARGEST_WEIGHT:
            raise BadInputError(f"weight: got {shown(weight)}; wanted 1 to {_LARGEST_WEIGHT}")
    return None if sensing is None else check_window(sensing)


def check_window(sensing: Any, name: str = "sensing") -> tuple[int, int]:
    """Check the window (h, w) of a vessel's view; returns it as two Python integers.

    Raises:
        BadTypeError: not whole numbers.
        BadInputError: not two, even or less than 3.
    """
    if isinstance(sensing, np.ndarray):
        sensing = sensing.tolist()
    if not isinstance(sensing, tuple | list):
        raise BadTypeError(f"{name}: got {shown(sensing)}; wanted {_WINDOW}")
    whole = [isinstance(n, int | np.integer) and not isinstance(n, bool) for n in sensing]
    if not all(whole):
        raise BadTypeError(f"{name}: got {shown(sensing)}; wanted {_WINDOW}")
    if len(sensing) != 2 or any(n < 3 or n % 2 == 0 for n in sensing):
        raise BadInputError(f"{name}: got {shown(sensing)}; wanted {_WINDOW}")
    return int(sensing[0]), int(sensing[1])


def clipped_window(sensing: tuple[int, int] | None, shape: tuple[int, int]) -> Any:
    """The window no larger than what sees all of a map (H, W) from any of its cells.

    Returns:
        (h, w), odd and at least 3, or None where it was: what is noticed stays the same.
    """
    if sensing is None:
        return None
    return tuple(
        min(size, max(2 * cells - 1, 3)) for size, cells in zip(sensing, shape, strict=True)
    )


def flip_table(flips: Any, shape: tuple[int, int], count: int) -> np.ndarray:
    """Flips as places in a plane of the map.

    Args:
        flips: int[B, T, C, 2] or int[T, C, 2].
        shape: (H, W).
        count: B of the other arguments; where that is 1, flips may have more rows.

    Returns:
        int32[B, T, C]; in each step the cells in their order, then -1.

    Raises:
        BadTypeError: not whole numbers.
        BadInputError: ragged, another shape, or a cell outside the map.
    """
    cells = any_array("flips", flips, _FLIPS)
    if cells.ndim not in (3, 4) or cells.shape[-1] != 2:
        raise BadInputError(f"flips: got shape {cells.shape}; wanted {_FLIPS}")
    if cells.dtype.kind not in "iu":
        raise BadTypeError(f"flips: got dtype {cells.dtype}; wanted {_FLIPS}")
    cells = cells if cells.ndim == 4 else cells[None]
    if len(cells) not in (1, count) and (count != 1 or not len(cells)):
        raise BadInputError(
            f"flips: got {len(cells)} rows; wanted {count}, as the others have, or one for all"
        )
    none = np.all(cells == -1, axis=-1)
    _check_inside(cells, none, shape)
    index = np.where(none, -1, Layout(*shape).index(cells))
    order = np.argsort(none, axis=-1, kind="stable")
    index = np.take_along_axis(index, order, axis=-1)
    return np.broadcast_to(index, (max(count, len(index)), *index.shape[1:]))


def _check_inside(cells: np.ndarray, none: np.ndarray, shape: tuple[int, int]) -> None:
    height, width = shape
    outside = ~none & np.any((cells < 0) | (cells >= np.array([width, height])), axis=-1)
    if outside.any():
        row, step, place = (int(i) for i in np.argwhere(outside)[0])
        x, y = cells[row, step, place].tolist()
        raise BadInputError(
            f"flips: ({x}, {y}) in row {row}, step {step} lies outside the map; "
            f"wanted 0 <= x < {width} and 0 <= y < {height}, or (-1, -1) for none"
        )


def repeated(scene: SearchScene, count: int) -> SearchScene:
    """The scene with `count` queries, where it had one and the flips have more rows."""
    if len(scene) == count:
        return scene
    return replace(
        scene,
        starts=np.broadcast_to(scene.starts, (count, 2)),
        goals=np.broadcast_to(scene.goals, (count, 2)),
        open_ends=np.broadcast_to(scene.open_ends, (count,)),
    )


def check_sizes(shape: tuple[int, int], steps: int, heuristic: str, weight: float | None) -> None:
    """Refuse maps and numbers of steps for which keys would not fit their integers.

    Raises:
        BadInputError: saying what would fit.
    """
    height, width = shape
    eq_17 = heuristic.startswith("weighted") and weight is None
    if eq_17 and height**2 + width**2 > LONGEST_EQ_17**2:
        raise BadInputError(
            f"blocked: got maps of {width} x {height} cells; wanted a diagonal of at most "
            f"{LONGEST_EQ_17} cells with heuristic={heuristic!r}"
        )
    left = NONE - INFINITE - largest_guide(heuristic, weight, height, width) - 4 * DIAGONAL
    if steps * DIAGONAL > left:
        raise BadInputError(
            f"flips: got {steps} steps on maps of {width} x {height} cells; wanted at most "
            f"{max(left // DIAGONAL, 0)} with heuristic={heuristic!r}"
        )
