"""GridMap: an occupancy grid with its place and scale in the world."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy

from usvjax import checks
from usvjax.checks import shown, whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps.obstacles import expand_obstacles
from usvjax.memory import check_memory

MOST_CELLS = 10**8
"""Of a map that is read, refined or drawn: what searches and figures of it bear."""

_REMOTE = 2.0**62  # the number of a cell where one of 64 bits would overflow
_AT_ONCE = 2**20  # cells in a band of rows


def check_size(height: int, width: int, what: str, each: int = 2) -> None:
    """Refuse a map that is too large, before anything of its size is made.

    Args:
        height, width: cells.
        what: it is, for the message.
        each: bytes of memory that a cell takes while the map is made.

    Raises:
        BadInputError: it has more than MOST_CELLS, or needs more memory than there is.
    """
    cells = height * width
    if cells > MOST_CELLS:
        # Not by "," where Python refuses to print so many digits.
        size = f"{width:,} x {height:,}" if max(height, width) < 10**15 else "too many"
        raise BadInputError(f"{what} has {size} cells; wanted at most {MOST_CELLS:,} in all")
    check_memory(each * cells, f"{what} of {width:,} x {height:,} cells")


def bands(height: int, width: int) -> Iterator[slice]:
    """Rows of a map, some at a time, so that what is computed of them takes little memory."""
    rows = max(1, _AT_ONCE // width)
    return (slice(first, min(first + rows, height)) for first in range(0, height, rows))


@dataclass(frozen=True, eq=False)
class GridMap:
    """A map of blocked and free cells, immutable.

    Two maps are equal when their cells, cell size and origin are; names do not matter.

    Attributes:
        blocked: bool[H, W], True = not navigable, read-only; row y grows to the north.
        cell_size: edge of a cell, m.
        origin: (x, y) of the south-west corner of cell (0, 0), m.
        name: what the map shows, for titles and tables.
        attribution: source and licence of the data, to be shown with it.

    Raises:
        BadTypeError: ``blocked`` is not bool, or another field has the wrong type.
        BadInputError: ``blocked`` is empty or not two-dimensional, ``cell_size`` is not above
            0, or a number is not finite.
    """

    blocked: np.ndarray
    cell_size: float = 1.0
    origin: tuple[float, float] = (0.0, 0.0)
    name: str = ""
    attribution: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "blocked", checks.grid("blocked", self.blocked))
        object.__setattr__(self, "cell_size", checks.positive("cell_size", self.cell_size))
        object.__setattr__(self, "origin", checks.pair("origin", self.origin))
        for name in ("name", "attribution"):
            if not isinstance(text := getattr(self, name), str):
                raise BadTypeError(f"{name}: got {shown(text)}; wanted a string")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GridMap):
            return NotImplemented
        return (
            self.cell_size == other.cell_size
            and self.origin == other.origin
            and np.array_equal(self.blocked, other.blocked)
        )

    def __hash__(self) -> int:
        return hash((self.shape, self.cell_size, self.origin, self.blocked.tobytes()))

    def __repr__(self) -> str:
        height, width = self.shape
        name = f"{self.name!r}, " if self.name else ""
        return (
            f"GridMap({name}{width} x {height} cells of {self.cell_size:g} m, "
            f"origin ({self.origin[0]:g}, {self.origin[1]:g}), {self.free_share:.1%} free)"
        )

    @property
    def shape(self) -> tuple[int, int]:
        """(H, W): rows and columns."""
        height, width = self.blocked.shape
        return height, width

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """(x0, x1, y0, y1) of the outer edges, m; the order that ``imshow`` takes."""
        x0, y0 = self.origin
        height, width = self.shape
        return x0, x0 + width * self.cell_size, y0, y0 + height * self.cell_size

    @property
    def free_share(self) -> float:
        """Share of cells that are free, in [0, 1]."""
        return 1.0 - float(self.blocked.mean())

    def cells_of(self, points: Any) -> np.ndarray:
        """Cells that contain points; on an edge, the cell to the north and east.

        Args:
            points: (x, y), float[..., 2], m. Computed in float64: at 100 km, float32 would
                be 8 mm coarse.

        Returns:
            (x, y) indices, int64[..., 2]; outside the map they are negative or too large.

        Raises:
            BadTypeError: ``points`` are not numbers.
            BadInputError: a point is not finite, or the last dimension is not 2.
        """
        place = _pairs("points", points)
        with np.errstate(over="ignore"):
            cells = np.floor((place - self.origin) / self.cell_size)
        return np.clip(cells, -_REMOTE, _REMOTE).astype(np.int64)

    def points_of(self, cells: Any) -> np.ndarray:
        """Centres of cells.

        Args:
            cells: (x, y) indices, int[..., 2].

        Returns:
            float64[..., 2], m.

        Raises:
            BadTypeError: ``cells`` are not numbers.
            BadInputError: an index is not finite, or the last dimension is not 2.
        """
        return np.asarray(self.origin) + self.cell_size * (_pairs("cells", cells) + 0.5)

    def is_blocked(self, points: Any) -> np.ndarray:
        """Whether points lie in blocked cells or outside the map.

        Args:
            points: (x, y), float[..., 2], m.

        Returns:
            bool[...].

        Raises:
            BadTypeError: ``points`` are not numbers.
            BadInputError: a point is not finite, or the last dimension is not 2.
        """
        cells = self.cells_of(points)
        limit = np.asarray(self.shape[::-1])
        inside = np.all((cells >= 0) & (cells < limit), axis=-1)
        x, y = np.moveaxis(np.clip(cells, 0, limit - 1), -1, 0)
        return ~inside | self.blocked[y, x]

    def clearance(self) -> np.ndarray:
        """Distance from the centre of each cell to the nearest centre of a blocked cell, m.

        Returns:
            float64[H, W]: 0 in blocked cells, inf everywhere if no cell is blocked. What lies
            outside the map does not count.
        """
        if not self.blocked.any():
            return np.full(self.shape, np.inf)
        return self.cell_size * scipy.ndimage.distance_transform_edt(~self.blocked)

    def inflated(self, radius_m: float) -> "GridMap":
        """Block every cell whose centre is within a radius of a blocked cell's centre.

        Args:
            radius_m: radius of the disc, m; on the circle counts.

        Raises:
            BadTypeError: ``radius_m`` is not a number.
            BadInputError: it is negative or not finite.
        """
        radius = checks.not_negative("radius_m", radius_m)
        # A radius of a whole number of cells must survive the rounding of the products.
        return replace(self, blocked=self.clearance() <= radius * (1 + 1e-6))

    def expanded(self, expansion: float) -> "GridMap":
        """Scale every obstacle by (1 + E) about its own centre (Chen 2023, Eq. 4).

        See ``usvjax.maps.expand_obstacles``.

        Args:
            expansion: the obstacle expansion coefficient E, >= 0.
        """
        return replace(self, blocked=expand_obstacles(self.blocked, expansion))

    def refined(self, factor: int) -> "GridMap":
        """Divide each cell into factor x factor, the shore by bilinear interpolation.

        The occupancy (1 in blocked cells, 0 in free ones) is interpolated between cell centres
        and thresholded at 0.5; exactly 0.5 is blocked. Water that is 4-connected stays so. A
        factor of 2 only divides the cells; from 3 on, corners of the shore are rounded.

        Args:
            factor: how many new cells along the edge of an old one, >= 1.

        Raises:
            BadTypeError: ``factor`` is not an integer.
            BadInputError: it is below 1, or the new map has more than MOST_CELLS.
        """
        factor = whole_number("factor", factor, 1)
        height, width = (factor * side for side in self.shape)
        check_size(height, width, f"a map refined by a factor of {shown(factor)}")
        old = self.blocked.astype(np.int32)
        blocked = np.empty((height, width), bool)
        # Weights are whole multiples of 1 / (2 factor), so integers decide 0.5 exactly.
        for rows in bands(height, width):
            north = _interpolate(old, factor, np.arange(height)[rows])
            weight = _interpolate(np.ascontiguousarray(north.T), factor, np.arange(width)).T
            blocked[rows] = weight * 2 >= (2 * factor) ** 2
        return replace(self, blocked=blocked, cell_size=self.cell_size / factor)

    def components(self) -> np.ndarray:
        """Label connected water, largest body first.

        Cells connect through edges (4-connected). Moving diagonally where both side cells are
        free reaches exactly the same cells, so this serves both kinds of planner.

        Returns:
            int32[H, W]: 0 in blocked cells, 1 in the largest body, 2 in the next, ...
        """
        labels, count = scipy.ndimage.label(~self.blocked)
        sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
        rank = np.zeros(count + 1, np.int32)
        rank[1 + np.argsort(-sizes, kind="stable")] = np.arange(1, count + 1)
        return rank[labels]

    def largest_component(self) -> np.ndarray:
        """Cells of the largest connected body of water, bool[H, W]; none on a blocked map."""
        return self.components() == 1


def _pairs(name: str, value: Any) -> np.ndarray:
    array = checks.any_array(name, value, "numbers [..., 2]")
    if array.dtype.kind not in "biufO":
        raise BadTypeError(f"{name}: got dtype {array.dtype}; wanted real numbers")
    try:
        array = array.astype(np.float64)
    except (TypeError, ValueError):
        raise BadTypeError(f"{name}: got {shown(value)}; wanted numbers [..., 2]") from None
    except OverflowError:
        raise BadInputError(
            f"{name}: got {shown(value)}; wanted numbers that a float holds"
        ) from None
    if array.ndim == 0 or array.shape[-1] != 2:
        raise BadInputError(f"{name}: got shape {array.shape}; wanted [..., 2] for (x, y)")
    if not np.isfinite(array).all():
        raise BadInputError(f"{name}: got NaN or infinity; wanted finite numbers")
    return array


def _interpolate(values: np.ndarray, factor: int, new: np.ndarray) -> np.ndarray:
    """Interpolate along axis 0 at ``new`` centres of ``factor`` parts per cell, times 2 factor."""
    count = values.shape[0]
    # In cells, new centre i lies (2 i + 1 - factor) / (2 factor) from the first old centre.
    lower, part = np.divmod(2 * new + 1 - factor, 2 * factor)
    before = values[np.clip(lower, 0, count - 1)]
    after = values[np.clip(lower + 1, 0, count - 1)]
    return ((2 * factor - part)[:, None] * before + part[:, None] * after).astype(np.int32)
