"""Yu 2022, Wei 2023: the textbook search, what is counted, and the verdicts."""

import json
from dataclasses import replace
from functools import partial
from math import hypot, sqrt
from types import SimpleNamespace

import jax
import numpy as np
import pytest

import usvjax as uj
from experiments import textbook
from experiments.textbook import Rules
from experiments.wei2023 import __main__ as wei
from experiments.wei2023 import paths as wei_paths
from experiments.wei2023 import scenes as wei_scenes
from experiments.wei2023 import verdicts as wei_verdicts
from experiments.yu2022 import __main__ as yu
from experiments.yu2022.heuristic import compare as yu_compare
from experiments.yu2022.heuristic import plans as yu_plans
from experiments.yu2022.heuristic import run as yu_run
from experiments.yu2022.heuristic import verdicts as yu_verdicts
from experiments.yu2022.heuristic.expansion import expanded_cells
from usvjax.search.replanning import dstar_lite
from usvkernels.status import Status

EXACT = Rules(1000, 1400, heuristic="octile")


def searched(blocked, starts, goals, *, heuristic="octile", turn_cost=0.0, turn_mode="", **_):
    """`astar` by the textbook program, for the shape of its results."""
    count = len(blocked)
    ends = [np.broadcast_to(np.asarray(cells), (count, 2)).tolist() for cells in (starts, goals)]
    accumulate = turn_mode in ("accumulated", "exact")
    rules = Rules(
        1000, 1400, heuristic=heuristic, turn=round(1000 * turn_cost), accumulate=accumulate
    )
    found = [
        textbook.search(grid, tuple(start), tuple(goal), rules)
        for grid, start, goal in zip(blocked, *ends, strict=True)
    ]
    longest = max(len(path) for path, _ in found)
    cells = np.array([goal for goal in ends[1]], np.int32)[:, None].repeat(longest, axis=1)
    for row, (path, _) in zip(cells, found, strict=True):
        row[: len(path)] = path or row[:0]
    status = [Status.FOUND if path else Status.UNREACHABLE for path, _ in found]
    return SimpleNamespace(
        status=np.array(status, np.int32),
        path=cells,
        path_cells=np.array([len(path) for path, _ in found], np.int32),
        expanded=np.array([len(cells) for _, cells in found], np.int32),
    )


# --- Yu et al. 2022 ---------------------------------------------------------------------------


def test_the_cells_that_are_drawn_are_those_that_the_planner_expands():
    scene = yu_plans.draw(replace(yu_plans.PLANS[1], moves=8), 12, seed=1)
    with jax.default_device(jax.local_devices()[0]):
        result = dstar_lite(
            scene.blocked, scene.starts, scene.goals, scene.flips, heuristic="weighted"
        )
    for row in range(len(scene.blocked)):
        ends = (tuple(map(int, cells[row])) for cells in (scene.starts, scene.goals))
        cells = expanded_cells(scene.blocked[row], *ends, "weighted")
        assert len(cells) == result.expanded[row, 0]


def test_ends_are_free_apart_and_connected():
    condition = yu_plans.PLANS[2]
    scene = yu_plans.draw(condition, 30, seed=5)
    again = yu_plans.draw(condition, 30, seed=5)
    np.testing.assert_array_equal(scene.starts, again.starts)
    apart = np.abs(scene.starts - scene.goals).max(axis=1)
    assert apart.min() >= 0.5 * condition.side
    for blocked, start, goal in zip(scene.blocked, scene.starts, scene.goals, strict=True):
        path, _ = textbook.search(blocked, tuple(start), tuple(goal), EXACT)
        assert path


def sailed(first, length, reached=None, extra=0):
    first = np.array(first)
    arrived = np.ones(len(first), bool) if reached is None else np.array(reached)
    position = np.zeros((len(first), 2, 2), int)
    position[:, 1, 0] = np.round(length)
    status = np.where(arrived, int(Status.REACHED), int(Status.OUT_OF_BUDGET))
    return yu_plans.Replanned(status, first, first + extra, np.array(length, float), position)


