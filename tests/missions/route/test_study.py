"""Studies of kind "route": what they draw, what they measure, what they refuse."""

import math

import numpy as np
import pytest
from route_ponds import CELL, SHAPE, pond, route_study
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from study_fake import study_rows

from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import save_map
from usvjax.missions.route.finish import Sailing, as_it_is, through_key_points
from usvjax.missions.route.mission import MISSION
from usvjax.missions.route.run import METHODS, SearchOptions, find_paths
from usvjax.missions.route.scenes import CellTable
from usvjax.study import load_run, load_spec, parse_spec, run_study
from usvkernels.status import Status

JOBS = np.arange(40)
RUN = ("astar", "turning", "shortened", "smoothed", "bspline")


pytestmark = pytest.mark.usefixtures("one_device")


@pytest.fixture(scope="module")
def spec():
    return parse_spec(route_study())


@pytest.fixture(scope="module")
def rows(spec):
    """Results of methods on the same queries."""
    return {m: study_rows(spec, m, JOBS) for m in RUN}


def oracle(blocked, start, goal):
    """Length of the shortest route by scipy's Dijkstra, cells; no corner is cut."""
    height, width = blocked.shape
    free = np.pad(~blocked, 1)
    number = np.arange(height * width).reshape(height, width)
    tails, heads, costs = [], [], []
    for dx, dy in ((1, 0), (0, 1), (1, 1), (-1, 1)):
        for y, x in np.argwhere(~blocked):
            there = free[y + 1 + dy, x + 1 + dx]
            beside = free[y + 1, x + 1 + dx] and free[y + 1 + dy, x + 1]
            if there and (beside or dx * dy == 0):
                tails.append(number[y, x])
                heads.append(number[y + dy, x + dx])
                costs.append(math.hypot(dx, dy))
    graph = coo_matrix((costs, (tails, heads)), shape=(height * width,) * 2).tocsr()
    found = dijkstra(graph, directed=False, indices=number[start[1], start[0]])
    return float(found[number[goal[1], goal[0]]])


def test_lengths_and_endings_agree_with_dijkstra(spec, rows):
    drawn = spec.conditions[0].case.given.source.draw(4, JOBS)
    wanted = np.array([oracle(drawn.blocked[j], drawn.starts[j], drawn.goals[j]) for j in JOBS])
    unreachable = np.isinf(wanted)
    assert 0 < unreachable.sum() < len(JOBS)
    for name in RUN:
        assert ((rows[name]["status"] == Status.UNREACHABLE) == unreachable).all()
    there = ~unreachable
    np.testing.assert_allclose(rows["astar"]["path_length"][there], CELL * wanted[there], rtol=1e-7)
    for name in RUN:
        there = rows[name]["status"] == Status.FOUND
        np.testing.assert_allclose(
            rows[name]["ratio"][there], rows[name]["path_length"][there] / (CELL * wanted[there])
        )


def test_methods_keep_what_they_promise(rows):
    found = {m: r["status"] == Status.FOUND for m, r in rows.items()}
    there = found["astar"]
    for name in ("astar", "turning"):
        assert (rows[name]["ratio"][there] >= 1.0 - 1e-9).all()
        assert (rows["turning"]["cost"] <= rows[name]["cost"] + 1e-3)[there].all()
        assert rows[name]["min_clearance"][there] == pytest.approx(CELL / 2)
        np.testing.assert_array_equal(rows[name]["sharp_turns"], rows[name]["turns"])
    assert rows["turning"]["turning"][there].sum() < rows["astar"]["turning"][there].sum()
    assert (rows["shortened"]["path_length"] <= rows["astar"]["path_length"] + 1e-6)[there].all()
    assert (rows["shortened"]["min_clearance"][there] > 0).all()
    assert rows["shortened"]["turns"][there].sum() < rows["astar"]["turns"][there].sum()
    smooth = rows["smoothed"]
    assert (smooth["min_clearance"][there] > 0).all()
    assert smooth["sharp_turns"][there].sum() < 0.5 * rows["shortened"]["turns"][there].sum()
    assert (rows["bspline"]["min_clearance"][found["bspline"]] > 0).all()
    for name in ("shortened", "smoothed", "bspline"):
        np.testing.assert_array_equal(rows[name]["expanded"], rows["astar"]["expanded"])


def test_a_route_is_sailable_where_no_turn_is_too_sharp(rows):
    for row in rows.values():
        there = row["status"] != Status.UNREACHABLE
        np.testing.assert_array_equal(row["sailable"], there & (row["sharp_turns"] == 0))
    shares = {m: r["sailable"][r["status"] == Status.FOUND].mean() for m, r in rows.items()}
    assert 0 < shares["smoothed"] < 1
    assert shares["smoothed"] > shares["shortened"]


