"""Running studies: results, resuming, refusing, stopping."""

import json
import signal
import threading
import time

import jax
import numpy as np
import polars as pl
import pytest
from study_fake import ToyMission, run_files, toy_study

from usvjax import registry
from usvjax.devices import chosen_devices
from usvjax.errors import BadInputError
from usvjax.mission import Metric, Outcome
from usvjax.report.sheets import text_of
from usvjax.study import load_run, parse_spec, run_study
from usvjax.study.figures import figures_for_run
from usvjax.study.replay import Replay
from usvjax.study.report import terminal
from usvjax.study.runner import StudyStoppedError, pick_devices
from usvjax.study.shards import Unit


class Recorder:
    def __init__(self) -> None:
        self.began: list[tuple[int, int]] = []
        self.advanced: list[int] = []
        self.stops = 0

    def begin(self, done: int, total: int) -> None:
        self.began.append((done, total))

    def advance(self, episodes: int) -> None:
        self.advanced.append(episodes)

    def stopping(self) -> None:
        self.stops += 1


def printed(summary: dict) -> str:
    """The tables of a summary as a terminal shows them."""
    return text_of(terminal(summary), 100)


@pytest.fixture
def finished(tmp_path):
    return run_study(parse_spec(toy_study()), tmp_path / "reference")


def test_table_has_one_row_per_condition_job_and_method(finished):
    table = load_run(finished.path).table()
    assert table.columns[:4] == ["condition", "job", "method", "status"]
    assert table.height == 2 * 250 * 2
    assert table.select("condition", "job", "method").n_unique() == table.height
    assert sorted(table["job"].unique()) == list(range(250))


def test_a_double_metric_keeps_what_lies_below_single_precision(tmp_path, monkeypatch):
    class Tiny(ToyMission):
        metrics = (Metric("time", "s", "Time", double=True), *ToyMission.metrics[1:])

        def run(self, scene, method, record=False):
            found = super().run(scene, method, record)
            return Outcome({**found.columns, "time": 1e-90 * scene.jobs}, found.recording)

    monkeypatch.setitem(registry._MISSIONS, "tiny", Tiny())
    path = run_study(parse_spec({**toy_study(), "kind": "tiny"}), tmp_path / "run").path
    rows = load_run(path).table()
    assert rows["time"].dtype == pl.Float64
    assert rows["clearance"].dtype == pl.Float32
    np.testing.assert_array_equal(rows["time"], 1e-90 * rows["job"].to_numpy())
    assert Replay(load_run(path), examples=1)(0, "plain", [3]).columns["time"][0] == 3 * 1e-90


def test_a_table_among_the_figures_is_written_as_the_mission_gives_it(finished):
    (file,) = figures_for_run(finished.path)
    table = load_run(finished.path).table().select("job", "time")
    assert pl.read_csv(file, schema=table.schema).equals(table)


def test_summary_agrees_with_the_table(finished):
    table = load_run(finished.path).table()
    for condition in finished.summary["conditions"]:
        rows = table.filter(pl.col("condition") == condition["index"])
        for method in condition["methods"]:
            own = rows.filter(pl.col("method") == method["method"])
            won = own.filter(pl.col("status") == 1)
            assert method["episodes"] == own.height == 250
            assert method["successes"] == won.height == method["statuses"]["REACHED"]["count"]
            assert sum(s["count"] for s in method["statuses"].values()) == 250
            mean = method["metrics"]["time"]["mean"]
            assert method["metrics"]["time"]["n"] == won.height
            assert mean["value"] == pytest.approx(won["time"].to_numpy().mean(dtype=float))
            assert mean["low"] < mean["value"] < mean["high"]


def test_pairs_rest_on_the_episodes_where_both_succeed(finished):
    table = load_run(finished.path).table()
    for condition in finished.summary["conditions"]:
        (pair,) = condition["pairs"]
        rows = table.filter(pl.col("condition") == condition["index"])
        wide = rows.pivot("method", index="job", values=["status", "time"])
        both = wide.filter((pl.col("status_plain") == 1) & (pl.col("status_better") == 1))
        found = pair["metrics"]["time"]
        assert pair["success"]["both"] == found["n"] == both.height
        gap = (both["time_better"].cast(float) - both["time_plain"].cast(float)).mean()
        assert found["difference"]["value"] == pytest.approx(gap)