def test_expansions_and_lengths_are_relative_to_the_traditional_heuristic():
    rows = {
        "chebyshev": sailed([100, 400, 100], [10.0, 20.0, 30.0]),
        "octile": sailed([50, 200, 50], [10.0, 20.0, 30.0]),
        "weighted": sailed([10, 40, 10], [11.0, 20.0, 30.0], [True, True, False]),
        "weighted_octile": sailed([25, 25, 25], [10.0, 22.0, 30.0], extra=5),
    }
    found = yu_compare.first_plans(rows, seed=0)
    assert found["n"] == 2
    weighted = found["heuristics"]["weighted"]
    assert weighted["times"]["value"] == pytest.approx(0.1)
    assert weighted["length_ratio"]["value"] == pytest.approx(1.05)
    assert weighted["same_length"]["value"] == 0.5
    octile = found["heuristics"]["weighted_octile"]
    assert octile["times"]["value"] == pytest.approx(sqrt(25 / 100 * 25 / 400))
    assert octile["longest_ratio"] == pytest.approx(1.1)
    changing = yu_compare.episodes(rows, seed=0)["heuristics"]
    assert changing["weighted_octile"]["replanning"]["value"] == 5
    assert changing["weighted"]["out_of_budget"]["value"] == pytest.approx(1 / 3)


def test_yus_verdicts_count_the_readings_of_eq_17_only():
    def table(times, same):
        row = {
            "times": {"value": times, "low": times - 0.01, "high": times + 0.01},
            "same_length": {"value": same},
            "length_ratio": {"value": 1.0 + (1 - same)},
        }
        names = ("octile", "weighted", "weighted_octile")
        return {"n": 100, "heuristics": dict.fromkeys(names, row)}

    plans = {"a": table(0.2, 0.3)}
    plans["a"]["heuristics"] = {
        **plans["a"]["heuristics"],
        "octile": table(0.5, 1.0)["heuristics"]["octile"],
    }
    found = yu_verdicts.judge({"plans": plans, "episodes": {"b": table(1.0, 1.0)}})
    assert [v.verdict for v in found] == ["reproduces", "does not reproduce", "does not reproduce"]
    assert found[1].found["octile, beside them"].holds
    few = {**table(0.2, 1.0), "n": 5}
    verdict = yu_verdicts.judge({"plans": {"a": few}, "episodes": {"a": few}})[0]
    assert verdict.verdict == "too few maps"


def replanned(blocked, starts, goals, flips, *, heuristic, sensing):
    """`dstar_lite` by the textbook program, for the shape of its results."""
    found = searched(blocked, starts, goals)
    counts = [
        len(expanded_cells(grid, tuple(map(int, start)), tuple(map(int, goal)), heuristic))
        for grid, start, goal in zip(blocked, starts, goals, strict=True)
    ]
    expanded = np.zeros((len(blocked), flips.shape[1] + 1), int)
    expanded[:, 0] = counts
    position = found.path[:, [*range(found.path.shape[1])]]
    status = np.full(len(blocked), int(Status.REACHED))
    return SimpleNamespace(status=status, expanded=expanded, position=position)


# --- Wei & Zhang 2023 -------------------------------------------------------------------------


