"""Runs of every swarm on every function: the printed budget, other settings, longer budgets."""

from typing import Any

from experiments.runs import Run, Study
from experiments.yu2022.functions.mission import MISSION
from experiments.yu2022.functions.published import ITERATIONS, RUNS, WOLVES
from experiments.yu2022.options import SEED, YuOptions
from usvjax.registry import register_mission
from usvkernels.swarms.functions import TABLE_8

KIND = "yu2022_swarms"
register_mission(KIND, "experiments.yu2022.functions.mission:MISSION")

MANY, QUICK_RUNS = 1000, 24
ALGORITHMS = list(MISSION.methods)
WOLVES_ONLY = ["gwo", "igwo"]
OTHERS = ["aco", "ga", "cmpso"]
WITH_OWN = ["aco", "ga"]
"""Whose settings in the paper are not 20 members and 200 iterations."""
BUDGETS, QUICK_BUDGETS = (500, 1000, 1250, 2500, 5000), (500, 1000)
"""Iterations of longer runs: of the wolves a run each, since a(t) depends on their number; of the
others shares of the longest."""
READINGS: dict[str, dict[str, Any]] = {
    "budget": {},
    "moved": {"moved": True},
    "other": {"settings": "other"},
}
"""What is run on the budget of Table 2."""


def runs(options: YuOptions) -> dict[str, Run]:
    """All runs.

    Args:
        options: of the paper; `runs` of each swarm on each function.

    Raises:
        BadInputError: fewer than one run.
    """
    many = options.size("runs", MANY, QUICK_RUNS)
    functions = list(TABLE_8)[: 1 if options.quick else None]
    budgets = QUICK_BUDGETS if options.quick else BUDGETS
    few = min(many, RUNS)
    size = {"population": WOLVES, "iterations": ITERATIONS}
    budget = {
        label(f, kind): {"function": f, **size, **own}
        for f in functions
        for kind, own in READINGS.items()
    }
    own = {label(f, "own"): {"function": f} for f in functions}
    wolves = {
        label(f, str(t)): {"function": f, "population": WOLVES, "iterations": t}
        for f in functions
        for t in budgets
    }
    longest = {
        label(f, "longest"): {"function": f, "population": WOLVES, "iterations": budgets[-1]}
        for f in functions
    }
    return {
        "budget": _study("budget", budget, many, ALGORITHMS),
        "own": _study("own", own, many, WITH_OWN),
        "wolves": _study("wolves", wolves, few, WOLVES_ONLY),
        "longest": _study("longest", longest, few, OTHERS),
    }


def label(function: str, kind: str) -> str:
    """Of a condition."""
    return f"{function}, {kind}"


def _study(
    name: str, swarms: dict[str, dict[str, Any]], episodes: int, methods: list[str]
) -> Study:
    # A condition is one shard: it runs on one processor, and only there its swarms are compiled.
    return Study(
        {
            "name": name,
            "kind": KIND,
            "seed": SEED,
            "episodes": episodes,
            "shard": episodes,
            "methods": methods,
            "conditions": [{"label": label, "swarm": own} for label, own in swarms.items()],
        }
    )
