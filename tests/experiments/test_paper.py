"""The machinery of papers: what is run, judged, written and resumed, on a paper of our own."""

import json
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from experiments import claims, estimates, output, pace, page
from experiments.claims import Check, Claim, Finding, judge, weigh
from experiments.output import RESULTS, results_folder, rounded
from experiments.paper import Absent, Drawing, Options, Paper, Part, main
from experiments.runs import Call, Study, place_of
from usvjax.errors import BadInputError
from usvjax.report import Section, Sheet
from usvjax.statistics import Estimate

pytestmark = pytest.mark.usefixtures("one_device")

YES, NO, NEITHER = (Finding(holds, "n") for holds in (True, False, None))


@dataclass(frozen=True)
class Sizes(Options):
    """A paper of our own.

    Attributes:
        episodes: How many.
    """

    episodes: int | None = None


def runs(options):
    if options.episodes is not None and options.episodes < 1:
        raise BadInputError(f"--episodes: got {options.episodes}; wanted at least 1")
    study = {
        "name": "sailed",
        "kind": "dwa",
        "episodes": options.episodes or 4,
        "shard": 2,
        "methods": ["traditional", "improved"],
        "static": {"max_steps": 60},
        "conditions": [{"label": "thin", "maps": {"rate": 0.02}}],
    }
    return {"sailed": Study(study), "timed": Call(lambda advance: advance(1) or 7.0, 1)}


def measured(found):
    ran = found.studies["sailed"]
    columns = ran.columns("thin", "improved")
    assert ran.replay("thin", "improved", [1]).columns["steps"] == columns["steps"][1]
    return {"mean": Estimate(float(np.mean(columns["steps"]))), "seconds": found.made["timed"]}


def decided(holds, numbers, reading):
    return Finding(holds, f"{numbers['seconds']:g} s, {reading}")


def claimed(numbers):
    return [
        Claim("It sails", "always", partial(decided, True), {"one": 1, "two": 2}, {"fit": 3}, "T."),
        Claim("It flies", "never", partial(decided, False), {"one": 1}, test="T."),
    ]


def drawn(found, numbers):
    yield Drawing("steps", "Steps.", Figure())


PAPER = Paper(
    name="somebody2099",
    cite="Somebody 2099",
    title="nothing",
    about="Nothing is here.",
    options=Sizes,
    parts=[
        Part(
            name="sailing",
            title="Sailing",
            runs=runs,
            measure=measured,
            claims=claimed,
            sections=lambda n: [Section("Table 1", [Sheet("", ["a"], [[f"{n['seconds']}"]])])],
            figures=drawn,
            readings=lambda n: ["As it stands."],
            summary=lambda n: ["Little."],
        )
    ],
    absent=[Absent("Table 2", "it has no numbers")],
    checks=lambda: [Check("Table 1", "1", "2", "contradicts"), Check("T", "1", "1", "agrees")],
)


def run(*args):
    return main(PAPER, list(args))


