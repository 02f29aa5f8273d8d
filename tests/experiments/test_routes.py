"""Zhang 2019: the textbook search, what is counted, and the verdicts."""

import json
from math import sqrt
from types import SimpleNamespace

import jax
import numpy as np
import pytest
from corner_grids import grids, shortest

import usvjax as uj
from experiments import textbook
from experiments.textbook import Rules
from experiments.zhang2019 import __main__ as zhang
from experiments.zhang2019 import compare as zhang_compare
from experiments.zhang2019 import runs as zhang_runs
from experiments.zhang2019 import verdicts as zhang_verdicts
from experiments.zhang2019.published import TRADITIONAL, arithmetic, steps_of
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


# --- Zhang et al. 2019 ------------------------------------------------------------------------


def test_steps_that_make_up_the_published_length():
    found = {(row.straight, row.diagonal): row.side for row in steps_of(TRADITIONAL.length)}
    assert all(s + 1.4 * d == pytest.approx(43.8) for s, d in found)
    assert {pair: side for pair, side in found.items() if side} == {
        (34, 7): 25,
        (20, 17): 28,
        (6, 27): 31,
    }
    assert all(check.agrees for check in arithmetic())


def test_steps_and_turns_are_counted_along_the_path():
    path = [(0, 0), (1, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 2), (0, 2)]
    straight, diagonal, turns = zhang_runs.measure(np.array([path, [(3, 3)] * 8]))
    assert straight.tolist() == [4, 0]
    assert diagonal.tolist() == [1, 0]
    assert turns.tolist() == [1 + 1 + 2, 0]


@pytest.mark.parametrize("method", ["printed", "exact"])
def test_the_batched_paths_are_measured_as_the_search_does(method):
    blocked = grids(24, zhang_runs.SIDE, 0.2)
    corner = zhang_runs.SIDE - 1
    with jax.default_device(jax.local_devices()[0]):
        batch = zhang_runs._searched(method, blocked)
        result = zhang_runs.astar(
            blocked, (0, 0), (corner, corner), engine="queue", **zhang_runs.BATCHED[method]
        )
    found = batch.paths.found
    np.testing.assert_allclose(batch.paths.total(sqrt(2.0))[found], result.cost[found])
    least = [shortest(grid, corner_cutting=False) for grid in blocked]
    np.testing.assert_array_equal(found, np.isfinite(least))


def zhang_paths(totals, turns, found=None):
    """Paths of straight steps with these totals and turns by 45 degrees."""
    totals, turns = np.array(totals, float), np.array(turns)
    length = totals - 0.5 * turns
    diagonal = np.round(length * 10).astype(int) * 3 % 5  # 1.4 d makes the tenths even
    diagonal = (5 - diagonal % 5) % 5
    for d in range(5):
        fits = np.isclose((length - 1.4 * d) % 1, 0, atol=1e-6)
        fits |= np.isclose((length - 1.4 * d) % 1, 1, atol=1e-6)
        diagonal = np.where(fits, d, diagonal)
    straight = np.round(length - 1.4 * diagonal).astype(int)
    ones = np.ones(len(totals), bool) if found is None else np.array(found)
    return zhang_runs.Paths(ones, straight, diagonal, turns, 10 * turns)


def test_maps_like_the_papers_are_chosen_by_the_traditional_path_alone():
    old = zhang_paths([59.3, 59.3, 70.0, 59.3], [31, 31, 31, 31], [True, True, True, False])
    new = zhang_paths([54.3, 59.3, 54.3, 54.3], [21, 31, 21, 21])
    assert zhang_compare.nearest(old) == 0
    assert zhang_compare.same(old).tolist() == [True, True, False, False]
    found = zhang_compare.on_maps_alike(new, old)
    assert (found["n"], found["same"], found["hits"]) == (2, 2, 1)
    assert found["saved"] == pytest.approx(2.5)
    assert found["as_published"]["value"] == pytest.approx(0.5)


def test_a_method_is_compared_where_both_have_a_path():
    old = zhang_paths([50.0, 50.0, 50.0, 40.0], [20, 20, 20, 20], [True, True, True, False])
    new = zhang_paths([48.0, 50.0, 51.0, 30.0], [16, 20, 22, 10])
    found = zhang_compare.against(new, old)
    assert found["n"] == 3
    assert [round(3 * found[k]["value"]) for k in ("better", "equal", "worse")] == [1, 1, 1]
    assert found["metrics"]["total"]["difference"]["value"] == pytest.approx(-1 / 3)


def zhang_evidence(change, alike, ratio):
    spread = {"value": 57.0, "low": 49.0, "high": 69.0}
    row = {"difference": {"value": change, "low": change - 0.1, "high": change + 0.1}}
    method = {"metrics": {"turning": row, "total": row}}
    program = {
        "traditional": {"n": 500, "total": spread, "turning": {**spread, "low": 8.0, "high": 19.0}},
        "alike": {m: alike for m in ("printed", "accumulated")},
        "against": {"0.1": {m: method for m in ("printed", "accumulated")}},
        "time": {m: {"ratio": {"value": ratio}} for m in ("printed", "accumulated")},
    }
    return {"batched": program, "textbook": program}


def test_zhangs_verdicts_follow_from_the_numbers():
    near = {"value": 55.0, "low": 50.0, "high": 58.0}
    turns = {"value": 11.0, "low": 8.0, "high": 14.0}
    alike = {"n": 40, "spread": {"total": near, "turning": turns}}
    good = [v.verdict for v in zhang_verdicts.judge(zhang_evidence(-1.0, alike, 1.05))]
    assert good == ["reproduces"] * 5
    far = {"n": 40, "spread": {"total": {**near, "low": 54.9}, "turning": turns}}
    bad = [v.verdict for v in zhang_verdicts.judge(zhang_evidence(-0.05, far, 1.2))]
    assert bad == ["reproduces", *["does not reproduce"] * 4]
    few = zhang_verdicts.judge(zhang_evidence(-1.0, {"n": 3}, 1.0))
    assert few[1].verdict == "too few maps"


# --- the programs -----------------------------------------------------------------------------


def small_zhang(patch):
    patch.setattr(zhang_runs, "astar", searched)
    patch.setattr(zhang, "QUICK", zhang_runs.Plan(1, 12, 3, 1, 1))


@pytest.mark.parametrize(
    ("program", "small", "figures"),
    [
        (zhang, small_zhang, {"fig9_10.png", "maps_alike.png", "changes.png"}),
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


@pytest.mark.parametrize(("program", "option"), [(zhang, "--maps")])
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
