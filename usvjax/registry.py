"""Which missions there are, and their parameter sets, by the name that studies call their kind."""

import importlib
import re
from typing import TYPE_CHECKING, Any, cast

from usvjax.checks import MOST_SHOWN, shown
from usvjax.errors import BadInputError, BadTypeError, unprintable
from usvjax.suggest import did_you_mean

if TYPE_CHECKING:
    from usvjax.mission import Mission

# A mission, or where it is: "package.module:NAME" is imported when a study asks for it.
_MISSIONS: "dict[str, Mission | str]" = {}
_OWN: set[str] = set()
_PRESETS: dict[str, str] = {}

_PLACE = re.compile(r"\w+(\.\w+)*:\w+")


def register_mission(kind: str, mission: "Mission | str") -> None:
    """Make a mission known.

    Args:
        kind: the `kind` of its study files.
        mission: the mission, or "package.module:NAME" of one.

    Raises:
        BadTypeError: `kind` is no string.
        BadInputError: usvjax has a mission of that kind itself, or `mission` is none.
    """
    if not isinstance(kind, str):
        raise BadTypeError(f"kind: got {shown(kind)}; wanted a string")
    if not 1 <= len(kind) <= MOST_SHOWN or unprintable(kind):
        raise BadInputError(
            f"kind: got {shown(kind)}; wanted text that can be printed in one line, of at most "
            f"{MOST_SHOWN} characters"
        )
    if kind in _OWN:
        raise BadInputError(f"kind: {kind!r} is a mission of usvjax's own; wanted another name")
    if not isinstance(mission, str):
        _check(kind, mission)
    elif not _PLACE.fullmatch(mission):
        raise BadInputError(f'mission: got {shown(mission)}; wanted "package.module:NAME"')
    _MISSIONS[kind] = mission


def _check(kind: str, mission: object) -> None:
    # Not at the top: it brings the maps along, which a command's start can do without.
    from usvjax.mission import check_mission

    check_mission(mission, f"the mission {shown(kind)}")


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
        BadInputError: no such kind, naming the nearest; or no mission where it is said to be.
    """
    if kind not in _MISSIONS:
        raise BadInputError(f"{where}: unknown kind {shown(kind)}; {did_you_mean(kind, _MISSIONS)}")
    found = _MISSIONS[kind]
    if isinstance(found, str):
        found = _MISSIONS[kind] = _imported(kind, found)
    return cast("Mission", found)


def _imported(kind: str, place: str) -> Any:
    """The mission at "package.module:NAME"."""
    module, _, name = place.partition(":")
    if kind in _OWN:
        return getattr(importlib.import_module(module), name)
    try:
        found = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError) as error:
        raise BadInputError(f"the mission {shown(kind)} is not at {place}: {error}") from error
    _check(kind, found)
    return found


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
