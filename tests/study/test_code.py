"""Which code a run is bound to: what decides results, and nothing that only draws."""

from pathlib import Path

import pytest

from usvjax.errors import BadInputError
from usvjax.registry import find_mission
from usvjax.study import load_spec, run_study
from usvjax.study.code import code_digest, sources

DRIFT = Path(__file__).parents[2] / "docs" / "examples" / "mydrift.py"

STUDY = """
name = "mine"
kind = "drift"
plugin = "mydrift.py"
episodes = 6
shard = 3
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "mydrift.py").write_text(DRIFT.read_text())
    (tmp_path / "mine.toml").write_text(STUDY)
    return tmp_path


def changed(folder, old, new):
    path = folder / "mydrift.py"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def run(folder):
    return run_study(load_spec(folder / "mine.toml"), folder / "runs", devices=1)


def test_a_plugin_runs_and_goes_on(folder):
    first = run(folder)
    assert run(folder).summary == first.summary


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("push = gain *", "push = 1.01 * gain *"),
        ("ARRIVED = 0.5, 400, 3.0", "ARRIVED = 0.5, 400, 3.03"),
        ("gain: float = 3.0", "gain: float = 3.03"),
    ],
)
def test_a_changed_plugin_refuses_the_old_run(folder, old, new):
    run(folder)
    changed(folder, old, new)
    with pytest.raises(BadInputError, match=r"holds a run (made with code|of another study)"):
        run(folder)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('yield "success"', 'yield "rates"'),
        ('return int(rows["job"].min()), "the first"', 'return int(rows["job"].max()), "the last"'),
    ],
)
def test_what_only_draws_may_change(folder, old, new):
    first = run(folder)
    changed(folder, old, new)
    assert run(folder).summary == first.summary


def test_what_a_plugin_imports_from_beside_it_counts(folder):
    changed(folder, "DT, STEPS", "from calm import FACTOR\n\nDT, STEPS")
    (folder / "calm.py").write_text("FACTOR = 1.0\n")
    load_spec(folder / "mine.toml")
    names = sources(find_mission("drift"))
    assert {"calm.py", "mydrift.py"} <= set(names)
    before = code_digest(find_mission("drift"))
    (folder / "calm.py").write_text("FACTOR = 1.1\n")
    changed(folder, "FACTOR\n", "FACTOR  # read anew\n")
    load_spec(folder / "mine.toml")
    assert code_digest(find_mission("drift")) != before


def test_the_facade_is_seen_through(folder):
    changed(folder, "DT, STEPS", "import usvjax as uj\n\nSEARCH = uj.astar\nDT, STEPS")
    load_spec(folder / "mine.toml")
    assert "usvjax/search/astar.py" in sources(find_mission("drift"))


@pytest.mark.parametrize(
    ("kind", "there", "not_there"),
    [
        ("dwa", "usvkernels/dwa/window.py", "usvkernels/search/astar.py"),
        ("route", "usvkernels/search/astar_lanes.py", "usvkernels/dwa/window.py"),
        ("cruise", "usvkernels/planners/aco.py", "usvkernels/dwa/window.py"),
    ],
)
def test_a_mission_is_bound_to_its_own_kernels(kind, there, not_there):
    names = sources(find_mission(kind))
    assert there in names
    assert not_there not in names
    assert f"usvjax/missions/{kind}/mission.py" in names
    assert not [name for name in names if name.endswith(("figures.py", "looks.py"))]


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("def (", r"the plugin 'mydrift.py' fails: SyntaxError"),
        ("1 / 0", r"the plugin 'mydrift.py' fails: ZeroDivisionError"),
        ("MISSIONS = []", "has no MISSIONS"),
        ("MISSIONS = {'drift': 3}", "the mission 'drift' has no 'tables'"),
        ("MISSIONS = {3: 3}", "a kind that is no string"),
    ],
)
def test_a_plugin_that_is_none_is_one_sentence(folder, source, words):
    (folder / "mydrift.py").write_text(source)
    with pytest.raises(BadInputError, match=words) as caught:
        load_spec(folder / "mine.toml")
    assert "\n" not in str(caught.value)


def test_a_plugin_may_not_take_the_place_of_a_mission_of_ours(folder):
    changed(folder, 'MISSIONS = {"drift"', 'MISSIONS = {"dwa"')
    with pytest.raises(BadInputError, match="'dwa' is a mission of usvjax's own"):
        load_spec(folder / "mine.toml")


def test_a_missing_plugin_is_said(folder):
    (folder / "mydrift.py").unlink()
    with pytest.raises(BadInputError, match=r"cannot read the plugin 'mydrift.py': No such file"):
        load_spec(folder / "mine.toml")