def test_a_paper_is_run_judged_written_and_not_run_twice(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run("--quick", "--format", "svg") == 0
    folder = Path("runs/somebody2099_quick")
    text = (folder / "README.md").read_text()
    for words in (
        "# Somebody 2099: nothing",
        "Written by `usvjax reproduce somebody2099`",
        "**Reproduces**: It sails.",
        "**Does not reproduce**: It flies.",
        "| It sails | always | **reproduces** | yes: 7 s, 1 | yes: 7 s, 2 | yes: 7 s, 3 |",
        "(fit)",
        "It sails; It flies: T.",
        "Of 2 checks of the paper's numbers against each other 1 agree",
        "- Table 2: it has no numbers",
        "![Steps.](figures/steps.svg)",
    ):
        assert words in text, words
    assert (folder / "figures/steps.svg").is_file()
    found = json.loads((folder / "results.json").read_text())
    assert found["sailing"]["mean"] == {
        "value": pytest.approx(60, abs=60),
        "low": None,
        "high": None,
    }
    assert found["pace"]["runs"]["sailing: sailed"]["size"] == 8
    out, err = capsys.readouterr()
    assert "somebody2099: 8 episodes; how long it takes was never recorded" in err
    assert "\nIt flies (published: never): DOES NOT REPRODUCE\n" in out
    assert "no: 7 s, 1" in out
    assert "\\n" not in out

    spec = runs(Sizes())["sailed"].spec
    shards = list((place_of("somebody2099", spec) / "sailed").rglob("*.parquet"))
    assert len(shards) == 2
    before = [shard.stat().st_mtime_ns for shard in shards]
    (folder / "figures/notes.txt").write_text("mine")
    assert run("--quick") == 0
    left = sorted(file.name for file in (folder / "figures").iterdir())
    assert left == ["notes.txt", "steps.png"]
    assert [shard.stat().st_mtime_ns for shard in shards] == before


def test_how_long_it_takes_is_scaled_from_the_record(tmp_path, monkeypatch):
    monkeypatch.setattr(pace, "RESULTS", tmp_path)
    monkeypatch.setattr(pace, "yardstick", lambda: 3.0)
    monkeypatch.chdir(tmp_path)
    wanted = {"a": Call(lambda advance: None, 40), "b": Call(lambda advance: None, 1)}
    assert pace.forecast("p", wanted) == "p; how long it takes was never recorded"
    (tmp_path / "p").mkdir()
    for runs, words in (
        ({"other": (10.0, 20)}, "p; about 62 s here"),  # by what each took there
        ({"a": (10.0, 20), "b": (0.1, 1)}, "p; about 62 s here"),  # 3 / 1 * 10 * 40 / 20, and 2
        ({"a": (20.0, 20), "b": (0.1, 1)}, "p; about 2 min here"),
    ):
        own = {name: {"seconds": s, "size": size} for name, (s, size) in runs.items()}
        record = {"pace": {"yardstick": 1.0, "runs": own}}
        (tmp_path / "p/results.json").write_text(json.dumps(record))
        assert pace.forecast("p", wanted).startswith(words)


def test_verdicts():
    assert weigh([YES, YES]) == "reproduces"
    assert weigh([NO, NO]) == "does not reproduce"
    assert weigh([YES, NO]) == weigh([YES, NEITHER, NO]) == "depends on the reading"
    for one_open in ([NEITHER], [YES, NEITHER], [NO, NEITHER], []):
        assert weigh(one_open) == "undecided"
    readings = {"a": YES, "b": YES}
    weak = Claim("c", "p", lambda n, given: given, readings, {"d": NO}, weak=True)
    (verdict,) = judge([weak], {})
    assert verdict.verdict == "not excluded"
    assert claims.sheet([verdict]).rows[0][3:] == ["yes: n", "yes: n", "no: n"]


@pytest.mark.parametrize(
    ("low", "high", "wanted"),
    [(-2.0, -0.1, True), (0.1, 2.0, False), (-1.0, 1.0, None), (None, None, None), (-1, 0, None)],
)
def test_a_figure_lies_below_a_bound_with_all_of_its_interval(low, high, wanted):
    figure = {"value": 0.0, "low": low, "high": high}
    assert claims.below(figure) is wanted
    assert claims.above(figure) is (None if wanted is None else not wanted)


@pytest.mark.parametrize("n", [0, 9, 38, 39, 159])
def test_what_is_farther_out_than_all_of_ours_has_the_least_p(n):
    ours = np.arange(float(n))
    assert estimates.rank_p(ours, -1.0) == estimates.least_rank_p(n)
    excluded = claims.not_excluded(estimates.least_rank_p(n), estimates.least_rank_p(n), 0.05)
    assert excluded is (False if n >= 39 else None)
    assert claims.not_excluded(1.0, estimates.least_rank_p(n), 0.05) is (True if n >= 39 else None)


def test_all_of_several_hold_where_each_does():
    assert claims.every([True, True]) is True
    assert claims.every([True, None]) is None
    assert claims.every([True, None, False]) is False


def test_the_rank_of_what_is_printed_excludes_at_its_level():
    assert estimates.rank_p(np.arange(1.0, 100.0), 0.0) == 0.02
    assert estimates.rank_p(np.arange(1.0, 100.0), 50.0) == 1.0
    assert estimates.rank_p(np.arange(1.0, 100.0), 2.0) == 0.06
    rng = np.random.default_rng(0)
    for n in (10, 39, 200):
        drawn = rng.normal(size=(2000, n + 1))
        excluded = np.mean([estimates.rank_p(row[1:], row[0]) < 0.05 + 1e-9 for row in drawn])
        assert excluded < 0.05 + 0.015


def test_readings_of_a_kind_are_counted_together():
    readings = {"a: 1": YES, "a: 2": NO, "a: 3": NO, "b: 1": YES, "c": NEITHER}
    (verdict,) = judge([Claim("c", "p", lambda n, given: given, readings)], {})
    sheet = claims.sheet([verdict])
    assert list(sheet.header[3:]) == ["a", "b: 1", "c"]
    assert sheet.rows[0][3:] == ["of 3: yes 1, no 2", "yes: n", "-: n"]
    assert claims.section([verdict]).parts[0].rows[0][1:] == ["a", "of 3: yes 1, no 2"]
    assert len(verdict.found) == 5


def test_of_many_readings_each_has_a_line_of_its_own():
    few, many = ({f"r{i}": YES for i in range(count)} for count in (7, 8))
    for readings, tables in ((few, 1), (many, 2)):
        given = [Claim("c", "p", lambda n, given: given, readings, {})] * 2
        found = page._sheets(judge(given, {}))
        assert len(found) == tables
    assert found[0].rows == [["c", "p", "**reproduces**"]] * 2
    named = [row for row in found[1].rows if row[0]]
    assert [row[1:] for row in found[1].rows[:2]] == [["r0", "yes: n"], ["r1", "yes: n"]]
    assert len(found[1].rows) == 16
    assert len(named) == 1


def test_numbers_are_rounded():
    given = {"a": [1 / 3, np.inf, 7], 1: (2.0,), "e": Estimate(np.float32(0.5)), "n": np.int32(3)}
    wanted = {"a": [0.333333, None, 7], "1": [2.0], "n": 3}
    assert rounded(given) == wanted | {"e": {"value": 0.5, "low": None, "high": None}}


def test_the_record_is_written_only_when_asked_for(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(output, "RESULTS", tmp_path / "kept")
    assert results_folder("a", None, False, False) == Path("runs/a")
    assert results_folder("a", None, False, True) == Path("runs/a_quick")
    assert results_folder("a", tmp_path / "b", False, True) == tmp_path / "b"
    assert results_folder("a", None, True, False) == tmp_path / "kept/a"
    assert RESULTS.name == "results"
    for out, look in ((None, True), (tmp_path / "b", False)):
        with pytest.raises(BadInputError, match="--record writes the results"):
            results_folder("a", out, True, look)


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["--foo"], "Unrecognized options: --foo"),
        (["--episodes", "x"], "--episodes: got 'x'; wanted a whole number"),
        (["--episodes", "0"], "--episodes: got 0; wanted at least 1"),
        (["--record", "--quick"], "--record writes the results"),
        (["--format", "gif"], "--format"),
        (["--dpi", "0"], "--dpi is 0; 20 to 1200 was wanted"),
    ],
)
def test_options_that_cannot_be_used_are_one_line(args, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(*args) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("somebody2099: ")
    assert words in err
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("README.md", "mine"),
        ("README.md", "Written by `usvjax reproduce` of somebody else"),
        ("notes.txt", "mine"),
    ],
)
def test_a_folder_of_something_else_is_refused_and_left_alone(name, text, tmp_path, capsys):
    (tmp_path / name).write_text(text)
    assert run("--quick", "--out", str(tmp_path)) == 2
    assert (
        "holds files that 'usvjax reproduce somebody2099' did not write" in capsys.readouterr().err
    )
    assert (tmp_path / name).read_text() == text
    assert [file.name for file in tmp_path.iterdir()] == [name]
