"""Images as maps: dark pixels are blocked, the top of the image is north.

An image holds neither cell size nor origin; for a map that knows its place use a ROS ``.yaml`` or
a MovingAI ``.map``.
"""

import io
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image

from usvjax import checks
from usvjax.errors import BadInputError, printable
from usvjax.maps import disk
from usvjax.maps.grid_map import MOST_CELLS, GridMap, bands, check_size

# ITU-R BT.601 luma, the grey of most image programs.
_LUMA = np.array([0.299, 0.587, 0.114])
_SIXTEEN_BIT = ("I", "I;16", "I;16B", "I;16L", "I;16N")
_MODES = (*_SIXTEEN_BIT, "1", "L", "LA", "P", "PA", "RGB", "RGBA", "CMYK")
_FORMATS = {".png": "PNG", ".pgm": "PPM"}
# What Pillow may try: others can do more than hold an image, such as run a program.
_READ = ("PNG", "PPM", "JPEG", "BMP")
_OTHERS = {b"II*\0": "TIFF", b"MM\0*": "TIFF", b"GIF8": "GIF", b"%!PS": "EPS", b"RIFF": "WebP"}
# Of memory for a pixel: four as it is decoded, its cell twice, and the share of a band's floats.
_PIXEL_BYTES = 8
_MOST_OF_ERROR = 100


def read_image(
    path: Path,
    cell_size: float | None,
    origin: tuple[float, float] | None = None,
    threshold: float = 0.5,
) -> GridMap:
    """Read a PNG, PGM (P2 or P5), JPEG or BMP as a map.

    Args:
        path: the image.
        cell_size: edge of a pixel, m.
        origin: (x, y) of the south-west corner of the image, m; (0, 0) if None.
        threshold: brightness in [0, 1] (0 black, 1 white) below which a pixel is blocked. What
            is transparent counts as it looks on white paper.

    Raises:
        BadInputError: the image cannot be read or is too large, ``cell_size`` is missing, or
            every pixel comes out alike because of its transparency.
    """
    if cell_size is None:
        raise BadInputError(f"{path}: an image has no scale; give cell_size, the metres per pixel")
    level = 255.0 * checks.fraction("threshold", threshold)
    blocked = read_cells(path, lambda pixels: _on_white(pixels) < level)
    place = (0.0, 0.0) if origin is None else origin
    return GridMap(blocked[::-1], cell_size, place, printable(path.stem))


def _on_white(pixels: np.ndarray) -> np.ndarray:
    """Brightness in [0, 255] of float64[..., C] pixels, on white where they are transparent."""
    if pixels.shape[-1] == 1:
        return pixels[..., 0]
    grey: np.ndarray = pixels[..., :3] @ _LUMA
    if pixels.shape[-1] == 4:
        grey = 255.0 + (grey - 255.0) * pixels[..., 3] / 255.0
    return grey


def read_cells(path: Path, blocked_where: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Read which pixels of an image are blocked.

    Args:
        path: the image.
        blocked_where: takes some rows, float64[h, W, C] in [0, 255] with C = 1 (grey), 3 (red,
            green, blue) or 4 (and alpha), and says which pixels are blocked, bool[h, W].

    Returns:
        bool[H, W], top row first.

    Raises:
        BadInputError: the file is missing, truncated, too large or not an image, or all pixels
            come out alike although some are transparent.
    """
    image = _decoded(disk.read_bytes(path), path)
    blocked = np.empty(image.size[::-1], bool)
    transparent = False
    for rows in bands(*blocked.shape):
        box = (0, rows.start, image.width, rows.stop)
        pixels = _to_array(image.crop(box))
        blocked[rows] = blocked_where(pixels)
        transparent |= pixels.shape[-1] == 4 and bool((pixels[..., 3] < 255.0).any())
    if transparent and (blocked.all() or not blocked.any()):
        every = "blocked" if blocked[0, 0] else "free"
        raise BadInputError(
            f"{path}: every cell comes out {every}, as the image is transparent in part; save it "
            f"without transparency, on white"
        )
    return blocked


def _decoded(content: bytes, path: Path) -> Image.Image:
    """An image in memory, of a mode that can be read and no larger than a map may be."""
    try:
        with warnings.catch_warnings():
            # The bound on the cells of a map is ours, and stricter.
            warnings.simplefilter("ignore")
            image = Image.open(io.BytesIO(content), formats=_READ)
            check_size(image.height, image.width, f"{path}: an image", _PIXEL_BYTES)
            if getattr(image, "is_animated", False):
                raise BadInputError(f"{path}: is an animated image; wanted a single picture")
            image.load()
    except BadInputError:
        raise
    except Image.UnidentifiedImageError:
        other = next((name for start, name in _OTHERS.items() if content.startswith(start)), None)
        what = f"a {other} file" if other else "not an image that can be read"
        raise BadInputError(f"{path}: {what}; wanted PNG, PGM, JPEG or BMP") from None
    except Image.DecompressionBombError:
        raise BadInputError(f"{path}: has too many pixels; wanted {MOST_CELLS:,} at most") from None
    except Exception as error:
        # A decoder raises whatever it meets with in a damaged file.
        said = str(error)[:_MOST_OF_ERROR]
        raise BadInputError(f"{path}: a damaged image ({said})") from None
    if image.mode not in _MODES:
        raise BadInputError(f"{path}: has pixels of kind {image.mode!r}; wanted grey or colours")
    if image.mode in _SIXTEEN_BIT and image.has_transparency_data:
        raise BadInputError(f"{path}: has 16-bit grey that may be transparent; wanted it opaque")
    return image


def _to_array(image: Image.Image) -> np.ndarray:
    """Pixels as float64[H, W, C] in [0, 255]."""
    if image.mode in _SIXTEEN_BIT:
        return np.asarray(image, np.float64)[..., None] / 257.0
    if image.mode in ("1", "L") and not image.has_transparency_data:
        return np.asarray(image.convert("L"), np.float64)[..., None]
    mode = "RGBA" if image.has_transparency_data else "RGB"
    return np.asarray(image.convert(mode), np.float64)


def encode_image(grid: GridMap, path: Path, free: int = 255) -> dict[Path, bytes]:
    """Return a grey PNG or binary PGM: blocked cells 0, free cells ``free``, north on top."""
    pixels = np.where(grid.blocked, np.uint8(0), np.uint8(free))[::-1]
    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, format=_FORMATS[path.suffix.lower()])
    return {path: stream.getvalue()}
