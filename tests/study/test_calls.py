"""Units that share a call: whichever do, a study writes the same bytes."""

import json
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from study_fake import ToyMission, run_files
from study_kin import MOST, KinMission, kin_study

from usvjax.mission import joining
from usvjax.missions.dwa.mission import DwaMission
from usvjax.study import calls, load_run, parse_spec, run_study
from usvjax.study.calls import Calls, Kindred
from usvjax.study.forecast import forecast
from usvjax.study.runner import Silent, StudyStoppedError
from usvjax.study.shards import Unit

TESTS = Path(__file__).parents[1] / "oracles"

RUN = """
import sys
sys.path.insert(0, sys.argv[1])
import study_kin
from usvjax.study import run_study
print("ready", flush=True)
run_study(sys.argv[2], sys.argv[3])
"""


@pytest.fixture
def joined():
    """Scenes of each call of `run`, from now on."""
    KinMission.calls.clear()
    return KinMission.calls


def run_alone(study, out):
    """A run of the study in which no unit shares a call."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(calls, "joining", lambda mission: None)
        KinMission.calls.clear()
        path = run_study(parse_spec(study), out).path
        assert set(KinMission.calls) == {1}
    return path


def random_study(rng):
    """Conditions of one kin or of several, one that joins none among them now and then."""
    rates = [round(rng.uniform(0.2, 1.0), 3) for _ in range(rng.randint(1, 12))]
    conditions = [{"label": f"c{i}", "params.rate": rate} for i, rate in enumerate(rates)]
    for condition in conditions:
        condition |= rng.choice([{}, {}, {"params.sleep": 1e-4}, {"params.unsensed": 0.1}])
    changes = {"conditions": conditions, "axes": {}, "seed": rng.randint(0, 99)}
    changes |= {"episodes": rng.randint(1, 300), "shard": rng.choice([7, 30, 100, 1000])}
    return kin_study(**changes, **rng.choice([{}, {"until": 0.2}]))


@pytest.mark.parametrize("seed", range(12))
def test_the_bytes_do_not_depend_on_who_shares_a_call(tmp_path, seed, joined):
    rng = random.Random(seed)
    study = random_study(rng)
    alone = run_files(run_alone(study, tmp_path / "alone"))
    devices = rng.choice([1, None])
    assert run_files(run_study(parse_spec(study), tmp_path, devices=devices).path) == alone


def test_units_of_a_kin_share_calls(tmp_path, joined):
    run_study(parse_spec(kin_study()), tmp_path, devices=1)
    assert sum(joined) == 2 * 9 * 3
    # One unit first, whose time says how long others take; then as many as have room.
    assert joined[:2] == [1, 1]
    assert max(joined) > 5
    assert len(joined) < 2 * 9


def test_a_run_taken_up_anywhere_ends_with_the_same_bytes(tmp_path, joined):
    reference = run_files(run_study(parse_spec(kin_study()), tmp_path / "whole").path)
    part = run_study(parse_spec(kin_study()), tmp_path / "part").path
    for seed in range(3):
        for shard in random.Random(seed).sample(sorted((part / "shards").iterdir()), 11):
            shard.unlink()
        run_study(parse_spec(kin_study()), tmp_path / "part")
        assert run_files(part) == reference


def test_looks_join_what_is_left_to_look_at(tmp_path, joined):
    study = kin_study(episodes=3000, until=0.08)
    alone = run_alone(study, tmp_path / "alone")
    joined.clear()
    result = run_study(parse_spec(study), tmp_path)
    assert max(joined) > 1
    assert run_files(result.path) == run_files(alone)
    assert len({condition["episodes"] for condition in result.summary["conditions"]}) > 1


def test_an_interrupt_in_a_joined_call_keeps_the_whole_call_and_resumes(tmp_path, joined):
    class Interrupting(Silent):
        def advance(self, episodes: int) -> None:
            if len(KinMission.calls) > 2:  # a joined call is under way, or its shards are written
                raise KeyboardInterrupt

    study = kin_study(params={"sleep": 0.02}, episodes=2000)
    reference = run_files(run_alone(study, tmp_path / "whole"))
    joined.clear()
    with pytest.raises(StudyStoppedError) as stop:
        run_study(parse_spec(study), tmp_path, devices=1, listener=Interrupting())
    path = tmp_path / "kin"
    on_disk = load_run(path).table().height
    assert on_disk == stop.value.done == 100 * sum(joined)
    assert 0 < on_disk < stop.value.total
    run_study(parse_spec(study), tmp_path)
    assert run_files(path) == reference


def test_killed_in_joined_calls_and_resumed_equals_uninterrupted(tmp_path):
    text = json.dumps(kin_study(params={"sleep": 0.01}, episodes=1500))
    study = tmp_path / "study.toml"
    lines = [f"{k} = {json.dumps(v)}" for k, v in json.loads(text).items() if k not in TABLES]
    tables = [
        f"[{name}]\n" + "\n".join(f"{k} = {json.dumps(v)}" for k, v in table.items())
        for name, table in json.loads(text).items()
        if name in TABLES
    ]
    study.write_text("\n".join([*lines, *tables]))
    reference = run_study(study, tmp_path / "reference")
    rng = random.Random(5)
    for wanted in (2, 40):
        command = [sys.executable, "-c", RUN, str(TESTS), str(study), str(tmp_path / "killed")]
        process = subprocess.Popen(command, stdout=subprocess.PIPE)
        while len(list((tmp_path / "killed").rglob("c*.parquet"))) < wanted:
            assert process.poll() is None
            time.sleep(0.001)
        time.sleep(rng.uniform(0.0, 0.05))
        process.send_signal(signal.SIGKILL)
        process.communicate()
        assert process.returncode == -signal.SIGKILL
    assert run_files(run_study(study, tmp_path / "killed").path) == run_files(reference.path)


TABLES = ("params", "axes")


def test_a_broken_mission_is_an_error_that_names_condition_and_job(tmp_path):
    conditions = [{"label": "fine"}, {"label": "bad", "params.nan_job": 137}]
    spec = parse_spec(kin_study(axes={}, conditions=conditions))
    with pytest.raises(RuntimeError, match=r"job 137 of condition 1 \(bad\), method .*is NaN"):
        run_study(spec, tmp_path, devices=1)


def test_progress_and_times_are_of_units(tmp_path):
    advanced: list[int] = []

    class Counting(Silent):
        def advance(self, episodes: int) -> None:
            advanced.append(episodes)

    path = run_study(parse_spec(kin_study()), tmp_path, listener=Counting()).path
    assert sorted(advanced) == [100] * 9 + [200] * 18
    timings = json.loads((path / "timings.json").read_text())
    assert len(timings["units"]) == 27
    assert min(timings["units"].values()) > 0


# --- how many ---------------------------------------------------------------------------------


def hand_out(each, devices=2, **changes):
    """Episodes of the calls of a study whose episodes take `each` seconds."""
    spec = parse_spec(kin_study(**changes))
    handed = Calls(spec, Kindred(spec), devices)
    units = [Unit(c, s) for s in range(-(-spec.episodes // spec.shard)) for c in range(9)]
    handed.put(units)
    sizes, seen = [], []
    while taken := handed.take():
        sizes.append(sum(len(spec.layout.jobs(unit)) for unit in taken))
        handed.took(taken, each * sizes[-1])
        seen += taken
    assert seen == units
    return sizes


def test_calls_are_as_large_as_the_mission_takes():
    assert hand_out(1e-6, episodes=1000) == [100, *[MOST] * 14, 500]


def test_a_call_takes_no_longer_than_is_good_for_a_kill():
    sizes = hand_out(calls.SECONDS / 250, episodes=1000)
    assert max(sizes) == 200
    # Units that alone take longer go alone.
    assert set(hand_out(calls.SECONDS, episodes=1000)) == {100}


def test_calls_get_smaller_towards_the_end(monkeypatch):
    monkeypatch.setattr(calls, "LEAST", 200)
    sizes = hand_out(1e-6, episodes=500)
    assert sizes[1] == MOST
    assert sizes[-1] <= 200
    assert sizes[1:] == sorted(sizes[1:], reverse=True)


# --- who --------------------------------------------------------------------------------------


def test_whoever_brings_a_run_or_a_pose_of_their_own_says_anew_whether_it_joins():
    class Renamed(DwaMission):
        def example(self, rows, methods):
            return 0, "first"

    class Run(DwaMission):
        def run(self, scene, method, record=False):
            return super().run(scene, method, record)

    class Posed(DwaMission):
        def pose(self, case, seed, jobs):
            return super().pose(case, seed, jobs)

    assert joining(DwaMission()) is not None
    assert joining(Renamed()) is not None
    assert joining(KinMission()) is not None
    assert [joining(mission) for mission in (Run(), Posed(), ToyMission())] == [None] * 3


def test_conditions_that_cannot_be_joined_go_alone():
    spec = parse_spec(kin_study(params={"unsensed": 0.5}))
    kindred = Kindred(spec)
    assert len(set(kindred.key)) == 9
    assert set(kindred.most.values()) == {0}
    assert np.ndim(kindred.pose([Unit(0, 0)]).parts[0].jobs) == 1


def test_a_forecast_is_of_calls_as_the_study_makes_them(joined):
    found = forecast(parse_spec(kin_study()))
    assert (found.conditions, found.tried) == (4, 100)
    assert joined[:2] == [1, 1]  # one episode, of what it takes to compile
    assert set(joined[2:]) == {4}
    assert found.bytes > 0


def test_a_forecast_joins_no_more_than_a_call_takes(joined):
    forecast(parse_spec(kin_study(episodes=4000, shard=4000)))
    assert set(joined[-8:]) == {1}
