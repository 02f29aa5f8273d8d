"""Studies of kind "cruise": what they draw, what they measure, what they refuse."""

import itertools
import re
from types import SimpleNamespace

import jax
import numpy as np
import pytest
from cruise_scenes import ponds
from study_fake import study_rows

from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import random_maps, save_map
from usvjax.missions.cruise import CruiseParams, CruiseStatic
from usvjax.missions.cruise.chart import TRACK_ID
from usvjax.missions.cruise.figures import visits_words
from usvjax.missions.cruise.itinerary import itinerary
from usvjax.missions.cruise.methods import (
    METHODS,
    CruiseOptions,
    CruisePosed,
    leg_lengths,
    pose,
    sail,
    shortest_tours,
    tour_lengths,
)
from usvjax.missions.cruise.mission import MISSION
from usvjax.plots.route import length_words
from usvjax.report.numbers import number
from usvjax.study import load_run, load_spec, parse_spec, run_study
from usvjax.study.figures import figures_for_run
from usvkernels.status import CRUISE_ENDINGS, Status

JOBS = np.arange(8)
CELL, SPEED, STATIONS = 20.0, 5.0, 5
MAPS = {"shape": [12, 12], "density": 0.2, "cell_size": CELL, "stations": STATIONS}


pytestmark = pytest.mark.usefixtures("one_device")


def cruise_study(**changes):
    study = {
        "name": "small",
        "kind": "cruise",
        "seed": 7,
        "episodes": 8,
        "shard": 8,
        "methods": ["recommended"],
        "maps": MAPS,
        "cruise": {"distances": "water", "speed": SPEED, "max_wait": 2},
    }
    return {**study, **changes}


@pytest.fixture(scope="module")
def spec():
    return parse_spec(cruise_study())


