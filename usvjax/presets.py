"""Parameter sets by name, mission by mission."""

import importlib
from dataclasses import dataclass
from typing import Any

from usvjax.checks import one_of
from usvjax.public import public
from usvjax.registry import presets_by_mission


@dataclass(frozen=True)
class Preset:
    """Parameters and static configuration that belong together.

    Attributes:
        params: numbers of the mission's method, such as `DwaParams`.
        static: sizes and choices that fit them, such as `DwaStatic`.
        source: where the values come from.
    """

    params: Any
    static: Any
    source: str


@public()
def preset(name: str, mission: str = "dwa") -> Preset:
    """A parameter set by name.

    Args:
        name: one of `preset_names(mission)`; of "dwa": "tan2022", "wei2023", "lake",
            "pythonrobotics".
        mission: whose set.

    Raises:
        BadInputError: no such preset or mission; names the nearest.
    """
    sets = _sets_of(mission)
    one_of("preset", name, sets)
    return sets[name]


@public()
def preset_names(mission: str = "dwa") -> tuple[str, ...]:
    """Names of a mission's parameter sets.

    Raises:
        BadInputError: no such mission; names the nearest.
    """
    return tuple(_sets_of(mission))


def _sets_of(mission: str) -> dict[str, Preset]:
    places = presets_by_mission()
    one_of("mission", mission, places)
    module, _, name = places[mission].partition(":")
    sets: dict[str, Preset] = getattr(importlib.import_module(module), name)
    return sets
