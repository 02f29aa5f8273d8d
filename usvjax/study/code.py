"""Which code decides a mission's results: its file, and all that its `pose` and `run` import.

A source checkout changes without its version changing; the digest keeps a study from being
continued by code other than its own. What only draws is left out, and so are other missions:
changing those refuses nothing.
"""

import ast
import hashlib
import inspect
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

import usvkernels
from usvjax.errors import BadInputError
from usvjax.exports import home_of
from usvjax.maps.disk import read_text_bytes
from usvjax.mission import Mission

DRAWING = ("example", "figures", "film")
"""Methods of a mission that decide no result."""

_FACADE = "usvjax"
_ROOTS = {
    _FACADE: Path(__file__).parents[2],
    "usvkernels": Path(str(usvkernels.__file__)).parents[1],
}


def code_digest(mission: Mission, plugin: Path | None = None) -> str:
    """Digest of the code that decides a mission's results, 16 hexadecimal digits.

    Args:
        mission: of a study.
        plugin: the file that brought it, if it is a user's own.

    Raises:
        BadInputError: the mission was made where there is no file to read.
    """
    digest = hashlib.sha256()
    for key, source in sorted(sources(mission, plugin).items()):
        digest.update(key.encode() + b"\0" + source + b"\0")
    return digest.hexdigest()[:16]


def sources(mission: Mission, plugin: Path | None = None) -> dict[str, bytes]:
    """The source of the files that decide a mission's results, by their path.

    Paths begin with the package; those of a plug-in, and of what stands beside it, with its folder
    left out. The arguments are those of `code_digest`.
    """
    kinds = [kind for kind in type(mission).__mro__ if kind not in (object, Mission)]
    names = frozenset(kind.__name__ for kind in kinds)
    files = {_file_of(kind): kind.__module__ for kind in kinds}
    starts = set(files) | ({plugin} if plugin else set())
    roots = _ROOTS | dict(filter(None, map(_root_of, files, files.values())))
    if all(_package_of(path, _ROOTS) for path in starts):
        return _own_sources(tuple(sorted(starts)), names)
    return _sources(starts, names, roots)


def beside(path: Path) -> dict[str, bytes]:
    """The source of the files that a plug-in imports from its own folder, itself among them."""
    return _sources({path}, frozenset(), _ROOTS, ours=False)


def _root_of(path: Path, module: str) -> tuple[str, Path] | None:
    """Name and folder of the package that a module of somebody's own belongs to, if to any."""
    top, *below = module.split(".")
    return (top, path.parents[len(below)]) if below else None


def _file_of(kind: type) -> Path:
    try:
        path = Path(inspect.getfile(kind))
    except (OSError, TypeError):
        path = Path()
    if not path.is_file():
        raise BadInputError(
            f"the code of the mission {kind.__name__!r} stands in no file; wanted it in one, so "
            f"that a run can tell what made it"
        )
    return path


@cache  # a plug-in may change while a process goes on
def _own_sources(starts: tuple[Path, ...], names: frozenset[str]) -> dict[str, bytes]:
    return _sources(set(starts), names, _ROOTS)


def _sources(
    starts: set[Path], names: frozenset[str], roots: Mapping[str, Path], ours: bool = True
) -> dict[str, bytes]:
    """Sources of the files and of what they import, without drawing methods of these classes.

    Args:
        starts: the files.
        names: of the classes.
        roots: packages whose modules count, and the folders that these are in.
        ours: whether modules of those packages count, besides what stands beside the files.
    """
    found: dict[str, bytes] = {}
    waiting = list(starts)
    folders = {path.parent for path in starts if _package_of(path, roots) is None}
    while waiting:
        path = waiting.pop()
        root = _package_of(path, roots) or next(f for f in folders if path.is_relative_to(f))
        key = path.relative_to(root).as_posix()
        if key in found:
            continue
        source = read_text_bytes(path)
        tree = ast.parse(source)
        found[key] = _without_drawing(source, tree, names) if path in starts else source
        package = key.split("/")[:-1]
        imported = {file for m in _imports(tree, package) for file in _files(m, folders, roots)}
        waiting += (file for file in imported if ours or not _package_of(file, roots))
    return found


def _package_of(path: Path, roots: Mapping[str, Path]) -> Path | None:
    """The folder of the package that a file belongs to; None for one that stands alone."""
    return next((r for name, r in roots.items() if path.is_relative_to(r / name)), None)


def _without_drawing(source: bytes, tree: ast.Module, names: frozenset[str]) -> bytes:
    """Take the methods that only draw out of a mission's classes: out of tree and source."""
    lines = source.splitlines(keepends=True)
    for kind in tree.body:
        if not isinstance(kind, ast.ClassDef) or kind.name not in names:
            continue
        for node in list(kind.body):
            if isinstance(node, ast.FunctionDef) and node.name in DRAWING:
                kind.body.remove(node)
                lines[node.lineno - 1 : node.end_lineno] = [b""] * _height(node)
    return b"".join(lines)


def _height(node: ast.FunctionDef) -> int:
    assert node.end_lineno is not None
    return node.end_lineno - node.lineno + 1


def _imports(tree: ast.Module, package: list[str]) -> Iterator[str]:
    """Names of modules that are imported anywhere but for type checkers, most of them ours.

    `package` has the names of the folders that the file is in, which "from . import" refers to.
    """
    facades = set()
    for node in _statements(tree.body):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
            facades |= {a.asname or a.name for a in node.names if a.name == _FACADE}
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) + 1 - node.level] if node.level else []
            module = ".".join([*above, *filter(None, [node.module])])
            for alias in node.names:
                yield module
                yield f"{module}.{alias.name}" if module else alias.name
                if module == _FACADE:
                    yield home_of(alias.name)
    if facades:
        for part in ast.walk(tree):
            if isinstance(part, ast.Attribute) and getattr(part.value, "id", None) in facades:
                yield home_of(part.attr)


def _statements(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    """All statements, however deep, but those under `if TYPE_CHECKING:`."""
    for node in body:
        yield node
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            continue
        for name in ("body", "orelse", "finalbody"):
            yield from _statements(getattr(node, name, []))
        for part in (*getattr(node, "handlers", []), *getattr(node, "cases", [])):
            yield from _statements(part.body)


def _files(module: str, folders: set[Path], roots: Mapping[str, Path]) -> list[Path]:
    """The files that importing a module runs, where it is in a package or beside a plug-in.

    Of these packages, `__init__` only says where names are, and decides nothing.
    """
    own = roots.get(module.partition(".")[0])
    parts = module.split(".")
    if own is not None:
        return _file_in(own, parts) if len(parts) > 1 else []
    # What is in a folder beside a plug-in runs the `__init__` of that folder as well.
    names = [parts[:count] for count in range(1, len(parts) + 1)] if module else []
    return [file for root in folders for name in names for file in _file_in(root, name)]


def _file_in(root: Path, parts: list[str]) -> list[Path]:
    base = root.joinpath(*parts)
    files = (base / "__init__.py", base.with_suffix(".py"))
    return [file for file in files if file.is_file()][:1]
