"""Scenario files of the MovingAI benchmark."""

import pickle

import numpy as np
import pytest

from usvjax.errors import BadInputError
from usvjax.maps import GridMap, save_map
from usvjax.maps.scen import read_scen

SCEN = """version 1
0\tmaps/room.map\t6\t5\t0\t0\t5\t0\t5
1\tmaps/room.map\t6\t5\t0\t0\t1\t1\t1.41421356
2\tmaps/room.map\t6\t5\t2\t2\t2\t2\t0
3\tmaps/room.map\t6\t5\t0\t0\t0\t4\t8
"""


@pytest.fixture
def benchmark(tmp_path):
    save_map(GridMap(np.zeros((5, 6), bool)), tmp_path / "room.map")
    (tmp_path / "room.map.scen").write_text(SCEN)
    return tmp_path


def test_a_file_holds_its_map_and_queries_in_order(benchmark):
    scen = read_scen("room.map.scen", None, 2.0, benchmark, "s.toml")
    assert scen.chart == GridMap(np.zeros((5, 6), bool), 2.0)
    assert scen.starts.tolist() == [[0, 0], [0, 0], [2, 2], [0, 0]]
    assert scen.goals.tolist() == [[5, 0], [1, 1], [2, 2], [0, 4]]
    assert scen.lengths.tolist() == [5.0, 1.41421356, 0.0, 8.0]
    assert len(pickle.loads(pickle.dumps(scen))) == 4


def test_jobs_take_every_line_once_in_an_order_of_the_seed(benchmark):
    scen = read_scen("room.map.scen", None, 1.0, benchmark, "s.toml")
    orders = {tuple(scen.rows_of(seed, np.arange(4)).tolist()) for seed in range(20)}
    assert all(sorted(order) == [0, 1, 2, 3] for order in orders)
    assert len(orders) > 8
    alone = scen.rows_of(3, np.asarray([2]))
    assert alone[0] == scen.rows_of(3, np.arange(4))[2]


def test_another_map_may_be_named(benchmark):
    save_map(GridMap(np.zeros((5, 6), bool)), benchmark / "hall.map")
    found = read_scen("room.map.scen", "hall.map", 1.0, benchmark, "s.toml")
    assert found.chart.name == "hall"


@pytest.mark.parametrize("size", [0.0, -1.0, float("inf"), float("nan")])
def test_cells_without_a_size_are_refused(benchmark, size):
    with pytest.raises(BadInputError, match=r"s\.toml: 'cell_size' must be above 0"):
        read_scen("room.map.scen", None, size, benchmark, "s.toml")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("version 1", "bucket", "no 'version' in line 1"),
        ("6\t5\t0\t0\t5\t0\t5", "6\t5\t0\t0\t5\t0", "line 2 has 8 fields"),
        ("6\t5\t0\t0\t5\t0\t5", "7\t5\t0\t0\t5\t0\t5", "line 2 is for a map of 7 x 5 cells"),
        (
            "6\t5\t0\t0\t5\t0\t5",
            "6\t5\t0\t0\t6\t0\t5",
            r"line 2: the goal \[6, 0\] is no free cell",
        ),
        ("6\t5\t2\t2\t2\t2\t0", "6\t5\t2\t-1\t2\t2\t0", r"line 4: the start \[2, -1\]"),
        ("6\t5\t0\t0\t5\t0\t5", "6\t5\t0\t0\t5\t0\tfar", "line 2 is no query"),
        ("6\t5\t0\t0\t5\t0\t5", "6\t5\t0\t0\t5\t0\tnan", "line 2: the length is nan"),
        ("6\t5\t0\t0\t5\t0\t5", "6\t5\t0\t0\t5\t0\t-1", "line 2: the length is -1.0; wanted 0 or"),
        ("6\t5\t0\t0\t5\t0\t5", "6\t5\t0\t0\t5\t0\t1e999", "line 2: the length is inf"),
        ("6\t5\t0\t0\t5\t0\t5", "6\t5\t0\t0\t5\t0\t4.9", "length is 4.9, but the goal is 5 cells"),
        (
            "6\t5\t2\t2\t2\t2\t0",
            "6\t5\t2\t2\t2\t2\t3",
            "the length is 3 from a cell to itself",
        ),
        ("5\t0\t5\n", f"{'9' * 20}\t0\t5\n", r"line 2: the goal \[9{20}, 0\] is no free cell"),
        ("6\t5\t2", f"{'9' * 5000}\t5\t2", "line 4 is no query: '2 maps"),
        ("2\tmaps/room", "2\tmaps/hall", "line 4 is for the map 'hall.map', line 2 for 'room.map'"),
        ("room.map", "hall.map", r"hall\.map: no such file"),
    ],
)
def test_bad_scenario_files_are_refused(benchmark, old, new, words):
    path = benchmark / "room.map.scen"
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(BadInputError, match=words) as caught:
        read_scen("room.map.scen", None, 1.0, benchmark, "study.toml")
    assert str(caught.value).startswith("study.toml")


@pytest.mark.parametrize(
    "change",
    [
        lambda text: "\ufeff" + text,
        lambda text: text.replace("\n", "\r\n") + "\r\n\r\n",
        lambda text: text.replace("\t", " "),
        lambda text: text.replace("\n", "\n\n"),
        lambda text: text.replace("version 1", "Version 1.0"),
        lambda text: text.replace("maps/", "C:\\maps\\"),
        lambda text: text.rstrip(),
    ],
    ids=["mark", "windows", "spaces", "empty lines", "capital", "backslashes", "no last end"],
)
def test_scenarios_as_other_programs_write_them_are_read(benchmark, change):
    path = benchmark / "room.map.scen"
    path.write_text(change(path.read_text()), newline="")
    scen = read_scen("room.map.scen", None, 1.0, benchmark, "s.toml")
    assert scen.goals.tolist() == [[5, 0], [1, 1], [2, 2], [0, 4]]
    assert scen.lengths.tolist() == [5.0, 1.41421356, 0.0, 8.0]


def test_between_tabs_a_map_may_have_spaces_in_its_name(benchmark):
    (benchmark / "room.map").rename(benchmark / "a room.map")
    path = benchmark / "room.map.scen"
    path.write_text(path.read_text().replace("room", "a room"))
    assert len(read_scen("room.map.scen", None, 1.0, benchmark, "s.toml")) == 4