@pytest.fixture(scope="module")
def rows(spec):
    return study_rows(spec, "recommended", JOBS)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A run of two conditions, one of them calm."""
    study = cruise_study(axes={"cruise.flip_rate": [0.0, 0.2]})
    return run_study(parse_spec(study), tmp_path_factory.mktemp("runs"), devices=1)


def test_tours_are_the_shortest_by_water(spec, rows):
    posed = pose(*_settings(spec), 7, JOBS)
    for job, legs in enumerate(posed.legs):
        tours = ((0, *rest, 0) for rest in itertools.permutations(range(1, STATIONS)))
        shortest = min(sum(legs[a, b] for a, b in itertools.pairwise(tour)) for tour in tours)
        assert rows["tour_length"][job] == pytest.approx(shortest, rel=1e-6)
        straight = CELL * np.hypot(*np.ptp(posed.scenes.stations[job][[0, 1]], axis=0))
        assert legs[0, 1] >= straight - 1e-3


def _settings(spec):
    given = spec.conditions[0].case.given
    return given.source, given.options


def test_measures_agree_with_one_another(rows):
    assert set(rows["status"]) <= set(CRUISE_ENDINGS)
    home = rows["status"] == Status.REACHED
    assert home.sum() >= 4
    assert (rows["skipped"][home] == 0).all()
    assert (rows["skipped"][rows["status"] == Status.PARTIAL] > 0).all()
    assert (rows["smooth_length"] <= rows["length"] + 1e-9).all()
    for length, time in (("length", "time"), ("smooth_length", "smooth_time")):
        wanted = (rows[length] + CELL * rows["waits"]) / SPEED
        np.testing.assert_allclose(rows[time], wanted)


def test_in_calm_water_the_track_is_the_tour(finished):
    table = load_run(finished.path).table().filter(condition=0)
    assert (table["status"] == Status.REACHED).all()
    np.testing.assert_allclose(table["length"], table["tour_length"], rtol=1e-6)
    assert (table["waits"] == 0).all()
    assert (table["replanned"] == STATIONS).all()


def test_jobs_that_do_not_follow_one_another_are_sailed_in_parts(tmp_path, monkeypatch):
    save_map(ponds(), tmp_path / "ponds.map")
    maps = {"source": "grid", "map": "ponds.map", "stations": 3}
    spec = parse_spec(cruise_study(maps=maps, cruise={}), folder=tmp_path)
    (condition,) = spec.conditions
    seen = []

    def sailed(blocked, stations, key, *, first, order, **given):
        seen.append((first, stations))
        count = np.arange(first, first + len(stations))
        metrics = {m.name: count for m in spec.mission.metrics}
        return SimpleNamespace(status=count, visited=np.ones((len(count), 3), bool), **metrics)

    monkeypatch.setattr("usvjax.missions.cruise.methods.cruise", sailed)
    rows = study_rows(spec, "recommended", np.array([6, 1, 2, 4]))
    assert [first for first, _ in seen] == [6, 1, 4]
    assert rows["length"].tolist() == [6, 1, 2, 4]
    drawn = condition.case.given.source.draw(7, np.arange(7)).stations
    np.testing.assert_array_equal(np.concatenate([s for _, s in seen]), drawn[[6, 1, 2, 4]])


def test_tours_are_the_same_in_any_shard():
    rng = np.random.default_rng(1)
    legs = rng.uniform(1, 2, (70, STATIONS, STATIONS))
    legs = (legs + legs.transpose(0, 2, 1)) * ~np.eye(STATIONS, dtype=bool)
    jobs = np.arange(70)
    orders = shortest_tours(3, jobs, legs, "gwo")
    assert len(np.unique(orders, axis=0)) > 5
    for first, last in ((0, 20), (60, 70), (5, 6)):
        part = shortest_tours(3, jobs[first:last], legs[first:last], "gwo")
        np.testing.assert_array_equal(part, orders[first:last])


@pytest.mark.parametrize("method", METHODS)
def test_methods_are_what_they_say(method, monkeypatch):
    seen = {}

    def solved(points, key, *, algorithm, distances, first):
        seen.update(tour=algorithm, first_tour=first)
        return SimpleNamespace(order=np.tile(np.arange(STATIONS), (len(distances), 1)))

    def sailed(blocked, stations, key, **given):
        seen.update(given, key=key)

    monkeypatch.setattr("usvjax.missions.cruise.methods.solve_tour", solved)
    monkeypatch.setattr("usvjax.missions.cruise.methods.cruise", sailed)
    (condition,) = parse_spec(cruise_study(cruise={"sensing": [3, 5]})).conditions
    source, options = condition.case.given.source, condition.case.given.options
    scenes = source.draw(7, np.arange(3, 5))
    legs = np.zeros((2, STATIONS, STATIONS))
    sail(CruisePosed(source, options, 7, np.arange(3, 5), scenes, legs), method)
    tour, planner, heuristic = {
        "recommended": ("recommended", "dstar_lite", "octile"),
        "astar": ("recommended", "astar", "octile"),
        "proposed": ("igwo", "dstar_lite", "weighted"),
        "gwo": ("gwo", "dstar_lite", "chebyshev"),
        "proposed_swap": ("igwo_swap", "dstar_lite", "weighted"),
        "gwo_swap": ("gwo_swap", "dstar_lite", "chebyshev"),
    }.get(method, (method, method, "octile"))
    wanted = {"tour": tour, "method": planner, "heuristic": heuristic, "first": 3, "first_tour": 3}
    wanted |= {"params": CruiseParams(), "static": CruiseStatic(sensing=(3, 5))}
    wanted |= {"cell_size": CELL}
    assert wanted.items() <= seen.items()
    assert (seen["order"] == np.arange(STATIONS)).all()
    # Whatever the method, the cells flip alike.
    assert seen["key"] == jax.random.fold_in(jax.random.key(7), 2**32 - 2)


def test_given_places_are_every_jobs(tmp_path):
    save_map(ponds(), tmp_path / "ponds.map")
    maps = {"source": "grid", "map": "ponds.map", "places": [[1075, -425], [1480, -60.5]]}
    (condition,) = parse_spec(cruise_study(maps=maps), folder=tmp_path).conditions
    drawn = condition.case.given.source.draw(0, np.arange(2))
    assert drawn.stations.tolist() == [[[1, 1], [9, 8]]] * 2
    assert drawn.blocked.shape == (10, 18)
    assert list(condition.case.inputs) == ["ponds.map"]
    for maps in ({"source": "grid", "map": "ponds.map"}, {}):
        (condition,) = parse_spec(cruise_study(maps=maps), folder=tmp_path).conditions
        assert condition.case.settings["maps"]["stations"] == 20


def test_given_places_are_free_on_random_maps():
    places = [[5.0, 5.0], [95.0, 15.0], [45.0, 115.0]]
    maps = {"shape": [12, 10], "density": 0.5, "places": places}
    (condition,) = parse_spec(cruise_study(maps=maps)).conditions
    source = condition.case.given.source
    drawn = source.draw(7, np.arange(4, 24))
    assert drawn.stations.tolist() == [[[0, 0], [9, 1], [4, 11]]] * 20
    free = random_maps(7, 20, (12, 10), 0.5, first=4)
    assert free[:, [0, 1, 11], [0, 9, 4]].any(axis=0).all()
    free[:, [0, 1, 11], [0, 9, 4]] = False
    np.testing.assert_array_equal(drawn.blocked, free)
    for changed, words in (
        ({"stations": 3}, "'stations' is of what is drawn"),
        ({"places": [*places, [101.0, 5.0]]}, r"'places': \(101, 5\) is not on the map's water"),
        ({"places": [*places, [6.0, 6.0]]}, "two stations in one cell"),
    ):
        with pytest.raises(BadInputError, match=words):
            parse_spec(cruise_study(maps={**maps, **changed}))


def test_the_figures_show_how_methods_compare_and_a_cruise(finished, monkeypatch):
    drawn = {}

    def kept(fig, path, **_):
        drawn[path.name] = fig
        path.parent.mkdir(exist_ok=True)
        path.touch()
        return path

    monkeypatch.setattr("usvjax.plots.style.save", kept)
    written = figures_for_run(finished.path, max_examples=1)
    assert {path.name for path in written} == {"methods.png", "cruise-c0.png", "cruise-c0.csv"}
    assert set(drawn) == {"methods.png", "cruise-c0.png"}
    head, *lines = (finished.path / "figures" / "cruise-c0.csv").read_text().splitlines()
    assert head.startswith("stop,station,x_m,y_m,status,")
    numbers = [line.split(",")[2:4] + line.split(",")[5:7] for line in lines]
    assert all(re.fullmatch(r"-?\d+\.\d", text) for row in numbers for text in row)
    labels = [ax.get_ylabel() for ax in drawn["methods.png"].axes]
    assert labels[1:] == ["length of the cruise (m)", "time (s)", "changes of course"]
    table = load_run(finished.path).table()
    job, why = MISSION.example(table.filter(condition=0), ["recommended"])
    lengths = table.filter(condition=0)["smooth_length"]
    assert (lengths < lengths[job]).sum() <= len(lengths) // 2 <= (lengths <= lengths[job]).sum()
    (ax,) = drawn["cruise-c0.png"].axes
    (track,) = ax.findobj(lambda artist: artist.get_gid() == TRACK_ID)
    sailed = np.hypot(*np.diff(track.get_xydata(), axis=0).T).sum()
    assert sailed == pytest.approx(lengths[job], rel=1e-6)
    assert f"job {job} ({why})" in ax.get_title()
    assert f"{STATIONS} stations, {length_words(lengths[job])}," in ax.get_title()


def one_cruise(job, **options):
    """A cruise of the small study, and the distances between its stations."""
    (condition,) = parse_spec(cruise_study(cruise=options)).conditions
    posed = pose(condition.case.given.source, condition.case.given.options, 7, np.asarray([job]))
    legs = {name: leg_lengths(posed.scenes, CELL, name) for name in ("straight", "water")}
    return posed, sail(posed, "recommended"), legs


def test_an_itinerary_is_the_cruise_stop_by_stop():
    posed, sailed, legs = one_cruise(3, distances="water", speed=SPEED, flip_rate=0.1)
    stops = itinerary(posed, sailed, legs)
    assert (sailed.status[0], sailed.waits[0] > 0) == (Status.REACHED, True)
    order = [*sailed.order[0], 0]
    assert stops["station"].to_list() == order
    np.testing.assert_allclose(
        stops.select("x_m", "y_m"), (posed.scenes.stations[0][order] + 0.5) * CELL
    )
    (straight,) = tour_lengths(legs["straight"], [order[:-1]])
    assert stops["straight_m"].sum() == pytest.approx(straight)
    assert (stops["water_m"] >= stops["straight_m"] - 1e-9).all()
    assert (stops["sailed_m"].diff()[1:] >= stops["straight_m"][1:] - 1e-9).all()
    assert stops["sailed_m"][-1] == pytest.approx(sailed.smooth_length[0])
    assert stops["time_s"][-1] == pytest.approx(sailed.smooth_time[0])


def test_an_itinerary_has_no_time_for_stops_given_up():
    posed, sailed, legs = one_cruise(3, flip_rate=0.5, walled_in="skip", speed=SPEED)
    stops = itinerary(posed, sailed, legs)
    came = stops["status"].is_in(["start", "reached"])
    assert 1 < came.sum() < len(stops)
    assert (stops["time_s"].is_not_null() == came).all()
    assert f"{sailed.visited[0].sum()} of {STATIONS} stations visited" in visits_words(sailed)


def test_a_summary_counts_the_stations_skipped_over_all_cruises(finished):
    table = load_run(finished.path).table()
    means = [table.filter(condition=c)["skipped"].mean() for c in (0, 1)]
    assert means[0] == 0 < means[1]
    rows = (finished.path / "summary.md").read_text().splitlines()
    header = next(row for row in rows if row.startswith("| Condition |"))
    assert header.endswith("| Stations skipped, mean |")
    second = next(row for row in rows if "0.2 | recommended |" in row)
    assert second.endswith(f"| {number(means[1])} |")


@pytest.mark.parametrize("name", ["cruise_hongze", "cruise_random"])
def test_shipped_studies_can_be_read(name, request):
    spec = load_spec(request.config.rootpath / "studies" / f"{name}.toml")
    assert spec.name == name
    assert spec.baseline == "recommended"
    assert all(c.case.settings["cruise"]["speed"] == 10.0 for c in spec.conditions)


@pytest.mark.parametrize(
    ("table", "change", "words"),
    [
        ("maps", {"density": 1.5}, "'density' must lie in"),
        ("maps", {"density": 1.0}, "no room for 5 stations"),
        ("maps", {"cell_size": 0.0}, "'cell_size' must be above 0"),
        ("maps", {"shape": [2, 12]}, "'shape' must be"),
        ("maps", {"stations": 1}, "must have 2 to 200 stations, home included, got 1"),
        ("maps", {"stations": 150}, "no room for 150 stations"),
        ("maps", {"min_distance": 140.0}, "no room for 5 stations 7 cells apart (job 0)"),
        ("maps", {"min_distance": -1.0}, "'min_distance' must be 0 or more"),
        ("maps", {"source": "lattice"}, "unknown source 'lattice'"),
        ("maps", {"ends": "free"}, "unknown key 'ends'"),
        ("cruise", {"flip_rate": 1.5}, "[cruise]: flip_rate: got 1.5; wanted a number in [0, 1]"),
        ("cruise", {"flip_rate": -0.1}, "[cruise]: flip_rate: got -0.1"),
        ("cruise", {"flip_scope": "windw"}, "[cruise]: flip_scope: got 'windw'"),
        ("cruise", {"distances": "air"}, "[cruise]: distances: got 'air'"),
        ("cruise", {"walled_in": "swim"}, "[cruise]: walled_in: got 'swim'"),
        ("cruise", {"sensing": [4, 5]}, "[cruise]: sensing: got (4, 5)"),
        ("cruise", {"max_wait": -1}, "[cruise]: max_wait: got -1"),
        ("cruise", {"max_steps": 0}, "[cruise]: max_steps: got 0"),
        ("cruise", {"speed": 0.0}, "[cruise]: speed: got 0.0"),
        ("cruise", {"corner_cutting": True}, "unknown key 'corner_cutting'"),
        ("cruise", {"fliprate": 0.1}, "unknown key 'fliprate'; did you mean 'flip_rate'"),
    ],
)
def test_settings_that_cannot_be_used_are_refused(table, change, words):
    study = cruise_study()
    study[table] = {**study[table], **change}
    with pytest.raises(BadInputError) as caught:
        parse_spec(study, where="s.toml")
    assert words in str(caught.value)
    assert str(caught.value).startswith("s.toml: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"inflate": -1.0}, "'inflate' must be 0 or more"),
        ({"shore_distance": 300.0}, "0 cells where a station may be, has no room for 20 stations"),
        ({"shore_distance": float("nan")}, "'shore_distance' must be 0 or more"),
        ({"places": [[1075.0, -425.0]]}, "must have 2 to 200 stations"),
        ({"places": [[1075.0, -425.0], [1010.0, -425.0]]}, "(1010, -425) is not on the map's"),
        ({"places": [[1075.0, -425.0], [1.0, 2.0]]}, "(1, 2) is not on the map's water"),
        ({"places": [[1075.0, -425.0], [1625.0, -425.0]]}, "no water joins (1625, -425)"),
        ({"places": [[1075.0, -425.0], [1076.0, -424.0]]}, "two stations in one cell"),
        ({"places": [[1075.0, -425.0], [float("inf"), 0.0]]}, "no place in metres"),
        ({"places": [[1075.0, -425.0], [1e300, 0.0]]}, "no place in metres"),
        ({"places": []}, "must have 2 to 200 stations"),
        ({"places": [[1075.0, -425.0], [1480.0, -60.5]], "stations": 2}, "'stations' is of"),
    ],
)
def test_stations_that_cannot_be_used_are_refused(change, words, tmp_path):
    save_map(ponds(), tmp_path / "ponds.map")
    study = cruise_study(maps={"source": "grid", "map": "ponds.map", **change})
    with pytest.raises(BadInputError) as caught:
        parse_spec(study, folder=tmp_path)
    assert words in str(caught.value)


def test_the_cruise_table_has_the_fields_of_params_and_static():
    (condition,) = parse_spec(cruise_study(cruise={"flip_rate": 1, "max_steps": 9})).conditions
    params, static = CruiseParams(flip_rate=1.0), CruiseStatic(max_steps=9)
    assert condition.case.given.options == CruiseOptions(params, static)
    assert condition.case.settings["cruise"] == {
        "distances": "straight",
        "flip_rate": 1.0,
        "flip_scope": "window",
        "sensing": (5, 5),
        "walled_in": "wait",
        "max_wait": 100,
        "max_steps": 9,
        "speed": 10.0,
    }


def test_a_method_that_cannot_count_so_many_steps_is_refused():
    maps = {**MAPS, "shape": [90, 90]}
    study = cruise_study(
        maps=maps, cruise={"max_steps": 9_000}, methods=["recommended", "proposed"]
    )
    with pytest.raises(BadInputError, match="the study: method 'proposed': max_steps: got 9000"):
        parse_spec(study)
    parse_spec({**study, "methods": ["recommended", "astar"]})


def test_a_value_of_the_wrong_type_is_refused():
    with pytest.raises(BadTypeError, match="'stations' must be an integer"):
        parse_spec(cruise_study(maps={**MAPS, "stations": 5.5}))
    with pytest.raises(BadTypeError, match="'source' must be a string"):
        parse_spec(cruise_study(maps={"source": 3}))
