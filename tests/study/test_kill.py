"""A study killed with SIGKILL at random moments and resumed ends with the same bytes."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

from study_fake import run_files

from usvjax.study import load_run, run_study

TESTS = Path(__file__).parents[1] / "oracles"

KILLS = int(os.environ.get("USVJAX_TEST_KILLS", "4"))

STUDY = """
name = "toy"
kind = "toy"
seed = 3
episodes = 6000
shard = 100
methods = ["plain", "better"]
[params]
sleep = 0.01
[axes]
params.rate = [0.5, 0.9]
"""

RUN = """
import sys
sys.path.insert(0, sys.argv[1])
import study_fake
from usvjax.study import run_study
print("ready", flush=True)
run_study(sys.argv[2], sys.argv[3])
"""


def start(study: Path, out: Path) -> "subprocess.Popen[bytes]":
    """Start a run and wait until it has imported everything."""
    command = [sys.executable, "-c", RUN, str(TESTS), str(study), str(out)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE)
    assert process.stdout is not None
    assert process.stdout.readline() == b"ready\n"
    return process


def shards_of(out: Path) -> int:
    return len(list(out.rglob("c*.parquet")))


def kill_after(study: Path, out: Path, shards: int, delay: float) -> None:
    """Run until so many shards are on disk and `delay` seconds have passed, then SIGKILL."""
    process = start(study, out)
    while shards_of(out) < shards:
        assert process.poll() is None
        time.sleep(0.001)
    time.sleep(delay)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert process.returncode == -signal.SIGKILL


def test_killed_and_resumed_equals_uninterrupted(tmp_path):
    study = tmp_path / "toy.toml"
    study.write_text(STUDY)
    reference = run_study(study, tmp_path / "reference")
    rng = random.Random(11)
    killed = tmp_path / "killed"
    for shards in sorted(rng.sample(range(100), KILLS)):
        kill_after(study, killed, shards, rng.uniform(0.0, 0.03))
        assert shards <= shards_of(killed) < 120
        assert not (killed / "toy" / "summary.json").exists()
    resumed = run_study(study, killed)
    assert run_files(resumed.path) == run_files(reference.path)
    assert load_run(resumed.path).table().height == 6000 * 2 * 2
