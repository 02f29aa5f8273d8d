"""MovingAI ``.map`` files (Sturtevant, Benchmarks for Grid-Based Pathfinding, 2012).

Free terrain is ``.`` and ``G`` (ground), ``S`` (swamp, passable from ground; a station in maps of
the League of Robot Runners) and ``E`` (a station there, too); ``@`` and ``O`` (out of bounds),
``T`` (trees) and ``W`` (water of a land map, not passable from ground) are blocked. Row 0 of the
file is y = 0, the benchmark's own convention, unless a sidecar says that it is the northern edge.
Of the header, height and width may come in either order and its words in capitals.
"""

import re
from pathlib import Path

import numpy as np

from usvjax.checks import shown
from usvjax.errors import BadInputError, printable
from usvjax.maps import disk
from usvjax.maps.grid_map import GridMap, check_size
from usvjax.maps.sidecar import Sidecar, encode_sidecar, read_sidecar, sidecar_path
from usvjax.memory import check_memory

FREE, BLOCKED = b".GSE", b"@OTW"
_HEADER = {
    "type octile": "type octile",
    "height H": "height [0-9]{1,9}",
    "width W": "width [0-9]{1,9}",
    "map": "map",
}
_LINE_BYTES = 128  # of memory for each line of a map while it is read, its cells aside
_LONGEST_HEADER = 2**16


def read_movingai(
    path: Path, cell_size: float | None = None, origin: tuple[float, float] | None = None
) -> GridMap:
    """Read a MovingAI map and its sidecar; given cell size and origin win over the sidecar's.

    Raises:
        BadInputError: the map or its sidecar is missing, truncated, malformed or too large.
    """
    blocked = _parse(disk.read_text_bytes(path, disk.MOST_BYTES), path)
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
        sidecar.name or printable(path.stem),
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
    height, width, above = _parse_header(content[:_LONGEST_HEADER].splitlines(), path)
    check_size(height, width, f"{path}: a map")
    line_ends = content.count(b"\n") + content.count(b"\r")
    check_memory(2 * len(content) + _LINE_BYTES * line_ends, f"{path}: a map of {line_ends} lines")
    rows = [line.rstrip() for line in content.rstrip().splitlines()[above:]]
    if len(rows) < height:
        raise BadInputError(f"{path}: ends after {len(rows)} of the {height} rows it declares")
    if len(rows) > height:
        raise BadInputError(f"{path}: has {len(rows)} rows, but declares height {height}")
    for number, row in enumerate(rows, start=above + 1):
        if len(row) != width:
            raise BadInputError(
                f"{path} line {number}: has {len(row)} cells, but the map declares width {width}"
            )
    cells = np.frombuffer(b"".join(rows), np.uint8).reshape(height, width)
    _check_terrain(cells, above, path)
    return np.isin(cells, np.frombuffer(BLOCKED, np.uint8))


def _parse_header(lines: list[bytes], path: Path) -> tuple[int, int, int]:
    """Height, width, and how many lines the header takes up."""
    values: dict[str, str] = {}
    left = [["type octile"], ["height H", "width W"], ["map"]]
    for number, line in enumerate([*lines, b""], start=1):
        words = line.decode(errors="replace").split()
        if not words and number <= len(lines):
            continue
        text = " ".join(words)
        what = next((w for w in left[0] if re.fullmatch(_HEADER[w], text.lower())), None)
        if what is None:
            wanted = " or ".join(f'"{what}"' for what in left[0])
            raise BadInputError(
                f"{path} line {number}: a MovingAI map has {wanted} here, got {shown(text)}"
            )
        values[what] = words[-1]
        left[0].remove(what)
        left = [whats for whats in left if whats]
        if not left:
            break
    height, width = int(values["height H"]), int(values["width W"])
    if height == 0 or width == 0:
        raise BadInputError(f"{path}: height and width must be above 0, got {height} x {width}")
    return height, width, number


def _check_terrain(cells: np.ndarray, above: int, path: Path) -> None:
    known = np.isin(cells, np.frombuffer(FREE + BLOCKED, np.uint8))
    if not known.all():
        row, column = np.argwhere(~known)[0]
        raise BadInputError(
            f"{path} line {row + above + 1}, column {column + 1}: "
            f"{chr(cells[row, column])!r} is no MovingAI terrain "
            f"(free: {' '.join(FREE.decode())}; blocked: {' '.join(BLOCKED.decode())})"
        )
