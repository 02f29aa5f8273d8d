"""Errors for a user's mistakes: one sentence naming what was wrong and what was wanted.

The command line prints exactly that sentence and exits with 2. Any other exception is a
defect of usvjax and keeps its traceback.
"""

from collections.abc import Iterator
from contextlib import contextmanager

MOST_LETTERS = 400
"""Of a message, whatever a user's value puts into it."""


def one_line(text: str, most: int = MOST_LETTERS) -> str:
    """A text as one printable line of at most `most` letters: control characters as escapes."""
    words = " ".join(text[: 4 * most].split())
    line = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in words)
    return line if len(line) <= most else f"{line[: most - 3]}..."


class BadInputError(ValueError):
    """An argument, a file or a study has a value that cannot be used."""

    def __init__(self, message: str) -> None:
        super().__init__(one_line(message))


class BadTypeError(TypeError):
    """An argument has a type or dtype that cannot be used."""

    def __init__(self, message: str) -> None:
        super().__init__(one_line(message))


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
