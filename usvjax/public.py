"""What every public function does first: check the kinds of its arguments, pin JAX's settings.

The kinds are read from the annotations, so that `record: bool` takes no "false" and
`heuristic: str` no array, in one place for all functions. What a value means is checked by the
function itself.
"""

import inspect
import sys
import types
import typing
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from functools import cache, wraps
from typing import Any, ParamSpec, TypeVar

import numpy as np

from usvjax.checks import public_name, shown
from usvjax.errors import BadInputError, BadTypeError

P = ParamSpec("P")
R = TypeVar("R")

_WORDS = {
    bool: "True or False",
    int: "a whole number",
    float: "a number",
    str: "a string",
    Mapping: "a dictionary",
}


def public(instead: str = "", *, jit: bool = False) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Make a public function of one, which then raises `BadTypeError` for arguments of other kinds.

    It runs under `usvjax.ambient.pinned`, so its results do not depend on JAX's settings.

    Args:
        instead: the kernels to use where arguments are traced, such as "usvkernels.dwa"; "" where
            there are none.
        jit: whether it runs compiled programs; those of kernels do.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        signature = inspect.signature(function)

        @wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> R:
            try:
                bound = signature.bind(*args, **kwargs)
            except TypeError as error:
                raise BadTypeError(f"{function.__name__}: {error}") from None
            kinds = _kinds(function)
            for name, value in bound.arguments.items():
                _refuse_traced(function.__name__, name, value, instead)
                if name in kinds:
                    bound.arguments[name] = _of_kind(name, value, *kinds[name])
            with _settings(function.__name__, instead, jit or bool(instead)):
                return function(*bound.args, **bound.kwargs)

        return checked

    return decorate


@contextmanager
def _settings(name: str, instead: str, jit: bool) -> Iterator[None]:
    """Pin JAX's settings where JAX is loaded; a function that only reads a file starts without."""
    if "jax" not in sys.modules:
        yield
        return
    import jax

    from usvjax.ambient import pinned
    from usvjax.devices import naming_the_platform

    if jit and getattr(jax.config, "jax_disable_jit"):  # noqa: B009, the stubs lack it
        raise BadInputError(
            f"{name}: jax_disable_jit is on; wanted it off, since JAX runs no program compiled "
            "ahead without jit"
        )
    try:
        with naming_the_platform(), pinned():
            yield
    except jax.errors.TracerArrayConversionError:
        # Deep within an argument, or all of the call inside a function that JAX traces.
        raise BadTypeError(_traced(f"{name}: is called where arrays are", name, instead)) from None


def _refuse_traced(function: str, name: str, value: Any, instead: str) -> None:
    if "jax" not in sys.modules:
        return
    from jax.core import Tracer

    own = [value]
    if is_dataclass(value):
        own += [getattr(value, field.name, None) for field in fields(value)]
    if any(isinstance(one, Tracer) for one in own):
        raise BadTypeError(_traced(f"{name}: is", function, instead))


def _traced(what: str, function: str, instead: str) -> str:
    use = f"; inside them use {instead}" if instead else ""
    return (
        f"{what} traced by JAX (jit, vmap or grad); {function} wants concrete arrays, and takes "
        f"thousands of rows at once{use}"
    )


# --- kinds ------------------------------------------------------------------------------------


@cache
def _kinds(function: Callable[..., Any]) -> dict[str, tuple[tuple[type, ...], str]]:
    """Of each argument whose annotation decides: the classes it may be of, and words for them."""
    hints = typing.get_type_hints(function)
    found = {}
    for name in inspect.signature(function).parameters:
        options = _options(hints.get(name, Any))
        # Of several classes the function knows which one it takes.
        if all(map(_is_checkable, options)) and sum(map(_is_ours, options)) < 2:
            named = [_WORDS.get(o, o.__name__) for o in options if o is not type(None)]
            found[name] = (options, " or ".join(named))
    return found


def _is_ours(option: type) -> bool:
    return option.__module__.startswith("usv")


def _is_checkable(option: Any) -> bool:
    """Whether `isinstance` can decide, which it cannot of a protocol."""
    is_class = isinstance(option, type) and option not in (Any, object)
    return is_class and not getattr(option, "_is_protocol", False)


def _options(hint: Any) -> tuple[Any, ...]:
    """The classes of a union, or the one that the hint is."""
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        return tuple(o for part in typing.get_args(hint) for o in _options(part))
    if typing.get_origin(hint) is typing.Literal:
        return (str,)
    if typing.get_origin(hint) is Mapping:
        return (Mapping,)
    return (hint,)


def _of_kind(name: str, value: Any, options: tuple[type, ...], words: str) -> Any:
    """The value, a number of NumPy or JAX as one of Python.

    Raises:
        BadTypeError: it is of none of the classes.
    """
    plain = _plain(value)
    for option in options:
        if option in (bool, int, float):
            if _is_number(plain, option):
                return plain
        elif isinstance(value, option):
            return value
    got = public_name(type(value)) if any(map(_is_ours, options)) else shown(value)
    raise BadTypeError(f"{name}: got {got}; wanted {words}")


def _plain(value: Any) -> Any:
    """A NumPy scalar, or an array of no dimensions, as a number of Python."""
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    return value.item() if kind and kind in "biuf" and np.ndim(value) == 0 else value


def _is_number(value: Any, option: type) -> bool:
    if option is bool:
        return isinstance(value, bool)
    wanted = (int, float) if option is float else int
    return isinstance(value, wanted) and not isinstance(value, bool)
