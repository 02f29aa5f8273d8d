"""`usvjax reproduce` beside experiments of one's own, and usage errors of every command."""

import sys

import pytest

from usvjax.cli import main


def loaded():
    """The modules of experiments, wherever they are from."""
    return [name for name in sys.modules if name.partition(".")[0] == "experiments"]


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A folder to work in, with an experiment of one's own."""
    own = tmp_path / "experiments" / "mine"
    own.mkdir(parents=True)
    (own.parent / "__init__.py").touch()
    (own / "__init__.py").touch()
    (own / "__main__.py").write_text("print('my own')\n")
    for module in loaded():
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setattr("usvjax.devices.use_compilation_cache", lambda: tmp_path)
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    for module in loaded():
        del sys.modules[module]


def test_experiments_of_ones_own_do_not_hide_a_paper(project, capsys):
    assert main(["reproduce", "mine"]) == 0
    assert capsys.readouterr().out == "my own\n"


def test_a_paper_is_found_beside_experiments_of_ones_own(project, capsys):
    with pytest.raises(SystemExit) as left:
        main(["reproduce", "tan2022", "--episodes", "1.5"])
    assert left.value.code == 2
    said = "tan2022: --episodes: got '1.5'; wanted a whole number"
    assert capsys.readouterr().err == f"{said} (see usvjax reproduce tan2022 --help)\n"
    assert [path.name for path in project.iterdir()] == ["experiments"]


def test_a_paper_that_neither_place_has_is_refused_with_those_of_both(project, capsys):
    assert main(["reproduce", "xyz"]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert f"no experiments for 'xyz' in {project / 'experiments'} or " in err
    assert "valid: chen2023, mine, tan2022, wei2023, yu2022, zhang2019" in err


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (
            ["maps", "show", "hongze-250", "--cell-size", "abc"],
            "--cell-size: got 'abc'; wanted a number (see usvjax maps show --help)",
        ),
        (
            ["maps", "draw", "hongze-250", "a.png", "--dpi", "1.5"],
            "--dpi: got '1.5'; wanted a whole number (see usvjax maps draw --help)",
        ),
        (
            ["maps", "show", "hongze-250", "--foo"],
            "Unrecognized options: --foo (see usvjax maps show --help)",
        ),
        (
            ["maps", "--foo", "show", "hongze-250"],
            "Unrecognized options: --foo (see usvjax maps --help)",
        ),
        (
            ["study", "a.toml", "--devices", "x"],
            "--devices: got 'x'; wanted a whole number (see usvjax study --help)",
        ),
        (
            ["route", "hongze-250", "--from", "1,1", "--to", "2,2", "--weight", "heavy"],
            "--weight: got 'heavy'; wanted a number (see usvjax route --help)",
        ),
    ],
)
def test_a_mistake_is_a_sentence_and_points_to_the_help(args, said, capsys):
    assert main(args) == 2
    assert capsys.readouterr() == ("", f"usvjax: {said}\n")
