"""`usvjax route`: one query from a shell."""

import json
import math

import numpy as np
import pytest
from PIL import Image

from usvjax.cli import main
from usvjax.maps import GridMap, save_map
from usvjax.missions.route.run import METHODS

SIZE = 50.0


pytestmark = pytest.mark.usefixtures("one_device")


@pytest.fixture(autouse=True)
def no_cache_on_disk(monkeypatch, tmp_path):
    monkeypatch.setattr("usvjax.devices.use_compilation_cache", lambda: tmp_path)
    monkeypatch.setenv("COLUMNS", "100")


@pytest.fixture
def chart(tmp_path):
    """16 x 16 cells of 50 m: water with a wall from the south, and a pond cut off in the east."""
    blocked = np.zeros((16, 16), bool)
    blocked[:12, 7] = True
    blocked[:, 13] = True
    path = tmp_path / "chart.map"
    save_map(GridMap(blocked, SIZE, (1000.0, -500.0)), path)
    return path


def route(*args):
    return main(["route", *(str(a) for a in args)])


def answer(capsys, *args):
    assert route(*args, "--json") == 0
    return json.loads(capsys.readouterr().out)


def one_line(capsys):
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith("usvjax: ")
    return err


def test_the_shortest_route_round_the_wall(chart, tmp_path, capsys):
    found = answer(capsys, chart, "--from", "3,3", "--to", "11,3", "--csv", tmp_path / "route.csv")
    cells = 14 + 6 * math.sqrt(2)  # up to the wall's end, two cells across, and down again
    assert found["status"] == "FOUND"
    assert found["method"] == "astar"
    assert found["length_cells"] == pytest.approx(cells)
    assert found["length_m"] == pytest.approx(SIZE * cells)
    assert found["min_clearance_m"] == pytest.approx(SIZE / 2)
    assert found["turns"] == found["sharp_turns"] >= 2
    assert found["sailable"] is False
    assert found["expanded"] >= 19
    assert found["seconds"] > 0
    head, *lines = (tmp_path / "route.csv").read_text().splitlines()
    assert head == "x_m,y_m,x_cell,y_cell"
    points = np.array([[float(v) for v in line.split(",")] for line in lines])
    assert points[0].tolist() == [1175.0, -325.0, 3.0, 3.0]
    assert points[-1].tolist() == [1575.0, -325.0, 11.0, 3.0]
    np.testing.assert_allclose(points[:, :2], [1000, -500] + SIZE * (points[:, 2:] + 0.5))
    assert np.abs(np.diff(points[:, 2:], axis=0)).max() == 1.0


def test_metres_mean_the_cells_they_lie_in(chart, capsys):
    by_cell = answer(capsys, chart, "--from", "3,3", "--to", "11,3")
    by_metres = answer(capsys, chart, "--from", "1160.5,-340", "--to", "1599,-301", "--metres")
    for found in (by_cell, by_metres):
        del found["seconds"]
    assert by_cell == by_metres


def test_a_turning_radius_smooths_and_draws(chart, tmp_path, capsys):
    picture = tmp_path / "figures" / "route.png"
    args = ("--from", "3,3", "--to", "11,3", "--turning-radius", 60, "--plot", picture)
    found = answer(capsys, chart, *args)
    assert found["method"] == "smoothed"
    assert found["sharp_turns"] == 0
    assert found["sailable"] is True
    assert found["turns"] >= 2
    assert 0 < found["min_clearance_m"] < SIZE / 2
    assert found["plot"] == str(picture)
    colours = np.asarray(Image.open(picture).convert("RGB")).reshape(-1, 3)
    for wanted in ((0, 0, 0), (213, 94, 0)):  # astar before, smoothed after
        assert (colours == wanted).all(axis=1).sum() > 50


def test_the_answer_for_people_names_everything(chart, tmp_path, capsys):
    file = tmp_path / "a.csv"
    assert route(chart, "--from", "3,3", "--to", "11,3", "--csv", file) == 0
    shown = capsys.readouterr().out
    for words in ("astar", "found", "1,124.3 m", "22.4853 cells", "turns", "ms (compiled)"):
        assert words in shown
    assert f"wrote {file}" in shown.replace("\n", "")


