"""Tan et al. 2022: the program runs episodes as the library does, and writes what it found."""

import json
from dataclasses import replace

import jax
import numpy as np
import pytest

import usvjax as uj
from experiments.tan2022 import __main__ as tan2022
from experiments.tan2022 import published as published
from experiments.tan2022 import readings as read
from experiments.tan2022.episodes import Plan, obstacles, record, sail, total

PLAN = Plan(seed=5, maps=64, few_maps=4)
METHODS = published.METHODS


@pytest.fixture(scope="module")
def one_device():
    """One device compiles once; what is tested here does not depend on how many there are."""
    with jax.default_device(jax.local_devices()[0]):
        yield


@pytest.fixture(scope="module")
def small_run(one_device, tmp_path_factory):
    """Results of the whole program on few maps and two readings."""
    out = tmp_path_factory.mktemp("tan2022")
    job = tan2022.Job(
        paired=Plan(2022, 24, 0),
        one_map=Plan(2024, 12, 0),
        varied=Plan(2023, 8, 0),
        readings=[read.PRESET, read.DEMO],
        ranked=Plan(2023, 8, 0),
        combinations=[read.PRESET, read.DEMO],
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tan2022, "_job", lambda options: job)
        patch.setattr(tan2022, "SHOWN", (read.DEMO,))
        assert tan2022.main(["--quick", "--out", str(out)]) == 0
    return out


def test_pooled_episodes_are_those_of_separate_calls(one_device):
    plan = Plan(seed=2022, maps=24, few_maps=0)
    sparse = [replace(reading, rate=0.05) for reading in (read.PRESET, read.DEMO)]
    runs = [plan.run(r, c, "improved") for r in sparse for c in read.CASES]
    told = []
    pooled = sail(runs, told.append)
    assert sum(told) == total(runs) == 6 * 24
    run = runs[4]
    scenarios = run.source.draw(run.seed, np.arange(24), float(run.params.radius))
    alone = uj.navigate_dwa(
        scenarios.obstacles,
        scenarios.starts,
        scenarios.goals,
        valid=scenarios.valid,
        params=run.params,
        static=run.static,
    )
    np.testing.assert_array_equal(pooled[run].status, alone.status)
    np.testing.assert_array_equal(pooled[run].steps, alone.steps)
    np.testing.assert_allclose(pooled[run].path_length, alone.path_length, rtol=1e-5)


def test_recorded_episodes_are_those_of_the_tables(small_run, one_device):
    found = json.loads((small_run / "results.json").read_text())
    row = found["tables"]["cap 2r"]["3"][-1]
    case = next(case for case in read.CASES if case.radius == row["radius"])
    runs = [Plan(2022, 24, 0).run(read.DEMO, case, method) for method in METHODS]
    tracks = record([(run, row["map"]) for run in runs])
    centres = obstacles(runs[0], row["map"])
    for method, track in zip(METHODS, tracks, strict=True):
        values = row["values"][method]
        assert len(track) - 1 == round(10 * values["time"])
        length = np.hypot(*np.diff(track[:, :2], axis=0).T).sum()
        assert length == pytest.approx(values["path_length"], rel=1e-4)
        assert np.hypot(*(track[-1, :2] - 10.0)) <= 0.5 + 1e-4
        gaps = np.hypot(*(track[:, None, :2] - centres[None]).transpose(2, 0, 1))
        assert gaps.min() >= case.radius


def test_a_run_writes_report_numbers_and_figures(small_run):
    found = json.loads((small_run / "results.json").read_text())
    assert found["settings"]["paired"]["maps"] == 24
    assert [c["maps"] for c in found["paired"][0]["cases"]] == [24, 24, 24]
    assert all(row["maps"] == 8 for row in found["sensitivities"])
    text = (small_run / "README.md").read_text()
    headings = [line for line in text.splitlines() if line.startswith("## ")]
    assert headings[:2] == ["## Summary", "## Verdict on each table and claim"]
    assert "nan" not in text
    assert "None" not in text.replace("None of this is printed", "")
    names = {file.name for file in (small_run / "figures").glob("*.png")}
    assert {"cap.png", "endings.png", "distributions_cap_2r.png", "fig7_cap_2r.png"} <= names
    assert not list(small_run.glob(".*"))


def test_the_published_values_stand_in_the_report(small_run):
    text = (small_run / "README.md").read_text()
    for values in published.TABLE4.values.values():
        for value in values:
            assert f"**{value:.2f}**" in text


# --- bad input --------------------------------------------------------------------------------


@pytest.mark.parametrize("episodes", ["0", "-3"])
def test_too_few_episodes_are_refused_in_one_line(episodes, tmp_path, capsys):
    assert tan2022.main(["--quick", "--episodes", episodes, "--out", str(tmp_path / "x")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "--episodes" in said
    assert episodes in said
    assert not (tmp_path / "x").exists()


def test_a_folder_that_cannot_be_written_is_refused_before_anything_runs(tmp_path, capsys):
    taken = tmp_path / "file"
    taken.write_text("mine")
    assert tan2022.main(["--quick", "--out", str(taken / "results")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "cannot write" in said
    assert taken.read_text() == "mine"
