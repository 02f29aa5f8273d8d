"""Map files: round trips of every format, the formats' own rules, and damaged files."""

import errno
import json
import os
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from property_draws import examples

from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import GridMap, hongze_lake, load_map, save_map

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data"
CELLS = arrays(bool, array_shapes(min_dims=2, max_dims=2, max_side=12))
SIZES = st.floats(1e-6, 1e6)
PLACES = st.tuples(st.floats(-1e9, 1e9), st.floats(-1e9, 1e9))
POND = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [1, 1, 0, 1]], bool)


def write(path: Path, content: str | bytes) -> Path:
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


# --- round trips -----------------------------------------------------------------------------


@examples(60)
@given(CELLS, SIZES, PLACES, st.sampled_from([".map", ".yaml", ".yml"]))
def test_round_trip_with_scale_and_place(
    blocked: np.ndarray, cell_size: float, origin: tuple[float, float], suffix: str
) -> None:
    grid = GridMap(blocked, cell_size, origin, "pond")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"pond{suffix}"
        written = save_map(grid, path)
        assert load_map(path) == grid
        assert sorted(written) == sorted(Path(folder).iterdir())


@examples(40)
@given(CELLS, SIZES, PLACES, st.sampled_from([".png", ".pgm", ".PNG"]))
def test_round_trip_of_images(
    blocked: np.ndarray, cell_size: float, origin: tuple[float, float], suffix: str
) -> None:
    grid = GridMap(blocked, cell_size, origin)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"pond{suffix}"
        assert save_map(grid, path) == [path]
        assert load_map(str(path), cell_size=cell_size, origin=origin) == grid


@examples(25)
@given(CELLS)
def test_a_plain_movingai_map_needs_no_sidecar(blocked: np.ndarray) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "pond.map"
        assert save_map(GridMap(blocked), path) == [path]
        assert load_map(path) == GridMap(blocked)


def test_name_and_attribution_survive(tmp_path: Path) -> None:
    lake = hongze_lake(1000)
    save_map(lake, tmp_path / "lake.map")
    loaded = load_map(tmp_path / "lake.map")
    assert (loaded.name, loaded.attribution) == (lake.name, lake.attribution)
    save_map(lake, tmp_path / "lake.yaml")
    assert "LGPL-3.0" in (tmp_path / "lake.yaml").read_text()


def test_a_stale_sidecar_is_replaced(tmp_path: Path) -> None:
    path = tmp_path / "pond.map"
    save_map(GridMap(POND, 25.0, (5.0, 6.0)), path)
    save_map(GridMap(~POND), path)
    assert load_map(path) == GridMap(~POND)


def test_given_cell_size_and_origin_win(tmp_path: Path) -> None:
    for suffix in (".map", ".yaml"):
        path = tmp_path / f"pond{suffix}"
        save_map(GridMap(POND, 25.0, (5.0, 6.0)), path)
        assert load_map(path, cell_size=2.0, origin=(0, 1)) == GridMap(POND, 2.0, (0.0, 1.0))


# --- MovingAI --------------------------------------------------------------------------------


def test_movingai_rows_and_terrain(tmp_path: Path) -> None:
    path = write(tmp_path / "a.map", "type octile\nheight 2\nwidth 4\nmap\n.GS@\nOTW.\n")
    expected = [[False, False, False, True], [True, True, True, False]]
    grid = load_map(path)
    np.testing.assert_array_equal(grid.blocked, expected)  # row 0 is y = 0
    assert (grid.cell_size, grid.origin, grid.name) == (1.0, (0.0, 0.0), "a")


def test_movingai_with_windows_line_ends(tmp_path: Path) -> None:
    path = write(
        tmp_path / "a.map", "type octile\r\nheight 2\r\nwidth 2\r\nmap\r\n.@\r\n..\r\n\r\n"
    )
    np.testing.assert_array_equal(load_map(path).blocked, [[False, True], [False, False]])


def test_movingai_sidecar_puts_north_up(tmp_path: Path) -> None:
    path = write(tmp_path / "a.map", "type octile\nheight 2\nwidth 2\nmap\n.@\n..\n")
    sidecar = {"cell_size_m": 250, "origin": [10, -5], "row_0": "north", "name": "pond"}
    write(tmp_path / "a.json", json.dumps({**sidecar, "source": "survey", "licence": "CC0"}))
    grid = load_map(path)
    assert grid == GridMap(np.array([[False, False], [False, True]]), 250.0, (10.0, -5.0))
    assert (grid.name, grid.attribution) == ("pond", "survey; CC0")