def test_inflated_water_is_kept_off(chart, capsys):
    found = answer(capsys, chart, "--from", "3,3", "--to", "10,3", "--inflate", 50)
    assert found["min_clearance_m"] > SIZE


def test_no_route_is_a_status_and_another_exit_code(chart, tmp_path, capsys):
    file = tmp_path / "none.csv"
    assert route(chart, "--from", "3,3", "--to", "15,3", "--csv", file, "--json") == 1
    found = json.loads(capsys.readouterr().out)
    assert found["status"] == "UNREACHABLE"
    assert found["csv"] is None
    assert "length_m" not in found
    assert not file.exists()
    assert route(chart, "--from", "3,3", "--to", "11,3", "--max-expansions", 4) == 1
    assert "out of budget" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (("--from", "7,3", "--to", "1,1"), "--from: 7,3 is blocked; the nearest free cell is 6,3"),
        (
            ("--from", "1,1", "--to", "16,3"),
            "--to: '16,3' lies outside the map; wanted 0 <= X < 16",
        ),
        (("--from=-1,1", "--to", "2,3"), "--from: '-1,1' lies outside the map"),
        (("--from", "1", "--to", "2,3"), "--from: got '1'; wanted two whole numbers X,Y"),
        (("--from", "1.5,2", "--to", "2,3"), "--from: got '1.5,2'; wanted two whole numbers"),
        (("--from", "1,2,3", "--to", "2,3"), "--from: got '1,2,3'; wanted"),
        (("--from", "nan,2", "--to", "2,3", "--metres"), "--from: got 'nan,2'; wanted two numbers"),
        (("--from", "0,0", "--to", "2,3", "--metres"), "wanted 1000 <= X < 1800 and -500 <= Y"),
        (("--from", "2,3", "--to", "2,3"), "--to: 2,3 is the cell of --from"),
        (("--from", "1,1", "--to", "2,3", "--method", "smoth"), "--method: got 'smoth'"),
        (("--from", "1,1", "--to", "2,3", "--turning-radius", "900"), "at most 800 m"),
        (
            ("--from", "1,1", "--to", "2,3", "--turning-radius", "0"),
            "usvjax: --turning-radius must",
        ),
        (
            ("--from", "1,1", "--to", "2,3", "--weight", "0.2"),
            "usvjax: --weight must be at ",
        ),
        (("--from", "1,1", "--to", "2,3", "--turn-cost=-1"), "usvjax: --turn-cost must be 0, or"),
        (
            ("--from", "1,1", "--to", "2,3", "--max-expansions", "0"),
            "usvjax: --max-expansions",
        ),
        (("--from", f"{10**20},3", "--to", "1,1"), f"--from: '{10**20},3' lies outside the map"),
        (("--from", f"{10**400},3", "--to", "1,1"), "3' lies outside the map; wanted 0 <= X < 16"),
        (
            ("--from", "1e300,3", "--to", "1,1", "--metres"),
            "--from: '1e300,3' lies outside the map",
        ),
        (("--from", "1,1"), "Missing from usvjax route: --to X,Y"),
        (("--from", "1,1", "--to", "2,3", "--connectivity", "6"), "invalid choice '6'"),
        (("--from", "1,1", "--to", "2,3", "--bogus"), "Unrecognized options: --bogus"),
        (("--from", "1,1", "--to", "2,3", "--weight", "x"), "--weight: got 'x'; wanted a number"),
        (("--from", "1,1", "--to", "2,3", "--inflate", "-1"), "--inflate: got -1"),
        (("--from", "1,1", "--to", "2,3", "--inflate", "9999"), "the map has no free cell"),
        (("--from", "1,1", "--to", "2,3", "--plot", "a.gif"), "a.gif: suffix '.gif'"),
    ],
)
def test_a_mistake_is_one_clear_line(chart, args, words, capsys):
    assert route(chart, *args) == 2
    assert words in one_line(capsys)


def test_a_map_that_is_not_there_is_named(capsys):
    assert route("nowhere.map", "--from", "1,1", "--to", "2,2") == 2
    assert "nowhere.map: no such file" in one_line(capsys)


def test_help_explains_every_method(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["route", "--help"])
    assert stop.value.code == 0
    shown = capsys.readouterr().out
    for name in METHODS:
        assert f"- {name}: " in shown
    assert "Example: usvjax route" in shown
