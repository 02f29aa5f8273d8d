"""How long a paper's experiments will take here, by how long they took for the record.

Both machines run one and the same small study of the lane driver, the yardstick; the seconds of
the record are scaled by it, and by the sizes that are asked for.
"""

import json
from collections.abc import Mapping
from functools import cache
from statistics import median
from time import perf_counter
from typing import Any

import usvjax as uj
from experiments.output import RESULTS
from experiments.runs import Run, Study, place_of
from usvjax.report.numbers import duration

MAPS, SIDE, DENSITY = 512, 50, 0.1
REPEATS = 3
LEAST = 2.0  # s, that a run takes at any size: most of it compilation


@cache
def yardstick() -> float:
    """Seconds that a fixed batch of searches takes here, compilation apart."""
    blocked = uj.random_maps(0, MAPS, (SIDE, SIDE), DENSITY)
    blocked[:, 0, 0] = blocked[:, -1, -1] = False
    seconds = []
    for _ in range(1 + REPEATS):
        begun = perf_counter()
        uj.astar(blocked, (0, 0), (SIDE - 1, SIDE - 1))
        seconds.append(perf_counter() - begun)
    return median(seconds[1:])


def record(seconds: Mapping[str, float], sizes: Mapping[str, int]) -> dict[str, Any]:
    """What is kept of a run, for results.json.

    Args:
        seconds: that each took, by name.
        sizes: how much each did.
    """
    return {
        "yardstick": yardstick(),
        "runs": {name: {"seconds": took, "size": sizes[name]} for name, took in seconds.items()},
    }


def forecast(paper: str, runs: Mapping[str, Run]) -> str:
    """Say how long it will take, and how much there is to do.

    Args:
        paper: its name.
        runs: everything to run, by name.
    """
    episodes = sum(run.size for run in runs.values() if isinstance(run, Study))
    what = f"{paper}: {episodes:,} episodes" if episodes else paper
    known = _recorded(paper)
    if known is None:
        return f"{what}; how long it takes was never recorded"
    scale = yardstick() / known["yardstick"]
    total = sum(
        max(scale * each * run.size, LEAST)
        for name, run in runs.items()
        for each in [_seconds_each(known["runs"], name)]
        if not (isinstance(run, Study) and _is_there(paper, run))
    )
    return f"{what}; about {duration(total)} here, and compilation where it is the first time"


def _seconds_each(recorded: Mapping[str, Any], name: str) -> float:
    """Seconds of the record for each thing that a run does; for an unknown run those of all."""
    chosen = [recorded[name]] if name in recorded else recorded.values()
    return sum(one["seconds"] for one in chosen) / max(sum(one["size"] for one in chosen), 1)


def _is_there(paper: str, run: Study) -> bool:
    return (place_of(paper, run.spec) / run.spec.name / "summary.json").is_file()


def _recorded(paper: str) -> dict[str, Any] | None:
    try:
        found = json.loads((RESULTS / paper / "results.json").read_text(encoding="utf-8"))
        return dict(found["pace"])
    except (OSError, ValueError, KeyError, TypeError):
        return None
