"""Which missions there are, and their parameter sets, by the name that studies call their kind."""

import importlib
from typing import TYPE_CHECKING, cast

from usvjax.checks import shown
from usvjax.errors import BadInputError
from usvjax.suggest import did_you_mean

if TYPE_CHECKING:
    from usvjax.mission import Mission

# A mission, or where it is: "package.module:NAME" is imported when a study asks for it.
_MISSIONS: "dict[str, Mission | str]" = {}
_OWN: set[str] = set()
_PRESETS: dict[str, str] = {}


def register_mission(kind: str, mission: "Mission | str") -> None:
    """Make a mission known.

    Args:
        kind: the `kind` of its study files.
        mission: the mission, or "package.module:NAME" of one.

    Raises:
        BadInputError: usvjax has a mission of that kind itself.
    """
    if kind in _OWN:
        raise BadInputError(f"kind: {kind!r} is a mission of usvjax's own; wanted another name")
    _MISSIONS[kind] = mission


def register_own(places: dict[str, str]) -> None:
    """Make the missions of usvjax known, by kind "package.module:NAME" of each."""
    _MISSIONS.update(places)
    _OWN.update(places)


def mission_kinds() -> list[str]:
    """The kinds of mission that are known, our own first."""
    return list(_MISSIONS)


def find_mission(kind: str, where: str = "the study") -> "Mission":
    """The mission of a kind of study.

    Args:
        kind: the `kind` of a study file.
        where: the study file, for the message.

    Raises:
        BadInputError: no such kind; names the nearest.
    """
    if kind not in _MISSIONS:
        raise BadInputError(f"{where}: unknown kind {shown(kind)}; {did_you_mean(kind, _MISSIONS)}")
    found = _MISSIONS[kind]
    if isinstance(found, str):
        module, _, name = found.partition(":")
        found = _MISSIONS[kind] = getattr(importlib.import_module(module), name)
    return cast("Mission", found)


def register_presets(mission: str, place: str) -> None:
    """Make the parameter sets of a mission known to `usvjax.preset`.

    Args:
        mission: its kind.
        place: "package.module:NAME" of a dictionary from names to `usvjax.Preset`.
    """
    _PRESETS[mission] = place


def presets_by_mission() -> dict[str, str]:
    """Where the parameter sets of missions are, by kind."""
    return dict(_PRESETS)
