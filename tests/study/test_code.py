"""Which code a run is bound to: what decides results, and nothing that only draws."""

from pathlib import Path

import pytest

from usvjax.errors import BadInputError, BadTypeError
from usvjax.registry import find_mission
from usvjax.study import load_run, load_spec, run_study
from usvjax.study.code import code_digest, sources
from usvjax.study.figures import figures_for_run
from usvjax.study.replay import Replay

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
    changed(folder, "push = gain *", "push = FACTOR * gain *")
    (folder / "calm.py").write_text("FACTOR = 1.0\n")
    first = run(folder)
    assert {"calm.py", "mydrift.py"} <= set(sources(find_mission("drift"), folder / "mydrift.py"))
    (folder / "calm.py").write_text("FACTOR = 4.0\n")
    with pytest.raises(BadInputError, match="holds a run made with code"):
        run(folder)
    again = run_study(load_spec(folder / "mine.toml"), folder / "other", devices=1)
    assert again.summary["conditions"] != first.summary["conditions"]  # the new one was imported


def test_the_file_that_a_study_names_counts_whoever_wrote_the_class(folder):
    (folder / "mydrift.py").rename(folder / "base_drift.py")
    (folder / "mydrift.py").write_text(
        "import base_drift\n\nbase_drift.STEPS = 400\nMISSIONS = {'drift': base_drift.Drift()}\n"
    )
    run(folder)
    changed(folder, "STEPS = 400", "STEPS = 300")
    with pytest.raises(BadInputError, match="holds a run made with code"):
        run(folder)


def test_a_changed_plugin_has_no_old_episode_back(folder):
    """Even where no row of the run would tell: here all that times out."""
    path = run(folder).path
    Replay(load_run(path), folder)(0, "field", [0])
    changed(folder, "push = gain *", "push = 1.5 * gain *")
    before = sorted((path).rglob("*"))
    with pytest.raises(BadInputError, match=r"was made with another mydrift\.py"):
        figures_for_run(path, folder=folder)
    assert sorted(path.rglob("*")) == before


def test_a_method_of_ones_own_is_bound_to_no_figure(tmp_path):
    (tmp_path / "detours.py").write_text(
        "from usvjax.missions.route.mission import RouteMission\n\n\n"
        "class Detours(RouteMission):\n    pass\n\n\nMISSIONS = {'detours': Detours()}\n"
    )
    (tmp_path / "d.toml").write_text(
        'name = "d"\nkind = "detours"\nplugin = "detours.py"\nepisodes = 2\n'
    )
    names = sources(load_spec(tmp_path / "d.toml").mission, tmp_path / "detours.py")
    assert {"detours.py", "usvjax/missions/route/mission.py"} <= set(names)
    assert not [n for n in names if "/plots/" in n or n.endswith(("figures.py", "looks.py"))]


def test_a_mission_without_a_file_is_refused():
    namespace = {}
    exec("class Nowhere:\n    pass\n", namespace)
    with pytest.raises(BadInputError, match="'Nowhere' stands in no file"):
        code_digest(namespace["Nowhere"]())


def test_the_facade_is_seen_through(folder):
    changed(folder, "DT, STEPS", "import usvjax as uj\n\nSEARCH = uj.astar\nDT, STEPS")
    load_spec(folder / "mine.toml")
    plugin = folder / "mydrift.py"
    assert "usvjax/search/astar.py" in sources(find_mission("drift"), plugin)


@pytest.mark.parametrize(
    ("kind", "there", "not_there"),
    [
        ("dwa", "usvkernels/dwa/window.py", "usvkernels/search/astar.py"),
        ("route", "usvkernels/search/astar_lanes.py", "usvkernels/dwa/window.py"),
        ("cruise", "usvkernels/planners/aco.py", "usvkernels/dwa/window.py"),
        ("fleet", "usvkernels/fleet/rules.py", "usvkernels/dwa/episodes.py"),
        ("aggregate", "usvjax/missions/fleet/run.py", "usvkernels/dwa/episodes.py"),
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
        ("MISSIONS = {3: 3}", "kind: got 3; wanted a string"),
        (DRIFT.read_text() + "MISSIONS = {'drift': Drift}", r"is a class; wanted .* Drift\(\)"),
        (
            DRIFT.read_text() + "Drift.endings = ()\n",
            "the mission 'drift': 'endings' is empty",
        ),
        (
            DRIFT.read_text() + "Drift.tables = {'drift': Waters}\n",
            "'tables' must be a dictionary of usvjax.sections.Table",
        ),
        (
            DRIFT.read_text().replace('MISSIONS = {"drift"', 'MISSIONS = {"drift\\x1b"'),
            r"kind: got 'drift\\x1b'; wanted text that can be printed",
        ),
        (
            DRIFT.read_text() + "Drift.methods = {'a\\nb': 'words'}\n",
            r"has the name 'a\\nb'; wanted text",
        ),
        ("raise ValueError('no ' * 999)", r"fails: ValueError: (no )+no?$"),
        ("x = " + "(" * 999 + ")" * 999, r"the plugin 'mydrift.py' fails: \w+Error"),
        ("x = 'a\0b'", r"mydrift\.py: holds NUL characters; wanted a text file in UTF-8"),
        ("raise SystemExit(3)", r"the plugin 'mydrift.py' fails: SystemExit: 3"),
    ],
)
def test_a_plugin_that_is_none_is_one_sentence(folder, source, words):
    (folder / "mydrift.py").write_text(source)
    with pytest.raises((BadInputError, BadTypeError), match=words) as caught:
        load_spec(folder / "mine.toml")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 500


def test_a_plugin_with_a_mark_is_read(folder):
    (folder / "mydrift.py").write_bytes(b"\xef\xbb\xbf" + DRIFT.read_bytes())
    assert load_spec(folder / "mine.toml").plugin.source == DRIFT.read_bytes()


def test_a_plugin_may_not_take_the_place_of_a_mission_of_ours(folder):
    changed(folder, 'MISSIONS = {"drift"', 'MISSIONS = {"dwa"')
    with pytest.raises(BadInputError, match="'dwa' is a mission of usvjax's own"):
        load_spec(folder / "mine.toml")


def test_a_missing_plugin_is_said(folder):
    (folder / "mydrift.py").unlink()
    with pytest.raises(BadInputError, match=r"cannot read the plugin 'mydrift.py': .*no such file"):
        load_spec(folder / "mine.toml")


@pytest.mark.parametrize(("key", "value"), [("rocks", -1), ("radius", -5.0), ("speed", 0.2)])
def test_the_example_refuses_what_cannot_be_meant(folder, key, value):
    (folder / "mine.toml").write_text(f"{STUDY}\n[drift]\n{key} = {value}\n")
    with pytest.raises(BadInputError, match=rf"\[drift\]: '{key}' must be at least"):
        load_spec(folder / "mine.toml")
