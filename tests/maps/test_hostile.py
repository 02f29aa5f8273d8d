"""Files that attack: endless ones, bombs, and names that steer a terminal."""

import json
import os
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest

import usvjax.maps.grid_map as grid_maps
from usvjax.checks import MOST_SHOWN, shown
from usvjax.errors import BadInputError, BadTypeError, printable
from usvjax.maps import GridMap, hongze_lake, load_map, save_map
from usvjax.maps.disk import MOST_BYTES, MOST_TEXT, read_bytes, read_text
from usvjax.maps.scen import read_scen
from usvjax.study import load_spec

IN_PROC = pytest.mark.skipif(not Path("/proc/self/mem").exists(), reason="no /proc here")
POND = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [1, 1, 0, 1]], bool)


def read(path: Path) -> object:
    """Hand a file to the loader of its suffix."""
    if path.suffix == ".toml":
        return load_spec(path)
    if path.suffix == ".scen":
        return read_scen(path.name, None, 1.0, path.parent, "study.toml")
    if path.suffix == ".json":
        save_map(GridMap(POND), path.with_suffix(".map"))
        return load_map(path.with_suffix(".map"))
    if path.suffix == ".py":
        path.with_suffix(".toml").write_text(
            f'name = "a"\nepisodes = 1\nkind = "a"\nplugin = "{path.name}"\n'
        )
        return load_spec(path.with_suffix(".toml"))
    return load_map(path, cell_size=1.0)


SUFFIXES = [".map", ".yaml", ".png", ".pgm", ".jpg", ".scen", ".toml", ".json", ".py"]


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize(
    "what", ["device", "pipe", "folder", "huge", pytest.param("endless", marks=IN_PROC)]
)
def test_only_files_of_bounded_size_are_read(tmp_path: Path, suffix: str, what: str) -> None:
    path = tmp_path / f"a{suffix}"
    if what == "device":
        path.symlink_to("/dev/zero")
    elif what == "pipe":
        os.mkfifo(path)
    elif what == "folder":
        path.mkdir()
    elif what == "huge":
        path.touch()
        os.truncate(path, MOST_BYTES + 1)  # without a block on the disk
    else:
        path.symlink_to("/proc/self/mem")
    with pytest.raises(BadInputError, match=rf"a\{suffix}'?: (.*: )?cannot be read") as caught:
        read(path)
    assert len(str(caught.value)) < 500


@IN_PROC
def test_a_file_that_hides_its_size_is_read_to_a_bound(tmp_path: Path) -> None:
    assert "Name:" in read_text(Path("/proc/self/status"))
    text = tmp_path / "a.txt"
    text.write_bytes(b"a" * MOST_TEXT)
    assert len(read_bytes(text, MOST_TEXT)) == MOST_TEXT
    text.write_bytes(b"a" * (MOST_TEXT + 1))
    with pytest.raises(BadInputError, match=r"larger than 1\.0 MiB, or endless"):
        read_text(text)
    with pytest.raises(BadInputError, match="cannot be read"):
        read_bytes(Path("/proc/self/status"), 10)


def test_an_image_named_by_a_yaml_is_a_file_as_well(tmp_path: Path) -> None:
    save_map(GridMap(POND), tmp_path / "pond.yaml")
    text = (tmp_path / "pond.yaml").read_text()
    (tmp_path / "pond.yaml").write_text(text.replace("pond.pgm", "/dev/zero"))
    with pytest.raises(BadInputError, match=r"pond\.yaml: /dev/zero: cannot be read \(is a device"):
        load_map(tmp_path / "pond.yaml")


def test_aliases_of_yaml_are_not_followed(tmp_path: Path) -> None:
    levels = [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 9)]
    text = "\n".join(["a0: &a0 [x, x, x, x, x, x, x, x, x]", *levels, "origin: *a8"])
    (tmp_path / "a.yaml").write_text(text)
    with pytest.raises(BadInputError, match=r"a\.yaml line 1: not valid YAML \(anchors and ali"):
        load_map(tmp_path / "a.yaml")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("short", "'short'"),
        ([0.5, 1], "[0.5, 1]"),
        ("\x1b[31m\ud800", "'\\x1b[31m\\ud800'"),
        pytest.param(10**6000, "a whole number of thousands of digits", id="digits"),
    ],
)
def test_values_are_shown_as_they_are(value: object, text: str) -> None:
    assert shown(value) == text