def test_the_cost_is_length_and_turning(rows):
    for row in rows.values():
        there = row["status"] == Status.FOUND
        turned = 0.5 * CELL * row["turning"] / (math.pi / 4)
        np.testing.assert_allclose(row["cost"][there], (row["path_length"] + turned)[there])


def test_without_a_route_there_is_no_figure(rows):
    lost = rows["smoothed"]["status"] == Status.UNREACHABLE
    for name in ("path_length", "ratio", "cost", "turning", "min_clearance"):
        assert np.isnan(rows["smoothed"][name][lost]).all()
    assert (rows["smoothed"]["turns"][lost] == 0).all()
    assert (rows["smoothed"]["expanded"][lost] > 0).all()


def test_a_grid_route_turns_by_45_degrees_a_whole_number_of_times(rows):
    row = rows["astar"]
    there = row["status"] == Status.FOUND
    steps = row["turning"][there] / (math.pi / 4)
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
    assert (steps >= row["turns"][there] - 1e-6).all()


def test_a_bound_on_expansions_ends_a_search_and_spoils_no_ratio(spec):
    bounded = parse_spec(route_study(search={"max_expansions": 12}))
    run = study_rows(bounded, "astar", JOBS)
    gave_up = run["status"] == Status.OUT_OF_BUDGET
    assert 0 < gave_up.sum() < len(JOBS)
    assert np.isfinite(run["ratio"][run["status"] == Status.FOUND]).all()
    assert np.isnan(run["path_length"][gave_up]).all()


@pytest.mark.parametrize(
    ("method", "wanted"),
    [
        ("astar", {"heuristic": "octile", "weight": 1.0, "turn_cost": 0.0}),
        ("key_points", {"heuristic": "octile", "weight": 1.0, "turn_cost": 0.0}),
        ("manhattan", {"heuristic": "manhattan", "weight": 1.0, "turn_cost": 0.0}),
        ("weighted", {"heuristic": "octile", "weight": 2.5, "turn_cost": 0.0}),
        ("turning", {"turn_cost": 0.75, "turn_mode": "exact", "weight": 1.0}),
        ("turning_parent", {"turn_cost": 0.75, "turn_mode": "parent", "weight": 1.0}),
    ],
)
def test_methods_search_as_they_say(method, wanted, monkeypatch):
    seen = {}
    monkeypatch.setattr("usvjax.missions.route.run.astar", lambda *_, **given: seen.update(given))
    options = SearchOptions(True, 8, turn_cost=0.75, weight=2.5, max_expansions=9)
    find_paths(CellTable(SHAPE).draw(0, JOBS), options, method)
    shared = {"corner_cutting": True, "connectivity": 8, "max_expansions": 9, "engine": "queue"}
    assert {**wanted, **shared}.items() <= seen.items()


def test_key_points_are_drawn_from_the_path():
    cells = np.array([[[0, 0], [1, 0], [2, 1], [3, 2], [3, 3], [3, 3]]])
    blocked = np.zeros((4, 4), bool)
    sailing = Sailing(blocked, 2.0, (10.0, 20.0), False, 1.0, None, 0)
    line = through_key_points(cells, np.array([5]), sailing)
    assert line.points[0, : line.counts[0]].tolist() == [[11.0, 21.0], [17.0, 27.0]]
    assert (line.corners, line.length, line.turning) == ([0], [pytest.approx(72**0.5)], [0.0])
    plain = as_it_is(cells, np.array([5]), sailing)
    assert plain.corners == plain.sharp == [2]
    assert plain.length == pytest.approx(2.0 * (2 + 2 * 2**0.5))
    assert plain.turning == pytest.approx(math.pi / 2)


def test_a_study_runs_summarises_and_repeats(tmp_path):
    methods = ["astar", "shortened"]
    study = route_study(methods=methods, shard=40, axes={"maps.density": [0.1, 0.3]})
    first, again = (run_study(parse_spec(study), tmp_path / name, devices=1) for name in "ab")
    assert first.summary == again.summary
    table = load_run(first.path).table()
    assert table.height == 2 * 2 * 40
    assert set(table["status"].unique()) <= {Status.FOUND, Status.UNREACHABLE}
    conditions = first.summary["conditions"]
    assert conditions[0]["pairs"][0]["metrics"]["ratio"]["difference"]["value"] < 0
    thin, thick = (c["methods"][0]["statuses"]["FOUND"]["count"] for c in conditions)
    assert thin > thick


