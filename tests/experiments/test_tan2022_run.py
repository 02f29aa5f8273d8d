"""Tan et al. 2022: the program runs episodes as the library does, and writes what it found."""

import json
from pathlib import Path

import jax
import numpy as np
import pytest

import usvjax as uj
from experiments.paper import main
from experiments.runs import Found, Study, carry_out
from experiments.tan2022 import published
from experiments.tan2022 import readings as read
from experiments.tan2022.__main__ import PAPER, TanOptions, runs
from experiments.tan2022.episodes import SEED, Asked, Sailed, studies
from experiments.tan2022.measures import COUNTED

MAPS = 24


@pytest.fixture(scope="module")
def one_device():
    """One device compiles once; what is tested here does not depend on how many there are."""
    with jax.default_device(jax.local_devices()[0]):
        yield


@pytest.fixture(scope="module")
def small_run(one_device, tmp_path_factory):
    """The folder that the whole program worked in, on few maps."""
    folder = tmp_path_factory.mktemp("tan2022")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert main(PAPER, ["--quick", "--episodes", str(MAPS)]) == 0
    return folder


def test_episodes_are_those_of_the_library(small_run, monkeypatch):
    monkeypatch.chdir(small_run)
    case = read.CASES[0]
    found, _ = carry_out("tan2022", runs(TanOptions(quick=True, episodes=MAPS)))
    for reading in (read.PRESET, read.DEMO):
        ran = Sailed(found).one(reading, case, "improved")
        (study,) = (
            study
            for name, study in studies([Asked(MAPS, reading, case)]).items()
            if name.startswith("improved")
        )
        given = study.spec.conditions[0].case.given
        scenes = given.source.draw(SEED, np.arange(MAPS), case.radius)
        alone = uj.navigate_dwa(
            scenes.obstacles,
            scenes.starts,
            scenes.goals,
            valid=scenes.valid,
            params=given.params,
            static=uj.DwaStatic(method="improved"),
        )
        np.testing.assert_array_equal(ran.status, alone.status)
        np.testing.assert_allclose(ran.time, alone.time, rtol=1e-6)
        np.testing.assert_allclose(ran.path_length, alone.path_length, rtol=1e-5)


def test_the_full_size_is_10000_maps_and_holds_every_reading_that_counts():
    wanted = runs(TanOptions())
    assert wanted["improved, 10,000 maps"].size == 9 * 10_000
    found = Sailed(Found({name: _Unrun(study) for name, study in wanted.items()}, {}))
    for reading in COUNTED:
        for case in (*read.CASES, *read.ONE_MAP_CASES):
            assert found.has(reading, case)


class _Unrun:
    """A study in place of what became of it."""

    def __init__(self, study: Study) -> None:
        self.spec = study.spec


def test_a_run_writes_page_numbers_and_figures(small_run):
    folder = small_run / "runs/tan2022_quick"
    found = json.loads((folder / "results.json").read_text())["dwa"]
    for reading in COUNTED:
        cases = found["paired"][reading.label]["cases"]
        assert [case["maps"] for case in cases] == [MAPS] * 3
    assert all(row["maps"] == MAPS for row in found["sensitivities"])
    text = (folder / "README.md").read_text()
    headings = [line for line in text.splitlines() if line.startswith("## ")]
    assert headings[:2] == ["## Summary", "## Verdicts"]
    assert "nan" not in text
    assert "None" not in text.replace("None of this is printed", "")
    assert "letter" not in text
    names = {file.stem for file in (folder / "figures").glob("*.png")}
    assert {"cap", "endings", "distributions_cap_2r", "fig7_cap_2r"} <= names


def test_the_published_values_stand_on_the_page(small_run):
    text = (small_run / "runs/tan2022_quick/README.md").read_text()
    for values in published.TABLE4.values.values():
        for value in values:
            assert f"**{value:.2f}**" in text


@pytest.mark.parametrize("episodes", ["0", "-3"])
def test_too_few_episodes_are_refused_in_one_line(episodes, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(PAPER, ["--quick", "--episodes", episodes]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "--episodes" in said
    assert episodes in said
    assert not list(Path().iterdir())
