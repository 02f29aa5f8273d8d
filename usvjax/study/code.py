"""Which code decides a mission's results: its file, and all that its `pose` and `run` import.

A source checkout changes without its version changing; the digest keeps a study from being
continued by code other than its own. What only draws is left out, and so are other missions:
changing those refuses nothing.
"""

import ast
import hashlib
import inspect
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import usvkernels
from usvjax.exports import home_of
from usvjax.mission import Mission

DRAWING = ("example", "figures", "film")
"""Methods of a mission that decide no result."""

_FACADE = "usvjax"
_ROOTS = {
    _FACADE: Path(__file__).parents[2],
    "usvkernels": Path(str(usvkernels.__file__)).parents[1],
}


def code_digest(mission: Mission) -> str:
    """Digest of the code that decides a mission's results, 16 hexadecimal digits."""
    digest = hashlib.sha256()
    for key, source in sorted(sources(mission).items()):
        digest.update(key.encode() + b"\0" + source + b"\0")
    return digest.hexdigest()[:16]


def sources(mission: Mission) -> dict[str, bytes]:
    """The source of the files that decide a mission's results, by their path.

    Paths begin with the package; those of a plug-in, and of what stands beside it, with its folder
    left out.
    """
    start, name = Path(inspect.getfile(type(mission))), type(mission).__name__
    own = _package_of(start) is not None
    return _own_sources(start, name) if own else _sources(start, name, start.parent)


@cache  # a plug-in may change while a process goes on
def _own_sources(start: Path, name: str) -> dict[str, bytes]:
    return _sources(start, name, None)


def _sources(start: Path, name: str, beside: Path | None) -> dict[str, bytes]:
    found: dict[str, bytes] = {}
    waiting = [start]
    while waiting:
        path = waiting.pop()
        root = _package_of(path) or beside or path.parent
        key = path.relative_to(root).as_posix()
        if key in found:
            continue
        source = path.read_bytes()
        tree = ast.parse(source)
        found[key] = _without_drawing(source, tree, name) if path == start else source
        waiting += filter(None, (_file(module, beside) for module in _imports(tree)))
    return found


def _package_of(path: Path) -> Path | None:
    """The folder of our package that a file belongs to; None for a user's own."""
    return next((r for name, r in _ROOTS.items() if path.is_relative_to(r / name)), None)


def _without_drawing(source: bytes, tree: ast.Module, name: str) -> bytes:
    """Take the methods that only draw out of a mission's class: out of the tree and the source."""
    lines = source.splitlines(keepends=True)
    for kind in tree.body:
        if not isinstance(kind, ast.ClassDef) or kind.name != name:
            continue
        for node in list(kind.body):
            if isinstance(node, ast.FunctionDef) and node.name in DRAWING:
                kind.body.remove(node)
                lines[node.lineno - 1 : node.end_lineno] = [b""] * _height(node)
    return b"".join(lines)


def _height(node: ast.FunctionDef) -> int:
    assert node.end_lineno is not None
    return node.end_lineno - node.lineno + 1


def _imports(tree: ast.Module) -> Iterator[str]:
    """Names of modules that are imported anywhere but for type checkers, most of them ours."""
    facades = set()
    for node in _statements(tree.body):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
            facades |= {a.asname or a.name for a in node.names if a.name == _FACADE}
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                yield node.module
                yield f"{node.module}.{alias.name}"
                if node.module == _FACADE:
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


def _file(module: str, beside: Path | None) -> Path | None:
    """The file of a module that is ours or stands beside a plug-in; else None.

    Of our own two packages, `__init__` only says where names are, and decides nothing.
    """
    package = module.partition(".")[0]
    root = _ROOTS.get(package, beside)
    if root is None or module in _ROOTS or not module:
        return None
    base = root.joinpath(*module.split("."))
    for path in (base.with_suffix(".py"), base / "__init__.py"):
        if path.is_file():
            return path
    return None
