"""A mission from a file of one's own, named by the study: `plugin = "mydrift.py"`.

The file holds a dictionary `MISSIONS`, from the kind of a study to a mission. It is imported under
a name made of its place and its content, and of what it imports from beside it, so that two studies
may bring files of one name, and a changed file is another module.
"""

import hashlib
import importlib.util
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from usvjax.checks import file_path, shown
from usvjax.errors import BadInputError, BadTypeError, saying_where
from usvjax.maps.disk import read_text_bytes
from usvjax.registry import register_mission
from usvjax.study.code import beside

PREFIX = "usvjax_plugin_"

_MOST_OF_ERROR = 200


@dataclass(frozen=True)
class Plugin:
    """A plug-in's file.

    Attributes:
        name: as the study has it.
        path: of the file.
        source: its content, with which another process can import it.
        digest: of its place, its content, and that of the files it imports from beside it.
        beside: SHA-256 of these files and of itself, by name relative to its folder.
    """

    name: str
    path: Path
    source: bytes
    digest: str
    beside: Mapping[str, str]

    def load(self, where: str = "the study") -> None:
        """Import the file and make its missions known.

        Raises:
            BadInputError: its import fails, or it holds no missions.
        """
        try:
            module = _imported(self)
        except (BadInputError, BadTypeError):
            raise
        except (Exception, SystemExit) as error:
            raise BadInputError(_failure(self.name, where, error)) from error
        found = getattr(module, "MISSIONS", None)
        if not isinstance(found, dict) or not found:
            raise BadInputError(
                f"{where}: the plugin {self.name!r} has no MISSIONS; wanted a dictionary from the "
                f"kind of a study to a mission"
            )
        with saying_where(f"{where}: the plugin {self.name!r}"):
            for kind, mission in found.items():
                register_mission(kind, mission)


def read_plugin(name: str, folder: Path, where: str) -> Plugin:
    """Read a plug-in's file.

    Args:
        name: of the file.
        folder: what it is relative to.
        where: the study file, for messages.

    Raises:
        BadInputError: it cannot be read.
    """
    with saying_where(f"{where}: cannot read the plugin {shown(name)}"):
        path = (folder / file_path("plugin", name)).resolve()
        source = read_text_bytes(path)
    try:
        found = beside(path)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        # All of them are what Python says of sources that it cannot parse.
        raise BadInputError(_failure(name, where, error)) from None
    digest = hashlib.sha256()
    for key, part in sorted({"": str(path).encode(), **found}.items()):
        digest.update(key.encode() + b"\0" + part + b"\0")
    each = {key: hashlib.sha256(part).hexdigest() for key, part in found.items()}
    return Plugin(name, path, source, digest.hexdigest()[:16], each)


def _failure(name: str, where: str, error: BaseException) -> str:
    """One sentence about what the import of a plug-in raised, whose message may be long."""
    text = " ".join(str(error).split())
    what = f"{type(error).__name__}: {text[:_MOST_OF_ERROR]}"
    return f"{where}: the plugin {name!r} fails: {what}"


def _imported(plugin: Plugin) -> ModuleType:
    """The module of a plug-in; imported once."""
    name = PREFIX + plugin.digest
    if name in sys.modules:
        return sys.modules[name]
    folder = plugin.path.parent
    _forget(plugin)
    spec = importlib.util.spec_from_loader(name, loader=None, origin=str(plugin.path))
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    module.__file__ = str(plugin.path)
    sys.modules[name] = module
    if str(folder) not in sys.path:
        sys.path.append(str(folder))  # for what its functions import when they are called
    sys.path.insert(0, str(folder))
    try:
        exec(compile(plugin.source, str(plugin.path), "exec"), module.__dict__)
    except BaseException:
        del sys.modules[name]
        raise
    finally:
        sys.path.remove(str(folder))
    return module


def _forget(plugin: Plugin) -> None:
    """Let modules from beside a plug-in be imported anew: they may have changed.

    So may those of its names that another plug-in brought, from beside itself.
    """
    folder = plugin.path.parent
    for name, module in list(sys.modules.items()):
        file = getattr(module, "__file__", None)
        beside = file is not None and Path(file).parent == folder
        if name in _HELPERS or (beside and not name.startswith((PREFIX, "__main__"))):
            del sys.modules[name]
    for file in plugin.beside:
        parts = file.removesuffix(".py").removesuffix("/__init__").split("/")
        _HELPERS.update(".".join(parts[:count]) for count in range(1, len(parts) + 1))


_HELPERS: set[str] = set()
"""Names of the modules that plug-ins have brought from beside themselves."""
