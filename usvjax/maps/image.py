"""Images as maps: dark pixels are blocked, the top of the image is north.

An image holds neither cell size nor origin; for a map that knows its place use a ROS ``.yaml`` or
a MovingAI ``.map``.
"""

import io
from pathlib import Path

import numpy as np
from PIL import Image

from usvjax import checks
from usvjax.errors import BadInputError
from usvjax.maps import disk
from usvjax.maps.grid_map import GridMap

# ITU-R BT.601 luma, the grey of most image programs.
_LUMA = np.array([0.299, 0.587, 0.114])
_SIXTEEN_BIT = ("I", "I;16", "I;16B", "I;16L", "I;16N")
_FORMATS = {".png": "PNG", ".pgm": "PPM"}


def read_image(
    path: Path,
    cell_size: float | None,
    origin: tuple[float, float] | None = None,
    threshold: float = 0.5,
) -> GridMap:
    """Read a PNG, PGM (P2 or P5) or JPEG as a map.

    Args:
        path: the image.
        cell_size: edge of a pixel, m.
        origin: (x, y) of the south-west corner of the image, m; (0, 0) if None.
        threshold: brightness in [0, 1] (0 black, 1 white) below which a pixel is blocked.
            Transparency is ignored.

    Raises:
        BadInputError: the image cannot be read, or ``cell_size`` is missing.
    """
    if cell_size is None:
        raise BadInputError(f"{path}: an image has no scale; give cell_size, the metres per pixel")
    level = checks.fraction("threshold", threshold)
    pixels = read_pixels(path)
    grey = pixels[..., 0] if pixels.shape[-1] == 1 else pixels[..., :3] @ _LUMA
    blocked = grey < 255.0 * level
    return GridMap(blocked[::-1], cell_size, (0.0, 0.0) if origin is None else origin, path.stem)


def read_pixels(path: Path) -> np.ndarray:
    """Read an image, top row first.

    Returns:
        float64[H, W, C] in [0, 255], C = 1 (grey), 3 (red, green, blue) or 4 (and alpha).

    Raises:
        BadInputError: the file is missing, truncated or not an image.
    """
    content = disk.read_bytes(path)
    try:
        with Image.open(io.BytesIO(content)) as image:
            pixels = _to_array(image)
    except Image.UnidentifiedImageError:
        raise BadInputError(f"{path}: not an image that can be read") from None
    except (OSError, ValueError, SyntaxError, EOFError, Image.DecompressionBombError) as error:
        raise BadInputError(f"{path}: a damaged image ({error})") from None
    return pixels.reshape(*pixels.shape[:2], -1)


def _to_array(image: Image.Image) -> np.ndarray:
    if image.mode in _SIXTEEN_BIT:
        return np.asarray(image, np.float64) / 257.0
    if image.mode in ("1", "L"):
        return np.asarray(image.convert("L"), np.float64)
    mode = "RGBA" if image.has_transparency_data else "RGB"
    return np.asarray(image.convert(mode), np.float64)


def encode_image(grid: GridMap, path: Path, free: int = 255) -> dict[Path, bytes]:
    """Return a grey PNG or binary PGM: blocked cells 0, free cells ``free``, north on top."""
    pixels = np.where(grid.blocked, 0, free).astype(np.uint8)[::-1]
    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, format=_FORMATS[path.suffix.lower()])
    return {path: stream.getvalue()}
