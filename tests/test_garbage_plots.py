"""Functions that draw: no raw exception, hang or warning for garbage either."""

import itertools
import os
from dataclasses import replace
from functools import wraps

import pytest
from garbage import attempt, problems_of, said
from plot_calls import plot_calls

from usvjax import plots
from usvjax.errors import BadInputError
from usvjax.plots import style

FUNCTIONS = sorted(plot_calls(None))

DRAWN = 1 if "USVJAX_FUZZ" in os.environ else 40
"""One of so many figures that pass the checks is drawn: all of them take minutes."""


class NotDrawnError(BaseException):
    """The checks let a figure pass."""


@pytest.fixture
def call(request, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = plot_calls(tmp_path)[request.param]
    assert attempt(found) == ""
    count, new_figure = itertools.count(1), style.new_figure

    def some(*size):
        if next(count) % DRAWN:
            raise NotDrawnError
        return new_figure(*size)

    @wraps(found.function)
    def checked(**arguments):
        try:
            return found.function(**arguments)
        except NotDrawnError:
            return None

    monkeypatch.setattr(style, "new_figure", some)
    return replace(found, function=checked)


def test_all_public_functions_are_called():
    functions = {name for name in plots.__all__ if name.islower()}
    assert functions <= set(FUNCTIONS)


@pytest.mark.parametrize("call", FUNCTIONS, indirect=True)
def test_garbage_is_refused_in_one_line(call):
    problems = problems_of(call)
    assert not problems, said(problems)


def test_an_unknown_status_ends_nothing():
    with pytest.raises(BadInputError, match="status is 9; one of"):
        plots.Ending(9, 1.0, 1.0)
