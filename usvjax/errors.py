"""Errors for a user's mistakes: one sentence naming what was wrong and what was wanted.

The command line prints exactly that sentence and exits with 2. Any other exception is a
defect of usvjax and keeps its traceback.
"""


class BadInputError(ValueError):
    """An argument, a file or a study has a value that cannot be used."""


class BadTypeError(TypeError):
    """An argument has a type or dtype that cannot be used."""