def test_somebody_elses_json_is_left_alone(tmp_path: Path) -> None:
    other = write(tmp_path / "a.json", '{"results": [1, 2]}')
    save_map(GridMap(POND), tmp_path / "a.map")
    assert load_map(tmp_path / "a.map") == GridMap(POND)
    before = (tmp_path / "a.map").read_bytes()
    with pytest.raises(BadInputError, match=r"a\.json: is not the sidecar of a map"):
        save_map(GridMap(~POND, 3.0), tmp_path / "a.map")
    assert other.read_text() == '{"results": [1, 2]}'
    assert (tmp_path / "a.map").read_bytes() == before


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", r'line 1: a MovingAI map has "type octile" here, got \'\''),
        ("type hex\nheight 1\nwidth 1\nmap\n.\n", 'line 1: .*"type octile"'),
        ("type octile\nwidth 2\nwidth 2\nmap\n..\n", "line 3: .*\"height H\" here, got 'width 2'"),
        ("type octile\nheight two\nwidth 2\nmap\n..\n", "line 2: .*got 'height two'"),
        ("type octile\nheight 1\nwidth 2\n", "line 4: .*\"map\" here, got ''"),
        ("type octile\nheight 1\nwidth -2\nmap\n..\n", 'line 3: .*"width W"'),
        ("type octile\nheight 1\nwidth 2\n..\n", 'line 4: .*"map" here'),
        ("type octile\nheight 0\nwidth 2\nmap\n", "height and width must be above 0"),
        ("type octile\nheight 3\nwidth 2\nmap\n..\n@.\n", "ends after 2 of the 3 rows"),
        ("type octile\nheight 9999999\nwidth 2\nmap\n..\n", "ends after 1 of the 9999999 rows"),
        ("type octile\nheight 1\nwidth 2\nmap\n..\n..\n", "has 2 rows, but declares height 1"),
        ("type octile\nheight 2\nwidth 3\nmap\n...\n..\n", "line 6: has 2 cells, .*width 3"),
        ("type octile\nheight 2\nwidth 3\nmap\n...\n.x.\n", "line 6, column 2: 'x' is no"),
        (b"\x89PNG\r\n\x1a\n\xff", "line 1: a MovingAI map"),
        (b"\x89PNG\r\n\x1a\n\x00\xff", "holds NUL characters; wanted a text file"),
    ],
)
def test_movingai_refuses(tmp_path: Path, content: str | bytes, words: str) -> None:
    path = write(tmp_path / "bad.map", content)
    with pytest.raises(BadInputError, match=rf"bad\.map.*{words}"):
        load_map(path)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ('{"cell_size_m": 250,', "line 1: not valid JSON"),
        (b"\xff", "line 1: not a text file in UTF-8"),
        ('{"cell_size_m": -1}', "cell_size_m: got -1"),
        ('{"cell_size_m": "250"}', "cell_size_m: got '250'"),
        ('{"cell_size_m": NaN}', "cell_size_m: got nan"),
        pytest.param(
            f'{{"cell_size_m": 1{"0" * 400}}}',
            "cell_size_m: got a whole number of more than 308 digits",
            id="401 digits",
        ),
        pytest.param(
            f'{{"cell_size_m": 1{"0" * 5000}}}',
            "holds a whole number of too many digits",
            id="5001 digits",
        ),
        pytest.param("[" * 100_000, r"not valid JSON \(nested too deeply\)", id="nested"),
        ('{"origin": [0]}', "origin: got 1 numbers"),
        ('{"origin": 5}', "origin: got 5"),
        ('{"row_0": "top"}', "row_0: got 'top'"),
        ('{"cell_size_m": 1, "height": 9, "width": 4}', r"says height and width \(9, 4\)"),
        ('{"cell_size_m": 1, "height": "9", "width": 4}', "height: got '9'"),
    ],
)
def test_a_damaged_sidecar_is_refused(tmp_path: Path, content: str | bytes, words: str) -> None:
    save_map(GridMap(POND), tmp_path / "bad.map")
    write(tmp_path / "bad.json", content)
    with pytest.raises(BadInputError, match=rf"bad\.json.*{words}"):
        load_map(tmp_path / "bad.map")


def shared_maps() -> list[Path]:
    return sorted((SHARED / "movingai").glob("*/*.map"))


@pytest.mark.skipif(not shared_maps(), reason=f"no MovingAI maps in {SHARED}")
def test_benchmark_scenarios_run_on_connected_free_cells() -> None:
    """Starts and goals of the published scenarios fit only if rows and columns are right."""
    for path in shared_maps():
        grid = load_map(path)
        water = grid.components()
        lines = path.with_suffix(".map.scen").read_text().splitlines()[1:]
        scenarios = np.array([line.split()[2:8] for line in lines if line], int)
        width, height, start_x, start_y, goal_x, goal_y = scenarios.T
        assert {(int(h), int(w)) for h, w in zip(height, width, strict=True)} == {grid.shape}
        starts, goals = water[start_y, start_x], water[goal_y, goal_x]
        assert (starts > 0).all(), path.name
        np.testing.assert_array_equal(starts, goals, err_msg=path.name)


