"""The manifest of a run: what was run, and with what; checked whenever it is read."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from usvjax.errors import BadInputError
from usvjax.study.folder import read_json
from usvjax.study.versions import COMPARED, environment

MANIFEST = "manifest.json"

_STUDY = {
    "name": str,
    "kind": str,
    "seed": int,
    "episodes": int,
    "shard": int,
    "methods": [str],
    "baseline": str,
    "until": (float, int, type(None)),
    "confidence": (float, int),
    "conditions": [{"label": str, "varied": dict, "settings": {"": dict}, "inputs": {"": str}}],
}
_SHAPE = {
    "hash": str,
    "study": _STUDY,
    "files": {"depth": int, "moved": {"": str}, "digests": {"": str}},
    **dict.fromkeys(COMPARED, (str, bool)),
}
"""What a manifest must hold; "" stands for any key. There may be more."""


def hash_of(study: Mapping[str, Any]) -> str:
    """SHA-256 of a study's canonical JSON, 64 hexadecimal digits."""
    text = json.dumps(study, sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def manifest_of(study: Mapping[str, Any], code: str, files: Mapping[str, Any]) -> dict[str, Any]:
    """The manifest of a run that begins now.

    Args:
        study: the canonical study.
        code: digest of the code that runs it.
        files: what the run holds; see `usvjax.study.held.Held.entry`.
    """
    made = environment(code)
    return {"hash": hash_of(study), **made, "study": dict(study), "files": dict(files)}


def read_manifest(run: Path) -> dict[str, Any]:
    """Read the manifest of a run.

    Args:
        run: its folder.

    Returns:
        Its content; everything in `_SHAPE` is there.

    Raises:
        BadInputError: there is none, it cannot be read, or it is not as it was written.
    """
    path = run / MANIFEST
    try:
        manifest = read_json(path)
    except OSError as error:
        raise BadInputError(f"{run} is not a run of usvjax: no readable {MANIFEST}") from error
    except BadInputError:
        raise
    except ValueError as error:
        raise BadInputError(f"{path} is damaged: {error}") from error
    wrong = _misfit(manifest, _SHAPE)
    if wrong is not None:
        raise BadInputError(f"{path} is not a manifest of this version of usvjax: {wrong}")
    try:
        same = hash_of(manifest["study"]) == manifest["hash"]
    except ValueError:  # NaN, which JSON as Python reads it may hold
        same = False
    if not same:
        raise BadInputError(
            f"{path} was edited or damaged: its study is not the one of its hash; bring the "
            f"original back, or run the study under another name"
        )
    return manifest


def check_same(run: Path, found: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    """Refuse to mix two studies, or two versions, in one run.

    Args:
        run: the run's folder.
        found: its manifest.
        wanted: the manifest that it would have now.

    Raises:
        BadInputError: they differ in what decides results; names the first difference.
    """
    remedy = "choose another name or --out, or delete the directory"
    if found["hash"] != wanted["hash"]:
        difference = _first_difference(found["study"], wanted["study"])
        raise BadInputError(f"{run} holds a run of another study: {difference}; {remedy}")
    for key, words in COMPARED.items():
        if found[key] != wanted[key]:
            raise BadInputError(
                f"{run} holds a run made with {words} {_said(found[key])}, this is "
                f"{_said(wanted[key])}, and results are not mixed; {remedy}"
            )


def _said(value: Any) -> str:
    return str(value) or "none"


def _misfit(value: Any, shape: Any, where: str = "it") -> str | None:
    """The first place where a value has not a shape, in words; None where there is none.

    A shape is a type or several, a list with the shape of the items of a list that is not empty,
    or a dictionary with the shapes of what a dictionary must hold.
    """
    if isinstance(shape, list):
        if not isinstance(value, list) or not value:
            return f"{where} is no list, or an empty one"
        parts = [(item, shape[0], f"{where}[{i}]") for i, item in enumerate(value)]
    elif isinstance(shape, dict):
        if not isinstance(value, dict):
            return f"{where} is no table"
        wanted = dict.fromkeys(value, shape[""]) if "" in shape else shape
        missing = [key for key in wanted if key not in value]
        if missing:
            return f"{where} has no {missing[0]!r}"
        parts = [(value[key], part, f"{where}[{key!r}]") for key, part in wanted.items()]
    else:
        fits = isinstance(value, shape) and (shape is not int or isinstance(value, bool) is False)
        return None if fits else f"{where} is {short(value)}"
    return next((wrong for part in parts if (wrong := _misfit(*part)) is not None), None)


def _first_difference(found: Any, wanted: Any, where: str = "") -> str:
    """Name the first place where two JSON values differ."""
    if isinstance(found, Mapping) and isinstance(wanted, Mapping):
        for key in sorted(set(found) | set(wanted)):
            if found.get(key) != wanted.get(key):
                place = f"{where}.{key}" if where else str(key)
                return _first_difference(found.get(key), wanted.get(key), place)
    if isinstance(found, list) and isinstance(wanted, list) and len(found) == len(wanted):
        for index, (a, b) in enumerate(zip(found, wanted, strict=True)):
            if a != b:
                return _first_difference(a, b, f"{where}[{index}]")
    return f"{where or 'the study'} is {short(found)} there and {short(wanted)} here"


def short(value: Any) -> str:
    """A JSON value in forty characters."""
    text = json.dumps(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
