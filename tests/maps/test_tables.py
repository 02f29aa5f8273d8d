"""Reading `[maps]` tables."""

from dataclasses import dataclass
from pathlib import Path

import pytest

from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps.tables import Opened, read_maps
from usvjax.sections import Table


@dataclass(frozen=True)
class Near:
    distance: float = 1.0


@dataclass(frozen=True)
class Far:
    distance: float = 10.0
    bearing: float = 0.0


TABLE = Table("where", {"near": Near, "far": Far}, choice="source", default="far")


def opened(options, folder, where):
    if isinstance(options, Near):
        return Opened(options, (options, folder, where))
    return Opened(Far(2 * options.distance), "drawn", {"file": "digest"})


def read(given):
    return read_maps(given, TABLE, opened, Path("here"), "study.toml: [maps]", {})


def test_the_source_is_opened_and_all_keys_in_force_are_told():
    settings, source, inputs = read({"source": "near", "distance": 3})
    assert list(settings.items()) == [("source", "near"), ("distance", 3.0)]
    assert source == (Near(3.0), Path("here"), "study.toml: [maps]")
    assert inputs == {}


def test_where_none_is_named_it_is_the_table_s_default_and_opening_may_complete_options():
    settings, source, inputs = read({})
    assert settings == {"source": "far", "distance": 20.0, "bearing": 0.0}
    assert (source, inputs) == ("drawn", {"file": "digest"})


def test_what_is_asked_for_again_is_opened_once():
    kept, calls = {}, []

    def counted(options, folder, where):
        calls.append(options)
        return opened(options, folder, where)

    first, again, other = (
        read_maps(given, TABLE, counted, Path("here"), "the study", kept)
        for given in ({"distance": 3}, {"source": "far", "distance": 3.0}, {"distance": 4})
    )
    assert first == again != other
    assert calls == [Far(3.0), Far(4.0)]


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"source": 3}, BadTypeError, r"\[maps\]: 'source' must be a string, got 3"),
        ({"source": "nera"}, BadInputError, "unknown source 'nera'; did you mean 'near'"),
        ({"source": "near", "bearing": 0.0}, BadInputError, "unknown key 'bearing'"),
        ({"distance": "x"}, BadTypeError, "'distance' must be a number"),
    ],
)
def test_what_cannot_be_used_is_refused(given, error, message):
    with pytest.raises(error, match=message):
        read(given)
