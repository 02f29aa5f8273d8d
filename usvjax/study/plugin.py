"""A mission from a file of one's own, named by the study: `plugin = "mydrift.py"`.

The file holds a dictionary `MISSIONS`, from the kind of a study to a mission. It is imported under
a name made of its content, so that two studies may bring files of one name, and a changed file is
another module.
"""

import hashlib
import importlib.util
import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from usvjax.errors import BadInputError, BadTypeError
from usvjax.mission import Mission
from usvjax.registry import register_mission

PREFIX = "usvjax_plugin_"

_WANTED = [name for name in (*Mission.__annotations__, *vars(Mission)) if not name.startswith("_")]


@dataclass(frozen=True)
class Plugin:
    """A plug-in's file.

    Attributes:
        name: as the study has it.
        path: of the file.
        source: its content, with which another process can import it.
    """

    name: str
    path: Path
    source: bytes

    def load(self, where: str = "the study") -> None:
        """Import the file and make its missions known.

        Raises:
            BadInputError: its import fails, or it holds no missions.
        """
        try:
            module = _imported(self.source, self.path)
        except (BadInputError, BadTypeError):
            raise
        except Exception as error:
            what = f"{type(error).__name__}: {error}"
            raise BadInputError(f"{where}: the plugin {self.name!r} fails: {what}") from error
        found = getattr(module, "MISSIONS", None)
        if not isinstance(found, dict) or not found:
            raise BadInputError(
                f"{where}: the plugin {self.name!r} has no MISSIONS; wanted a dictionary from the "
                f"kind of a study to a mission"
            )
        for kind, mission in found.items():
            self._check(kind, mission, where)
            try:
                register_mission(kind, mission)
            except BadInputError as error:
                raise BadInputError(f"{where}: the plugin {self.name!r}: {error}") from None

    def _check(self, kind: object, mission: object, where: str) -> None:
        place = f"{where}: the plugin {self.name!r}: the mission {kind!r}"
        if not isinstance(kind, str):
            raise BadInputError(f"{place} has a kind that is no string; wanted one")
        missing = [name for name in _WANTED if not hasattr(mission, name)]
        if missing:
            raise BadInputError(f"{place} has no {missing[0]!r}; see usvjax.mission.Mission")


def read_plugin(name: str, folder: Path, where: str) -> Plugin:
    """Read a plug-in's file.

    Args:
        name: of the file.
        folder: what it is relative to.
        where: the study file, for messages.

    Raises:
        BadInputError: it cannot be read.
    """
    path = (folder / name).resolve()
    try:
        return Plugin(name, path, path.read_bytes())
    except OSError as error:
        raise BadInputError(f"{where}: cannot read the plugin {name!r}: {error.strerror}") from None


def _imported(source: bytes, path: Path) -> ModuleType:
    """The module of a source; imported once."""
    name = PREFIX + hashlib.sha256(source).hexdigest()[:16]
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_loader(name, loader=None, origin=str(path))
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    module.__file__ = str(path)
    if str(path.parent) not in sys.path:
        sys.path.append(str(path.parent))  # what stands beside it may be imported, too
    sys.modules[name] = module
    try:
        exec(compile(source, str(path), "exec"), module.__dict__)
    except BaseException:
        del sys.modules[name]
        raise
    return module
