"""Zhang et al. 2019: the searches, what is counted, the verdicts, and the whole program."""

import json
from itertools import pairwise
from math import sqrt
from pathlib import Path

import numpy as np
import pytest
from corner_grids import grids, shortest

from experiments import textbook
from experiments.claims import judge
from experiments.paper import main
from experiments.zhang2019 import arithmetic, compare, runs
from experiments.zhang2019.__main__ import PAPER
from experiments.zhang2019.mission import (
    BATCHED,
    LARGEST,
    MISSION,
    TEXTBOOK,
    Maps,
    Scene,
    by_the_book,
    named,
)
from experiments.zhang2019.paths import Paths, counted, paths_of
from experiments.zhang2019.published import TRADITIONAL
from experiments.zhang2019.verdicts import claims
from usvjax.errors import BadInputError
from usvjax.mission import Files
from usvjax.search.astar import astar
from usvkernels.status import Status

pytestmark = pytest.mark.usefixtures("one_device")

# --- the searches -----------------------------------------------------------------------------


def scene_of(blocked, corner_cutting=False):
    """A scene on given maps, bool[n, side, side]."""
    side = blocked.shape[-1]
    whole = np.ones((len(blocked), LARGEST, LARGEST), bool)
    whole[:, :side, :side] = blocked
    return Scene(Maps(side, 0.2, corner_cutting), whole)


def test_steps_and_turns_are_counted_along_the_path():
    path = [(0, 0), (1, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 2), (0, 2)]
    found = counted(np.array([path, [(3, 3)] * 8]))
    assert {name: count.tolist() for name, count in found.items()} == {
        "straight": [4, 0],
        "diagonal": [1, 0],
        "turns": [1 + 1 + 2, 0],
        "bends": [3, 0],
    }


@pytest.mark.parametrize(("rule", "cutting"), [("exact", False), ("traditional", True)])
def test_batched_paths_are_measured_as_the_search_does(rule, cutting):
    blocked = grids(24, 25, 0.3)
    scene = scene_of(blocked, cutting)
    outcome = MISSION.run(scene, named(rule, "batched"), record=True)
    plain = astar(
        scene.blocked, (0, 0), (24, 24), engine="queue", corner_cutting=cutting, **BATCHED[rule]
    )
    own = paths_of(outcome.columns)
    least = np.array([shortest(grid, cutting) for grid in blocked])
    np.testing.assert_array_equal(own.found, np.isfinite(least))
    assert 0 < own.found.sum() < 24
    assert (1000 * own.length()[own.found] >= least[own.found] - 1e-6).all()
    cost = own.total(sqrt(2.0)) if rule == "exact" else own.length(sqrt(2.0))
    np.testing.assert_allclose(cost[own.found], plain.cost[own.found])
    np.testing.assert_array_equal(own.expanded, plain.expanded)
    row = int(own.found.argmax())
    track = outcome.recording.tracks[row]
    assert track.places[0].tolist() == [[0, 0]]
    assert track.places[-1].tolist() == [[24, 24]]
    assert track.along[-1] == pytest.approx(own.length(sqrt(2.0))[row])


@pytest.mark.parametrize("cutting", [False, True])
def test_the_textbooks_program_searches_every_map_by_its_rules(cutting):
    blocked = grids(12, 15, 0.25, seed=2)
    scene = scene_of(blocked, cutting)
    own = {name: paths_of(MISSION.run(scene, name).columns) for name in TEXTBOOK}
    assert len({tuple(one.total()) for one in own.values()}) > len(TEXTBOOK) / 2
    least = np.array([shortest(grid, cutting) for grid in blocked])
    for one in own.values():
        np.testing.assert_array_equal(one.found, np.isfinite(least))
        assert (1000 * one.length()[one.found] >= least[one.found] - 1e-6).all()
    rules = textbook.Rules(1000, 1400, turn=500, accumulate=True, corner_cutting=cutting)
    for row, grid in enumerate(blocked):
        path, closed = textbook.search(grid, (0, 0), (14, 14), rules)
        assert own["accumulated (textbook)"].expanded[row] == len(closed)
        straight = sum(abs(x - u) + abs(y - v) == 1 for (x, y), (u, v) in pairwise(path))
        assert own["accumulated (textbook)"].straight[row] == straight


