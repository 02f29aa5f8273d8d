"""Compile time of each public entry, on a first start and on the next one from the cache."""

import json
import re
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.compile_log import CompileLog
from benchmarks.markdown import table, verdict
from benchmarks.processes import FreshProcess, environment
from benchmarks.timing import seconds_of
from benchmarks.workloads import heavy_tailed, of_method
from usvjax.devices import use_compilation_cache
from usvjax.maps import obstacle_table, random_maps
from usvjax.missions.dwa.candidates import dwa_candidates
from usvjax.missions.dwa.run import navigate_dwa
from usvjax.study import load_spec

TITLE = "compile time, first start and second"
STUDIES = Path(__file__).parent.parent / "studies"
FIRST, SECOND = STARTS = ("first start", "second start")
SECOND_STARTS = 3
BAR = 3.0
STUDY = "usvjax study"


def measure(quick: bool) -> dict[str, Any]:
    """Start processes with an empty cache and then with what the first one left in it."""
    starts = [FIRST] + [SECOND] * (1 if quick else SECOND_STARTS)
    found: dict[str, Any] = {name: {start: [] for start in STARTS} for name in [*_entries(), STUDY]}
    with tempfile.TemporaryDirectory() as cache:
        for start in starts:
            with FreshProcess(variables={"XDG_CACHE_HOME": cache}) as process:
                for name, spent in process.call(entries).items():
                    found[name][start].append(spent)
    with tempfile.TemporaryDirectory() as cache:
        for start in starts:
            found[STUDY][start].append(_study(Path(cache)))
    return found


def entries() -> dict[str, dict[str, float]]:
    """Call every entry twice in this process and note what the first call spent."""
    use_compilation_cache()
    found = {}
    for name, call in _entries().items():
        log = CompileLog()
        first = seconds_of(call)
        found[name] = {**log.spent(), "first_call": first, "second_call": seconds_of(call)}
    return found


def _entries() -> dict[str, Callable[[], Any]]:
    work = replace(heavy_tailed(32), static=replace(heavy_tailed(1).static, max_steps=200))
    sail = partial(navigate_dwa, work.obstacles, work.starts, work.goals, valid=work.valid)
    methods = {m: of_method(work, m).static for m in ("traditional", "improved")}
    state = np.append(work.starts[0], [0.0, 0.0])
    shore = np.zeros((100, 100), bool)
    shore[40:60, 40:60] = True
    return {
        **{f"navigate_dwa, {m}": partial(sail, static=static) for m, static in methods.items()},
        "navigate_dwa, record=True": partial(sail, static=methods["improved"], record=True),
        "navigate_dwa on a GridMap": _on_lake,
        "dwa_candidates": partial(dwa_candidates, work.obstacles[0], state, work.goals[0]),
        "random_maps": partial(random_maps, 0, 100),
        "obstacle_table": partial(obstacle_table, shore, None, 8.0),
    }


def _on_lake() -> None:
    lake = load_spec(STUDIES / "hongze.toml").conditions[0].case.given
    drawn = lake.source.draw(0, np.arange(32), lake.params.radius)
    static = replace(lake.static, max_steps=64)
    navigate_dwa(drawn.obstacles, drawn.starts, drawn.goals, params=lake.params, static=static)


def _study(cache: Path) -> dict[str, float]:
    """Run the shipped study with few episodes as a command; seconds are of the whole process."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = (STUDIES / "tan2022.toml").read_text(encoding="utf-8")
        for key, value in (("episodes", 64), ("shard", 32)):
            text, found = re.subn(rf"^{key} = .*$", f"{key} = {value}", text, flags=re.M)
            assert found == 1
        (folder / "tiny.toml").write_text(text, encoding="utf-8")
        log = folder / "log.json"
        command = [sys.executable, "-m", "benchmarks.compile_log", str(log)]
        command += ["study", str(folder / "tiny.toml"), "--out", name, "--quiet"]
        variables = environment({"XDG_CACHE_HOME": str(cache)})
        run = partial(subprocess.run, command, stdout=subprocess.DEVNULL, env=variables, check=True)
        seconds = seconds_of(run)
        return {**json.loads(log.read_text(encoding="utf-8")), "first_call": seconds}


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""

    def median(name: str, start: str, what: str) -> float:
        return statistics.median(one[what] for one in found[name][start])

    rows = []
    for name in found:
        cells = [f"{median(name, start, 'preparing_seconds'):.2f}" for start in STARTS]
        cells += [f"{median(name, start, 'first_call'):.2f}" for start in STARTS]
        programs = f"{median(name, FIRST, 'programs'):.0f}"
        rows.append((name, *cells, programs))
    second = median(STUDY, SECOND, "preparing_seconds")
    header = ("entry", "compile s, first", "second", "first call s, first", "second", "programs")
    return (
        f"One first start and the median of {len(found[STUDY][SECOND])} second ones. "
        "Seconds in which the process traces, compiles or loads programs (stretches in several "
        "threads counted once), on a start with an empty cache and on the next, and seconds of "
        "the first call as a whole; for the study (`studies/tan2022.toml` with 64 episodes "
        "per condition and method, figures included) those of the whole process. Programs: how "
        "many were compiled or loaded, small ones and one per device included.\n\n"
        + table(header, rows)
        + "\n\n"
        + verdict(f"{STUDY}, second start: {second:.1f} s, under {BAR:.0f} s", second < BAR)
    )
