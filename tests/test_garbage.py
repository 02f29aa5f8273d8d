"""No public function answers garbage with a raw exception, a hang or the machine's memory."""

import os
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from garbage import attempt, problems_of, said, wrong
from public_calls import calls

import usvjax as uj
from usvjax.errors import BadInputError, BadTypeError

pytestmark = pytest.mark.usefixtures("one_device")

FUNCTIONS = sorted(calls(None))

FUZZ = "USVJAX_FUZZ" in os.environ

OTHER_PROGRAMS = {
    ("blocked", "an axis less"),
    ("blocked", "a row less"),
    ("blocked", "a row more"),
    ("stations", "a row less"),
    ("sensing", "None"),
    ("sensing", "far away"),
    ("corner_cutting", "True"),
    ("static", "corner_cutting: True"),
    ("turn_cost", "zero"),
    ("weight", "zero"),
    ("weight", "array of no dimensions"),
    ("record", "True"),
    *((name, "None") for name in ("iterations", "population", "static", "environment")),
    *((name, "numpy whole number") for name in ("iterations", "population", "max_lanes")),
}
"""Valid after all, and 5 to 15 s to compile: left to `make fuzz`."""


@pytest.fixture
def call(request, tmp_path):
    return calls(tmp_path)[request.param]


@pytest.fixture(autouse=True, scope="module")
def quickly_compiled():
    """What is computed is not looked at."""
    jax.config.update("jax_disable_most_optimizations", True)
    yield
    jax.config.update("jax_disable_most_optimizations", False)
    jax.clear_caches()


def test_all_public_functions_are_called():
    functions = {name for name in uj.__all__ if callable(getattr(uj, name)) and name.islower()}
    # Asked elsewhere: of studies, of plug-ins, before JAX starts.
    others = {"load_run", "run_study", "register_mission", "use_all_cores"}
    assert {call.function.__name__ for call in calls(None).values()} == functions - others


@pytest.mark.parametrize("call", FUNCTIONS, indirect=True)
def test_garbage_is_refused_in_one_line(call):
    problems = problems_of(call, () if FUZZ else OTHER_PROGRAMS)
    assert not problems, said(problems)


@pytest.mark.skipif(not FUZZ, reason="by `make fuzz`: minutes")
@pytest.mark.parametrize("call", FUNCTIONS, indirect=True)
def test_garbage_in_several_arguments(call):
    problems, rng = [], np.random.default_rng(0)
    kinds = {name: list(wrong(valid)) for name, valid in call.arguments.items()}
    for _ in range(500):
        names = rng.choice(list(kinds), min(len(kinds), int(rng.integers(2, 4))), replace=False)
        chosen = {name: kinds[name][rng.integers(len(kinds[name]))] for name in names}
        if problem := attempt(call, **{name: value for name, (_, value) in chosen.items()}):
            said_of = {name: kind for name, (kind, _) in chosen.items()}
            problems.append(f"{said_of}: {problem}")
    assert not problems, said(problems)


ARRAYS = [
    (function, name)
    for function, call in calls(None).items()
    for name, value in call.arguments.items()
    if np.ndim(value) > 0 and np.asarray(value).dtype.kind in "biuf" and name != "shape"
]


@pytest.mark.parametrize(("function", "name"), ARRAYS)
@pytest.mark.parametrize("transform", [jax.jit, jax.vmap, jax.grad])
def test_traced_arguments_are_refused(function, name, transform, tmp_path):
    call = calls(tmp_path)[function]
    array = jnp.asarray(np.asarray(call.arguments[name])[None], float)

    def traced(value):
        one = value[0] if transform is not jax.vmap else value
        return replace(call, options={**call.arguments, name: one}, needed={})()

    with pytest.raises(BadTypeError, match=f"^{name}: is traced by JAX .* wants concrete arrays"):
        transform(traced)(array)


def test_traced_numbers_within_an_argument_are_refused(tmp_path):
    call = calls(tmp_path)["navigate_dwa"]

    def params(value):
        replace(call, options={**call.arguments, "params": uj.DwaParams(radius=value)})()

    def rows(value):
        replace(call, options={**call.arguments, "starts": [[0.0, 0.0, value]]})()

    for traced in (params, rows):
        with pytest.raises(BadTypeError, match=r"traced by JAX .* use usvkernels\.dwa"):
            jax.jit(traced)(0.5)


def test_disabled_jit_is_refused_in_one_line(tmp_path):
    with (
        jax.disable_jit(),
        pytest.raises(BadInputError, match="jax_disable_jit is on; wanted it off"),
    ):
        calls(tmp_path)["astar"]()
