"""``usvjax maps``: list, show, convert, draw."""

import json
from pathlib import Path

import numpy as np
import pytest
import tyro
from PIL import Image

from usvjax.cli.maps import MAPS_COMMANDS, sketch
from usvjax.errors import BadInputError
from usvjax.maps import GridMap, hongze_lake, load_map, save_map

POND = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [1, 1, 0, 1]], bool)


def run(*args: object) -> None:
    tyro.extras.subcommand_cli_from_dict(MAPS_COMMANDS, args=[str(arg) for arg in args])


def test_list_names_the_packaged_maps(capsys: pytest.CaptureFixture[str]) -> None:
    run("list")
    shown = capsys.readouterr().out
    for words in ("hongze-250", "427 x 365", "250 m", "23.0%", "hongze-1000", "107 x 92"):
        assert words in shown


def test_list_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    run("list", "--json")
    rows = json.loads(capsys.readouterr().out)
    assert [row["map"] for row in rows] == ["hongze-250", "hongze-500", "hongze-1000"]
    assert rows[0]["width"] == 427
    assert rows[0]["free_share"] == pytest.approx(35889 / (427 * 365))
    assert "GSHHG" in rows[0]["attribution"]


def test_show_describes_and_sketches(capsys: pytest.CaptureFixture[str]) -> None:
    run("show", "hongze-250")
    shown = capsys.readouterr().out
    for words in ("106.75 km x 91.25 km", "2,243.1 km2", "3 bodies", "LGPL-3.0", "█"):
        assert words in shown


def test_show_as_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save_map(GridMap(POND), tmp_path / "pond.pgm")
    run("show", tmp_path / "pond.pgm", "--cell-size", 10, "--json")
    summary = json.loads(capsys.readouterr().out)
    assert (summary["width"], summary["height"], summary["cell_size_m"]) == (4, 3, 10.0)
    assert summary["free_area_m2"] == 700.0
    assert summary["water_bodies"] == 1
    assert summary["largest_body_share"] == 1.0


@pytest.mark.parametrize(("blocked", "words"), [(True, "no free cell"), (False, "all of the")])
def test_show_of_nothing_but_land_or_water(
    tmp_path: Path, blocked: bool, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    save_map(GridMap(np.full((3, 3), blocked)), tmp_path / "a.map")
    run("show", tmp_path / "a.map")
    assert words in capsys.readouterr().out


def test_sketch_is_north_up_in_half_blocks() -> None:
    """Rows of POND from the south: ..#. / #... / ##.#; the odd one out fills its line."""
    assert sketch(POND, 80, 20).plain.splitlines() == ["█▀ ▀", "  █ "]


def test_sketch_fits_and_keeps_the_shares() -> None:
    lake = hongze_lake()
    lines = sketch(lake.blocked, 60, 20).plain.splitlines()
    assert len(lines) <= 20
    assert all(len(line) == len(lines[0]) <= 60 for line in lines)
    land = {" ": 0, "▄": 1, "▀": 1, "█": 2}
    share = np.mean([land[cell] / 2 for line in lines for cell in line])
    assert share == pytest.approx(lake.blocked.mean(), abs=0.05)


@pytest.mark.parametrize("suffix", [".map", ".yaml"])
def test_convert_keeps_the_map(tmp_path: Path, suffix: str) -> None:
    out = tmp_path / f"lake{suffix}"
    run("convert", "hongze-1000", out)
    assert load_map(out) == hongze_lake(1000)
    run("convert", out, tmp_path / "lake2.png")
    again = load_map(tmp_path / "lake2.png", cell_size=1000, origin=(0, -750))
    assert again == hongze_lake(1000)


def test_convert_says_how_to_load_an_image(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run("convert", "hongze-1000", tmp_path / "lake.png")
    assert "--cell-size 1000" in capsys.readouterr().out


def test_convert_replaces_only_when_told(tmp_path: Path) -> None:
    source, out = tmp_path / "pond.png", tmp_path / "lake.yaml"
    save_map(GridMap(POND), source)
    save_map(GridMap(~POND), out)
    with pytest.raises(BadInputError, match=r"lake\.pgm: exists already; .*--force"):
        run("convert", source, out, "--cell-size", 2)
    assert load_map(out) == GridMap(~POND)
    run("convert", source, out, "--cell-size", 2, "--force")
    assert load_map(out) == GridMap(POND, 2.0)


@pytest.mark.parametrize("options", [(), ("--force",)])
def test_convert_spares_the_image_that_it_reads(tmp_path: Path, options: tuple[str, ...]) -> None:
    source = tmp_path / "pond.pgm"
    save_map(GridMap(POND), source)
    before = source.read_bytes()
    with pytest.raises(BadInputError, match=r"pond\.pgm: is not the image of pond\.yaml"):
        run("convert", source, tmp_path / "pond.yaml", "--cell-size", 2, *options)
    assert source.read_bytes() == before
    assert list(tmp_path.iterdir()) == [source]


def test_convert_takes_a_packaged_name_with_a_point(tmp_path: Path) -> None:
    run("convert", "hongze-62.5", tmp_path / "lake.map")
    assert load_map(tmp_path / "lake.map") == hongze_lake(62.5)


def test_convert_passes_on_threshold_and_unknown(tmp_path: Path) -> None:
    Image.fromarray(np.array([[40, 100]], np.uint8)).save(tmp_path / "a.png")
    run("convert", tmp_path / "a.png", tmp_path / "b.map", "--cell-size", 1, "--threshold", 0.3)
    np.testing.assert_array_equal(load_map(tmp_path / "b.map").blocked, [[True, False]])
    yaml = "image: a.png\nresolution: 1.0\norigin: [0, 0, 0]\nnegate: 0\n"
    (tmp_path / "a.yaml").write_text(yaml + "occupied_thresh: 0.65\nfree_thresh: 0.1\n")
    run("convert", tmp_path / "a.yaml", tmp_path / "c.map", "--unknown", "free")
    np.testing.assert_array_equal(load_map(tmp_path / "c.map").blocked, [[True, False]])
    run("convert", tmp_path / "a.yaml", tmp_path / "d.map")
    np.testing.assert_array_equal(load_map(tmp_path / "d.map").blocked, [[True, True]])


def test_draw_puts_north_up_in_the_picture(tmp_path: Path) -> None:
    blocked = np.zeros((30, 30), bool)
    blocked[20:] = True  # land in the north
    save_map(GridMap(blocked), tmp_path / "a.map")
    run("draw", tmp_path / "a.map", tmp_path / "a.png", "--dpi", 60)
    picture = np.asarray(Image.open(tmp_path / "a.png").convert("RGB")).astype(int)
    height, width, _ = picture.shape
    column = picture[:, int(width * 0.4)]
    upper, lower = column[int(height * 0.2)], column[int(height * 0.7)]
    assert upper[2] < upper[0]  # sand: more red than blue
    assert lower[2] > lower[0]  # water: more blue than red


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (("show", "hongse-250"), "hongse-250: neither a map file nor a packaged map"),
        (("show", "nowhere.map"), r"nowhere\.map: no such file"),
        (("draw", "hongze-1000", "lake.bmp"), r"lake\.bmp: suffix '\.bmp'"),
        (("convert", "hongze-1000", "lake.tif"), r"lake\.tif: got suffix"),
        (("convert", "hongze-250", "lake.map", "--cell-size", 5), "a packaged map has its own"),
    ],
)
def test_a_mistake_is_one_clear_line(
    args: tuple, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadInputError, match=words) as caught:
        run(*args)
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []
