"""Which waters the paths are sought in."""

from typing import Any

from experiments.runs import Run, Study
from experiments.wei2023.mission import MISSION, TEXTBOOK
from usvjax.errors import BadInputError
from usvjax.registry import register_mission

KIND = "wei2023_paths"
register_mission(KIND, "experiments.wei2023.mission:MISSION")

SEED = 2023
SCENES, QUICK_SCENES = 1000, 60
BY_TEXTBOOK, QUICK_BY_TEXTBOOK = 200, 24
"""So many of the scenes the textbook program searches, too, which is slow."""
FITTED = "5 nm, 3 obstacles"
"""The kind whose side was chosen after the fact, so that 41 turning points occur."""
KINDS: dict[str, dict[str, Any]] = {
    FITTED: {},
    "2.5 nm, 3 obstacles": {"side": 2.5, "least": 0.1, "most": 0.35},
    "10 nm, 3 obstacles": {"side": 10.0, "least": 0.5, "most": 1.5},
    "5 nm, 8 obstacles": {"obstacles": 8, "least": 0.1, "most": 0.4},
}
AS_PRINTED = [label for label in KINDS if label.endswith(" 3 obstacles")]
"""Kinds with as many obstacles as the paper's scene."""
SEARCHES = MISSION.methods
BATCHED = [name for name in SEARCHES if name not in TEXTBOOK]


def runs(options: Any) -> dict[str, Run]:
    """All searches on all kinds of scenes.

    Args:
        options: of the paper; `scenes` of each kind.

    Raises:
        BadInputError: fewer than one scene.
    """
    scenes = options.scenes
    if scenes is None:
        scenes = QUICK_SCENES if options.quick else SCENES
    elif scenes < 1:
        raise BadInputError(f"--scenes: got {scenes}; wanted at least 1 scene of each kind")
    few = min(scenes, QUICK_BY_TEXTBOOK if options.quick else BY_TEXTBOOK)
    return {
        "batched": _study("batched", scenes, BATCHED, 250),
        "textbook": _study("textbook", few, list(TEXTBOOK), 50),
    }


def study_of(search: str) -> str:
    """The study that a search is in."""
    return "textbook" if search in TEXTBOOK else "batched"


def _study(name: str, scenes: int, methods: list[str], shard: int) -> Study:
    return Study(
        {
            "name": name,
            "kind": KIND,
            "seed": SEED,
            "episodes": scenes,
            "shard": shard,
            "methods": methods,
            "conditions": [{"label": label, "waters": own} for label, own in KINDS.items()],
        }
    )
