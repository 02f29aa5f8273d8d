"""What a run holds: the files that its study names, to be drawn and replayed anywhere."""

import json
import pickle
import shutil
from pathlib import Path

import numpy as np
import pytest

from usvjax.errors import BadInputError
from usvjax.maps import GridMap, save_map
from usvjax.study import load_run, load_spec, run_study
from usvjax.study.figures import figures_as_drawn, figures_for_run
from usvjax.study.replay import Replay

PLUGIN = """
from dataclasses import asdict, dataclass, replace
from study_fake import ToyMission, ToyParams
from helpers.shared import RADIUS
from usvjax.mission import Case
from usvjax.maps.chart import read_chart
from usvjax.maps.scen import read_scen
from usvjax.sections import Table
from usvjax.tables import read_table

@dataclass(frozen=True)
class Places:
    map: str
    scen: str | None = None

class Charted(ToyMission):
    tables = {"places": Table("files", {"": Places})}

    def case(self, tables, files):
        places = read_table(Places, tables["places"], files.table("places"))
        grid, mark = read_chart(places.map, None, 1, files.folder, "it")
        params = ToyParams(radius=RADIUS + grid.free_share)
        inputs = {places.map: mark}
        if (files.folder / "rates.txt").is_file():
            inputs["rates.txt"] = files.read("rates.txt").decode()
        if places.scen is not None:
            scen = read_scen(places.scen, None, 1.0, files.folder, "it")
            inputs[places.scen] = str(scen.lengths.sum())
        return Case({"places": asdict(places)}, inputs, params)

MISSIONS = {"charted": Charted()}
"""

STUDY = """
name = "mine"
kind = "charted"
plugin = "{plugin}"
episodes = 6
shard = 3
methods = ["plain", "better"]
[places]
map = "{map}"
{scen}
"""

SCEN = "version 1\n0 pond.map 6 4 0 0 2 0 2.0\n"


def blocked():
    found = np.zeros((4, 6), bool)
    found[2, 3] = True
    return found


def study(root, plugin="mine.py", map="pond.map", scen=""):
    """A folder with a study, and beside it one with maps; the study's file."""
    here, maps = root / "studies", root / "maps"
    here.mkdir(parents=True)
    maps.mkdir()
    home = maps if plugin.startswith("..") else here
    (home / "mine.py").write_text(PLUGIN)
    (home / "rates.txt").write_text("0.5")
    (home / "helpers").mkdir()
    (home / "helpers" / "__init__.py").write_text("SCALE = 1.0\n")
    (home / "helpers" / "shared.py").write_text("from . import SCALE\nRADIUS = 0.5 * SCALE\n")
    for folder in (here, maps):
        for name in ("pond.map", "ros.yaml"):
            save_map(GridMap(blocked(), cell_size=2.0, origin=(3.0, 4.0)), folder / name)
        (folder / "pond.scen").write_text(SCEN)
    line = f'scen = "{scen.format(root=root)}"' if scen else ""
    text = STUDY.format(plugin=plugin.format(root=root), map=map.format(root=root), scen=line)
    (here / "mine.toml").write_text(text)
    return here / "mine.toml"


def held(run):
    return {p.relative_to(run / "files").as_posix() for p in run.rglob("files/**/*") if p.is_file()}


PLUGIN_FILES = {"mine.py", "rates.txt", "helpers/__init__.py", "helpers/shared.py"}


