"""Errors for a user's mistakes: one sentence naming what was wrong and what was wanted.

The command line prints exactly that sentence and exits with 2. Any other exception is a
defect of usvjax and keeps its traceback.
"""

from collections.abc import Iterator
from contextlib import contextmanager


class BadInputError(ValueError):
    """An argument, a file or a study has a value that cannot be used."""


class BadTypeError(TypeError):
    """An argument has a type or dtype that cannot be used."""


@contextmanager
def saying_where(where: str) -> Iterator[None]:
    """Put the place of a mistake, such as a file's name, in front of messages without it."""
    try:
        yield
    except BadInputError as error:
        raise BadInputError(_prefixed(where, error)) from error
    except BadTypeError as error:
        raise BadTypeError(_prefixed(where, error)) from error


def _prefixed(where: str, error: Exception) -> str:
    text = str(error)
    return text if text.startswith(where) else f"{where}: {text}"