def test_infinite_values_are_left_out_and_counted(tmp_path, finished):
    study = toy_study(params={"unsensed": 0.3})
    result = run_study(parse_spec(study), tmp_path / "unsensed")
    table = load_run(result.path).table()
    for condition, old in zip(
        result.summary["conditions"], finished.summary["conditions"], strict=True
    ):
        rows = table.filter(pl.col("condition") == condition["index"])
        for method, before in zip(condition["methods"], old["methods"], strict=True):
            own = rows.filter((pl.col("method") == method["method"]) & (pl.col("status") == 1))
            sensed = own.filter(pl.col("clearance").is_finite())["clearance"].to_numpy()
            found = method["metrics"]["clearance"]
            assert (found["n"], found["infinite"]) == (len(sensed), own.height - len(sensed))
            assert found["infinite"] > 0
            assert found["mean"]["value"] == pytest.approx(sensed.mean(dtype=float))
            assert found["median"]["value"] == pytest.approx(np.median(sensed))
            assert found["mean"]["low"] < found["iqm"]["value"] < found["mean"]["high"]
            # What the others say has not moved.
            assert method["metrics"]["time"] == before["metrics"]["time"]
            assert "infinite" not in method["metrics"]["time"]
        (pair,) = condition["pairs"]
        wide = rows.pivot("method", index="job", values=["status", "clearance"])
        both = wide.filter((pl.col("status_plain") == 1) & (pl.col("status_better") == 1))
        kept = both.filter(
            pl.col("clearance_plain").is_finite() & pl.col("clearance_better").is_finite()
        )
        found = pair["metrics"]["clearance"]
        assert (found["n"], found["infinite"]) == (kept.height, both.height - kept.height)
        means = [kept[f"clearance_{m}"].to_numpy().mean(dtype=float) for m in ("plain", "better")]
        assert found["baseline"]["mean"]["value"] == pytest.approx(means[0])
        assert found["method"]["mean"]["value"] == pytest.approx(means[1])
        assert found["difference"]["value"] == pytest.approx(means[1] - means[0], rel=1e-5)
        assert pair["metrics"]["time"]["difference"]["value"] is not None


def test_reports_say_how_many_values_are_left_out(tmp_path, finished):
    result = run_study(parse_spec(toy_study(params={"unsensed": 0.3})), tmp_path / "unsensed")
    condition = result.summary["conditions"][0]
    text = (result.path / "summary.md").read_text()
    for found in (condition["methods"][0], condition["pairs"][0]):
        count = found["metrics"]["clearance"]
        of_all = f"{count['n']} of {count['n'] + count['infinite']}"
        assert f"| Clearance (m) | {of_all} |" in text
    shown = printed(result.summary)
    assert f"Clearance (m), n = {of_all}" in shown
    for said in (text, shown):
        assert "Clearance: episodes with an infinite value" in " ".join(said.split())
    without = (finished.path / "summary.md").read_text() + printed(finished.summary)
    assert "infinite" not in without


def test_without_any_finite_value_there_is_no_figure(tmp_path):
    result = run_study(parse_spec(toy_study(params={"unsensed": 1.0})), tmp_path)
    found = result.summary["conditions"][0]["pairs"][0]["metrics"]["clearance"]
    assert (found["n"], found["infinite"]) == (0, found["method"]["infinite"])
    assert found["difference"]["value"] is found["method"]["mean"]["value"] is None
    assert f"| 0 of {found['infinite']} | - |" in (result.path / "summary.md").read_text()


def test_the_terminal_says_what_success_is_a_share_of(finished):
    text = " ".join(printed(finished.summary).split())
    assert "success over all episodes, all else over the n where both succeed" in text
    success = finished.summary["conditions"][0]["pairs"][0]["success"]
    assert f"better, n = {success['both']} of 250 Success (%)" in text


def test_results_do_not_depend_on_shards_order_or_devices(tmp_path, finished):
    whole = parse_spec(toy_study(shard=250))
    other = run_study(whole, tmp_path / "other", devices=1)
    key = ["condition", "job", "method"]
    assert load_run(other.path).table().sort(key).equals(load_run(finished.path).table().sort(key))
    for summary in (other.summary, finished.summary):
        summary["study"].pop("hash")
    assert other.summary == finished.summary


def test_last_shard_is_partial():
    assert len(parse_spec(toy_study()).layout.jobs(Unit(0, 2))) == 50


