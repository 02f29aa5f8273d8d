"""`usvjax init` and `usvjax check`: study files that explain themselves."""

import dataclasses
import json
import tomllib
from pathlib import Path

import pytest

from usvjax.cli import main
from usvjax.registry import find_mission
from usvjax.study import parse_spec
from usvjax.study.template import template, toml

ROOT = Path(__file__).parents[2]
KINDS = ["dwa", "route", "cruise", "fleet", "aggregate"]


def uncommented(text):
    """The template with every key in force that has a value, of the first choice of a table."""
    lines = []
    skipping = False
    for line in text.splitlines():
        if line.startswith("# With "):
            skipping = 'source = "' in line and not line.startswith(f"# With {first_choice(lines)}")
        elif line.startswith("["):
            skipping = False
        key = line.removeprefix("# ")
        is_key = line.startswith("# ") and "=" in line and key.split("=")[0].strip().isidentifier()
        if is_key and not key.endswith("="):
            line = "" if skipping else key
        lines.append(line)
    return "\n".join(lines)


def first_choice(lines):
    return next(line.split("  #")[0] for line in reversed(lines) if line.startswith("source ="))


@pytest.mark.parametrize("kind", KINDS)
def test_a_template_is_a_study_as_it_is(kind, tmp_path, capsys):
    file = tmp_path / "my.toml"
    assert main(["init", kind, "--out", str(file)]) == 0
    spec = parse_spec(tomllib.loads(file.read_text()), folder=tmp_path)
    assert spec.kind == kind
    assert spec.methods == tuple(find_mission(kind).methods)
    assert main(["init", kind]) == 0
    assert file.read_text() in capsys.readouterr().out


@pytest.mark.parametrize("kind", KINDS)
def test_the_defaults_that_a_template_shows_are_those_in_force(kind):
    text = template(kind, find_mission(kind))
    plain = parse_spec(tomllib.loads(text))
    explicit = tomllib.loads(uncommented(text))
    spec = parse_spec(explicit)
    assert spec.conditions[0].case.settings == plain.conditions[0].case.settings
    assert spec.shard == plain.shard == 2000


@pytest.mark.parametrize("kind", KINDS)
def test_a_template_shows_every_key(kind):
    mission = find_mission(kind)
    text = template(kind, mission)
    for table in mission.tables.values():
        for key in table.keys:
            assert f"\n{key} =" in text or f"\n# {key} =" in text, key
    for name in mission.methods:
        assert f"#   {name}: " in text


def test_a_template_is_not_written_over_a_file(tmp_path, capsys):
    file = tmp_path / "my.toml"
    file.write_text("mine")
    assert main(["init", "dwa", "--out", str(file)]) == 2
    assert "exists already" in capsys.readouterr().err
    assert file.read_text() == "mine"
    assert main(["init", "dwa", "--out", str(file), "--force"]) == 0


def test_a_template_of_a_plugin_names_it(tmp_path, capsys):
    plugin = tmp_path / "mydrift.py"
    plugin.write_text((ROOT / "docs" / "examples" / "mydrift.py").read_text())
    out = tmp_path / "mine.toml"
    assert main(["init", "drift", "--plugin", str(plugin), "--out", str(out)]) == 0
    assert 'plugin = "mydrift.py"' in out.read_text()
    assert main(["check", str(out), "--no-trial"]) == 0
    assert "my_drift, kind drift" in capsys.readouterr().out


def test_an_unknown_kind_is_one_line(capsys):
    assert main(["init", "dwaa"]) == 2
    assert "unknown kind 'dwaa'; did you mean 'dwa'?" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("value", "text"),
    [(True, "true"), (0.5, "0.5"), (3, "3"), ("a", '"a"'), ((1, 2.0), "[1, 2.0]")],
)
def test_values_are_written_as_toml(value, text):
    assert toml(value) == text
    found = tomllib.loads(f"x = {text}")["x"]
    assert found == (list(value) if isinstance(value, tuple) else value)


def test_a_field_without_a_meaning_is_a_defect():
    @dataclasses.dataclass
    class Bare:
        """Says nothing.

        Attributes:
            named: something.
        """

        named: int = 1
        bare: int = 2

    from usvjax.study.template import meanings_of

    with pytest.raises(Exception, match="nothing of 'bare'"):
        meanings_of(Bare)


def test_check_says_how_much_and_how_long(tmp_path, capsys):
    file = tmp_path / "small.toml"
    file.write_text(
        'name = "small"\nkind = "route"\nepisodes = 40\nshard = 20\nmethods = ["astar"]\n'
        "[maps]\nshape = [10, 10]\n[axes]\nmaps.density = [0.1, 0.2]\n"
    )
    assert main(["check", str(file), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["episodes"] == 80
    assert facts["shards"] == 4
    assert facts["conditions"] == ["density 0.1", "density 0.2"]
    assert facts["values"] == {"maps.density": 2}
    assert facts["estimate"]["tried"] in (16, 20)
    assert facts["estimate"]["conditions"] == 2
    assert 0 < facts["estimate"]["wall_seconds"] < 60
    assert facts["estimate"]["bytes"] > 80
    assert [path.name for path in tmp_path.iterdir()] == ["small.toml"]
    assert main(["check", str(file), "--no-trial"]) == 0
    shown = capsys.readouterr().out
    assert "80: 40 x 1 method x 2 conditions, in 4 shards" in shown
    assert "Conditions  2: 2 values of maps.density" in shown
    assert "Time" not in shown


def test_check_counts_combinations(tmp_path, capsys):
    text = 'name = "a"\nepisodes = 4\n[axes]\nparams.radius = [0.2, 0.3, 0.4]\n'
    (tmp_path / "a.toml").write_text(f"{text}maps.rate = {[0.01 * i for i in range(1, 8)]}\n")
    assert main(["check", str(tmp_path / "a.toml"), "--no-trial"]) == 0
    out = capsys.readouterr().out
    words = "21: all combinations of 3 values of params.radius x 7 values of maps.rate"
    assert f"Conditions  {words}" in out
    assert "... and 9 more" in out


def test_check_refuses_what_study_does(tmp_path, capsys):
    file = tmp_path / "bad.toml"
    file.write_text('name = "bad"\nepisodes = 4\n[maps]\nrat = 0.1\n')
    assert main(["check", str(file)]) == 2
    assert "unknown key 'rat'" in capsys.readouterr().err