def test_clearance_is_the_exact_distance_to_the_obstacles():
    line = np.array([[[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [4.0, 3.0]]])
    circles = np.array([[[2.0, 1.5, 0.5], [6.0, 5.0, 1.0]]])
    assert wei_scenes.clearance(line, circles)[0] == pytest.approx(1.0)
    circles = np.array([[[7.0, 7.0, 1.0]]])
    assert wei_scenes.clearance(line, circles)[0] == pytest.approx(hypot(3, 4) - 1)


def test_scenes_bar_the_straight_course_and_leave_another():
    scene = wei_scenes.draw(wei_scenes.SHOWN, 6, seed=3)
    for row in range(6):
        ends = [tuple(map(int, cells[row])) for cells in (scene.starts, scene.goals)]
        line = wei_scenes.centre_of(np.array([ends]))
        assert wei_scenes.clearance(line, scene.circles[row : row + 1])[0] <= 0.25
        path, _ = textbook.search(scene.blocked[row], *ends, EXACT)
        points = wei_scenes.centre_of(np.array([path]))
        # Between the centres of two free cells a path is nearer by a part of a cell at most.
        assert wei_scenes.clearance(points, scene.circles[row : row + 1])[0] > 0.25 - 0.005


def test_weis_verdicts_follow_from_the_numbers():
    def table(before, after, change):
        spread = {
            "before": {"turns": {"value": before, "low": before - 5, "high": before + 5}},
            "key points": {"turns": {"value": after, "low": after - 1, "high": after + 1}},
        }
        change = {"turns": {"value": change, "low": change - 1, "high": change + 1}}
        stages = {name: {"spread": spread[name], "difference": change} for name in spread}
        return {"n": 100, "stages": stages}

    good, other = table(38.0, 2.5, -35.0), table(15.0, 2.5, -12.0)
    tables = {wei_scenes.SHOWN.label: dict.fromkeys(wei_verdicts.SEARCHES, good)}
    assert {v.verdict for v in wei_verdicts.judge({"tables": tables})} == {"reproduces"}
    tables[wei_scenes.SHOWN.label] = {**tables[wei_scenes.SHOWN.label], "octile": other}
    found = wei_verdicts.judge({"tables": tables})
    assert [v.verdict for v in found] == ["depends on the reading", "reproduces", "reproduces"]


# --- the programs -----------------------------------------------------------------------------


def small_yu(patch):
    patch.setattr(yu_plans, "dstar_lite", replanned)
    patch.setattr(yu_run, "PLANS", yu_plans.PLANS[:1])
    patch.setattr(yu_run, "EPISODES", yu_plans.EPISODES[:1])
    patch.setattr(yu, "_plan", lambda options: [partial(yu_run.run, 4, 2022, True)])


def small_wei(patch):
    patch.setattr(wei_paths, "astar", searched)
    small = wei.Plan(6, 2, kinds=wei_scenes.KINDS[:1])
    patch.setattr(wei, "_plan", lambda options: small)


@pytest.mark.parametrize(
    ("program", "small", "figures"),
    [
        (yu, small_yu, {"fig5.png", "heuristics.png"}),
        (wei, small_wei, {"fig7_8.png", "turning_points.png"}),
    ],
)
def test_a_run_writes_report_numbers_and_figures(program, small, figures, tmp_path, monkeypatch):
    small(monkeypatch)
    with jax.default_device(jax.local_devices()[0]):
        assert program.main(["--quick", "--out", str(tmp_path)]) == 0
    found = json.loads((tmp_path / "results.json").read_text())
    assert found["settings"]["usvjax"] == uj.__version__
    text = (tmp_path / "README.md").read_text()
    headings = [line.strip("# ") for line in text.splitlines() if line.startswith("##")]
    assert headings[0] == "Summary"
    assert any(heading.startswith("Verdict") for heading in headings)
    assert "nan" not in text
    assert "None" not in text
    for verdict in found["verdicts"]:
        assert f"**{verdict['verdict']}**" in text
    assert {file.name for file in (tmp_path / "figures").iterdir()} == figures
    assert not list(tmp_path.glob(".*"))


@pytest.mark.parametrize(("program", "option"), [(yu, "--maps"), (wei, "--scenes")])
def test_bad_options_are_refused_in_one_line(program, option, tmp_path, capsys):
    assert program.main(["--quick", option, "0", "--out", str(tmp_path / "x")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert option in said
    assert not (tmp_path / "x").exists()
    taken = tmp_path / "file"
    taken.write_text("mine")
    assert program.main(["--quick", "--out", str(taken / "results")]) == 2
    assert "cannot write" in capsys.readouterr().err
