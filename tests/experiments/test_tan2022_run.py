"""Tan et al. 2022: episodes are those of the library, and the page says what became of them."""

from pathlib import Path

import jax
import numpy as np
import pytest

import usvjax as uj
from experiments.claims import judge
from experiments.output import rounded
from experiments.page import page
from experiments.paper import Done, main
from experiments.runs import Found, carry_out
from experiments.tan2022 import figures as drawing
from experiments.tan2022 import published
from experiments.tan2022 import readings as read
from experiments.tan2022.__main__ import PAPER, TanOptions, runs
from experiments.tan2022.episodes import SEED, Asked, Sailed, studies
from experiments.tan2022.measures import COUNTED
from experiments.tan2022.tables import Shown
from usvjax.missions.dwa.scenes import LatticeTable
from usvjax.report import markdown
from usvkernels.status import Status

pytestmark = pytest.mark.usefixtures("one_device")

PART = PAPER.parts[0]
MAPS = 60

# --- real episodes ----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def sailed(tmp_path_factory):
    """Twelve maps of one reading; on one device, which compiles once."""
    with pytest.MonkeyPatch.context() as patch, jax.default_device(jax.local_devices()[0]):
        patch.chdir(tmp_path_factory.mktemp("tan2022"))
        found, _ = carry_out("tan2022", studies([Asked("some", 12, read.DEMO, read.CASES[1])]))
        yield Sailed(found)


def test_episodes_are_those_of_the_library(sailed):
    case = read.CASES[1]
    scenes = LatticeTable(rate=case.rate).draw(SEED, np.arange(12), case.radius)
    params = uj.DwaParams(radius=case.radius, clearance_cap=1.0, clear_distance=1.0)
    alone = uj.navigate_dwa(
        scenes.obstacles,
        scenes.starts,
        scenes.goals,
        valid=scenes.valid,
        params=params,
        static=uj.DwaStatic(method="improved"),
    )
    ran = sailed.one(read.DEMO, case, "improved")
    np.testing.assert_array_equal(ran.status, alone.status)
    np.testing.assert_allclose(ran.time, alone.time, rtol=1e-6)
    np.testing.assert_allclose(ran.path_length, alone.path_length, rtol=1e-5)


def test_a_figure_shows_the_episodes_of_the_tables(sailed):
    case, pair = read.CASES[1], sailed.pair(read.DEMO, read.CASES[1])
    drawn = drawing._as_printed(sailed, read.DEMO, Shown(6, case, 3))
    assert drawn.name == "fig6_cap_2r"
    tracks = [line.get_xydata() for line in drawn.figure.axes[0].lines]
    lengths = [np.hypot(*np.diff(track, axis=0).T).sum() for track in tracks if len(track) > 20]
    for method in published.METHODS:
        wanted = pair[method].path_length[3]
        assert np.isclose(lengths, wanted, rtol=1e-3).any(), (method, wanted, lengths)


# --- the page, from episodes that were made up -------------------------------------------------


class MadeUp:
    """A study in place of what became of it: vessels as quick as the reading's label is long."""

    def __init__(self, study):
        self.spec = study.spec

    def columns(self, label, method):
        n = self.spec.episodes
        rng = np.random.default_rng((len(label), len(method)))
        length = rng.uniform(14.0, 15.0, n) + len(label) / 10
        time = length / rng.uniform(0.2, 0.7, n)
        ends = (Status.REACHED, Status.REACHED, Status.COLLIDED, Status.STUCK, Status.TIMED_OUT)
        status = np.where(rng.uniform(size=n) < 0.9, 0, rng.integers(1, 5, n))
        return {
            "status": np.array([int(end) for end in ends])[status],
            "time": time,
            "path_length": length,
            "mean_speed": length / time,
        }


@pytest.fixture(scope="module")
def made_up():
    """The whole page's episodes, at every reading, and its numbers."""
    wanted = runs(TanOptions(episodes=MAPS))
    found = Found({name: MadeUp(study) for name, study in wanted.items()}, {})
    return found, rounded(PART.measure(found))


@pytest.fixture(scope="module")
def text(made_up):
    """The page."""
    found, numbers = made_up
    verdicts = judge(PART.claims(numbers), numbers)
    return markdown(page(PAPER, [Done(PART, found, numbers, verdicts, [("a.png", "A.")])]))


def test_the_full_size_is_10000_maps_of_the_main_readings():
    wanted = runs(TanOptions())
    assert wanted["improved, main readings"].size == 9 * 10_000
    quick = runs(TanOptions(quick=True))
    assert {study.spec.episodes for study in quick.values()} == {100}
    assert quick.keys() < wanted.keys()  # by which the record's paces are known


def test_every_reading_that_counts_is_on_the_page_on_as_many_maps_as_asked(made_up, text):
    _, numbers = made_up
    for reading in COUNTED:
        cases = numbers["paired"][reading.label]["cases"]
        assert [case["maps"] for case in cases] == [MAPS] * 3
        assert f"| {reading.label} |" in text
    labels = {row["reading"] for row in numbers["sensitivities"]}
    assert labels == {one.label for one in (*COUNTED, *read.sensitivities())}
    assert numbers["ranking"]["readings"] == len(read.combinations())


def test_the_page_gives_every_reason_and_no_number_that_is_none(text):
    assert "nan" not in text
    assert "None" not in text.replace("None of this is printed", "")
    assert "to the letter" not in text
    for words in (
        "The cap and",
        "Who is given up",
        "Control period",
        "Of all ",
        "diagonal",
        "sailing astern",
    ):
        assert words in text, words
    assert text.count("- **") >= 14  # verdicts, findings and reasons


def test_the_published_values_stand_on_the_page(text):
    for values in published.TABLE4.values.values():
        for value in values:
            assert f"**{value:.2f}**" in text


def test_the_figures_of_all_maps_show_what_the_numbers_say(made_up, monkeypatch):
    found, numbers = made_up
    monkeypatch.setattr(drawing, "SHOWN", ())
    drawings = {drawn.name: drawn.figure for drawn in drawing.figures(found, numbers)}
    assert len(drawings) == 5 + 1 + 2  # distributions, of the hybrid too, endings and the cap
    fig = drawings["cap"]
    assert [tick.get_text() for tick in fig.axes[3].get_xticklabels()] == list(read.CAPS.values())
    row = next(row for row in numbers["sensitivities"] if row["reading"] == read.DEMO.label)
    assert fig.axes[0].texts[0].get_text() == f"n={row['both']}"
    drawn = fig.axes[3].containers[0].lines[0].get_ydata()[0]
    assert drawn == pytest.approx(100 * row["endings"]["traditional"]["REACHED"]["value"])


# --- bad input --------------------------------------------------------------------------------


@pytest.mark.parametrize("episodes", ["0", "-3"])
def test_too_few_episodes_are_refused_in_one_line(episodes, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(PAPER, ["--quick", "--episodes", episodes]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "--episodes" in said
    assert episodes in said
    assert not list(Path().iterdir())
