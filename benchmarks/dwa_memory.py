"""Peak memory of a study, and of one call, at ten and at a hundred thousand episodes."""

import tempfile
from dataclasses import replace
from typing import Any

from benchmarks.markdown import table, verdict
from benchmarks.processes import FreshProcess, peak_memory
from benchmarks.workloads import SEED, heavy_tailed
from usvjax.study import parse_spec, run_study

TITLE = "peak memory as episodes grow"
SIZES = (10_000, 100_000)
BAR = 1.2
MIB = 2**20


def measure(quick: bool) -> dict[str, Any]:
    """Run each size in a fresh process and ask it for its peak memory."""
    sizes = tuple(n // 100 for n in SIZES) if quick else SIZES
    found: dict[str, Any] = {"study": {}, "navigate_dwa": {}}
    for n in sizes:
        for name, function in (("study", study), ("navigate_dwa", navigate)):
            with FreshProcess() as process:
                found[name][str(n)] = process.call(function, n)
    return found


def study(episodes: int) -> dict[str, int]:
    """Run a study from start to summary, `episodes` of each method; short ways, few obstacles."""
    settings = {
        "name": "memory",
        "kind": "dwa",
        "seed": SEED,
        "episodes": episodes,
        "methods": ["traditional", "improved"],
        "maps": {"source": "lattice", "rate": 0.1, "hi": 3, "goal": [3.0, 3.0]},
        "params": {"radius": 0.3, "clearance_cap": 2.0},
        "static": {"max_steps": 128},
    }
    spec = parse_spec(settings)
    before = peak_memory()
    with tempfile.TemporaryDirectory() as folder:
        summary = run_study(spec, folder).summary
    if not summary:
        raise RuntimeError("the study has no summary")
    return {"before": before, "peak": peak_memory()}


def navigate(episodes: int) -> dict[str, int]:
    """Run so many episodes in one call, all arguments and results in memory."""
    work = heavy_tailed(episodes)
    # What is held depends on the number of episodes and not on their length.
    work = replace(work, static=replace(work.static, max_steps=64))
    before = peak_memory()
    work.sail()
    return {"before": before, "peak": peak_memory()}


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    rows, verdicts = [], []
    for name, by_size in found.items():
        sizes = list(by_size)
        ratio = by_size[sizes[-1]]["peak"] / by_size[sizes[0]]["peak"]
        cells = [f"{m['peak'] / MIB:,.0f} ({m['before'] / MIB:,.0f})" for m in by_size.values()]
        rows.append((name, *cells, f"{ratio:.2f}"))
        verdicts.append(verdict(f"{name}: {ratio:.2f}x, at most {BAR}x", ratio <= BAR))
    header = ("", *(f"{int(size):,} episodes, MiB" for size in sizes), "ratio")
    return (
        "Peak resident memory of a fresh process; in brackets what it had held before the run "
        "began. The study runs both methods, so twice as many episodes, and includes its "
        "summary with bootstrap intervals.\n\n" + table(header, rows) + "\n\n" + "\n".join(verdicts)
    )
