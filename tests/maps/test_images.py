"""ROS map_server maps and plain images: the formats' own rules, and damaged files."""

import io
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

from usvjax.errors import BadInputError
from usvjax.maps import GridMap, load_map, save_map

POND = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [1, 1, 0, 1]], bool)
ROS = {
    "image": "pond.pgm",
    "resolution": 0.05,
    "origin": [-1.0, 2.0, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}


def write(path: Path, content: str | bytes) -> Path:
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def write_ros(folder: Path, pixels: np.ndarray | None = None, **change: object) -> Path:
    """Write pond.yaml and its image; a key set to None is left out."""
    pixels = np.where(POND, 0, 254).astype(np.uint8) if pixels is None else pixels
    suffix = "pgm" if pixels.ndim == 2 else "png"
    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, "PPM" if suffix == "pgm" else "PNG")
    write(folder / f"pond.{suffix}", stream.getvalue())
    content = {**ROS, "image": f"pond.{suffix}", **change}
    text = yaml.safe_dump({key: value for key, value in content.items() if value is not None})
    return write(folder / "pond.yaml", text)


# --- ROS map_server --------------------------------------------------------------------------


def test_ros_map_is_flipped_and_placed(tmp_path: Path) -> None:
    grid = load_map(write_ros(tmp_path))
    assert grid == GridMap(POND[::-1], 0.05, (-1.0, 2.0))
    assert grid.name == "pond"


@pytest.mark.parametrize("negate", [0, 1, False, True])
@pytest.mark.parametrize("unknown", ["blocked", "free"])
def test_ros_trinary_thresholds(tmp_path: Path, negate: int, unknown: str) -> None:
    """All 256 greys against map_server's rule, with thresholds that some of them hit exactly."""
    greys = np.arange(256, dtype=np.uint8).reshape(16, 16)
    path = write_ros(tmp_path, greys, negate=negate, occupied_thresh=0.6, free_thresh=0.2)
    blocked = load_map(path, unknown=unknown).blocked[::-1].ravel()  # type: ignore[arg-type]
    for grey, found in enumerate(blocked):
        p = grey / 255 if negate else (255 - grey) / 255
        expected = True if p > 0.6 else False if p < 0.2 else unknown == "blocked"
        assert found == expected, grey


def test_ros_alpha_is_averaged_in_trinary_mode(tmp_path: Path) -> None:
    """map_server takes the mean over all channels: black but transparent is (0 + 0 + 0 + 0) / 4."""
    pixels = np.array([[[255] * 4, [0, 0, 0, 255], [255, 255, 255, 0], [90] * 4]], np.uint8)
    shades = [255, 63.75, 191.25, 90]
    path = write_ros(tmp_path, pixels, occupied_thresh=0.7, free_thresh=0.26)
    expected = [(255 - shade) / 255 > 0.7 for shade in shades]
    assert expected == [False, True, False, False]
    np.testing.assert_array_equal(load_map(path, unknown="free").blocked[0], expected)


def test_ros_scale_grades_what_lies_between(tmp_path: Path) -> None:
    greys = np.array([[255, 204, 160, 120, 100, 0]], np.uint8)
    path = write_ros(tmp_path, greys, mode="scale", occupied_thresh=0.7, free_thresh=0.1)
    p = (255 - greys[0].astype(float)) / 255
    percent = np.floor(1 + 98 * (p - 0.1) / 0.6)
    expected = np.where(p > 0.7, True, (p >= 0.1) & (percent >= 50))
    assert expected.tolist() == [False, False, False, True, True, True]
    for unknown in ("free", "blocked"):
        np.testing.assert_array_equal(load_map(path, unknown=unknown).blocked[0], expected)


def test_ros_scale_takes_transparent_for_unknown(tmp_path: Path) -> None:
    pixels = np.array([[[130, 130, 130, 0], [130, 130, 130, 255], [0, 0, 0, 255]]], np.uint8)
    path = write_ros(tmp_path, pixels, mode="scale", occupied_thresh=0.9, free_thresh=0.3)
    np.testing.assert_array_equal(load_map(path, unknown="free").blocked, [[False, False, True]])
    shut = load_map(path, unknown="blocked").blocked
    np.testing.assert_array_equal(shut, [[True, False, True]])


