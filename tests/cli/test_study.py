"""The command line: studies from a shell, and one clear line for every mistake."""

import json
import sys
from pathlib import Path

import pytest
from study_fake import run_files

from usvjax import __version__
from usvjax.cli import COMMANDS, main
from usvjax.errors import BadInputError

STUDY = """
name = "toy"
kind = "toy"
seed = 3
episodes = 250
shard = 100
methods = ["plain", "better"]
[axes]
params.rate = [0.5, 0.9]
"""


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "toy.toml"
    path.write_text(STUDY)
    return path


@pytest.fixture(autouse=True)
def without_figures(monkeypatch, tmp_path):
    monkeypatch.setattr(
        "usvjax.cli.study._figures", lambda run, *_: [run / "figures" / "rates.png"]
    )
    monkeypatch.setattr("usvjax.devices.use_compilation_cache", lambda: tmp_path)
    monkeypatch.setenv("COLUMNS", "100")


def one_line(capsys) -> str:
    """What a refused command printed: one line on stderr, nothing on stdout."""
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith("usvjax: ")
    return err


def test_a_study_ends_with_its_table_and_paths(study, tmp_path, capsys):
    assert main(["study", str(study), "--out", str(tmp_path / "runs")]) == 0
    out, err = capsys.readouterr()
    run = tmp_path / "runs" / "toy"
    for words in ("rate 0.5", "plain", "better", "Reached", "Success (%)", str(run / "summary.md")):
        assert words in out
    assert str(run / "figures" / "rates.png") in out
    assert "1,000/1,000 episodes" in err
    tables = out[: out.index("Run ")].splitlines()
    assert max(map(len, tables)) <= 100


def test_json_is_all_that_is_printed(study, tmp_path, capsys):
    assert main(["study", str(study), "--out", str(tmp_path), "--json", "--quiet"]) == 0
    out, err = capsys.readouterr()
    found = json.loads(out)
    assert err == ""
    assert found["run"] == str(tmp_path / "toy")
    assert found["figures"] == [str(tmp_path / "toy" / "figures" / "rates.png")]
    assert found["summary"] == json.loads((tmp_path / "toy" / "summary.json").read_text())


def test_figures_can_be_left_out(study, tmp_path, capsys):
    args = ["study", str(study), "--out", str(tmp_path), "--json", "--quiet", "--no-figures"]
    assert main(args) == 0
    assert json.loads(capsys.readouterr().out)["figures"] == []


def test_running_again_says_that_it_continues(study, tmp_path, capsys):
    main(["study", str(study), "--out", str(tmp_path)])
    capsys.readouterr()
    assert main(["study", str(study), "--out", str(tmp_path)]) == 0
    assert "continuing: 1,000 of 1,000 episodes on disk" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("episodes = 0", "'episodes' must lie between"),
        ("episodes = -5", "'episodes' must lie between"),
        ("episodes = 'many'", "'episodes' must be an integer"),
        ("episodes = 2\nshards = 1", "did you mean 'shard'?"),
        ("episodes = ", "not valid TOML"),
        ("episodes = 2\nrate = 0.2", "unknown key 'rate'; did you mean 'params.rate'?"),
        ("episodes = " + "1" * 5001, "a whole number of thousands of digits"),
        ("episodes = " + "[" * 5000, "nested too deeply"),
        ("episodes = 2147483647\nshard = 2147483647", "'shard' must be at most 1,000,000"),
        ("episodes = 2\n[axes]\nrate = [0.2]", "section.key; did you mean 'params.rate'?"),
    ],
)
def test_a_bad_study_is_one_line_and_exit_2(tmp_path, capsys, text, words):
    (tmp_path / "bad.toml").write_text(f'name = "bad"\nkind = "toy"\n{text}\n')
    assert main(["study", str(tmp_path / "bad.toml"), "--out", str(tmp_path / "runs")]) == 2
    assert words in one_line(capsys)
    assert not (tmp_path / "runs").exists()


def test_a_missing_study_is_one_line_and_exit_2(tmp_path, capsys):
    assert main(["study", str(tmp_path / "none.toml")]) == 2
    assert "none.toml: no such file" in one_line(capsys)


