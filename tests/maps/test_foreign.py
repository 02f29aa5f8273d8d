"""Map files as other programs write them: what is unambiguous is read."""

import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, PngImagePlugin

from usvjax.errors import BadInputError
from usvjax.maps import GridMap, load_map, save_map

POND = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [1, 1, 0, 1]], bool)
MAP = "type octile\nheight 3\nwidth 4\nmap\n..@.\n@...\n@@.@\n"
ROS = """image: pond.pgm
mode: trinary
resolution: 0.5
origin: [1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


@pytest.mark.parametrize(
    "content",
    [
        MAP,
        "\ufeff" + MAP,
        MAP.replace("\n", "\r\n"),
        MAP.replace("\n", "\r"),
        MAP.rstrip(),
        MAP + "\n \n\t\n",
        MAP.replace("height 3\nwidth 4", "width 4\nheight 3"),
        MAP.replace("type octile", "Type Octile").replace("\nmap", "\nMAP"),
        MAP.replace("height 3", "HEIGHT\t3 ").replace("map\n", "\nmap\t\n"),
        MAP.replace("@...", "@... \t").replace("..@.", ".E@S"),
    ],
)
def test_a_movingai_map_however_it_is_written(tmp_path: Path, content: str) -> None:
    path = tmp_path / "pond.map"
    path.write_bytes(content.encode())
    assert load_map(path) == GridMap(POND)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("", ""),
        ("image", "\ufeffimage"),
        ("\n", "\r\n"),
        ("trinary", "Trinary"),
        ("mode: trinary\n", "mode: RAW\n"),
        ("mode: trinary\n", ""),
        ("negate: 0", "negate: false"),
        ("negate: 0", 'negate: "0"'),
        ("negate: 0", "negate: 'False'"),
        ("0.5", "'0.5'"),
        ("[1.0, 2.0, 0.0]", '["1.0", 2, "0.0"]'),
        ("[1.0, 2.0, 0.0]", "[1.0, 2.0]"),
        ("free_thresh: 0.196\n", "free_thresh: 0.196"),
    ],
)
def test_a_ros_map_however_it_is_written(tmp_path: Path, old: str, new: str) -> None:
    shades = np.where(POND, 60 if "RAW" in new else 0, 0 if "RAW" in new else 254)[::-1]
    Image.fromarray(shades.astype(np.uint8)).save(tmp_path / "pond.pgm")
    path = tmp_path / "pond.yaml"
    path.write_bytes(ROS.replace(old, new, 1 if old != "\n" else -1).encode())
    assert load_map(path) == GridMap(POND, 0.5, (1.0, 2.0))


def test_negated_by_a_quoted_flag(tmp_path: Path) -> None:
    Image.fromarray(np.where(POND, 255, 0).astype(np.uint8)[::-1]).save(tmp_path / "pond.pgm")
    (tmp_path / "pond.yaml").write_text(ROS.replace("negate: 0", 'negate: "Yes"'))
    assert load_map(tmp_path / "pond.yaml") == GridMap(POND, 0.5, (1.0, 2.0))


def test_a_sidecar_with_a_mark_is_read(tmp_path: Path) -> None:
    save_map(GridMap(POND, 3.0), tmp_path / "pond.map")
    sidecar = tmp_path / "pond.json"
    sidecar.write_bytes(b"\xef\xbb\xbf" + sidecar.read_bytes())
    assert load_map(tmp_path / "pond.map") == GridMap(POND, 3.0)


@pytest.mark.parametrize("name", ["pond.map", "pond.json", "pond.yaml"])
@pytest.mark.parametrize("coding", ["utf-16", "utf-16-be"])
def test_utf_16_is_refused_by_name(tmp_path: Path, name: str, coding: str) -> None:
    for suffix in (".map", ".yaml"):
        save_map(GridMap(POND, 3.0), tmp_path / f"pond{suffix}")
    path = tmp_path / name
    path.write_bytes(path.read_text().encode(coding))  # without a mark where the order is named
    place = rf"{name}: (is UTF-16|holds NUL characters); wanted a text file in UTF-8"
    with pytest.raises(BadInputError, match=place):
        load_map(path if name != "pond.json" else tmp_path / "pond.map")


# --- transparency ----------------------------------------------------------------------------


def drawing(shade: int, paper: int) -> Image.Image:
    """The pond drawn in one shade, opaque, on nothing: what is no land is transparent."""
    pixels = np.zeros((*POND.shape, 4), np.uint8)
    pixels[..., :3] = np.where(POND[::-1], shade, paper)[..., None]
    pixels[..., 3] = np.where(POND[::-1], 255, 0)
    return Image.fromarray(pixels)


def test_black_on_nothing_is_black_on_white(tmp_path: Path) -> None:
    for mode in ("RGBA", "LA"):
        drawing(0, 0).convert(mode).save(tmp_path / "pond.png")
        assert load_map(tmp_path / "pond.png", cell_size=1.0) == GridMap(POND), mode


def test_a_palette_with_a_transparent_colour_is_on_white(tmp_path: Path) -> None:
    image = Image.fromarray(POND[::-1].astype(np.uint8), "P")
    image.putpalette([0, 0, 0, 0, 0, 0])
    image.save(tmp_path / "pond.png", transparency=0)
    assert load_map(tmp_path / "pond.png", cell_size=1.0) == GridMap(POND)


def test_half_transparent_black_is_grey(tmp_path: Path) -> None:
    pixels = np.array([[[0, 0, 0, 100], [0, 0, 0, 160]]], np.uint8)  # 155 and 95 on white
    Image.fromarray(pixels).save(tmp_path / "a.png")
    grid = load_map(tmp_path / "a.png", cell_size=1.0)
    np.testing.assert_array_equal(grid.blocked, [[False, True]])


def test_an_image_that_transparency_makes_all_alike_is_refused(tmp_path: Path) -> None:
    drawing(255, 0).save(tmp_path / "pond.png")
    with pytest.raises(BadInputError, match=r"pond\.png: every cell comes out free, as the image"):
        load_map(tmp_path / "pond.png", cell_size=1.0)
    drawing(0, 0).save(tmp_path / "pond.png")  # by map_server's rule, transparent black is black
    (tmp_path / "pond.yaml").write_text(ROS.replace("pgm", "png"))
    with pytest.raises(BadInputError, match=r"pond\.png: every cell comes out blocked"):
        load_map(tmp_path / "pond.yaml")
    Image.fromarray(np.full((2, 2, 4), 255, np.uint8)).save(tmp_path / "open.png")
    assert not load_map(tmp_path / "open.png", cell_size=1.0).blocked.any()  # opaque, and open


# --- what is no map image --------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["TIFF", "GIF", "WEBP", "EPS"])
def test_other_formats_under_the_name_of_one_are_refused_by_name(tmp_path: Path, kind: str) -> None:
    Image.fromarray(np.zeros((4, 4, 3), np.uint8)).save(tmp_path / "a.png", kind)
    word = {"WEBP": "WebP"}.get(kind, kind)
    with pytest.raises(BadInputError, match=rf"a\.png: a {word} file; wanted PNG, PGM, JPEG or"):
        load_map(tmp_path / "a.png", cell_size=1.0)


def test_animated_and_floating_images_are_refused(tmp_path: Path) -> None:
    frames = [Image.new("L", (3, 3), shade) for shade in (0, 255)]
    frames[0].save(tmp_path / "a.png", save_all=True, append_images=frames[1:])
    with pytest.raises(BadInputError, match=r"a\.png: is an animated image; wanted"):
        load_map(tmp_path / "a.png", cell_size=1.0)
    (tmp_path / "a.pgm").write_bytes(b"Pf\n2 1\n-1.0\n" + np.array([0, 1], "<f4").tobytes())
    with pytest.raises(BadInputError, match=r"a\.pgm: has pixels of kind 'F'; wanted"):
        load_map(tmp_path / "a.pgm", cell_size=1.0)


def test_an_interlaced_png_and_one_with_words_are_read(tmp_path: Path) -> None:
    words = PngImagePlugin.PngInfo()
    words.add_text("Comment", "drawn by hand", zip=True)
    stream = io.BytesIO()
    Image.fromarray(np.where(POND, 0, 255).astype(np.uint8)[::-1]).save(
        stream, "PNG", pnginfo=words
    )
    (tmp_path / "a.png").write_bytes(stream.getvalue())
    assert load_map(tmp_path / "a.png", cell_size=1.0) == GridMap(POND)
