"""Figures of real runs: the very episodes of the table, and the commands that draw them."""

import json
import shutil

import numpy as np
import polars as pl
import pytest
from PIL import Image
from study_fake import rewrite_shards

from usvjax.cli import main
from usvjax.errors import BadInputError
from usvjax.maps import GridMap, save_map
from usvjax.missions.dwa.figures import decide_of, typical_job
from usvjax.study import load_run, load_spec, parse_spec, run_study
from usvjax.study.figures import figures_for_run
from usvjax.study.replay import Replay
from usvkernels.status import Status

# Few obstacles and a short prediction, which is what compiling takes its time over.
PARAMS = {"clearance_cap": 1.0, "clear_distance": 1.0, "stuck_time": 5.0}
STATIC = {"horizon": 8, "max_steps": 300}

POND_STUDY = """
name = "pond"
episodes = 12
shard = 12
methods = ["improved"]

[maps]
source = "grid"
map = "pond.map"
shore_distance = 1.0
distance = [3.0, 9.0]

[params]
clearance_cap = 1.0
clear_distance = 1.0
stuck_time = 5.0
radius = 0.8
v_dec = 1.0
v_acc = 1.0
v_step = 0.05

[static]
horizon = 8
max_steps = 300
"""


@pytest.fixture(scope="module")
def lattice_run(tmp_path_factory):
    spec = parse_spec(
        {
            "name": "small",
            "episodes": 16,
            "shard": 16,
            "seed": 3,
            "maps": {"hi": 4, "goal": [4.0, 4.0], "rate": 0.2, "rate_meaning": "count"},
            "params": PARAMS,
            "static": STATIC,
            "axes": {"params.radius": [0.2, 0.3]},
        }
    )
    return run_study(spec, tmp_path_factory.mktemp("runs"), devices=1).path


@pytest.fixture(scope="module")
def lake_run(tmp_path_factory):
    """A run on a map file beside the study: a lake of 14 x 10 m with an island."""
    folder = tmp_path_factory.mktemp("study")
    blocked = np.ones((14, 18), bool)
    blocked[2:12, 2:16] = False
    blocked[5:8, 8:10] = True
    # At UTM coordinates, where single precision is too coarse for a vessel's steps.
    save_map(GridMap(blocked, origin=(500_000.0, 4_400_000.0)), folder / "pond.map")
    (folder / "pond.toml").write_text(POND_STUDY)
    return run_study(load_spec(folder / "pond.toml"), folder / "runs", devices=1).path


@pytest.fixture(autouse=True)
def no_cache_on_disk(monkeypatch):
    monkeypatch.setattr("usvjax.devices.use_compilation_cache", lambda: None)


def copy_of(run, tmp_path):
    return shutil.copytree(run, tmp_path / run.name, ignore=shutil.ignore_patterns("figures"))


# --- replaying --------------------------------------------------------------------------------


def test_a_replay_is_the_episode_of_the_table(lattice_run):
    run = load_run(lattice_run)
    found = Replay(run)(1, "improved", [9, 2])
    mine = run.table().filter((pl.col("condition") == 1) & (pl.col("method") == "improved"))
    for row, job in enumerate([9, 2]):
        (expected,) = mine.filter(pl.col("job") == job).iter_rows(named=True)
        assert found.columns["status"][row] == expected["status"]
        assert found.columns["time"][row] == expected["time"]
        assert found.columns["path_length"][row] == pytest.approx(expected["path_length"], rel=1e-6)
        track, ground = found.recording.tracks[row], found.recording.grounds[row]
        assert len(track.places) == len(track.along) == expected["steps"] + 1
        assert track.along[-1] == pytest.approx(expected["time"])
        sailed = np.hypot(*np.diff(track.places[:, 0], axis=0).T).sum()
        # Steps of 0.05 m between places of up to 10 m, rounded by 5e-7 m each.
        assert sailed == pytest.approx(expected["path_length"], rel=2e-5)
        gaps = track.places - ground.circles
        clearance = np.hypot(*np.moveaxis(gaps, -1, 0)).min() - ground.radius
        assert clearance == pytest.approx(expected["min_clearance"], abs=2e-6)


def test_the_fan_of_a_replay_chooses_what_was_executed(lattice_run):
    found = Replay(load_run(lattice_run))(0, "improved", [1])
    decide, states = decide_of(found, 0), found.recording.detail.trajectory[0]
    for step in (0, 3, 10):
        state, after = states[step], states[step + 1]
        np.testing.assert_allclose(decide(state).command, after[3:], atol=1e-5)