def test_ros_raw_is_per_cent(tmp_path: Path) -> None:
    greys = np.array([[0, 49, 50, 100, 101, 255]], np.uint8)
    path = write_ros(tmp_path, greys, mode="raw")
    expected = [False, False, True, True, True, True]
    np.testing.assert_array_equal(load_map(path).blocked[0], expected)
    expected = [False, False, True, True, False, False]
    np.testing.assert_array_equal(load_map(path, unknown="free").blocked[0], expected)
    path = write_ros(tmp_path, 255 - greys, mode="raw", negate=1)
    np.testing.assert_array_equal(load_map(path, unknown="free").blocked[0], expected)


def test_ros_numbers_without_a_point(tmp_path: Path) -> None:
    write_ros(tmp_path)
    text = "image: pond.pgm\nresolution: 5e-2\norigin: [-1e0, 2, 0]\nnegate: 0\n"
    path = write(tmp_path / "pond.yaml", text + "occupied_thresh: 65e-2\nfree_thresh: 0.196\n")
    assert load_map(path) == GridMap(POND[::-1], 0.05, (-1.0, 2.0))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"resolution": None}, "lacks resolution"),
        ({"image": None, "negate": None}, "lacks image, negate"),
        ({"image": "nowhere.pgm"}, "nowhere.pgm: no such file"),
        ({"image": 3}, "image: got 3"),
        ({"image": "a\0.pgm"}, r"image: got 'a\\x00\.pgm'; wanted a path without NUL"),
        ({"resolution": 0}, "resolution: got 0"),
        ({"resolution": 10**400}, "resolution: got a whole number of more than 308 digits"),
        ({"resolution": "fine"}, "resolution: got 'fine'"),
        ({"resolution": float("nan")}, "resolution: got nan"),
        ({"origin": [0.0]}, r"origin: got \[0.0\]"),
        ({"negate": "maybe"}, "negate: got 'maybe'"),
        ({"origin": [0.0, "east", 0.0]}, "origin y: got 'east'"),
        ({"origin": [0.0, 0.0, 0.3]}, "origin: got yaw 0.3 rad"),
        ({"negate": 2}, "negate: got 2"),
        ({"mode": "colour"}, "mode: got 'colour'"),
        ({"occupied_thresh": 1.5}, "occupied_thresh: got 1.5"),
        ({"free_thresh": -0.1}, "free_thresh: got -0.1"),
        ({"free_thresh": 0.7}, "free_thresh: got 0.7; wanted at most"),
    ],
)
def test_ros_refuses(tmp_path: Path, change: dict, words: str) -> None:
    path = write_ros(tmp_path, **change)
    with pytest.raises(BadInputError, match=rf"pond\.yaml: .*{words}"):
        load_map(path)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("image: [", "line 1: not valid YAML|line 2: not valid YAML"),
        (b"\xff", "line 1: not a text file"),
        ("", "not a map_server file"),
        ("- a\n- b\n", "not a map_server file"),
        ("a: 1\nb: 2024-13-45", r"line 2: not valid YAML \('2024-13-45' cannot be read as time"),
        ('a: !!int "abc"', r"line 1: not valid YAML \('abc' cannot be read as int\)"),
        ('a: !!int ""', r"not valid YAML \('' cannot be read as int\)"),
        ('a: [!!bool "abc"]', r"not valid YAML \('abc' cannot be read as bool\)"),
        ('a: !!timestamp "abc"', r"not valid YAML \('abc' cannot be read as timestamp\)"),
        pytest.param(
            f"a: {'1' * 5001}",
            r"line 1: not valid YAML \('1+\.\.\.1+' cannot be read as int\)",
            id="5001 digits",
        ),
        pytest.param(
            f"a: {'1:' * 300}1.5",
            r"line 1: not valid YAML \('1:.*' cannot be read as float\)",
            id="base 60",
        ),
        pytest.param("[" * 20_000, r"not valid YAML \(nested too deeply\)", id="nested"),
    ],
)
def test_a_damaged_yaml_is_refused(tmp_path: Path, content: str | bytes, words: str) -> None:
    with pytest.raises(BadInputError, match=rf"bad\.yaml.*({words})"):
        load_map(write(tmp_path / "bad.yaml", content))


def test_a_damaged_image_of_a_yaml_is_named(tmp_path: Path) -> None:
    path = write_ros(tmp_path)
    image = tmp_path / "pond.pgm"
    write(image, image.read_bytes()[:-3])
    with pytest.raises(BadInputError, match=r"pond\.yaml: .*pond\.pgm: a damaged image"):
        load_map(path)


def test_unknown_must_be_a_known_word(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="unknown: got 'maybe'"):
        load_map(write_ros(tmp_path), unknown="maybe")  # type: ignore[arg-type]


