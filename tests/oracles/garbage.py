"""What people hand in by mistake: values of every wrong kind, and valid ones spoiled."""

import resource
import time
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import polars as pl

from usvjax.errors import BadInputError, BadTypeError
from usvkernels.status import Status

SECONDS, KIBIBYTES = 5.0, 2**20
NUMERIC = (bool, int, float, list, tuple, np.ndarray, np.generic)
LONGEST_MESSAGE = 450


class Hostile:
    """An object that fails at whatever is asked of it."""

    def __repr__(self) -> str:
        raise RuntimeError("no name")

    def __array__(self, *args: Any, **kwargs: Any) -> np.ndarray:
        raise RuntimeError("no array")

    def __bool__(self) -> bool:
        raise RuntimeError("no truth")

    def __eq__(self, other: object) -> bool:
        raise RuntimeError("no equality")

    __hash__ = None  # type: ignore[assignment]


NUMBERS = {
    "nan": np.nan,
    "inf": np.inf,
    "minus inf": -np.inf,
    "zero": 0,
    "minus one": -1,
    "a half": 0.5,
    "subnormal": 5e-324,
    "subnormal in single precision": 1e-44,
    "huge": 1e300,
    "beyond single precision": 1e39,
    "ten billion": 10**10,
    "2**63": 2**63,
    "400 digits": 10**400,
    "5,000 digits": 10**5000,
    "numpy float": np.float64(2.5),
    "jax number": jnp.float32(2.0),
    "numpy whole number": np.int8(2),
}

KINDS = {
    "None": None,
    "True": True,
    "text": "x",
    "long text": "x" * 100_000,
    "escape": "\x1b[31m\nx",
    "surrogate": "\ud800",
    "bytes": b"x",
    "complex": 1j,
    "object": object(),
    "hostile": Hostile(),
    "function": len,
    "class": int,
    "dict": {"a": 1},
    "set": {1},
    "empty list": [],
    "empty tuple": (),
    "ragged list": [[1, 2], [3]],
    "list of text": ["octile"],
    "array of text": np.array(["octile"]),
    "array of bool": np.array([True, False]),
    "array of objects": np.array([None, "x"], object),
    "array of complex": np.array([[1j, 2j]]),
    "array of dates": np.array(["2020-01-01"], "datetime64[D]"),
    "structured array": np.zeros(2, [("x", float)]),
    "masked array": np.ma.masked_array([1.0, 2.0], [True, False]),
    "empty array": np.zeros((0, 2)),
    "array of no dimensions": np.array(1.5),
    "array of nine dimensions": np.zeros((1,) * 9),
    "key of another kind": jax.random.key(0, impl="rbg"),
    "several keys": jax.random.split(jax.random.key(0, impl="threefry2x32"), 3),
    "iterator": iter([1, 2]),
}


def wrong(value: Any) -> Iterator[tuple[str, Any]]:
    """Garbage for an argument whose valid value is given, each with a name."""
    yield from KINDS.items()
    yield from NUMBERS.items()
    if is_dataclass(value) and not isinstance(value, type):
        yield from _spoiled_fields(value)
    elif isinstance(value, pl.DataFrame):
        yield from _spoiled_table(value)
    elif isinstance(value, dict):
        yield from _spoiled_dict(value)
    elif isinstance(value, list | tuple) and not all(isinstance(one, NUMERIC) for one in value):
        yield from _spoiled_list(value)
    elif np.ndim(value) > 0:
        yield from _spoiled_array(np.asarray(value))


def _spoiled_table(table: pl.DataFrame) -> Iterator[tuple[str, Any]]:
    yield "no rows", table.head(0)
    yield "no columns", pl.DataFrame()
    yield "lazy", table.lazy()
    yield "of NumPy", table.to_numpy()
    for name in table.columns:
        column = pl.col(name)
        yield f"without {name}", table.drop(name)
        for said, other in {
            "nulls": pl.lit(None),
            "a null": pl.when(pl.int_range(pl.len()) > 0).then(column),
            "text": pl.lit("x"),
            "escape": pl.lit("\x1b[31m\nx"),
            "NaN": pl.lit(np.nan),
            "infinity": pl.lit(np.inf),
            "huge": pl.lit(1e300),
            "minus one": pl.lit(-1),
            "fractions": pl.lit(0.5),
            "truth": pl.lit(value=True),
            "lists": pl.lit([1, 2]),
            "a large number": pl.lit(2**62),
        }.items():
            yield f"{name}: {said}", table.with_columns(other.alias(name))


