"""Functions that draw: no raw exception, hang or warning for garbage either."""

import pytest
from garbage import attempt, said, wrong
from plot_calls import plot_calls

from usvjax import plots

FUNCTIONS = sorted(plot_calls(None))


@pytest.fixture
def call(request, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return plot_calls(tmp_path)[request.param]


def test_all_public_functions_are_called():
    functions = {name for name in plots.__all__ if name.islower()}
    assert functions <= set(FUNCTIONS)


@pytest.mark.parametrize("call", FUNCTIONS, indirect=True)
def test_garbage_is_refused_in_one_line(call):
    problems = [
        f"{name} = {kind}: {problem}"
        for name, valid in call.arguments.items()
        for kind, value in wrong(valid)
        if (problem := attempt(call, **{name: value}))
    ]
    assert attempt(call) == ""
    assert not problems, said(problems)