# --- images ----------------------------------------------------------------------------------


def test_image_threshold_and_north(tmp_path: Path) -> None:
    path = write(tmp_path / "a.pgm", "P2\n# drawn by hand\n3 2\n255\n0 127 128\n255 200 10\n")
    grid = load_map(path, cell_size=5)
    np.testing.assert_array_equal(grid.blocked, [[False, False, True], [True, True, False]])
    darker = load_map(path, cell_size=5, threshold=0.1)
    np.testing.assert_array_equal(darker.blocked, [[False, False, True], [True, False, False]])
    assert not load_map(path, cell_size=5, threshold=0.0).blocked.any()


@pytest.mark.parametrize(
    "pixels",
    [
        b"P5 2 1 255\n" + bytes([20, 240]),
        b"P2 2 1 15\n2 14\n",
        b"P5 2 1 65535\n" + bytes([20, 0, 240, 0]),
    ],
)
def test_pgm_in_ascii_and_binary_8_and_16_bit(tmp_path: Path, pixels: bytes) -> None:
    path = write(tmp_path / "a.pgm", pixels)
    np.testing.assert_array_equal(load_map(path, cell_size=1.0).blocked, [[True, False]])


@pytest.mark.parametrize("mode", ["1", "L", "LA", "P", "RGB", "RGBA", "I;16"])
def test_png_of_every_colour_mode(tmp_path: Path, mode: str) -> None:
    shades = np.array([[0, 255], [255, 0]])
    if mode == "I;16":
        image = Image.fromarray((shades * 257).astype(np.uint16))
    else:
        image = Image.fromarray(shades.astype(np.uint8)).convert(mode)
    image.save(tmp_path / "a.png")
    grid = load_map(tmp_path / "a.png", cell_size=1.0)
    np.testing.assert_array_equal(grid.blocked, [[False, True], [True, False]])


def test_colours_count_by_brightness(tmp_path: Path) -> None:
    colours = np.array([[[255, 255, 0], [0, 0, 255], [0, 255, 0], [255, 0, 0]]], np.uint8)
    Image.fromarray(colours).save(tmp_path / "a.png")
    grid = load_map(tmp_path / "a.png", cell_size=1.0)
    np.testing.assert_array_equal(grid.blocked, [[False, True, False, True]])


def test_jpeg_can_be_read(tmp_path: Path) -> None:
    pixels = np.zeros((16, 16), np.uint8)
    pixels[:8] = 255
    Image.fromarray(pixels).save(tmp_path / "a.jpg")
    blocked = load_map(tmp_path / "a.jpg", cell_size=1.0).blocked
    np.testing.assert_array_equal(blocked[:, 0], [True] * 8 + [False] * 8)


def test_an_image_needs_a_cell_size(tmp_path: Path) -> None:
    save_map(GridMap(POND), tmp_path / "a.png")
    with pytest.raises(BadInputError, match=r"a\.png: an image has no scale; give cell_size"):
        load_map(tmp_path / "a.png")
    with pytest.raises(BadInputError, match=r"threshold: got 1\.2"):
        load_map(tmp_path / "a.png", cell_size=1.0, threshold=1.2)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.png", b"", "not an image"),
        ("a.png", b"hello", "not an image"),
        ("a.pgm", b"P5 4 4 255\n" + bytes(10), "a damaged image"),
        ("a.pgm", b"P2 3 2 255\n1 2 3 4", "a damaged image"),
        ("a.pgm", b"P2 2 1 255\n1 x", "a damaged image"),
        ("a.pgm", b"P2 2 1 255\n1 300", "a damaged image"),
    ],
)
def test_damaged_images_are_refused(tmp_path: Path, name: str, content: bytes, words: str) -> None:
    path = write(tmp_path / name, content)
    with pytest.raises(BadInputError, match=rf"{name}: {words}"):
        load_map(path, cell_size=1.0)


def test_a_truncated_png_is_refused(tmp_path: Path) -> None:
    Image.fromarray(np.random.default_rng(0).integers(0, 256, (40, 40), np.uint8)).save(
        tmp_path / "a.png"
    )
    whole = (tmp_path / "a.png").read_bytes()
    for share in (0.02, 0.3, 0.9):
        write(tmp_path / "a.png", whole[: int(len(whole) * share)])
        with pytest.raises(BadInputError, match=r"a\.png: (a damaged|not an) image"):
            load_map(tmp_path / "a.png", cell_size=1.0)
