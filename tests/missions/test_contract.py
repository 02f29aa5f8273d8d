"""What every mission must keep: asked of all that are registered, and of a plug-in."""

import math
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from figure_kinds import check_figure
from matplotlib.figure import Figure
from property_draws import FUZZ
from study_fake import KIND as TOY
from study_fake import run_files

from usvjax import registry
from usvjax.errors import BadInputError
from usvjax.mission import Metric
from usvjax.plots.film import Film
from usvjax.registry import find_mission
from usvjax.study import load_run, parse_spec, run_study
from usvjax.study.code import sources
from usvjax.study.export import tracks_table
from usvjax.study.replay import Replay
from usvjax.study.store import Unit
from usvjax.study.units import run_unit

pytestmark = pytest.mark.usefixtures("one_device")

DRIFT = Path(__file__).parents[2] / "docs" / "examples"

STUDIES = {
    "dwa": {
        "kind": "dwa",
        "methods": ["traditional", "improved"],
        "maps": {"rate": 0.2},
        "params": {"radius": 0.3, "clearance_cap": 1.0},
        "static": {"max_steps": 600},
    },
    "route": {
        "kind": "route",
        "methods": ["astar", "turning", "smoothed", "bspline"],
        "maps": {"shape": [14, 14], "density": 0.2, "min_distance": 5.0, "ends": "connected"},
    },
    "cruise": {
        "kind": "cruise",
        "methods": ["recommended", "astar"],
        "maps": {"shape": [14, 14], "density": 0.1, "stations": 3},
    },
    "fleet": {
        "kind": "fleet",
        "methods": ["none"],
        "params": {"sight_time": 180.0},
        "scenes": {"encounter": "crossing", "least_tcpa": 90.0},
        "static": {"max_steps": 900},
    },
    "aggregate": {
        "kind": "aggregate",
        "methods": ["none"],
        "scenes": {"vessels": 2, "size": 3000.0, "least_distance": 900.0, "circles": 0},
        "params": {"hull_radius": 20.0},
        "static": {"max_steps": 600, "guide_length": 400.0, "look_ahead": 200.0},
    },
    TOY: {"kind": TOY},
    "drift": {"kind": "drift", "plugin": "mydrift.py"},
}
"""A small study of each mission."""


def small(kind, **changes):
    study = {"name": "small", "seed": 3, "episodes": 8, "shard": 4, **STUDIES[kind], **changes}
    return parse_spec(study, folder=DRIFT)


