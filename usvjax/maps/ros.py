"""ROS map_server maps: a ``.yaml`` that names an image and says how to read it.

The rules are those of map_server's image loader. With s the mean of a pixel's channels (alpha
included in trinary mode), the occupancy probability is p = (255 - s) / 255, or s / 255 if
``negate``; a cell is occupied when p > occupied_thresh, free when p < free_thresh, and unknown in
between. Mode ``scale`` grades the cells in between from 1 to 99 per cent (transparent ones are
unknown); mode ``raw`` takes s (255 - s if ``negate``) as the percentage, unknown above 100. A
graded cell counts as blocked from 50 per cent up.

Names of modes may be in capitals, numbers and flags in quotation marks, and the yaw left out.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np
import yaml

from usvjax import checks
from usvjax.checks import one_of, shown
from usvjax.errors import BadInputError, BadTypeError, printable
from usvjax.maps import disk
from usvjax.maps.grid_map import GridMap
from usvjax.maps.image import encode_image, read_cells

Unknown = Literal["blocked", "free"]

_REQUIRED = ("image", "resolution", "origin", "occupied_thresh", "free_thresh", "negate")
_MODES = ("trinary", "scale", "raw")
_BLOCKED_FROM_PERCENT = 50.0
_UNKNOWN = -1.0
_FLAGS = {"0": False, "false": False, "no": False, "1": True, "true": True, "yes": True}
# What the YAML loader lets through for a date of no calendar, !!int "abc", !!bool "abc", ...
_NOT_CONVERTED = (ValueError, ArithmeticError, LookupError, AttributeError)
_MOST_TEXT = 2**16  # bytes: these files have seven keys, and reading YAML takes its time
# map_saver writes these, so that its own readers see free and occupied, nothing unknown.
_OCCUPIED_THRESH, _FREE_THRESH, _FREE_PIXEL = 0.65, 0.196, 254


def read_ros(
    path: Path,
    cell_size: float | None = None,
    origin: tuple[float, float] | None = None,
    unknown: Unknown = "blocked",
) -> GridMap:
    """Read a map_server map; given cell size and origin win over the file's.

    Args:
        path: the ``.yaml``; its image lies relative to it.
        cell_size: edge of a cell, m; None takes ``resolution``.
        origin: (x, y) of the lower left corner, m; None takes the file's.
        unknown: what unknown cells become.

    Raises:
        BadInputError: the file or its image is missing or malformed, a value is out of range, or
            the map is rotated.
    """
    one_of("unknown", unknown, ("blocked", "free"))
    content = _parse(path)
    try:
        resolution = checks.positive("resolution", _as_number(content["resolution"]))
        corner = _corner(content["origin"])
        percent = _percent_of(content)
        image = checks.file_path("image", content["image"])
        occupied = read_cells(
            path.parent / image, lambda pixels: _blocked(percent(pixels), unknown)
        )
    except (BadInputError, BadTypeError) as error:
        raise BadInputError(f"{path}: {error}") from None
    return GridMap(
        occupied[::-1],
        resolution if cell_size is None else cell_size,
        corner if origin is None else origin,
        printable(path.stem),
    )


def _blocked(percent: np.ndarray, unknown: Unknown) -> np.ndarray:
    """Which cells are blocked by their occupancy in per cent, _UNKNOWN where it is not known."""
    return np.where(percent == _UNKNOWN, unknown == "blocked", percent >= _BLOCKED_FROM_PERCENT)


def encode_ros(grid: GridMap, path: Path) -> dict[Path, bytes]:
    """Return a trinary map_server ``.yaml`` and its ``.pgm`` of the same stem.

    Raises:
        BadInputError: there is an image of that name, but no ``.yaml`` that it could belong to.
    """
    image = path.with_suffix(".pgm")
    if image.exists() and not path.exists():
        raise BadInputError(
            f"{image}: is not the image of {path.name}, which does not exist yet, and would be "
            f"overwritten; save the map under another name"
        )
    content = {
        "image": image.name,
        "mode": "trinary",
        "resolution": grid.cell_size,
        "origin": [*grid.origin, 0.0],
        "negate": 0,
        "occupied_thresh": _OCCUPIED_THRESH,
        "free_thresh": _FREE_THRESH,
    }
    text = yaml.safe_dump(content, sort_keys=False, default_flow_style=None)
    if grid.attribution:
        note = printable(" ".join(f"{grid.name}: {grid.attribution}".split()))
        text = f"# {note}\n{text}"
    return {**encode_image(grid, image, free=_FREE_PIXEL), path: text.encode()}


class _RefusedError(yaml.MarkedYAMLError):
    """A value is not of the type that its tag or its looks say, or may stand for many."""


class _Loader(yaml.SafeLoader):
    """The safe loader without anchors, which names the line of a value it cannot convert."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Read a node; what anchors repeat, one in another, soon fills any memory."""
        event: Any = self.peek_event()
        if event.anchor is not None:
            problem = "anchors and aliases, & and *, are not read"
            raise _RefusedError(problem=problem, problem_mark=event.start_mark)
        return super().compose_node(parent, index)

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        """Return the value of a node."""
        try:
            return super().construct_object(node, deep=deep)
        except _NOT_CONVERTED:
            kind = node.tag.rsplit(":")[-1]
            problem = f"{shown(node.value)} cannot be read as {kind[:20]}"
            raise _RefusedError(problem=problem, problem_mark=node.start_mark) from None