def test_running_again_computes_nothing_and_changes_nothing(tmp_path, finished, monkeypatch):
    before = run_files(finished.path)
    monkeypatch.setattr(ToyMission, "run", pytest.fail)
    listener = Recorder()
    again = run_study(parse_spec(toy_study()), tmp_path / "reference", listener=listener)
    assert listener.began == [(1000, 1000)]
    assert listener.advanced == []
    assert again.summary == finished.summary
    assert run_files(finished.path) == before


def test_missing_shards_are_computed_again(tmp_path, finished):
    before = run_files(finished.path)
    shards = sorted((finished.path / "shards").iterdir())
    for shard in shards[1::2]:
        shard.unlink()
    listener = Recorder()
    run_study(parse_spec(toy_study()), tmp_path / "reference", listener=listener)
    layout = parse_spec(toy_study()).layout
    assert sum(listener.advanced) == sum(
        layout.rows(Unit(0, int(s.name[8:13]))) for s in shards[1::2]
    )
    assert run_files(finished.path) == before


def test_interrupt_finishes_the_shards_under_way_and_resumes(tmp_path, finished, monkeypatch):
    class Interrupting(Recorder):
        def advance(self, episodes: int) -> None:
            super().advance(episodes)
            if len(self.advanced) == 2:
                raise KeyboardInterrupt

    slow = ToyMission.run

    def run(self, *args):
        time.sleep(0.02)
        return slow(self, *args)

    monkeypatch.setattr(ToyMission, "run", run)
    listener = Interrupting()
    with pytest.raises(StudyStoppedError) as stop:
        run_study(parse_spec(toy_study()), tmp_path / "stopped", listener=listener)
    assert listener.stops == 1
    path = tmp_path / "stopped" / "toy"
    on_disk = load_run(path).table().height
    assert 0 < on_disk == stop.value.done < stop.value.total == 1000
    assert not (path / "summary.json").exists()
    time.sleep(0.1)
    assert load_run(path).table().height == on_disk
    run_study(parse_spec(toy_study()), tmp_path / "stopped")
    assert run_files(path) == run_files(finished.path)


def test_a_second_interrupt_waits_for_no_shard_and_keeps_none(tmp_path):
    class Impatient(Recorder):
        def begin(self, done: int, total: int) -> None:
            super().begin(done, total)
            threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()

        def stopping(self) -> None:
            raise KeyboardInterrupt

    began = time.monotonic()
    with pytest.raises(StudyStoppedError, match="stopped after 0 of 1000"):
        run_study(parse_spec(toy_study(params={"sleep": 1.0})), tmp_path, listener=Impatient())
    assert time.monotonic() - began < 1.5
    time.sleep(3.0)
    assert not list((tmp_path / "toy" / "shards").iterdir())


@pytest.mark.parametrize(
    ("params", "words"),
    [({"nan_job": 137}, "job 137 .*time is NaN"), ({"running_job": 42}, "job 42 .*no ending")],
)
def test_a_broken_mission_is_an_error_that_names_the_job(tmp_path, params, words):
    spec = parse_spec(toy_study(params=params))
    with pytest.raises(RuntimeError, match=words):
        run_study(spec, tmp_path)


def test_a_defect_in_a_worker_reaches_the_caller(tmp_path):
    spec = parse_spec(toy_study(params={"crash_job": 120}))
    with pytest.raises(OSError, match="a defect"):
        run_study(spec, tmp_path)


def test_nan_in_a_failed_episode_is_no_error(tmp_path, monkeypatch):
    original = ToyMission.run

    def run(self, *args):
        columns = original(self, *args).columns
        columns["time"] = np.where(columns["status"] == 1, columns["time"], np.nan)
        return Outcome(columns)

    monkeypatch.setattr(ToyMission, "run", run)
    result = run_study(parse_spec(toy_study()), tmp_path)
    text = (result.path / "summary.json").read_text()
    assert "NaN" not in text
    assert result.summary["conditions"][0]["methods"][0]["metrics"]["time"]["mean"]["value"] > 0


def test_no_success_gives_empty_figures(tmp_path):
    study = toy_study(params={"rate": -1.0}, axes={})
    summary = run_study(parse_spec(study), tmp_path).summary
    (condition,) = summary["conditions"]
    assert condition["methods"][0]["metrics"]["time"]["mean"] == {
        "value": None,
        "low": None,
        "high": None,
    }
    assert condition["methods"][0]["statuses"]["REACHED"]["high"] > 0
    difference = condition["pairs"][0]["metrics"]["time"]["difference"]
    assert difference["value"] is None
    assert difference["p_t_holm"] is None
    assert condition["pairs"][0]["success"]["p_mcnemar_holm"] == 1.0