def test_a_study_of_a_grid_names_its_map_and_digest(tmp_path):
    save_map(pond(), tmp_path / "pond.map")
    study = route_study(maps={"source": "grid", "map": "pond.map", "min_distance": 300.0})
    (condition,) = parse_spec(study, folder=tmp_path).conditions
    assert list(condition.case.inputs) == ["pond.map"]
    assert condition.case.settings["maps"]["ends"] == "harbours"
    assert condition.case.given.turning_radius == 6.0
    assert condition.case.given.source.chart == pond()


def test_the_turning_radius_is_one_cell_by_default():
    (condition,) = parse_spec(route_study(smoothing={})).conditions
    assert condition.case.settings["smoothing"]["turning_radius"] == CELL


@pytest.mark.parametrize("name", ["route_hongze", "route_random"])
def test_shipped_studies_can_be_read(name, request):
    spec = load_spec(request.config.rootpath / "studies" / f"{name}.toml")
    assert spec.name == name
    assert spec.baseline == "astar"
    assert all(c.case.settings["search"]["turn_cost"] == 0.5 for c in spec.conditions)


@pytest.mark.parametrize(
    ("table", "change", "words"),
    [
        ("maps", {"density": 1.5}, "'density' must lie in"),
        ("maps", {"cell_size": 0.0}, "'cell_size' must be above 0"),
        ("maps", {"shape": [0, 16]}, "'shape' must be"),
        ("maps", {"shape": [1, 1]}, "'shape' must be"),
        ("maps", {"ends": "harbors"}, "unknown ends 'harbors'"),
        ("maps", {"ends": "harbours"}, "unknown ends 'harbours'"),
        ("maps", {"min_distance": -1.0}, "'min_distance' must be 0 or more"),
        ("maps", {"min_distance": 900.0}, "no start and goal 90 cells apart"),
        ("maps", {"density": 1.0}, "no start and goal"),
        ("maps", {"source": "lattice"}, "unknown source 'lattice'"),
        ("maps", {"rate": 0.1}, "unknown key 'rate'"),
        ("search", {"weight": 0.5}, "'weight' must be at least 1"),
        ("search", {"turn_cost": -0.5}, "'turn_cost' must be 0, or above"),
        ("search", {"turn_cost": 1e-5}, "'turn_cost' must be 0, or above"),
        ("search", {"connectivity": 6}, "'connectivity' must be 4 or 8"),
        ("search", {"max_expansions": 0}, "'max_expansions' must be at least 1"),
        ("smoothing", {"turning_radius": 0.0}, "'turning_radius' must be above 0"),
        ("smoothing", {"turning_radius": 161.0}, "at most 160 m"),
        ("smoothing", {"safety_range": math.nan}, "'safety_range' must be above 0"),
        ("smoothing", {"repair": -1}, "'repair' must be 0 or more"),
    ],
)
def test_settings_that_cannot_be_used_are_refused(table, change, words, monkeypatch):
    monkeypatch.setattr("usvjax.maps.ends.CELL_ROUNDS", 3)
    study = route_study()
    study[table] = {**study.get(table, {}), **change}
    with pytest.raises(BadInputError, match=words) as caught:
        parse_spec(study, where="study.toml")
    assert f"study.toml: [{table}]" in str(caught.value) or "no start and goal" in words


def test_a_grid_refuses_what_it_cannot_use(tmp_path):
    save_map(pond(), tmp_path / "pond.map")
    for change, words in (
        ({"inflate": -1.0}, "'inflate' must be 0 or more"),
        ({"refine": 0}, "'refine' must be at least 1"),
        ({"inflate": 5000.0}, "no start and goal"),
        ({"map": "lake.map"}, r"lake\.map: no such file"),
    ):
        maps = {"source": "grid", "map": "pond.map", **change}
        with pytest.raises(BadInputError, match=words):
            parse_spec(route_study(maps=maps, smoothing={}), folder=tmp_path)


def test_wrong_types_are_refused():
    with pytest.raises(BadTypeError, match="'corner_cutting' must be a boolean"):
        parse_spec(route_study(search={"corner_cutting": 1}))
    with pytest.raises(BadTypeError, match="'source' must be a string"):
        parse_spec(route_study(maps={"source": 3}))


def test_methods_of_the_mission_are_those_of_the_table():
    assert list(MISSION.methods) == list(METHODS)
    with pytest.raises(BadInputError, match="unknown method 'smooth' in 'methods'"):
        parse_spec(route_study(methods=["smooth"]))