@pytest.mark.parametrize("value", ["x" * 10**6, [[list(range(99))] * 99] * 99, np.eye(99)])
def test_long_values_are_cut(value: object) -> None:
    assert len(shown(value)) <= MOST_SHOWN
    assert "\n" not in shown(value)


def test_messages_can_be_printed_whatever_they_quote() -> None:
    for error in (BadInputError, BadTypeError):
        assert str(error("a\x1b[31m\ud800\nb\u202e")) == "a\\x1b[31m\\ud800\\nb\\u202e"
    assert printable("Hongze 洪泽湖 10\u00a0m") == "Hongze 洪泽湖 10\u00a0m"


def test_a_path_is_quoted_safely(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match=r"a\\x1b\[31m\\nb\.map: no such file"):
        load_map(tmp_path / "a\x1b[31m\nb.map")


# --- more cells than there is memory for -----------------------------------------------------


def png_of(width: int, height: int, rows: int) -> bytes:
    """A grey PNG of zeros, a thousand times smaller than what it says that it holds."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        check = zlib.crc32(kind + data).to_bytes(4, "big")
        return len(data).to_bytes(4, "big") + kind + data + check

    head = width.to_bytes(4, "big") + height.to_bytes(4, "big") + b"\x08\0\0\0\0"
    packer = zlib.compressobj(1)
    body = b"".join(packer.compress(bytes(width + 1)) for _ in range(rows)) + packer.flush()
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", body) + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.png", png_of(11_000, 11_000, 10)),
        ("a.png", png_of(30_000, 30_000, 10)),
        ("a.pgm", b"P5 2147483647 2147483647 255\n"),
    ],
    ids=["more than ours", "more than Pillow's", "PGM"],
)
def test_an_image_of_too_many_pixels_is_not_decoded(
    tmp_path: Path, name: str, content: bytes
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(BadInputError, match=r"wanted (at most 100,000,000|100,000,000 at most)"):
        load_map(tmp_path / name, cell_size=1.0)


def test_just_below_the_bound_pillow_does_not_warn(tmp_path: Path, recwarn) -> None:
    (tmp_path / "a.png").write_bytes(png_of(9_460, 9_460, 9_460))  # it warns from 89,478,485
    assert load_map(tmp_path / "a.png", cell_size=1.0).blocked.all()
    assert len(recwarn) == 0


@pytest.mark.parametrize("suffix", [".png", ".pgm", ".map"])
def test_a_map_needs_the_memory_that_it_takes(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    save_map(GridMap(np.zeros((300, 300), bool)), tmp_path / f"a{suffix}")
    monkeypatch.setattr("usvjax.memory.free_memory", lambda: 50_000)
    with pytest.raises(BadInputError, match=rf"a\{suffix}: .* needs .*KiB of memory; this machine"):
        load_map(tmp_path / f"a{suffix}", cell_size=1.0)


def test_decoding_takes_few_bytes_a_pixel(tmp_path: Path) -> None:
    """The peak of a process that reads 16 million pixels of four channels."""
    from PIL import Image

    Image.new("RGBA", (4000, 4000), (255, 255, 255, 255)).save(tmp_path / "a.png")
    script = (
        "import resource, sys; from usvjax.maps import load_map\n"
        "peak = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024\n"
        "before = peak(); cells = load_map(sys.argv[1], cell_size=1.0).blocked.size\n"
        "print((peak() - before) / cells)"
    )
    command = [sys.executable, "-c", script, str(tmp_path / "a.png")]
    took = float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    assert took < 20.0  # 44 with the whole image in double precision


@pytest.mark.parametrize(
    "header", ["height 999999999\nwidth 999999999", "height 10001\nwidth 10000"]
)
def test_a_map_that_declares_too_many_cells_is_refused(tmp_path: Path, header: str) -> None:
    (tmp_path / "a.map").write_text(f"type octile\n{header}\nmap\n..\n")
    with pytest.raises(BadInputError, match=r"a\.map: a map has .* cells; wanted at most 100,000,"):
        load_map(tmp_path / "a.map")


def test_refining_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(BadInputError, match="cells; wanted at most 100,000,000 in all"):
        GridMap(POND).refined(10**6)
    with pytest.raises(BadInputError, match=r"factor: got .*digits; wanted less than 2\*\*63"):
        GridMap(POND).refined(10**5000)
    for size in (1e-9, 1e-300, 0.5):
        with pytest.raises(BadInputError, match="cell_size: got"):
            hongze_lake(size)
    fine = GridMap(POND).refined(9)
    monkeypatch.setattr(grid_maps, "_AT_ONCE", 50)
    assert GridMap(POND).refined(9) == fine  # whatever the bands


def test_points_however_far_are_outside_the_map(recwarn) -> None:
    grid = GridMap(POND, 1e-37)
    for point in ((1e300, 0.0), (-1e19, 1e19), (1e308, -1e308)):
        assert grid.is_blocked(point)
        assert (np.abs(grid.cells_of(point)) > 2**40).any()
    with pytest.raises(BadInputError, match=r"points: got .* wanted numbers that a float holds"):
        grid.cells_of([10**400, 1])
    assert len(recwarn) == 0


# --- names and labels ------------------------------------------------------------------------


@pytest.mark.parametrize("key", ["name", "attribution", "source"])
def test_words_of_a_sidecar_can_be_printed(tmp_path: Path, key: str) -> None:
    save_map(GridMap(POND, 2.0), tmp_path / "a.map")
    said = {"cell_size_m": 2.0, key: "Lake\n\x1b[31m \ud800"}
    (tmp_path / "a.json").write_text(json.dumps(said))
    grid = load_map(tmp_path / "a.map")
    assert "Lake\\n\\x1b[31m \\ud800" in (grid.name, grid.attribution)
    save_map(grid, tmp_path / "b.yaml")
    for wrong, words in ((["x"], rf"{key}: got \['x'\]; wanted text"), ("x" * 1001, "has 1001 ch")):
        (tmp_path / "a.json").write_text(json.dumps({"cell_size_m": 2.0, key: wrong}))
        with pytest.raises(BadInputError, match=words):
            load_map(tmp_path / "a.map")


@pytest.mark.parametrize("suffix", [".map", ".png", ".yaml"])
def test_the_name_of_a_file_becomes_one_that_can_be_printed(tmp_path: Path, suffix: str) -> None:
    save_map(GridMap(POND), tmp_path / f"a\x1b[31m{suffix}")
    assert load_map(tmp_path / f"a\x1b[31m{suffix}", cell_size=1.0).name == "a\\x1b[31m"


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ('[[conditions]]\nlabel = "a\\nb"', "label"),
        ('[[conditions]]\nlabel = "a\\u001b[31m"', "label"),
        ('[[conditions]]\nlabel = "a\\u202eb"', "label"),
        ('[maps]\nsource = "grid"\nmap = "a\\u0007.map"', "map"),
        ('[axes]\n"params.preset" = ["tan\\n"]', "params.preset"),
        ('methods = ["a\\r"]', "methods"),
    ],
)
def test_control_characters_in_a_study_are_refused_by_key(
    tmp_path: Path, text: str, key: str
) -> None:
    path = tmp_path / "a.toml"
    top, tables = (text, "") if text.startswith("methods") else ("", text)
    path.write_text(f'name = "a"\nepisodes = 1\n{top}\n{tables}\n')
    with pytest.raises(BadInputError, match=rf"a\.toml: '{key}' holds the control character \\"):
        load_spec(path)


def test_a_study_with_a_mark_is_read_and_utf_16_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b'\xef\xbb\xbfname = "a"\nepisodes = 1\n')
    assert load_spec(path).name == "a"
    path.write_bytes('name = "a"\n'.encode("utf-16"))
    with pytest.raises(BadInputError, match=r"a\.toml: is UTF-16; wanted"):
        load_spec(path)