def _spoiled_dict(table: dict[Any, Any]) -> Iterator[tuple[str, Any]]:
    value = next(iter(table.values()))
    rest = list(table.items())[1:]
    yield "empty", {}
    yield "the values alone", list(table.values())
    alike = len({type(one) for one in table.values()}) == 1
    for name, bad in {**KINDS, **NUMBERS}.items():
        for key in list(table)[: 1 if alike else None]:
            yield f"{key}: {name}", {**table, key: bad}
        if getattr(bad, "__hash__", None):
            yield f"a key: {name}", {bad: value, **dict(rest)}
    for key, one in table.items():
        if isinstance(one, dict) or (one is value and (np.ndim(one) or is_dataclass(one))):
            for name, bad in wrong(one):
                yield f"{key}: {name}", {**table, key: bad}


def _spoiled_list(items: Any) -> Iterator[tuple[str, Any]]:
    yield "twice", [*items, *items]
    yield "reversed", items[::-1]
    for name, bad in {**KINDS, **NUMBERS}.items():
        yield f"its first: {name}", [bad, *items[1:]]


def _spoiled_fields(value: Any) -> Iterator[tuple[str, Any]]:
    for place, field in enumerate(fields(value)):
        # A number for each of two rows is another program for each field: one will do.
        two = {"two": np.array([1.0, 2.0])} if place == 0 else {}
        for name, bad in {**KINDS, **NUMBERS, **two}.items():
            try:
                spoiled = replace(value, **{field.name: bad})
            except (TypeError, ValueError):  # refused on the spot, as BadInputError, BadTypeError
                continue
            yield f"{field.name}: {name}", spoiled


def _spoiled_array(array: np.ndarray) -> Iterator[tuple[str, Any]]:
    flat = array.reshape(-1)
    for name, bad in NUMBERS.items():
        for place in (0, -1):
            spoiled = flat.astype(object)
            spoiled[place] = bad
            yield f"{name} at {place}", spoiled.reshape(array.shape).tolist()
            if array.dtype.kind == "f" and isinstance(bad, float):
                there = flat.astype(float)
                there[place] = bad
                yield f"{name} at {place} of an array", there.reshape(array.shape)
    for kind in ("float16", "float32", "float64", "int8", "uint64", "bool", "complex64", "U3", "O"):
        yield f"as {kind}", array.astype(kind)
    yield "an axis more", array[None]
    yield "two axes more", array[None, None]
    yield "an axis less", array[0]
    yield "no rows", array[:0]
    yield "a row less", array[:-1]
    yield "a row more", np.concatenate([array, array[-1:]])
    yield "another last axis", array[..., :-1]
    yield "no last axis", array[..., :0]
    yield "turned", array.T
    yield "reversed", array[::-1]
    yield "read-only", _read_only(array)
    yield "of JAX", jnp.asarray(array)
    yield "negative", -array.astype(float)
    yield "scaled up", array.astype(float) * 1e30
    yield "far away", array.astype(np.int64) + 2**40


def _read_only(array: np.ndarray) -> np.ndarray:
    array = array.copy()
    array.flags.writeable = False
    return array


# --- what a call makes of it ------------------------------------------------------------------


def attempt(call, **changes):
    """Words for what is wrong with how the call took the changes; "" for nothing."""
    before, began = peak(), time.monotonic()
    problem = outcome(call, changes)
    if not problem and time.monotonic() - began > SECONDS:
        began = time.monotonic()  # once more, compiled
        outcome(call, changes)
        took = time.monotonic() - began
        problem = f"took {took:.1f} s" * (took > SECONDS)
    if not problem and peak() - before > KIBIBYTES:
        problem = f"took {(peak() - before) / 2**20:.1f} GiB"
    return problem


def outcome(call, changes):
    try:
        found = replace(call, options={**call.arguments, **changes}, needed={})()
    except (BadInputError, BadTypeError) as error:
        return bad_message(str(error))
    except Exception as error:
        return f"{type(error).__name__}: {str(error)[:120]}"
    running = np.any(np.asarray(getattr(found, "status", 1)) == int(Status.RUNNING))
    return "a status RUNNING" if running else ""


def bad_message(text):
    if not text.isprintable():
        return f"a message that cannot be printed: {text[:120]!r}"
    return f"a message of {len(text)} letters: {text[:120]!r}" * (len(text) > LONGEST_MESSAGE)


def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def problems_of(call, left_out=()):
    """What is wrong with how a call takes garbage for every argument, but some (name, kind)."""
    return [
        f"{name} = {kind}: {problem}"
        for name, valid in call.arguments.items()
        for kind, value in wrong(valid)
        if (name, kind) not in left_out and (problem := attempt(call, **{name: value}))
    ]


def said(problems):
    return "\n".join([f"{len(problems)} problems", *problems])
