"""Load and save maps; the suffix of the file chooses the format."""

from pathlib import Path
from typing import Any

from usvjax import checks
from usvjax.errors import BadInputError
from usvjax.maps import disk
from usvjax.maps.grid_map import GridMap
from usvjax.maps.image import encode_image, read_image
from usvjax.maps.movingai import encode_movingai, read_movingai
from usvjax.maps.ros import Unknown, encode_ros, read_ros
from usvjax.public import public

_MOVINGAI = (".map",)
_ROS = (".yaml", ".yml")
_LOSSLESS = (".png", ".pgm")
_IMAGE = (*_LOSSLESS, ".jpg", ".jpeg")


@public()
def load_map(
    path: Any,
    *,
    cell_size: float | None = None,
    origin: tuple[float, float] | None = None,
    unknown: Unknown = "blocked",
    threshold: float = 0.5,
) -> GridMap:
    """Load a map from a file.

    - ``.map``: MovingAI; row 0 is y = 0. A JSON file of the same stem may give ``cell_size_m``,
      ``origin`` ([x, y], m), ``name``, ``source``, ``licence`` and ``row_0: "north"``, which puts
      the first row at the top. Terrain ``.``, ``G``, ``S``, ``E`` is free; ``@``, ``O``, ``T``,
      ``W`` blocked.
    - ``.yaml``, ``.yml``: ROS map_server with its image; yaw must be 0.
    - ``.png``, ``.pgm``, ``.jpg``, ``.jpeg``: dark is blocked, the top is north; needs
      ``cell_size``. What is transparent counts as it looks on white paper.

    Args:
        path: the file.
        cell_size: edge of a cell, m; overrides what the file says.
        origin: (x, y) of the south-west corner, m; overrides what the file says.
        unknown: what the unknown cells of a ROS map become.
        threshold: brightness in [0, 1] below which a pixel of a plain image is blocked.

    Raises:
        BadTypeError: an argument has the wrong type.
        BadInputError: the file is missing, truncated, malformed or too large (see
            ``usvjax.maps.disk`` and ``grid_map.MOST_CELLS``), an image is all blocked or all free
            for its transparency, or an argument is out of range.
    """
    place = checks.file_path("path", path)
    if cell_size is not None:
        cell_size = checks.positive("cell_size", cell_size)
    if origin is not None:
        origin = checks.pair("origin", origin)
    suffix = place.suffix.lower()
    if suffix in _MOVINGAI:
        return read_movingai(place, cell_size, origin)
    if suffix in _ROS:
        return read_ros(place, cell_size, origin, unknown)
    if suffix in _IMAGE:
        return read_image(place, cell_size, origin, threshold)
    raise BadInputError(_unknown_format(place, (*_MOVINGAI, *_ROS, *_IMAGE)))


@public()
def save_map(grid: GridMap, path: Any, *, replace: bool = True) -> list[Path]:
    """Save a map; loading it again gives the same cells, cell size and origin.

    ``.map`` gets a JSON sidecar of the same stem unless cells are 1 m and the origin is (0, 0);
    ``.yaml`` gets a ``.pgm`` of the same stem; ``.png`` and ``.pgm`` hold the cells alone, so
    loading them needs ``cell_size`` (and ``origin``) again. Existing files are replaced, but only
    once everything new is safely on disk; a ``.json`` or ``.pgm`` of the same stem that is not
    part of a saved map is never replaced.

    Args:
        grid: the map.
        path: the file.
        replace: False refuses to replace existing files (sidecars and images included).

    Returns:
        The files written.

    Raises:
        BadTypeError: an argument has the wrong type.
        BadInputError: the format is unknown, the file cannot be written, it exists and
            ``replace`` is False, or a file that is not the map's has the name of its sidecar or
            image.
    """
    place = checks.file_path("path", path)
    suffix = place.suffix.lower()
    if suffix in _MOVINGAI:
        files = encode_movingai(grid, place)
    elif suffix in _ROS:
        files = encode_ros(grid, place)
    elif suffix in _LOSSLESS:
        files = encode_image(grid, place)
    else:
        raise BadInputError(_unknown_format(place, (*_MOVINGAI, *_ROS, *_LOSSLESS)))
    if not replace:
        for existing in filter(Path.exists, files):
            raise BadInputError(
                f"{existing}: exists already; give replace=True (--force on the command line) "
                f"to replace it"
            )
    disk.write_all(files)
    return list(files)


def _unknown_format(path: Path, known: tuple[str, ...]) -> str:
    return f"{path}: got suffix {path.suffix!r}; wanted one of {', '.join(known)}"
