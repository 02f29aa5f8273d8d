"""A study killed with SIGKILL at random moments and resumed, against an uninterrupted one."""

import random
import signal
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Any

from benchmarks.markdown import verdict
from benchmarks.processes import environment
from benchmarks.timing import seconds_of

TITLE = "a study killed ten times against an uninterrupted one"
KILLS = 10
SHARD = 100
# No file but this one may differ: it holds wall-clock times.
TIMINGS = "timings.json"

STUDY = """
name = "resume"
kind = "dwa"
seed = 2022
episodes = {episodes}
shard = {shard}
methods = ["traditional", "improved"]
[maps]
source = "lattice"
rate = 0.1
hi = 5
goal = [5.0, 5.0]
[params]
radius = 0.3
clearance_cap = 2.0
[static]
max_steps = 300
"""


def measure(quick: bool) -> dict[str, Any]:
    """Run one study twice, once with kills, and compare the files."""
    shards, kills = (16, 2) if quick else (100, KILLS)
    rng = random.Random(2022)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        study = folder / "study.toml"
        study.write_text(STUDY.format(episodes=SHARD * shards, shard=SHARD), encoding="utf-8")
        uninterrupted = seconds_of(partial(_finish, study, folder / "whole"))
        kept = [_kill(study, folder / "killed", rng, shards // kills) for _ in range(kills)]
        resumed = seconds_of(partial(_finish, study, folder / "killed"))
        whole, killed = _files(folder / "whole"), _files(folder / "killed")
    return {
        "episodes": 2 * SHARD * shards,
        "shards": shards,
        "shards_kept": kept,
        "files": len(whole),
        "bytes": sum(map(len, whole.values())),
        "differ": sorted(k for k in whole.keys() | killed if whole.get(k) != killed.get(k)),
        "uninterrupted_seconds": uninterrupted,
        "last_resumption_seconds": resumed,
    }


def _start(study: Path, out: Path) -> "subprocess.Popen[bytes]":
    command = [sys.executable, "-c", "import sys; from usvjax.cli import main; sys.exit(main())"]
    command += ["study", str(study), "--out", str(out), "--quiet", "--no-figures"]
    cache = environment({"XDG_CACHE_HOME": str(study.parent / "cache")})
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, env=cache)


def _finish(study: Path, out: Path) -> None:
    code = _start(study, out).wait()
    if code != 0:
        raise RuntimeError(f"the study ended with exit code {code}")


def _kill(study: Path, out: Path, rng: random.Random, most: int) -> int:
    """Kill a run at a random moment; return how many shards are on disk.

    That is up to `most` - 2 shards after the start and a little later, so in the midst of
    computing or writing, or within the first three seconds: importing, or taking up the run.
    """
    new = rng.randrange(most - 1)
    process = _start(study, out)
    wanted = _shards(out) + new
    while _shards(out) < wanted and process.poll() is None:
        time.sleep(0.001)
    time.sleep(rng.uniform(0.0, 0.1 if new else 3.0))
    process.send_signal(signal.SIGKILL)
    if process.wait() != -signal.SIGKILL:
        raise RuntimeError(f"the study ended with exit code {process.returncode}, not killed")
    return _shards(out)


def _shards(out: Path) -> int:
    return len(list(out.rglob("c*.parquet")))


def _files(out: Path) -> dict[str, bytes]:
    """Every file of a run but the timings, by its name in the run."""
    files = (file for file in out.rglob("*") if file.is_file() and file.name != TIMINGS)
    return {str(file.relative_to(out)): file.read_bytes() for file in files}


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    kept = found["shards_kept"]
    killed = (
        f"{found['episodes']:,} episodes in {found['shards']} shards; killed {len(kept)} times, "
        f"with {', '.join(map(str, kept))} shards on disk, then finished."
    )
    took = (
        f"Uninterrupted: {found['uninterrupted_seconds']:.1f} s, compiling included; last "
        f"resumption: {found['last_resumption_seconds']:.1f} s."
    )
    compared = (
        f"{found['files']} files ({found['bytes'] / 1e6:.1f} MB: shards, manifest, summary as "
        f"JSON and Markdown, all but {TIMINGS}), {len(found['differ'])} differ"
    )
    if found["differ"]:
        compared += f": {', '.join(found['differ'][:5])}"
    return f"{killed} {took}\n\n{verdict(compared, not found['differ'])}"
