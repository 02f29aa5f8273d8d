"""What the summary and the figures of a run were made from, so that they are not made again.

Each is taken as it is only where the same code and libraries made it from the same shards, and
where its own bytes are those that were written. All else is made anew.
"""

import hashlib
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import usvjax
import usvkernels
from usvjax.study.code import beside
from usvjax.study.folder import digest, read_json, read_plain

FINISHED = "finished.json"
FIGURES = "figures.json"
SUMMARY = "summary.json"

_LIBRARIES = ("jax", "jaxlib", "numpy", "scipy", "polars", "matplotlib")


def maker(plugin: Path | None) -> str:
    """Digest of all code that may decide a summary or a figure.

    Args:
        plugin: the file of a user's own mission.
    """
    parts = {} if plugin is None else beside(plugin)
    return _digest_of(_ours(), *(word for item in sorted(parts.items()) for word in item))


def record(
    by: str, shards: Iterable[Path], made: Mapping[str, bytes], **asked: Any
) -> dict[str, Any]:
    """What to write down of some files of a run.

    Args:
        by: what made them; see `maker`.
        shards: the shards that they were made from.
        made: their contents, by name in the run.
        asked: what else they depend on; JSON-able.
    """
    # A list, which keeps the order of the figures.
    marks = [[name, digest(content)] for name, content in made.items()]
    return {**_origin(by, shards, asked), "made": marks}


def as_recorded(
    run: Path, name: str, by: str, shards: Iterable[Path], **asked: Any
) -> dict[str, bytes] | None:
    """The files that a record of a run names, if they are as they would be made now.

    Args:
        run: its folder.
        name: of the record.
        by, shards, asked: as for `record`.

    Returns:
        Their contents, by name in the run; None where anything differs.
    """
    found = read_record(run / name)
    if found is None or found[0] != _origin(by, shards, asked):
        return None
    made = {file: _content(run / file, mark) for file, mark in found[1].items()}
    whole = {file: content for file, content in made.items() if content is not None}
    return whole if len(whole) == len(made) else None


def read_record(path: Path) -> tuple[dict[str, Any], dict[str, str]] | None:
    """What a record says files were made from, and their digests; None where there is none."""
    try:
        found = read_json(path)
        made = {str(name): str(mark) for name, mark in found.pop("made")}
    except (OSError, ValueError, TypeError, AttributeError, KeyError):
        return None
    return found, made


def _origin(by: str, shards: Iterable[Path], asked: Mapping[str, Any]) -> dict[str, Any]:
    names = sorted(path.name for path in shards)
    return {"by": by, "from": _digest_of(*names), "asked": dict(asked)}


def _content(path: Path, mark: str) -> bytes | None:
    """What a file holds, if it is what was written."""
    try:
        content = read_plain(path)
    except (OSError, ValueError):
        return None
    return content if digest(content) == mark else None


@cache
def _ours() -> str:
    """Digest of all our code and of the versions of what it builds on."""
    words: list[str | bytes] = [f"{name} {version(name)}" for name in _LIBRARIES]
    for package in (usvjax, usvkernels):
        root = Path(str(package.__file__)).parent
        for path in sorted(root.rglob("*.py")):
            words += [path.relative_to(root.parent).as_posix(), path.read_bytes()]
    return _digest_of(*words)


def _digest_of(*words: str | bytes) -> str:
    found = hashlib.sha256()
    for word in words:
        content = word.encode() if isinstance(word, str) else word
        found.update(len(content).to_bytes(8, "big") + content)
    return found.hexdigest()
