"""Cost per episode from a thousand to a hundred thousand episodes."""

from functools import partial
from typing import Any

from benchmarks.markdown import table, verdict
from benchmarks.timing import in_turns, spread
from benchmarks.workloads import heavy_tailed

TITLE = "cost per episode as episodes grow"
SIZES = (1_000, 3_000, 10_000, 30_000, 100_000)
BAR = 0.10


def measure(quick: bool) -> dict[str, Any]:
    """Time `navigate_dwa` with a growing number of the same kind of episodes."""
    sizes = tuple(n // 100 for n in SIZES) if quick else SIZES
    work = heavy_tailed(max(sizes))
    steps = {n: work.rows(slice(n)).sail() for n in sizes}
    # A fourth timing of the largest would take longer than everything else together.
    small = in_turns({str(n): partial(work.rows(slice(n)).sail) for n in sizes[:-1]})
    large = in_turns({str(n): partial(work.rows(slice(n)).sail) for n in sizes[-1:]}, 3)
    found = {**small, **large}
    for n in sizes:
        found[str(n)]["occupancy"] = steps[n].occupancy
        found[str(n)]["decisions"] = int(steps[n].steps.sum())
    return found


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    return ""
