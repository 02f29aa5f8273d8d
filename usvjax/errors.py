"""Errors for a user's mistakes: one sentence naming what was wrong and what was wanted.

The command line prints exactly that sentence and exits with 2. Any other exception is a
defect of usvjax and keeps its traceback.
"""

import re
from collections.abc import Iterator
from contextlib import contextmanager

# Control characters, line and paragraph ends, overrides of the direction of writing, and lone
# surrogates: they steer a terminal, break a table, or cannot be written at all.
_UNPRINTABLE = re.compile(
    "[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)


def printable(text: str) -> str:
    """A text with its control characters and lone surrogates escaped."""
    return _UNPRINTABLE.sub(lambda found: found[0].encode("unicode_escape").decode(), text)


def unprintable(text: str) -> str | None:
    """The first control character or lone surrogate of a text, escaped; None where it has none."""
    found = _UNPRINTABLE.search(text)
    return None if found is None else printable(found[0])


MOST_LETTERS = 450
"""Of a message, whatever a user's value puts into it."""


class _SentenceError(Exception):
    """An error whose message can be printed, whatever names it quotes."""

    def __init__(self, message: str = "") -> None:
        text = printable(message)
        super().__init__(text if len(text) <= MOST_LETTERS else f"{text[: MOST_LETTERS - 3]}...")


class BadInputError(_SentenceError, ValueError):
    """An argument, a file or a study has a value that cannot be used."""


class BadTypeError(_SentenceError, TypeError):
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