def test_another_spec_in_the_directory_is_exit_2(study, tmp_path, capsys):
    main(["study", str(study), "--out", str(tmp_path / "runs"), "--quiet"])
    before = run_files(tmp_path / "runs")
    study.write_text(STUDY.replace("seed = 3", "seed = 4"))
    capsys.readouterr()
    assert main(["study", str(study), "--out", str(tmp_path / "runs")]) == 2
    assert "seed is 3 there and 4 here" in one_line(capsys)
    assert run_files(tmp_path / "runs") == before


def test_an_unwritable_directory_is_exit_2(study, tmp_path, capsys):
    (tmp_path / "runs").write_text("a file")
    assert main(["study", str(study), "--out", str(tmp_path / "runs")]) == 2
    assert "cannot write the run directory" in one_line(capsys)
    assert (tmp_path / "runs").read_text() == "a file"


def test_too_many_devices_is_exit_2(study, tmp_path, capsys):
    assert main(["study", str(study), "--out", str(tmp_path), "--devices", "999"]) == 2
    assert "--devices must lie between 1 and" in one_line(capsys)


def test_messages_of_several_lines_are_printed_in_one(monkeypatch, capsys):
    def fail(*_: object) -> int:
        raise BadInputError("first\n  second")

    monkeypatch.setattr("usvjax.cli._dispatch", fail)
    assert main(["study"]) == 2
    assert one_line(capsys) == "usvjax: first\\n second\n"


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["study"], "Missing from usvjax study: FILE.toml"),
        (["study", "a.toml", "--devices", "x"], "'x'"),
        (["study", "a.toml", "--nope"], "Unrecognized options: --nope (see usvjax study --help)"),
        (["maps"], "Expected one of {list, show, convert, draw}. (see usvjax maps --help)"),
        (["maps", "shw"], "Unrecognized options: shw"),
    ],
)
def test_errors_of_usage_are_one_line_and_exit_2(args, words, capsys):
    assert main(args) == 2
    said = one_line(capsys)
    assert words in said
    assert not set("│─╭╮").intersection(said)
    assert "--- " not in said


def test_unknown_commands_name_the_nearest(capsys):
    assert main(["studdy"]) == 2
    assert "did you mean 'study'?" in one_line(capsys)
    assert main(["xyz"]) == 2
    assert "valid: animate, check, export, init, maps, plot, reproduce, route, study" in one_line(
        capsys
    )


def test_help_and_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"usvjax {__version__}\n"
    assert main(["--help"]) == 0
    out = capsys.readouterr().out
    for name, command in COMMANDS.items():
        assert f" {name} " in out
        assert command.example in out
    assert main([]) == 2


@pytest.mark.parametrize("name", ["study", "reproduce"])
def test_each_command_teaches(name, capsys):
    with pytest.raises(SystemExit) as left:
        main([name, "--help"])
    assert left.value.code == 0
    assert f"Example: usvjax {name}" in capsys.readouterr().out


def checkout(path: Path, monkeypatch) -> Path:
    """A folder with one experiment, to be run from."""
    (path / "experiments").mkdir()
    (path / "experiments" / "__init__.py").touch()
    (path / "experiments" / "somebody2099").mkdir()
    (path / "experiments" / "somebody2099" / "__init__.py").touch()
    (path / "experiments" / "somebody2099" / "__main__.py").write_text(
        'import sys\nif __name__ == "__main__":\n    print(sys.argv)\n'
    )
    for module in [name for name in sys.modules if name.partition(".")[0] == "experiments"]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.chdir(path)
    return path


def test_reproduce_runs_the_experiment_with_its_options(tmp_path, monkeypatch, capsys):
    checkout(tmp_path, monkeypatch)
    argv = list(sys.argv)
    assert main(["reproduce", "somebody2099", "--episodes", "7"]) == 0
    assert "'--episodes', '7'" in capsys.readouterr().out
    assert sys.argv == argv
    assert str(tmp_path) not in sys.path


def test_reproduce_names_the_nearest_paper(tmp_path, monkeypatch, capsys):
    checkout(tmp_path, monkeypatch)
    assert main(["reproduce", "somebody2098"]) == 2
    assert "did you mean 'somebody2099'?" in one_line(capsys)


def test_reproduce_without_a_checkout_says_so(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("usvjax.__file__", str(tmp_path / "site" / "usvjax" / "__init__.py"))
    assert main(["reproduce", "tan2022"]) == 2
    assert "needs a source checkout" in one_line(capsys)