@pytest.mark.skipif(not shared_maps(), reason=f"no MovingAI maps in {SHARED}")
def test_benchmark_maps_have_their_known_free_cells() -> None:
    free = {path.name: int((~load_map(path).blocked).sum()) for path in shared_maps()}
    assert free["arena.map"] == 2054
    assert free["maze512-32-0.map"] == 253840


# --- files in general ------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["a.map", "a.yaml", "a.png", "a.pgm", "a.jpg"])
def test_a_missing_file_is_named(tmp_path: Path, name: str) -> None:
    with pytest.raises(BadInputError, match=rf"{name}: no such file"):
        load_map(tmp_path / name, cell_size=1.0)


def test_a_folder_is_no_map(tmp_path: Path) -> None:
    (tmp_path / "a.map").mkdir()
    with pytest.raises(BadInputError, match=r"a\.map: cannot be read"):
        load_map(tmp_path / "a.map")
    with pytest.raises(BadInputError, match=r"a\.map: cannot be written"):
        save_map(GridMap(POND), tmp_path / "a.map")


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"path": "a.tif"}, BadInputError, r"a\.tif: got suffix '\.tif'; wanted one of \.map"),
        ({"path": "lake"}, BadInputError, "lake: got suffix ''"),
        ({"path": 3}, BadTypeError, "path: got 3"),
        ({"path": "a\0.map"}, BadInputError, r"path: got 'a\\x00\.map'; wanted .* without NUL"),
        ({"path": "a.map", "cell_size": -1.0}, BadInputError, "cell_size: got -1"),
        ({"path": "a.map", "cell_size": "1"}, BadTypeError, "cell_size: got '1'"),
        ({"path": "a.map", "origin": (1.0,)}, BadInputError, "origin: got 1 numbers"),
    ],
)
def test_load_map_refuses(arguments: dict, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        load_map(**arguments)


def test_save_map_refuses(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match=r"a\.jpg: got suffix"):
        save_map(GridMap(POND), tmp_path / "a.jpg")  # JPEG would not give the same cells back
    with pytest.raises(BadTypeError, match="grid: got ndarray"):
        save_map(POND, tmp_path / "a.map")  # type: ignore[arg-type]
    with pytest.raises(BadInputError, match="cannot be written"):
        save_map(GridMap(POND), tmp_path / "no" / "folder" / "a.map")
    assert list(tmp_path.iterdir()) == []


def test_without_replace_every_file_is_spared(tmp_path: Path) -> None:
    sidecar = write(tmp_path / "pond.json", '{"cell_size_m": 3}')
    with pytest.raises(BadInputError, match=r"pond\.json: exists already; give replace=True"):
        save_map(GridMap(POND), tmp_path / "pond.map", replace=False)
    assert sidecar.read_text() == '{"cell_size_m": 3}'
    assert [path.name for path in tmp_path.iterdir()] == ["pond.json"]


@pytest.mark.parametrize("suffix", [".yaml", ".yml"])
@pytest.mark.parametrize("replace", [True, False])
def test_an_image_of_no_saved_map_is_left_alone(tmp_path: Path, suffix: str, replace: bool) -> None:
    image = write(tmp_path / "pond.pgm", "precious")
    with pytest.raises(BadInputError, match=rf"pond\.pgm: is not the image of pond\{suffix}, "):
        save_map(GridMap(POND), tmp_path / f"pond{suffix}", replace=replace)
    assert image.read_text() == "precious"
    assert [path.name for path in tmp_path.iterdir()] == ["pond.pgm"]


def test_both_files_of_a_ros_map_are_replaced(tmp_path: Path) -> None:
    save_map(GridMap(POND, 2.0), tmp_path / "pond.yaml")
    save_map(GridMap(~POND, 3.0), tmp_path / "pond.yaml")
    assert load_map(tmp_path / "pond.yaml") == GridMap(~POND, 3.0)


@pytest.mark.parametrize("suffix", [".map", ".yaml", ".png", ".pgm"])
def test_a_full_disk_damages_nothing(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"pond{suffix}"
    save_map(GridMap(POND, 2.0), path)
    before = {file: file.read_bytes() for file in tmp_path.iterdir()}

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(BadInputError, match=r"cannot be written \(No space left on device\)"):
        save_map(GridMap(~POND, 7.0), path)
    assert {file: file.read_bytes() for file in tmp_path.iterdir()} == before


def test_saving_through_a_link_keeps_the_link(tmp_path: Path) -> None:
    real = tmp_path / "real.map"
    save_map(GridMap(POND), real)
    link = tmp_path / "link.map"
    link.symlink_to(real)
    save_map(GridMap(~POND), link)
    assert link.is_symlink()
    assert load_map(real) == GridMap(~POND)