def test_maps_depend_on_their_job_alone_and_the_denser_ones_hold_the_others():
    files, posed = Files(), {}
    for density in (0.1, 0.3):
        case = MISSION.case({"maps": {"side": 20, "density": density}}, files)
        posed[density] = MISSION.pose(case, 1, np.arange(6)).blocked
        alone = MISSION.pose(case, 1, np.array([4])).blocked
        np.testing.assert_array_equal(posed[density][4], alone[0])
    thin, dense = posed.values()
    assert not (thin & ~dense).any()
    assert (dense != thin).any()
    assert not dense[:, 0, 0].any()
    assert not dense[:, 19, 19].any()
    assert dense[:, 20:].all()
    assert dense[:, :, 20:].all()
    assert dense[:, :20, :20].mean() == pytest.approx(0.3, abs=0.05)


@pytest.mark.parametrize(("key", "value"), [("side", 32), ("side", 1), ("density", 1.5)])
def test_maps_that_cannot_be_are_refused(key, value):
    with pytest.raises(BadInputError, match=key):
        MISSION.case({"maps": {key: value}}, Files())


# --- what is measured -------------------------------------------------------------------------


def made(totals, turns, found=None):
    """Paths with these totals and turns by 45 degrees, of straight and diagonal steps."""
    totals, turns = np.array(totals, float), np.array(turns)
    tenths = np.round(10 * (totals - 0.5 * turns)).astype(int)
    diagonal = np.array([next(d for d in range(5) if (t - 14 * d) % 10 == 0) for t in tenths])
    ones = np.ones(len(totals), bool) if found is None else np.array(found)
    return Paths(ones, (tenths - 14 * diagonal) // 10, diagonal, turns, turns // 2, 10 * turns)


def test_maps_like_the_papers_are_chosen_by_the_traditional_path_alone():
    old = made([59.3, 59.3, 69.9, 59.3], [31, 31, 31, 31], [True, True, True, False])
    new = made([54.3, 59.3, 54.3, 54.3], [21, 31, 21, 21])
    np.testing.assert_allclose(old.total(), [59.3, 59.3, 69.9, 59.3])
    assert compare.nearest(old) == 0
    assert compare.alike(old, 1.0).tolist() == [True, True, False, False]
    assert compare.exactly({"new": new}, old) == {"maps": 2, "new": 1}
    found = compare.saved(new, old, 1.0)
    assert found["saved"] == pytest.approx(2.5)
    assert found["as_published"]["value"] == pytest.approx(0.5)
    assert found["p"] == pytest.approx(2 / 3)  # one of two, and the paper's own
    wide = made([61.3, 61.5, 61.3, 61.8], [31, 31, 35, 36])  # length, then turning cost
    assert compare.alike(wide, 2.0).tolist() == [True, False, True, False]


def test_how_far_out_the_published_path_is_goes_by_ranks():
    alike, others = made([59.3] * 199, [31] * 199), made([60.3] * 199, [33] * 199)
    assert compare.traditional(alike)["p"] == 1.0
    # Further out in turning cost than all 199; two sides, and one of two quantities.
    assert compare.traditional(others)["p"] == pytest.approx(4 / 200)


def test_a_rule_is_compared_where_both_have_a_path():
    old = made([50.0, 50.0, 50.0, 40.0], [20, 20, 20, 20], [True, True, True, False])
    new = made([48.0, 50.0, 51.0, 30.0], [16, 20, 22, 10])
    found = compare.closely(new, old)
    assert found["n"] == 3
    assert [round(3 * found[name]["value"]) for name in ("equal", "worse")] == [1, 1]
    assert found["total"]["value"] == pytest.approx(-1 / 3)
    assert found["turning"]["value"] == pytest.approx(-1 / 3)
    assert found["bends"]["value"] == pytest.approx(-1 / 3)
    assert found["means"]["total"] == pytest.approx([149 / 3, 50.0])
    assert compare.against(new, old)["total"] == found["total"]


def test_the_excess_is_that_over_the_exact_optimum():
    exact, other = made([40.0, 40.0], [0, 0]), made([42.0, 40.0], [0, 0])
    assert compare.excess(other, exact) == pytest.approx(0.025)
    assert compare.excess(made([1.0], [0], [False]), made([1.0], [0])) is None


# --- verdicts ---------------------------------------------------------------------------------

SIZES = ("25 cells, 0.3", "28 cells, 0.2")


def numbers(change=-1.0, p=0.3, saving=0.2, n=400, ratio=(1.05, 1.04, 1.06)):
    """Numbers that are the same for all programs, rules and sizes."""

    def figure(value, low, high):
        return {"value": value, "low": low, "high": high}

    changes = {name: figure(change, change - 0.1, change + 0.1) for name in
               ("total", "turning", "bends")}  # fmt: skip
    spread = {name: figure(57.0, 49.0, 69.0) for name in ("total", "turning")}
    alike = {"n": n, "printed": {"p": saving, "as_published": figure(saving, 0.0, 1.0)}}
    size = {
        "traditional": {"n": n, "p": p, **spread},
        "alike": {window: {**alike, "accumulated": alike["printed"]} for window in ("1", "2")},
        "against": {rule: {"n": n, **changes} for rule in ("printed", "accumulated")},
    }
    time = {rule: {"n": 9, "ratio": figure(*ratio)} for rule in ("printed", "accumulated")}
    return {
        "sizes": dict.fromkeys(SIZES),
        "programs": {program: dict.fromkeys(SIZES, size) for program in compare.PROGRAMS},
        "time": {label: dict.fromkeys(("batched", "textbook"), time) for label in runs.TIMED},
    }


def words(found):
    return [one.verdict for one in judge(claims(found), found)]


GOOD = ["not excluded", "not excluded", *["reproduces"] * 4]


@pytest.mark.parametrize(
    ("changed", "places", "verdict"),
    [
        ({}, (), ""),
        ({"p": 0.05}, (0,), "does not reproduce"),
        ({"saving": 0.05}, (1,), "does not reproduce"),
        ({"n": 78}, (0,), "undecided"),  # no path can be far enough out among 78
        ({"n": 79}, (), ""),
        ({"n": 18}, (0, 1), "undecided"),
        ({"n": 19}, (0,), "undecided"),
        ({"change": -0.11}, (2, 3, 4), "undecided"),  # alone, but not among 8 readings
        ({"change": 0.2}, (2, 3, 4), "does not reproduce"),
        ({"ratio": (1.05, 1.03, 1.07)}, (5,), "undecided"),  # alone, but not among 16 readings
        ({"ratio": (1.2, 1.15, 1.25)}, (5,), "does not reproduce"),
    ],
)
def test_verdicts_follow_from_the_numbers(changed, places, verdict):
    wanted = [verdict if place in places else good for place, good in enumerate(GOOD)]
    assert words(numbers(**changed)) == wanted


def test_the_size_that_was_chosen_to_fit_does_not_count():
    found = numbers()
    out = numbers(p=0.01, saving=0.01, change=0.2)["programs"]["textbook"][SIZES[0]]
    fitted = {program: {**sizes, SIZES[0]: out} for program, sizes in found["programs"].items()}
    assert words({**found, "programs": fitted}) == GOOD
    other = {program: {**sizes, SIZES[1]: out} for program, sizes in found["programs"].items()}
    assert words({**found, "programs": other})[:5] == ["does not reproduce"] * 5
    one = {**found["programs"], "textbook": {**found["programs"]["textbook"], SIZES[1]: out}}
    assert words({**found, "programs": one})[:5] == ["depends on the reading"] * 5


def test_intervals_are_as_wide_as_the_readings_that_count_need():
    for sizes in (SIZES, runs.SIZES):
        found = numbers()
        found["sizes"] = dict.fromkeys(sizes)
        for claim in claims(found)[2:5]:
            assert claim.measure.args[1] == len(claim.readings)
            assert f"all {len(claim.readings)} readings that count" in claim.test
            assert all(runs.FITTED.label in label for label in claim.beside)


def test_every_choice_that_is_not_printed_is_a_reading():
    found = numbers()
    found["sizes"] = dict.fromkeys(runs.SIZES)
    by_text = {claim.text: claim for claim in claims(found)}
    labels = list(by_text["The turning cost is reduced"].readings)
    assert len(labels) == 2 * 4 * 22
    for choice in ("printed, ", "accumulated, ", "batched", "textbook", "upper first", "last in",
                   "corners cut", "20 cells", "31 cells", "0.1", "0.3"):  # fmt: skip
        assert 0 < sum(choice in label for label in labels) < len(labels), choice
    traditional = by_text["Table 3: cost of the traditional path"]
    assert len(traditional.readings) == 4 * 22
    assert len(traditional.beside) == 4 * 2


# --- the paper's arithmetic -------------------------------------------------------------------


def test_steps_that_make_up_the_published_length():
    found = {(row.straight, row.diagonal): row.side for row in arithmetic.steps_of(43.8)}
    assert TRADITIONAL.length == pytest.approx(43.8)
    assert all(s + 1.4 * d == pytest.approx(43.8) for s, d in found)
    assert {pair: side for pair, side in found.items() if side} == {
        (34, 7): 25,
        (20, 17): 28,
        (6, 27): 31,
    }


def test_six_per_cent_is_what_the_times_say_of_queries_a_second_alone(monkeypatch):
    def found():
        return [check.verdict for check in arithmetic.checks()]

    assert found() == ["agrees", "agrees", "can agree", "agrees"]
    assert "6.90 %" in arithmetic.checks()[2].recomputed
    assert "6.45 %" in arithmetic.checks()[3].recomputed
    monkeypatch.setattr(arithmetic, "TIMES", {"traditional": 116.0, "improved": 130.0})
    assert found()[2:] == ["contradicts", "contradicts"]
    monkeypatch.setattr(arithmetic, "GAMMA", 0.4)
    assert found()[:2] == ["contradicts", "contradicts"]


# --- the program ------------------------------------------------------------------------------


def test_a_run_writes_page_numbers_and_figures(tmp_path, monkeypatch):
    # The batched search is tried above; compiling its four rules would take most of the time.
    rules = {rule: TEXTBOOK[f"{rule} (textbook)"] for rule in runs.TIMED_RULES}
    rules["exact"] = rules["accumulated"]
    monkeypatch.setattr(
        "experiments.zhang2019.mission.batched",
        lambda scene, rule: by_the_book(scene, rules[rule]),
    )
    sizes = {one.label: one for one in (runs.FITTED, runs.FITTED._replace(density=0.1))}
    for module in (runs, compare):
        monkeypatch.setattr(module, "SIZES", sizes)
    monkeypatch.setattr(compare, "CLOSELY", list(sizes))
    monkeypatch.setattr("experiments.zhang2019.figures.SIZES", sizes)
    monkeypatch.setattr("experiments.zhang2019.figures.DENSITIES", (0.1, 0.3))
    monkeypatch.setattr(runs, "TIMED", {runs.FITTED.label: runs.FITTED})
    monkeypatch.setattr("experiments.zhang2019.verdicts.TIMED", [runs.FITTED.label])
    monkeypatch.setattr(runs, "SHARD", 24)
    monkeypatch.chdir(tmp_path)
    assert main(PAPER, ["--quick", "--maps", "24"]) == 0
    folder = Path("runs/zhang2019_quick")
    found = json.loads((folder / "results.json").read_text())
    own = found["searches"]["programs"]["batched"]
    assert own[runs.FITTED.label]["traditional"]["n"] > 5
    text = (folder / "README.md").read_text()
    assert "nan" not in text
    assert "None" not in text
    for verdict in found["verdicts"]:
        assert f"**{verdict['verdict']}**" in text
    for title in ("Table 3 on one map", "The size of the paper's map", "Maps like the paper's",
                  "What ties explain", "Time (Table 4)", "Not here"):  # fmt: skip
        assert f"## {title}" in text, title
    drawn = {file.stem for file in (folder / "figures").iterdir()}
    assert {"fig9_10", "sizes", "changes"} <= drawn <= {"fig9_10", "sizes", "changes", "maps_alike"}


def test_fewer_maps_than_one_are_refused(capsys):
    assert main(PAPER, ["--maps", "0"]) == 2
    assert (
        capsys.readouterr().err == "zhang2019: --maps: got 0; wanted at least 1 map per density\n"
    )


def test_no_path_is_counted_as_nothing():
    blocked = np.zeros((1, 5, 5), bool)
    blocked[0, 2] = True
    for name in ("traditional (batched)", "printed (textbook)"):
        columns = MISSION.run(scene_of(blocked), name).columns
        assert columns["status"].tolist() == [Status.UNREACHABLE]
        assert columns["straight"] == columns["diagonal"] == columns["turns"] == 0
