"""Hongze Lake, the packaged real map, and finding maps by name."""

import re
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from usvjax import checks
from usvjax.errors import BadInputError
from usvjax.maps.files import load_map
from usvjax.maps.grid_map import GridMap
from usvjax.public import public

SHIPPED_CELL_SIZES = (250, 500, 1000)
_FINEST = 250
# 25 x 25 new cells per old one: 10 m cells, 97 million of them, about the most one array bears.
_LARGEST_FACTOR = 25
_FOLDER = Path(__file__).parent.parent / "data" / "hongze"
_ATTRIBUTION = "Shoreline: GSHHG (Wessel & Smith 1996), LGPL-3.0"
_NAME = re.compile(r"hongze-(\d+(?:\.\d+)?)")


@public()
def hongze_lake(cell_size: float = 250) -> GridMap:
    """Hongze Lake, Jiangsu, China: about 2,240 km2 of water and its islands, north up.

    The shoreline is GSHHG at full resolution (Wessel and Smith 1996, doi:10.1029/96JB00104),
    LGPL-3.0; see ``usvjax/data/hongze/ATTRIBUTION.md``. x and y are metres east and north of the
    south-west corner of the 250 m map; the north-west corner, 117.7475 E 33.669164 N, is common
    to every cell size, so that points mean the same place on all of them. Not for navigation.

    Args:
        cell_size: edge of a cell, m: 250, 500 or 1,000 as rasterised from the shoreline, or 250
            divided by a whole number up to 25, interpolated from the 250 m map.

    Raises:
        BadTypeError: ``cell_size`` is not a number.
        BadInputError: it is none of these sizes.
    """
    size = checks.positive("cell_size", cell_size)
    if size in SHIPPED_CELL_SIZES:
        return _shipped(int(size))
    # Bounded, since the quotient of a tiny size is infinite, which cannot be rounded.
    factor = round(min(_FINEST / size, 1e6))
    if size > _FINEST or abs(factor * size - _FINEST) > 1e-6 * _FINEST:
        raise BadInputError(
            f"cell_size: got {size:g}; wanted 250, 500, 1000 or a whole fraction of 250 (m)"
        )
    if factor > _LARGEST_FACTOR:
        raise BadInputError(
            f"cell_size: got {size:g}; wanted at least {_FINEST / _LARGEST_FACTOR:g} m"
        )
    return _shipped(_FINEST).refined(factor)


@public()
def find_map(
    name: Any, *, cell_size: float | None = None, origin: tuple[float, float] | None = None
) -> GridMap:
    """Return a packaged map by its name, or load a file.

    Args:
        name: ``hongze-250`` (or another cell size that ``hongze_lake`` takes), or the path of a
            map file.
        cell_size: as for ``load_map``; a packaged map has its own.
        origin: likewise.

    Raises:
        BadTypeError: an argument has the wrong type.
        BadInputError: there is no such map, or the file is malformed.
    """
    text = str(checks.file_path("map", name))
    match = _NAME.fullmatch(text)
    if match is None:
        if not Path(text).suffix:
            raise BadInputError(
                f"{text}: neither a map file nor a packaged map ({', '.join(packaged_names())})"
            )
        return load_map(text, cell_size=cell_size, origin=origin)
    if cell_size is not None or origin is not None:
        raise BadInputError(
            f"{text}: a packaged map has its own cell size (the number in its name) and origin"
        )
    return hongze_lake(float(match.group(1)))


def is_packaged_name(text: str) -> bool:
    """Whether ``find_map`` takes this for the name of a packaged map, not for a file."""
    return _NAME.fullmatch(text) is not None


def packaged_names() -> list[str]:
    """Names of the packaged maps, for ``find_map``."""
    return [f"hongze-{size}" for size in SHIPPED_CELL_SIZES]


@lru_cache
def _shipped(cell_size: int) -> GridMap:
    grid = load_map(_FOLDER / f"hongze_{cell_size}m.map")
    if cell_size == _FINEST:
        return replace(grid, attribution=_ATTRIBUTION)
    # The coarser maps reach a little further south; hang all of them from the north-west corner.
    south = _shipped(_FINEST).extent[3] - grid.extent[3]
    return replace(grid, origin=(0.0, south), attribution=_ATTRIBUTION)
