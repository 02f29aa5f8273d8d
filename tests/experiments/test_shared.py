"""What experiments share: the textbook search, devices, files, verdicts."""

from dataclasses import replace
from pathlib import Path

import jax
import numpy as np
import pytest
from corner_grids import grids, shortest

from experiments import parallel, textbook, verdicts
from experiments.chen2023 import __main__ as chen2023
from experiments.files import RESULTS, results_folder, rounded
from experiments.program import begin
from experiments.textbook import LOWER_FIRST, STRAIGHTS_FIRST, UPPER_FIRST, Rules
from experiments.wei2023 import __main__ as wei2023
from experiments.yu2022 import __main__ as yu2022
from experiments.zhang2019 import __main__ as zhang2019
from experiments.zhang2019.runs import measure

EXACT = Rules(1000, 1400, heuristic="octile")
PROGRAMS = {
    "chen2023": (chen2023, "--scenes"),
    "wei2023": (wei2023, "--scenes"),
    "yu2022": (yu2022, "--swarm-runs"),
    "zhang2019": (zhang2019, "--maps"),
}


def cost_of(path):
    straight, diagonal, turns = (int(n[0]) for n in measure(np.array([path])))
    return 1000 * straight + 1400 * diagonal, turns


# --- the textbook search ----------------------------------------------------------------------


@pytest.mark.parametrize("corner_cutting", [False, True])
@pytest.mark.parametrize("heuristic", ["octile", "euclidean"])
def test_a_consistent_heuristic_gives_the_shortest_path(heuristic, corner_cutting):
    rules = replace(EXACT, heuristic=heuristic, corner_cutting=corner_cutting)
    for blocked in grids(25, 9, 0.35):
        path, expanded = textbook.search(blocked, (0, 0), (8, 8), rules)
        least = shortest(blocked, corner_cutting)
        assert bool(path) == np.isfinite(least)
        assert len(expanded) == len(set(expanded))
        if path:
            assert cost_of(path)[0] == least
            assert path[0] == (0, 0)
            assert path[-1] == expanded[-1] == (8, 8)


def test_orders_are_permutations_and_named_for_what_comes_first():
    for order in (LOWER_FIRST, UPPER_FIRST, STRAIGHTS_FIRST):
        assert sorted(order) == list(range(8))
    rows = {name: [textbook.CLOCKWISE[i][1] for i in order] for name, order in
            (("lower", LOWER_FIRST), ("upper", UPPER_FIRST))}  # fmt: skip
    assert rows["upper"] == sorted(rows["upper"])
    assert rows["lower"] == sorted(rows["lower"], reverse=True)


def test_ties_go_to_the_cell_that_entered_first_or_last():
    # Along an open row both diagonal starts are equally good.
    blocked = np.zeros((3, 6), bool)
    blocked[1, 2] = True
    for order, row in ((LOWER_FIRST, 2), (UPPER_FIRST, 0)):
        rules = replace(EXACT, order=order, corner_cutting=True)
        path, _ = textbook.search(blocked, (0, 1), (5, 1), rules)
        assert {y for _, y in path} == {1, row}


def test_a_turning_cost_of_almost_nothing_decides_ties_only():
    better = 0
    for blocked in grids(40, 12, 0.15, seed=3):
        before, after = (
            textbook.search(blocked, (0, 0), (11, 11), replace(EXACT, turn=turn, accumulate=True))
            for turn in (0, 1)
        )
        if before[0]:
            assert cost_of(after[0])[0] <= cost_of(before[0])[0]
            better += cost_of(after[0])[1] < cost_of(before[0])[1]
    assert better > 10


# --- shared pieces ----------------------------------------------------------------------------


def test_jobs_run_on_the_devices_they_are_told_to():
    def job():
        return jax.config.jax_default_device

    assert parallel.on_own_devices([job] * 3) == [parallel.device_of(k) for k in range(3)]
    with pytest.raises(ZeroDivisionError):
        parallel.on_own_devices([lambda: 1 // 0])


def test_numbers_are_rounded_and_recorded_results_are_left_alone(tmp_path, monkeypatch):
    assert rounded({"a": [1 / 3, np.inf, 7], 1: (2.0,)}) == {"a": [0.333333, None, 7], "1": [2.0]}
    monkeypatch.chdir(tmp_path)
    assert results_folder("yu2022", None, quick=True) == Path("runs/yu2022_quick")
    assert results_folder("yu2022", tmp_path / "here", quick=False) == tmp_path / "here"


def ready_for(paper, *args):
    """The folder that a program would write to, by its own options; nothing is run."""
    ready = begin(paper, PROGRAMS[paper][0].Options, list(args), lambda options: None)
    return None if ready is None else ready[2]


@pytest.mark.parametrize("paper", PROGRAMS)
def test_only_a_run_of_default_size_writes_over_the_record(paper, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    size = PROGRAMS[paper][1]
    assert ready_for(paper) == RESULTS / paper
    for args in (["--quick"], [size, "20"], ["--quick", size, "20"]):
        assert ready_for(paper, *args) == Path(f"runs/{paper}_quick")
    assert ready_for(paper, size, "20", "--out", "mine") == Path("mine")


@pytest.mark.parametrize("paper", PROGRAMS)
def test_a_folder_of_something_else_is_refused_and_left_alone(paper, tmp_path, capsys):
    program, size = PROGRAMS[paper]
    other = "Written by `usvjax reproduce` of somebody2099"
    for name, text in (("README.md", "mine"), ("README.md", other), ("notes.txt", "mine")):
        folder = tmp_path / str(len(list(tmp_path.iterdir())))
        folder.mkdir()
        assert ready_for(paper, "--out", str(folder)) == folder
        (folder / name).write_text(text)
        assert program.main(["--quick", size, "1", "--out", str(folder)]) == 2
        out, err = capsys.readouterr()
        assert out == ""
        assert err.count("\n") == 1
        assert f"{folder} holds files that 'usvjax reproduce {paper}' did not write" in err
        assert [file.name for file in folder.iterdir()] == [name]
        assert (folder / name).read_text() == text


@pytest.mark.parametrize("paper", PROGRAMS)
@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["--foo"], "Unrecognized options: --foo"),
        (["SIZE", "x"], "SIZE: got 'x'; wanted a whole number"),
        (["SIZE", "0"], "SIZE: got 0; wanted at least 1"),
    ],
)
def test_options_that_cannot_be_used_are_one_line(paper, args, words, tmp_path, capsys):
    program, size = PROGRAMS[paper]
    given = [arg.replace("SIZE", size) for arg in args]
    assert program.main([*given, "--out", str(tmp_path / "new")]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"{paper}: {words.replace('SIZE', size)}")
    assert err.count("\n") == 1
    assert not (tmp_path / "new").exists()


def test_a_verdict_weighs_the_findings_that_there_are():
    yes, no, open_ = (verdicts.Finding(holds, "") for holds in (True, False, None))
    assert verdicts.weigh([yes, open_]) == "reproduces"
    assert verdicts.weigh([yes, no]) == "depends on the reading"
    assert verdicts.weigh([no, no]) == "does not reproduce"
    assert verdicts.weigh([open_]) == "too few maps"
    text = verdicts.verdict_table(
        [{"claim": "c", "published": "p", "verdict": "v", "found": {"a": vars(yes)}}]
    )
    assert text.splitlines()[-1] == "| c | p | **v** | yes:  |"