def test_each_thread_works_on_its_own_device(tmp_path, monkeypatch):
    seen: list[tuple[str, ...]] = []
    original = ToyMission.run

    def run(self, *args):
        seen.append(tuple(map(str, chosen_devices())))
        time.sleep(0.05)
        return original(self, *args)

    monkeypatch.setattr(ToyMission, "run", run)
    run_study(parse_spec(toy_study()), tmp_path)
    assert set(seen) == {(str(device),) for device in jax.local_devices()}


def test_timings_are_kept_apart(finished):
    timings = json.loads((finished.path / "timings.json").read_text())
    assert len(timings["units"]) == 6
    assert timings["device_seconds"] > 0


@pytest.mark.parametrize("count", [0, -1, 10_000])
def test_impossible_device_counts_are_refused(count):
    with pytest.raises(BadInputError, match="--devices"):
        pick_devices(count)


def test_three_methods_are_each_compared_with_the_baseline(tmp_path):
    study = toy_study(methods=["worse", "plain", "better"], baseline="plain", axes={})
    summary = run_study(parse_spec(study), tmp_path).summary
    pairs = summary["conditions"][0]["pairs"]
    assert [p["method"] for p in pairs] == ["worse", "better"]
    assert pairs[0]["success"]["difference"]["high"] < 0
    assert pairs[1]["success"]["difference"]["value"] > 0
    # 2 pairs x 2 metrics, but "worse" and "plain" have the same clearance: nothing to test.
    assert pairs[0]["metrics"]["clearance"]["difference"]["p_t_holm"] is None
    assert summary["study"]["families"] == {"p_mcnemar": 2, "p_t": 3, "p_wilcoxon": 3}


def test_until_stops_each_condition_when_it_is_narrow_enough(tmp_path):
    study = toy_study(episodes=3000, shard=100, until=0.08, axes={"params.rate": [0.5, 0.94]})
    summary = run_study(parse_spec(study), tmp_path).summary
    looks = summary["study"]["looks"]
    assert looks == [100, 200, 400, 800, 1600, 3000]
    wide, narrow = summary["conditions"]
    assert narrow["episodes"] < wide["episodes"] <= 3000
    for condition in (wide, narrow):
        assert condition["episodes"] in looks
        assert condition["narrow_enough"]
        assert condition["widest"] <= 0.08
        assert {m["episodes"] for m in condition["methods"]} == {condition["episodes"]}


def test_until_that_is_never_met_says_so(tmp_path):
    result = run_study(parse_spec(toy_study(until=0.001, axes={})), tmp_path)
    (condition,) = result.summary["conditions"]
    assert condition["episodes"] == 250
    assert condition["narrow_enough"] is False
    assert "except" in (result.path / "summary.md").read_text()


def test_a_resumed_run_with_until_stops_at_the_same_place(tmp_path):
    study = toy_study(episodes=3000, until=0.08)
    reference = run_study(parse_spec(study), tmp_path / "a")
    partial = run_study(parse_spec(study), tmp_path / "b")
    for shard in sorted((partial.path / "shards").iterdir())[::3]:
        shard.unlink()
    run_study(parse_spec(study), tmp_path / "b")
    assert run_files(partial.path) == run_files(reference.path)


TINY = """
name = "tiny"
episodes = 12
shard = 8
[maps]
rate = 0.05
rate_meaning = "count"
[params]
v_step = 0.04
w_step = 0.1
[static]
horizon = 10
max_steps = 300
"""


def test_a_dwa_study_runs_from_file_to_summary(tmp_path):
    (tmp_path / "tiny.toml").write_text(TINY)
    result = run_study(tmp_path / "tiny.toml", tmp_path / "runs", devices=1)
    table = load_run(result.path).table()
    metrics = ["time", "path_length", "mean_speed", "min_clearance", "steps"]
    assert table.columns == ["condition", "job", "method", "status", *metrics]
    assert table.height == 24
    assert set(table["status"]) <= {1, 2, 3, 4}
    assert (table["time"] - 0.1 * table["steps"]).abs().max() < 1e-3
    (tmp_path / "tiny.toml").write_text(TINY.replace("shard = 8", "shard = 5"))
    other = run_study(tmp_path / "tiny.toml", tmp_path / "other", devices=1)
    key = ["job", "method"]
    assert load_run(other.path).table().sort(key).equals(table.sort(key))