def _parse(path: Path) -> dict[str, Any]:
    text = disk.read_text(path, _MOST_TEXT)
    try:
        content = yaml.load(text, _Loader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = f" line {mark.line + 1}" if mark else ""
        reason = f" ({error.problem})" if isinstance(error, _RefusedError) else ""
        raise BadInputError(f"{path}{place}: not valid YAML{reason}") from None
    except RecursionError:
        raise BadInputError(f"{path}: not valid YAML (nested too deeply)") from None
    if not isinstance(content, dict):
        raise BadInputError(f"{path}: not a map_server file (no keys)")
    missing = [key for key in _REQUIRED if key not in content]
    if missing:
        raise BadInputError(f"{path}: not a map_server file, lacks {', '.join(missing)}")
    return content


def _percent_of(content: dict[str, Any]) -> Callable[[np.ndarray], np.ndarray]:
    """How the file reads pixels, float64[h, W, C]: occupancy in per cent, -1 where unknown."""
    mode = content.get("mode", "trinary")
    mode = mode.lower() if isinstance(mode, str) else mode
    one_of("mode", mode, _MODES)
    free, occupied = _thresholds(content)
    negate = _as_flag(content["negate"])

    def percent(pixels: np.ndarray) -> np.ndarray:
        has_alpha = pixels.shape[-1] == 4
        shade = (pixels if mode == "trinary" or not has_alpha else pixels[..., :3]).mean(axis=-1)
        if mode == "raw":
            value = np.floor(255.0 - shade if negate else shade)
            return np.where(value <= 100, value, _UNKNOWN)
        p = (shade if negate else 255.0 - shade) / 255.0
        between = np.full(p.shape, _UNKNOWN)
        if mode == "scale" and occupied > free:
            between = np.floor(1.0 + 98.0 * (p - free) / (occupied - free))
            if has_alpha:
                between[pixels[..., 3] < 255] = _UNKNOWN
        return np.where(p > occupied, 100.0, np.where(p < free, 0.0, between))

    return percent


def _thresholds(content: dict[str, Any]) -> tuple[float, float]:
    free = checks.fraction("free_thresh", _as_number(content["free_thresh"]))
    occupied = checks.fraction("occupied_thresh", _as_number(content["occupied_thresh"]))
    if free > occupied:
        raise BadInputError(
            f"free_thresh: got {free:g}; wanted at most occupied_thresh, {occupied:g}"
        )
    return free, occupied


def _corner(origin: Any) -> tuple[float, float]:
    if not isinstance(origin, list) or len(origin) not in (2, 3):
        raise BadInputError(f"origin: got {shown(origin)}; wanted [x, y, yaw]")
    x, y, *rest = (
        checks.number(f"origin {axis}", _as_number(value))
        for axis, value in zip(("x", "y", "yaw"), origin, strict=False)
    )
    yaw = rest[0] if rest else 0.0
    if yaw != 0:
        raise BadInputError(f"origin: got yaw {yaw:g} rad; wanted 0, rotated maps cannot be read")
    return x, y


def _as_number(value: Any) -> Any:
    """Undo quotation marks, and a quirk of YAML 1.1: 5e-2, without a point, is a string."""
    try:
        return float(value) if isinstance(value, str) else value
    except ValueError:
        return value


def _as_flag(value: Any) -> bool:
    flag = _FLAGS.get(value.lower()) if isinstance(value, str) else value
    if flag not in (0, 1):
        raise BadInputError(f"negate: got {shown(value)}; wanted 0 or 1")
    return bool(flag)
