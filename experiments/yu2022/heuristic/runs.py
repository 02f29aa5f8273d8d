"""Which maps the heuristics are compared on."""

from typing import Any

from experiments.runs import Run, Study
from experiments.yu2022.heuristic.mission import TRADITIONAL, UNIT
from experiments.yu2022.options import SEED, YuOptions
from usvjax.registry import register_mission

KIND = "yu2022_plans"
register_mission(KIND, "experiments.yu2022.heuristic.mission:MISSION")

MAPS, QUICK_MAPS = 1000, 100
COMPLEX = "100 x 100, 12 % (complex)"
PLANS: dict[str, dict[str, Any]] = {
    "50 x 50, 10 % (ordinary)": {"density": 0.10},
    "50 x 50, 20 %": {"density": 0.20},
    "50 x 50, 30 %": {"density": 0.30},
    "20 x 20, 10 %": {"side": 20},
    COMPLEX: {"side": 100, "density": 0.12, "moves": 250},
}
EPISODES: dict[str, dict[str, Any]] = {
    "50 x 50, 10 %, 3 cells a move": {"flips": 3},
    "50 x 50, 10 %, 12 cells a move": {"flips": 12},
}


def runs(options: YuOptions) -> dict[str, Run]:
    """First plans on maps that stay as they are, and episodes on maps that change.

    Args:
        options: of the paper; `maps` of each kind.

    Raises:
        BadInputError: fewer than one map.
    """
    maps = options.size("maps", MAPS, QUICK_MAPS)
    plans = {label: own for label, own in PLANS.items() if label != COMPLEX or not options.quick}
    exact = [TRADITIONAL, "octile", "weighted", "weighted_octile"]
    return {
        "plans": _study("plans", plans, maps, [*exact, UNIT]),
        "episodes": _study("episodes", EPISODES, maps, exact),
    }


def _study(name: str, maps: dict[str, dict[str, Any]], episodes: int, methods: list[str]) -> Study:
    return Study(
        {
            "name": name,
            "kind": KIND,
            "seed": SEED,
            "episodes": episodes,
            "shard": 500,
            "methods": methods,
            "conditions": [{"label": label, "maps": own} for label, own in maps.items()],
        }
    )