@pytest.mark.parametrize(
    ("names", "files"),
    [
        ({}, {*PLUGIN_FILES, "pond.map", "pond.json"}),
        ({"map": "ros.yaml"}, {*PLUGIN_FILES, "ros.yaml", "ros.pgm"}),
        ({"map": "hongze-1000"}, PLUGIN_FILES),
        ({"scen": "pond.scen"}, {*PLUGIN_FILES, "pond.map", "pond.json", "pond.scen"}),
        (
            {"map": "../maps/ros.yaml", "plugin": "../maps/mine.py"},
            {f"maps/{name}" for name in (*PLUGIN_FILES - {"rates.txt"}, "ros.yaml", "ros.pgm")},
        ),
        (
            {"map": "../maps/ros.yaml"},
            {*(f"_/{name}" for name in PLUGIN_FILES), "maps/ros.yaml", "maps/ros.pgm"},
        ),
        (
            {"map": "{root}/maps/pond.map", "plugin": "{root}/studies/mine.py"},
            {*(f"_/{name}" for name in PLUGIN_FILES), "maps/pond.map", "maps/pond.json"},
        ),
    ],
    ids=["beside", "ros", "packaged", "scen", "all above", "above", "absolute"],
)
def test_a_run_that_was_moved_needs_nothing_else(tmp_path, monkeypatch, names, files):
    file = study(tmp_path / "first", **names)
    run = run_study(file, tmp_path / "first" / "runs").path
    assert held(run) == files
    before = Replay(load_run(run), file.parent)(0, "better", [4])
    moved = shutil.copytree(run, tmp_path / "second" / "moved")
    shutil.rmtree(tmp_path / "first")
    for folder in filter(Path.is_dir, sorted(moved.rglob("*"), reverse=True)):
        if not list(folder.iterdir()):
            folder.rmdir()  # as some ways of copying leave them out
    monkeypatch.chdir(tmp_path)
    after = Replay(load_run(moved))(0, "better", [4])
    assert after.case.given == before.case.given
    assert figures_for_run(moved)


def test_a_name_relative_to_where_one_works_is_held_as_well(tmp_path, monkeypatch):
    file = study(tmp_path / "first", map="pond.map")
    shutil.copytree(file.parent, tmp_path / "work")
    for left in file.parent.glob("pond.*"):
        left.unlink()
    monkeypatch.chdir(tmp_path / "work")
    run = run_study(file, tmp_path / "runs").path
    shutil.rmtree(tmp_path / "work")
    shutil.rmtree(tmp_path / "first")
    monkeypatch.chdir(tmp_path)
    assert figures_for_run(run)


def test_a_changed_file_of_a_plugin_is_refused(tmp_path):
    file = study(tmp_path)
    run = run_study(file, tmp_path / "runs").path
    (file.parent / "rates.txt").write_text("0.6")
    with pytest.raises(BadInputError, match=r"inputs.rates.txt is .0\.5. there and .0\.6. here"):
        run_study(file, tmp_path / "runs")
    with pytest.raises(BadInputError, match=r"rates\.txt is not what .* was made with"):
        Replay(load_run(run), file.parent)(0, "plain", [0])


def test_a_changed_map_is_refused_by_the_study_and_where_it_is_seen(tmp_path):
    file = study(tmp_path)
    run = run_study(file, tmp_path / "runs").path
    save_map(GridMap(~blocked(), cell_size=2.0, origin=(3.0, 4.0)), file.parent / "pond.map")
    with pytest.raises(BadInputError, match=r"another study: .*inputs.pond.map is"):
        run_study(file, tmp_path / "runs")
    with pytest.raises(BadInputError, match=r"pond\.map.* is not what .* was made with"):
        Replay(load_run(run), file.parent)(0, "plain", [0])
    assert Replay(load_run(run), tmp_path)(0, "plain", [0])


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("mine.py", "radius=RADIUS +", "radius=1.01 * RADIUS +"),
        ("helpers/shared.py", "0.5", "0.505"),
        ("helpers/__init__.py", "1.0", "1.01"),
    ],
)
def test_a_changed_plugin_or_what_it_imports_is_refused(tmp_path, name, old, new):
    file = study(tmp_path)
    run = run_study(file, tmp_path / "runs").path
    path = file.parent / name
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(BadInputError, match="holds a run made with code"):
        run_study(file, tmp_path / "runs")
    assert figures_as_drawn(run, file.parent) is None
    with pytest.raises(BadInputError, match=r"was made with another mine\.py"):
        figures_for_run(run, folder=file.parent)
    other = run_study(file, tmp_path / "other")  # what changed is imported anew
    table, changed = (load_run(path).table()["clearance"] for path in (run, other.path))
    assert np.allclose(changed - table, 0.005, atol=1e-5)


