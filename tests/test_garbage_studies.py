"""Functions of studies, methods of maps: no raw exception, hang or folder for garbage either."""

import os
from dataclasses import replace

import pytest
from garbage import attempt, problems_of, said
from study_calls import BRIEF, study_calls
from study_fake import ToyMission

import usvjax as uj
from usvjax import registry
from usvjax.errors import BadInputError, BadTypeError
from usvjax.study import parse_spec

FUNCTIONS = sorted(study_calls(None))


@pytest.fixture
def call(request, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("JAX_NUM_CPU_DEVICES", "2")
    monkeypatch.setattr(registry, "_MISSIONS", dict(registry._MISSIONS))
    return study_calls(tmp_path)[request.param]


@pytest.mark.parametrize("call", FUNCTIONS, indirect=True)
def test_garbage_is_refused_in_one_line(call):
    problems = problems_of(call)
    assert attempt(call) == ""
    assert not problems, said(problems)


@pytest.mark.parametrize(
    "change",
    [{"devices": -1}, {"devices": 10**6}, {"listener": object()}, {"study": "no.toml"}],
    ids=lambda change: ", ".join(change),  # an object has another name in every process
)
def test_nothing_is_written_before_all_is_checked(change, tmp_path):
    call = study_calls(tmp_path)["run_study"]
    with pytest.raises((BadInputError, BadTypeError)):
        replace(call, options={**call.arguments, "out": tmp_path / "new", **change}, needed={})()
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    ("attribute", "value", "words"),
    [
        ("tables", 3, "'tables' must be a dictionary of usvjax.sections.Table"),
        ("tables", {"params": 3}, "'tables' must be a dictionary of usvjax.sections.Table"),
        ("methods", ("plain",), "'methods' must be a dictionary of words"),
        ("methods", {"plain": 3}, "'methods' must be a dictionary of words"),
        ("methods", {3: "plain"}, "has the name 3"),
        ("metrics", ["time"], "'metrics' must be a tuple of usvjax.mission.Metric"),
        ("metrics", (), "'metrics' is empty"),
        ("endings", (0, 1), "'endings' must be a tuple of codes"),
        ("pose", None, "'pose' must be a method"),
    ],
)
def test_a_mission_without_the_contract_is_refused(attribute, value, words):
    mission = ToyMission()
    setattr(mission, attribute, value)
    with pytest.raises(BadInputError, match=words):
        uj.register_mission("toy_again", mission)


def study_at(place):
    uj.register_mission("toy_again", place)
    parse_spec({**BRIEF, "kind": "toy_again"})


@pytest.mark.parametrize(
    ("place", "words"),
    [
        ("nowhere", "wanted .package.module:NAME"),
        ("no_such_module:MISSION", "'toy_again' is not at no_such_module:MISSION: No module"),
        ("usvjax.mission:NOTHING", "'toy_again' is not at usvjax.mission:NOTHING: module"),
        ("usvjax.mission:Mission", "the mission 'toy_again' has no 'tables'"),
    ],
)
def test_a_mission_that_is_not_where_it_is_said_to_be_is_refused(place, words, monkeypatch):
    monkeypatch.setattr(registry, "_MISSIONS", dict(registry._MISSIONS))
    with pytest.raises(BadInputError, match=words):
        study_at(place)


def test_cores_are_as_many_as_a_machine_may_have(monkeypatch):
    monkeypatch.setenv("JAX_NUM_CPU_DEVICES", "2")
    with pytest.raises(BadInputError, match="count: got 10000000000; wanted at most 4,096"):
        uj.use_all_cores(10**10)
    assert os.environ["JAX_NUM_CPU_DEVICES"] == "2"
