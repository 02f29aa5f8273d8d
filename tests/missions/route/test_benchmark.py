"""Route studies on scenario files of the MovingAI benchmark."""

import numpy as np
import pytest
from grid_oracle import lengths
from route_ponds import route_study
from study_fake import study_rows

from usvjax.errors import BadInputError
from usvjax.maps import GridMap, save_map
from usvjax.study import parse_spec
from usvkernels.status import Status

pytestmark = pytest.mark.usefixtures("one_device")


SCEN = """version 1
0\tmaps/room.map\t6\t5\t0\t0\t5\t0\t5
1\tmaps/room.map\t6\t5\t0\t0\t1\t1\t1.41421356
2\tmaps/room.map\t6\t5\t2\t2\t2\t2\t0
3\tmaps/room.map\t6\t5\t0\t0\t0\t4\t0
"""


@pytest.fixture
def benchmark(tmp_path):
    blocked = np.zeros((5, 6), bool)
    save_map(GridMap(blocked), tmp_path / "room.map")
    (tmp_path / "room.map.scen").write_text(SCEN)
    return tmp_path


def scen_study(**changes):
    maps = {"source": "movingai", "scen": "room.map.scen", **changes.pop("maps", {})}
    return route_study(**{"episodes": 4, "maps": maps, "smoothing": {}, **changes})


def test_a_scenario_file_gives_every_query_once_with_its_optimum(benchmark):
    spec = parse_spec(scen_study(maps={"cell_size": 2.0}), folder=benchmark)
    drawn = spec.conditions[0].case.given.source.draw(4, np.arange(4))
    assert sorted(drawn.published.tolist()) == [0.0, 0.0, 1.41421356, 5.0]
    assert drawn.starts.tolist() != [[0, 0], [0, 0], [2, 2], [0, 0]]
    row = study_rows(spec, "astar", np.arange(4))
    assert row["ratio"].tolist() == [1.0] * 4
    assert set(row["path_length"].round(6)) == {0.0, 2.828427, 10.0, 8.0}


@pytest.mark.parametrize("method", ["smoothed", "bspline"])
def test_a_route_from_a_cell_to_itself_has_no_length(benchmark, method):
    spec = parse_spec(scen_study(), folder=benchmark)
    row = study_rows(spec, method, np.arange(4))
    drawn = spec.conditions[0].case.given.source.draw(4, np.arange(4))
    nowhere = (drawn.starts == drawn.goals).all(axis=1)
    assert row["path_length"][nowhere] == [0.0]
    assert row["ratio"][nowhere] == [1.0]
    assert (row["status"] == Status.FOUND).all()


def test_a_length_that_is_not_known_is_no_optimum(benchmark):
    """0 between two cells: the route is compared with the shortest that there is."""
    blocked = np.zeros((5, 6), bool)
    blocked[:4, 2] = True
    save_map(GridMap(blocked), benchmark / "room.map")
    line = "0\troom.map\t6\t5\t0\t0\t5\t0\t0\n"
    (benchmark / "room.map.scen").write_text(f"version 1\n{line}")
    row = study_rows(parse_spec(scen_study(episodes=1), folder=benchmark), "shortened", [0])
    assert row["path_length"][0] > 5.0
    shortest = lengths(blocked, np.array([[5, 0]]))[0, 0]
    assert row["ratio"][0] == pytest.approx(row["path_length"][0] / shortest, rel=1e-6)
    assert row["ratio"][0] < 1.0  # pulled straight, it is shorter than any on the grid


@pytest.mark.parametrize("length", ["8", "4.1"])
def test_a_published_length_that_is_not_the_shortest_ends_the_study(benchmark, length):
    text = (benchmark / "room.map.scen").read_text()
    (benchmark / "room.map.scen").write_text(text.replace("\t4\t0\n", f"\t4\t{length}\n"))
    spec = parse_spec(scen_study(), folder=benchmark)
    words = rf"from \[0, 0\] to \[0, 4\] is {length} cells long, but on this map it is 4; wanted"
    with pytest.raises(BadInputError, match=words):
        study_rows(spec, "astar", np.arange(4))
    other_rules = parse_spec(scen_study(search={"corner_cutting": True}), folder=benchmark)
    assert study_rows(other_rules, "astar", np.arange(4))["ratio"].tolist() == [1.0] * 4


def test_a_bad_scenario_file_is_refused_by_the_study(benchmark):
    (benchmark / "room.map").unlink()
    with pytest.raises(BadInputError, match=r"study\.toml: \[maps\]: .*room\.map: no such file"):
        parse_spec(scen_study(), folder=benchmark, where="study.toml")


def test_more_episodes_than_queries_are_refused(benchmark):
    with pytest.raises(BadInputError, match="'episodes' must be at most 4"):
        parse_spec(scen_study(episodes=5), folder=benchmark)


def test_the_shortest_routes_have_the_published_lengths(request):
    folder = request.config.rootpath.parent / "shared" / "data" / "movingai" / "dao"
    if not folder.is_dir():
        pytest.skip(f"no MovingAI maps in {folder}")
    spec = parse_spec(scen_study(episodes=60, maps={"scen": "arena.map.scen"}), folder=folder)
    jobs = np.arange(60)
    row = study_rows(spec, "astar", jobs)
    published = spec.conditions[0].case.given.source.draw(spec.seed, jobs).published
    assert (row["status"] == Status.FOUND).all()
    np.testing.assert_allclose(row["path_length"], published, atol=5e-4)
    assert len(set(published)) > 30