@pytest.mark.parametrize("name", ["pond.map", "pond.json", "mine.py", "helpers/shared.py"])
def test_a_damaged_copy_is_refused_and_copied_again(tmp_path, name):
    file = study(tmp_path)
    run = run_study(file, tmp_path / "runs").path
    copy, whole = run / "files" / name, (run / "files" / name).read_bytes()
    for damage in (lambda: copy.write_bytes(whole + b" "), copy.unlink):
        damage()
        with pytest.raises(BadInputError, match=f"{name} is missing or damaged"):
            figures_for_run(run, folder=tmp_path)
        run_study(file, tmp_path / "runs")
        assert copy.read_bytes() == whole


def test_copies_are_not_written_through_a_link(tmp_path):
    file = study(tmp_path, map="../maps/pond.map")
    run = run_study(file, tmp_path / "runs").path
    shutil.rmtree(run / "files" / "maps")
    (tmp_path / "elsewhere").mkdir()
    (run / "files" / "maps").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(BadInputError, match=r"files/maps is a link; nothing is written"):
        run_study(file, tmp_path / "runs")
    assert not list((tmp_path / "elsewhere").iterdir())


def test_a_manifest_cannot_name_files_outside_the_run(tmp_path):
    run = run_study(study(tmp_path), tmp_path / "runs").path
    manifest = json.loads((run / "manifest.json").read_text())
    manifest["files"]["digests"]["../secret"] = "0" * 64
    (run / "manifest.json").write_text(json.dumps(manifest))
    with pytest.raises(BadInputError, match=r"names a file outside the run: '\.\./secret'"):
        figures_for_run(run, folder=tmp_path)


def test_a_study_crosses_to_another_process_with_what_it_holds(tmp_path):
    spec = load_spec(study(tmp_path))
    assert pickle.loads(pickle.dumps(spec)).held.entry() == spec.held.entry()


# --- showing a finished run -------------------------------------------------------------------


@pytest.fixture
def finished(tmp_path):
    file = study(tmp_path)
    run = run_study(file, tmp_path / "runs").path
    figures_for_run(run, folder=file.parent)
    return file, run


def test_figures_that_are_there_are_not_drawn_again(finished):
    file, run = finished
    assert figures_as_drawn(run, file.parent) == [run / "figures" / "times.csv"]


@pytest.mark.parametrize("what", ["figure", "record", "options", "code", "shards", "gone"])
def test_figures_that_would_be_others_are_drawn_again(finished, monkeypatch, what):
    file, run = finished
    if what == "figure":
        (run / "figures" / "times.csv").write_text("job\n")
    elif what == "record":
        (run / "figures.json").write_text('{"made": [["figures/times.csv", 3]]}')
    elif what == "options":
        figures_for_run(run, folder=file.parent, max_examples=1)
    elif what == "code":
        monkeypatch.setattr("usvjax.study.finished._ours", lambda: "other")
    elif what == "shards":
        min((run / "shards").iterdir()).unlink()
    else:
        (run / "figures" / "times.csv").unlink()
    assert figures_as_drawn(run, file.parent) is None


@pytest.mark.parametrize("what", ["code", "shard", "record"])
def test_a_summary_that_would_be_another_is_made_again(finished, monkeypatch, what):
    file, run = finished
    made = []
    real = run_study.__wrapped__.__globals__["summarise"]
    monkeypatch.setitem(
        run_study.__wrapped__.__globals__, "summarise", lambda *args: made.append(1) or real(*args)
    )
    run_study(file, run.parent)
    assert made == []
    if what == "code":
        monkeypatch.setattr("usvjax.study.finished._ours", lambda: "other")
    elif what == "shard":
        shard = min((run / "shards").iterdir())
        shard.write_bytes(shard.read_bytes()[:-1])
    else:
        (run / "finished.json").unlink()
    run_study(file, run.parent)
    assert made == [1]
