"""MovingAI ``.map`` files (Sturtevant, Benchmarks for Grid-Based Pathfinding, 2012).

Free terrain is ``.`` and ``G`` (ground) and ``S`` (swamp, passable from ground); ``@`` and ``O``
(out of bounds), ``T`` (trees) and ``W`` (water of a land map, not passable from ground) are
blocked. Row 0 of the file is y = 0, the benchmark's own convention, unless a sidecar says that it
is the northern edge.
"""

import re
from pathlib import Path

import numpy as np

from usvjax.errors import BadInputError
from usvjax.maps import disk
from usvjax.maps.grid_map import GridMap
from usvjax.maps.sidecar import Sidecar, encode_sidecar, read_sidecar, sidecar_path

FREE, BLOCKED = b".GS", b"@OTW"
_HEADER_LINES = 4


def read_movingai(
    path: Path, cell_size: float | None = None, origin: tuple[float, float] | None = None
) -> GridMap:
    """Read a MovingAI map and its sidecar; given cell size and origin win over the sidecar's.

    Raises:
        BadInputError: the map or its sidecar is missing, truncated or malformed.
    """
    blocked = _parse(disk.read_bytes(path), path)
    sidecar = read_sidecar(path) or Sidecar()
    if sidecar.shape not in (None, blocked.shape):
        raise BadInputError(
            f"{sidecar_path(path)}: says height and width {sidecar.shape}, "
            f"but {path.name} has {blocked.shape}"
        )
    return GridMap(
        blocked[::-1] if sidecar.north_first else blocked,
        sidecar.cell_size if cell_size is None else cell_size,
        sidecar.origin if origin is None else origin,
        sidecar.name or path.stem,
        sidecar.attribution,
    )


def encode_movingai(grid: GridMap, path: Path) -> dict[Path, bytes]:
    """Return the map file and, where the format cannot hold scale and place, its sidecar.

    Raises:
        BadInputError: another program's JSON file has the sidecar's name.
    """
    height, width = grid.shape
    header = f"type octile\nheight {height}\nwidth {width}\nmap\n".encode()
    text = np.where(grid.blocked, BLOCKED[0], FREE[0]).astype(np.uint8)
    rows = np.pad(text, ((0, 0), (0, 1)), constant_values=ord("\n"))
    return {**encode_sidecar(grid, path), path: header + rows.tobytes()}


def _parse(content: bytes, path: Path) -> np.ndarray:
    lines = [line.rstrip() for line in content.rstrip().splitlines()]
    height, width = _parse_header(lines[:_HEADER_LINES], path)
    rows = lines[_HEADER_LINES:]
    if len(rows) < height:
        raise BadInputError(f"{path}: ends after {len(rows)} of the {height} rows it declares")
    if len(rows) > height:
        raise BadInputError(f"{path}: has {len(rows)} rows, but declares height {height}")
    for number, row in enumerate(rows, start=_HEADER_LINES + 1):
        if len(row) != width:
            raise BadInputError(
                f"{path} line {number}: has {len(row)} cells, but the map declares width {width}"
            )
    cells = np.frombuffer(b"".join(rows), np.uint8).reshape(height, width)
    _check_terrain(cells, path)
    return np.isin(cells, np.frombuffer(BLOCKED, np.uint8))


def _parse_header(lines: list[bytes], path: Path) -> tuple[int, int]:
    wanted = (
        (rb"type\s+octile", "type octile"),
        (rb"height\s+(\d{1,9})", "height H"),
        (rb"width\s+(\d{1,9})", "width W"),
        (rb"map", "map"),
    )
    sizes = []
    for index, (pattern, meaning) in enumerate(wanted):
        line = lines[index] if index < len(lines) else b""
        match = re.fullmatch(pattern, line.strip())
        if match is None:
            shown = line[:40].decode(errors="replace")
            raise BadInputError(
                f'{path} line {index + 1}: a MovingAI map has "{meaning}" here, got "{shown}"'
            )
        sizes += [int(size) for size in match.groups()]
    height, width = sizes
    if height == 0 or width == 0:
        raise BadInputError(f"{path}: height and width must be above 0, got {height} x {width}")
    return height, width


def _check_terrain(cells: np.ndarray, path: Path) -> None:
    known = np.isin(cells, np.frombuffer(FREE + BLOCKED, np.uint8))
    if not known.all():
        row, column = np.argwhere(~known)[0]
        raise BadInputError(
            f"{path} line {row + _HEADER_LINES + 1}, column {column + 1}: "
            f"{chr(cells[row, column])!r} is no MovingAI terrain "
            f"(free: {' '.join(FREE.decode())}; blocked: {' '.join(BLOCKED.decode())})"
        )