def test_the_fan_on_a_chart_knows_the_shore_that_the_vessel_sensed(lake_run):
    found = Replay(load_run(lake_run), lake_run.parent.parent)(0, "improved", [4])
    assert found.recording.grounds[0].grid is not None
    decide, states = decide_of(found, 0), found.recording.detail.trajectory[0]
    last = int(found.columns["steps"][0]) - 1
    for step in (0, last // 2, last):
        state, after = states[step], states[step + 1]
        opened = decide(state)
        np.testing.assert_allclose(opened.command, after[3:], atol=1e-5)
        np.testing.assert_allclose(opened.paths[..., 0, :] - state[:2], 0.0, atol=1e-5)
        assert np.abs(opened.end - state[:2]).max() < 2.0


@pytest.mark.parametrize(("column", "change"), [("steps", 1), ("path_length", 0.01)])
def test_a_run_of_other_code_is_not_passed_off_as_the_table(lattice_run, tmp_path, column, change):
    run = copy_of(lattice_run, tmp_path)
    rewrite_shards(run, lambda t: t.with_columns((pl.col(column) + change).cast(t.schema[column])))
    with pytest.raises(BadInputError, match=r"episode 5 goes otherwise here .* made with usvjax"):
        Replay(load_run(run))(0, "improved", [5])


@pytest.mark.parametrize(
    ("condition", "method", "job", "message"),
    [
        (2, "improved", 0, "condition is 2; 0 to 1 was wanted"),
        (-1, "improved", 0, "condition is -1"),
        (0, "best", 0, "method is 'best'; one of traditional, improved was wanted"),
        (0, "improved", 16, "episode 16 is not in .* has 16 of them"),
    ],
)
def test_a_replay_refuses(lattice_run, condition, method, job, message):
    with pytest.raises(BadInputError, match=message):
        Replay(load_run(lattice_run))(condition, method, [job])


def test_a_map_that_has_changed_is_said(lake_run, tmp_path):
    run = load_run(lake_run)
    Replay(run, tmp_path)(0, "improved", [0])  # not there: the run has it
    shutil.copy(lake_run.parent.parent / "pond.json", tmp_path)
    save_map(GridMap(np.zeros((14, 18), bool)), tmp_path / "pond.map")
    with pytest.raises(BadInputError, match=r"pond\.map is not what .* was made with"):
        Replay(run, tmp_path)(0, "improved", [0])


# --- choosing the example ---------------------------------------------------------------------


def rows_of(times, status=None):
    """One condition, methods "a" and "b"; times[job] = (of a, of b)."""
    jobs = list(range(len(times)))
    return pl.DataFrame(
        {
            "condition": 0,
            "job": jobs * 2,
            "method": ["a"] * len(jobs) + ["b"] * len(jobs),
            "status": status or [int(Status.REACHED)] * (2 * len(jobs)),
            "time": [float(a) for a, _ in times] + [float(b) for _, b in times],
        }
    )


def test_the_example_has_the_median_difference():
    table = rows_of([(10, 10), (10, 4), (10, 9), (10, 12), (10, 10)])
    assert typical_job(table, ["a", "b"]) == (2, "median difference in time")


def test_the_example_only_comes_from_episodes_that_all_methods_reached():
    reached, stuck = int(Status.REACHED), int(Status.STUCK)
    table = rows_of([(1, 2), (1, 3), (1, 9)], [stuck, reached, stuck] + [reached] * 3)
    assert typical_job(table, ["a", "b"])[0] == 1


def test_without_a_difference_or_a_success_there_still_is_an_example():
    assert typical_job(rows_of([(3, 3), (5, 5), (4, 4)]), ["a", "b"]) == (2, "median time")
    stuck = rows_of([(3, 3), (5, 5)], [int(Status.STUCK)] * 4)
    assert typical_job(stuck, ["a", "b"]) == (0, "no episode in which all reached")


# --- commands ---------------------------------------------------------------------------------


def test_plot_draws_a_lattice_run(lattice_run, tmp_path, capsys):
    run = copy_of(lattice_run, tmp_path)
    command = ["plot", str(run), "--max-examples", "1", "--format", "png", "pdf", "--dpi", "100"]
    assert main(command) == 0
    names = ["success", "distributions", "paths-c0"]
    expected = {f"{name}.{suffix}" for name in names for suffix in ("png", "pdf")}
    assert {path.name for path in (run / "figures").iterdir()} == expected
    for name in names:
        with Image.open(run / "figures" / f"{name}.png") as image:
            assert image.width in (334, 335, 669)
    out = capsys.readouterr().out
    assert all(name in out for name in expected)


def test_plot_draws_charts_of_a_lake_run_and_lists_them_as_json(lake_run, tmp_path, capsys):
    run = copy_of(lake_run, tmp_path)
    folder = str(lake_run.parent.parent)
    assert main(["plot", str(run), "--folder", folder, "--max-paths", "6", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["run"] == str(run)
    names = [path.rsplit("/", 1)[1] for path in found["figures"]]
    assert names[0] == "success.png"
    assert "chart-c0-improved.png" in names
    assert {path.name for path in (run / "figures").iterdir()} == set(names)


def test_a_study_plots_a_map_beside_it_from_anywhere(lake_run, tmp_path, monkeypatch, capsys):
    """The map file is relative to the study, not to where the command is typed."""
    shutil.copytree(lake_run.parent.parent, tmp_path / "ours")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    command = ["study", "../ours/pond.toml", "--out", "../ours/runs", "--devices", "1"]
    assert main([*command, "--quiet", "--json"]) == 0
    figures = json.loads(capsys.readouterr().out)["figures"]
    assert "../ours/runs/pond/figures/chart-c0-improved.png" in figures
    assert all((tmp_path / "elsewhere" / figure).is_file() for figure in figures)


def test_a_study_that_is_shown_again_draws_nothing(tmp_path, monkeypatch, capsys):
    (tmp_path / "toy.toml").write_text('name = "toy"\nkind = "toy"\nepisodes = 6\n')
    command = ["study", str(tmp_path / "toy.toml"), "--out", str(tmp_path), "--quiet"]
    assert main(command) == 0
    shown = capsys.readouterr().out
    assert str(tmp_path / "toy" / "figures" / "times.csv") in shown
    monkeypatch.setattr("usvjax.study.figures.figures_for_run", None)
    monkeypatch.setattr("usvjax.study.study.summarise", None)
    assert main(command) == 0
    assert capsys.readouterr().out == shown


def test_a_study_draws_in_the_formats_asked_for(tmp_path, monkeypatch, capsys):
    from usvjax import plots

    fig = plots.plot_paths([(9.0, 9.0)], 0.5, {"a": [[0, 0], [1, 1]]}, (0, 0), (1, 1))
    monkeypatch.setattr("study_fake.ToyMission.figures", lambda *_: iter([("way", fig)]))
    (tmp_path / "toy.toml").write_text('name = "toy"\nkind = "toy"\nepisodes = 6\n')
    command = ["study", str(tmp_path / "toy.toml"), "--out", str(tmp_path), "--quiet"]
    figures = tmp_path / "toy" / "figures"
    for more, names in (
        ([], {"way.png"}),
        (["--format", "svg", "pdf"], {"way.png", "way.svg", "way.pdf"}),
    ):
        assert main([*command, *more]) == 0
        assert {path.name for path in figures.iterdir()} == names
    assert main([*command, "--dpi", "50"]) == 0
    with Image.open(figures / "way.png") as image:
        assert image.width == pytest.approx(85 / 25.4 * 50, abs=1)


def test_a_study_that_may_only_be_read_is_shown_without_new_figures(tmp_path, monkeypatch, capsys):
    (tmp_path / "toy.toml").write_text('name = "toy"\nkind = "toy"\nepisodes = 6\n')
    command = ["study", str(tmp_path / "toy.toml"), "--out", str(tmp_path), "--quiet"]
    assert main([*command, "--no-figures"]) == 0
    monkeypatch.setattr("os.access", lambda path, mode: False)
    (tmp_path / "toy" / "finished.json").unlink()
    capsys.readouterr()
    assert main(command) == 0
    out, err = capsys.readouterr()
    assert f"Run      {tmp_path / 'toy'}\n" in out
    assert err.splitlines() == [
        f"usvjax: {tmp_path / 'toy'} may only be read; its figures are not drawn",
        f"usvjax: {tmp_path / 'toy'} may only be read; its summary was computed and not written",
    ]


def test_figures_without_examples_need_no_simulation(lattice_run, tmp_path, monkeypatch):
    run = copy_of(lattice_run, tmp_path)
    monkeypatch.setattr(Replay, "__call__", None)
    told = []
    written = figures_for_run(run, max_examples=0, on_written=told.append)
    assert [path.name for path in written] == ["success.png", "distributions.png"]
    assert told == written


def test_a_run_without_common_successes_has_no_distributions(lattice_run, tmp_path):
    run = copy_of(lattice_run, tmp_path)
    rewrite_shards(run, lambda table: table.with_columns(status=pl.lit(3, pl.Int32)))
    written = figures_for_run(run, max_examples=0)
    assert [path.name for path in written] == ["success.png"]


def test_animate_writes_the_episode_asked_for(lattice_run, tmp_path, capsys):
    run = copy_of(lattice_run, tmp_path)
    arguments = ["animate", str(run), "--job", "1", "--max-frames", "3", "--json"]
    assert main(arguments) == 0
    path = run / "figures" / "episode-c0-improved-j1.gif"
    assert json.loads(capsys.readouterr().out) == {"run": str(run), "animation": str(path)}
    with Image.open(path) as image:
        assert image.n_frames == 3


def test_animate_writes_one_frame_where_one_is_asked_for(lattice_run, tmp_path):
    out = tmp_path / "one.gif"
    assert main(["animate", str(lattice_run), "--max-frames", "1", "--out", str(out)]) == 0
    with Image.open(out) as image:
        assert image.n_frames == 1


def test_animate_takes_the_example_by_default(lattice_run, tmp_path, capsys):
    table = load_run(lattice_run).table().filter(pl.col("condition") == 1)
    job, _ = typical_job(table, ["traditional", "improved"])
    out = tmp_path / "a.gif"
    arguments = ["--condition", "1", "--method", "traditional", "--out", str(out)]
    monkey = ["animate", str(lattice_run), *arguments, "--max-frames", "2"]
    with pytest.MonkeyPatch.context() as patch:
        jobs = []
        real = Replay.__call__

        def spy(self, condition, method, numbers):
            jobs.append((condition, method, numbers))
            return real(self, condition, method, numbers)

        patch.setattr(Replay, "__call__", spy)
        assert main(monkey) == 0
    assert jobs == [(1, "traditional", [job])]
    assert out.exists()
    assert str(out) in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["plot", "{nowhere}"], "is not a run of usvjax"),
        (["animate", "{nowhere}"], "is not a run of usvjax"),
        (["plot", "{empty}"], "holds no episodes yet"),
        (["plot", "{run}", "--max-paths", "0"], "max_paths is 0"),
        (["plot", "{run}", "--dpi", "19"], "dpi is 19; 20 to 1200 was wanted"),
        (["plot", "{run}", "--format", "jpeg"], "invalid choice 'jpeg' for argument '--format'"),
        (["study", "{run}", "--dpi", "2000"], "dpi is 2000; 20 to 1200 was wanted"),
        (["animate", "{run}", "--dpi", "2000"], "dpi is 2000; 20 to 1200 was wanted"),
        (["plot", "{run}", "--max-examples", "-1"], "max_examples is -1"),
        (["animate", "{run}", "--condition", "7"], "condition is 7"),
        (["animate", "{run}", "--method", "imp"], "method is 'imp'"),
        (["animate", "{run}", "--job", "99"], "episode 99 is not in"),
        (["animate", "{run}", "--job", "-1"], "episode -1 is not in"),
        (["animate", "{run}", "--out", "a.txt"], "suffix '.txt' is not one of .gif, .mp4"),
        (["animate", "{run}", "--fps", "0"], "fps is 0"),
        (["animate", "{run}", "--max-frames", "0"], "max_frames is 0"),
        (["animate", "{run}", "--job", "1.5"], "usvjax: --job: got '1.5'; wanted a whole number ("),
        (["animate", "{run}", "--fps", "x"], "usvjax: --fps: got 'x'; wanted a whole number ("),
        (
            ["plot", "{run}", "--max-paths", "it's"],
            '--max-paths: got "it\'s"; wanted a whole number',
        ),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(
    lattice_run, tmp_path, capsys, arguments, message
):
    run = copy_of(lattice_run, tmp_path)
    empty = shutil.copytree(run, tmp_path / "empty", ignore=shutil.ignore_patterns("*.parquet"))
    places = {"run": run, "empty": empty, "nowhere": tmp_path / "nowhere"}
    before = sorted(tmp_path.rglob("*"))
    assert main([argument.format(**places) for argument in arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert message in captured.err
    assert sorted(tmp_path.rglob("*")) == before


def test_a_figures_folder_that_cannot_be_written_is_said(lattice_run, tmp_path, capsys):
    run = copy_of(lattice_run, tmp_path)
    (run / "figures").write_text("in the way")
    assert main(["plot", str(run), "--max-examples", "0"]) == 2
    assert "cannot write" in capsys.readouterr().err
    assert (run / "figures").read_text() == "in the way"