@pytest.fixture(params=list(STUDIES))
def kind(request):
    return request.param


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Finished runs by kind, made when first asked for."""
    runs = {}

    def run_of(kind):
        if kind not in runs:
            runs[kind] = run_study(small(kind), tmp_path_factory.mktemp(kind), devices=1).path
        return runs[kind]

    return run_of


def test_every_registered_mission_is_asked():
    assert set(registry._OWN) < set(STUDIES)


def test_a_mission_says_what_the_engines_ask(kind):
    mission = small(kind).mission
    assert mission is find_mission(kind)
    names = [metric.name for metric in mission.metrics]
    assert len(set(names)) == len(names)
    assert all(isinstance(metric, Metric) and metric.label for metric in mission.metrics)
    assert not set(names) & {"condition", "job", "method", "status", "rank"}
    assert all(words for words in mission.methods.values())
    assert len(set(map(int, mission.endings))) == len(mission.endings)
    for name, table in mission.tables.items():
        assert table.about
        assert name not in ("axes", "conditions", "name", "kind", "plugin")


def test_a_job_does_not_depend_on_the_others(kind):
    if not FUZZ and kind in ("route", "cruise", "fleet"):
        pytest.skip("by `make fuzz`: tests of each mission have it as well")
    count = 200 if FUZZ and kind not in ("cruise", "fleet", "aggregate") else 12
    whole = run_unit(small(kind, episodes=count, shard=count), Unit(0, 0))
    for job in (0, 7):
        alone = run_unit(small(kind, shard=1), Unit(0, job))
        assert whole.filter(pl.col("job") == job).equals(alone, null_equal=True)


def test_methods_share_a_scene_in_any_order(kind):
    spec = small(kind)
    first = run_unit(spec, Unit(0, 1), first_method=0)
    assert first.equals(run_unit(spec, Unit(0, 1), first_method=1), null_equal=True)


def test_what_crosses_to_another_process_pickles(kind):
    spec = pickle.loads(pickle.dumps(small(kind)))
    (condition,) = spec.conditions
    scene = pickle.loads(pickle.dumps(spec.mission.pose(condition.case, spec.seed, np.arange(3))))
    method = spec.methods[0]
    here = spec.mission.run(scene, method, record=True)
    there = pickle.loads(pickle.dumps(here))
    for name, values in here.columns.items():
        np.testing.assert_array_equal(there.columns[name], values)
    assert len(there.recording.tracks) == 3
    assert run_unit(spec, Unit(0, 0)).equals(run_unit(small(kind), Unit(0, 0)), null_equal=True)


def test_another_process_runs_a_unit_that_it_was_sent(kind, tmp_path):
    if not FUZZ and kind in ("dwa", "route", "cruise", "aggregate"):
        pytest.skip("by `make fuzz`: a process that compiles; fleets and plug-ins do here")
    task = tmp_path / "task"
    task.write_bytes(pickle.dumps((small(kind), Unit(0, 0))))
    command = (
        "import pickle, sys\n"
        "spec, unit = pickle.load(open(sys.argv[1], 'rb'))\n"
        "from usvjax.study.units import run_unit\n"
        "run_unit(spec, unit).write_parquet(sys.argv[1] + '.parquet')\n"
    )
    path = [*map(str, (Path(__file__).parents[1] / "oracles",)), *filter(None, sys.path)]
    subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path[:0] = {path!r}\n{command}", str(task)],
        check=True,
        cwd=tmp_path,
    )
    found = pl.read_parquet(f"{task}.parquet")
    assert found.equals(run_unit(small(kind), Unit(0, 0)), null_equal=True)


def test_a_stopped_study_resumes_to_the_same_bytes(kind, finished, tmp_path):
    whole = finished(kind)
    part = tmp_path / "part"
    run_study(small(kind), part, devices=1)
    for shard in sorted((part / "small" / "shards").iterdir())[::2]:
        shard.unlink()
    (part / "small" / "summary.json").unlink()
    run_study(small(kind), part)
    assert run_files(part / "small") == {
        name: content for name, content in run_files(whole).items() if "figures" not in name
    }


def test_a_replay_equals_the_table(kind, finished):
    run = load_run(finished(kind))
    replay = Replay(run, DRIFT)
    for method in run.methods:
        found = replay(0, method, [5, 2])
        rows = run.table().filter((pl.col("method") == method) & pl.col("job").is_in([5, 2]))
        by_job = {row["job"]: row for row in rows.iter_rows(named=True)}
        for place, job in enumerate([5, 2]):
            assert found.columns["status"][place] == by_job[job]["status"]
            track, ground = found.recording.tracks[place], found.recording.grounds[place]
            assert track.places.ndim == 3
            assert track.places.shape[2] == 2
            assert len(track.along) == len(track.places) > 0
            assert (np.diff(track.along) >= 0).all()
            assert ground.circles.shape[1:] == (2,)
        table = tracks_table(found)
        assert table["job"].unique().sort().to_list() == [2, 5]


def test_an_example_is_an_episode_of_the_run(kind, finished):
    run = load_run(finished(kind))
    job, why = Replay(run, DRIFT).example(0)
    assert job in run.table()["job"].to_list()
    assert why


def test_every_mission_draws_its_run_and_films_its_episodes(kind, finished):
    run = load_run(finished(kind))
    replay = Replay(run, DRIFT, examples=1, most=3)
    drawn = dict(replay.mission.figures(run, replay))
    assert drawn
    assert all(isinstance(found, Figure | pl.DataFrame) for found in drawn.values())
    for found in drawn.values():
        if isinstance(found, Figure):
            check_figure(found)
    film = replay.mission.film(replay(0, run.methods[-1], [4]), 0)
    assert isinstance(film, Film)
    film.show(film.steps - 1)
    film.show(0)


def test_a_key_that_nobody_reads_is_refused_by_name(kind):
    mission = small(kind).mission
    for name in mission.tables:
        with pytest.raises(BadInputError, match="unknown key 'nonsense'"):
            small(kind, **{name: {**STUDIES[kind].get(name, {}), "nonsense": 1}})


def test_settings_in_force_can_be_given_again(kind):
    spec = small(kind)
    settings = spec.conditions[0].case.settings
    again = {
        name: {k: v for k, v in values.items() if v is not None and v != math.inf}
        for name, values in settings.items()
    }
    lists = {
        name: {k: list(v) if isinstance(v, tuple) else v for k, v in values.items()}
        for name, values in again.items()
    }
    assert small(kind, **lists).conditions[0].case.settings == settings


def test_figures_and_other_missions_decide_no_results(kind):
    spec = small(kind)
    files = sources(spec.mission, spec.plugin and spec.plugin.path)
    assert not [name for name in files if "/plots/" in name or name.endswith("figures.py")]
    # A mission may derive from another.
    own = {
        c.__module__.split(".")[2]
        for c in type(spec.mission).__mro__
        if "missions." in c.__module__
    }
    others = set(registry._OWN) - {kind, *own}
    assert not [name for name in files for other in others if f"missions/{other}/" in name]
