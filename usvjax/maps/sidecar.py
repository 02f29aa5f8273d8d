"""The JSON sidecar of a MovingAI map: its scale, its place and which way its rows run."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from usvjax import checks
from usvjax.checks import shown, whole_number
from usvjax.errors import BadInputError, BadTypeError, printable
from usvjax.maps import disk
from usvjax.maps.grid_map import GridMap

# A JSON file with none of these beside a map is somebody else's file.
_MARKS = ("cell_size_m", "origin", "row_0")
_MOST_WORDS = 1000


@dataclass(frozen=True)
class Sidecar:
    """What a sidecar says; the defaults are MovingAI's own convention.

    Attributes:
        cell_size: edge of a cell, m.
        origin: (x, y) of the south-west corner of the map, m.
        north_first: True if the first row of the file is the northern edge.
        shape: (H, W) that it claims for the map; None where it says nothing.
        name: what the map shows.
        attribution: source and licence of the data.
    """

    cell_size: float = 1.0
    origin: tuple[float, float] = (0.0, 0.0)
    north_first: bool = False
    shape: tuple[int, int] | None = None
    name: str = ""
    attribution: str = ""


def sidecar_path(map_path: Path) -> Path:
    """Path of the sidecar of a map file: the same stem, ``.json``."""
    return map_path.with_suffix(".json")


def read_sidecar(map_path: Path) -> Sidecar | None:
    """Read the sidecar of a map; None where there is none.

    Raises:
        BadInputError: the sidecar is malformed.
    """
    path = sidecar_path(map_path)
    if not path.exists():
        return None
    content = _parse(path)
    if not isinstance(content, dict) or not any(mark in content for mark in _MARKS):
        return None
    try:
        return _sidecar_of(content)
    except (BadInputError, BadTypeError) as error:
        raise BadInputError(f"{path}: {error}") from None


def encode_sidecar(grid: GridMap, map_path: Path) -> dict[Path, bytes]:
    """Return the sidecar file that a map needs: none for unit cells at the origin.

    A sidecar that is already there is replaced even then: it describes the old map.

    Raises:
        BadInputError: another program's JSON file has the sidecar's name.
    """
    path = sidecar_path(map_path)
    plain = grid.cell_size == 1.0 and grid.origin == (0.0, 0.0) and not grid.attribution
    if read_sidecar(map_path) is None:
        if plain:
            return {}
        if path.exists():
            raise BadInputError(
                f"{path}: is not the sidecar of a map and would be overwritten by the cell size "
                f"and origin of {map_path.name}; save the map under another name"
            )
    height, width = grid.shape
    content: dict[str, Any] = {
        "name": grid.name,
        "attribution": grid.attribution,
        "cell_size_m": grid.cell_size,
        "origin": list(grid.origin),
        "height": height,
        "width": width,
        "row_0": "south",
    }
    text = json.dumps({key: value for key, value in content.items() if value != ""}, indent=1)
    return {path: f"{text}\n".encode()}


def _parse(path: Path) -> Any:
    text = disk.read_text(path)
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        raise BadInputError(f"{path} line {error.lineno}: not valid JSON ({error.msg})") from None
    except RecursionError:
        raise BadInputError(f"{path}: not valid JSON (nested too deeply)") from None
    except ValueError:
        # Of json.loads, only Python's limit on the digits of a whole number is left.
        raise BadInputError(f"{path}: holds a whole number of too many digits") from None


def _sidecar_of(content: dict[str, Any]) -> Sidecar:
    row_0 = content.get("row_0", "south")
    if row_0 not in ("north", "south"):
        raise BadInputError(f"row_0: got {shown(row_0)}; wanted 'north' or 'south'")
    shape = None
    if "height" in content and "width" in content:
        shape = (
            whole_number("height", content["height"], 1),
            whole_number("width", content["width"], 1),
        )
    return Sidecar(
        cell_size=checks.positive("cell_size_m", content.get("cell_size_m", 1.0)),
        origin=checks.pair("origin", content.get("origin", (0.0, 0.0))),
        north_first=row_0 == "north",
        shape=shape,
        name=_words(content, "name"),
        attribution=_words(content, "attribution")
        or "; ".join(filter(None, (_words(content, key) for key in ("source", "licence")))),
    )


def _words(content: dict[str, Any], key: str) -> str:
    """A text that titles and tables show; what cannot be printed is escaped."""
    text = content.get(key, "")
    if not isinstance(text, str):
        raise BadTypeError(f"{key}: got {shown(text)}; wanted text")
    if len(text) > _MOST_WORDS:
        raise BadInputError(f"{key}: has {len(text)} characters; wanted at most {_MOST_WORDS}")
    return printable(text)
