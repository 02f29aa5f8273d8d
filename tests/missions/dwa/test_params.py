"""The flat records of a user, and the records of the kernels that they are split into."""

import re
from dataclasses import fields, replace
from typing import Any

import jax
import numpy as np
import pytest

import usvjax as uj
from usvjax.missions.dwa.params import split


def test_every_field_goes_to_one_record() -> None:
    params = uj.DwaParams(**{f.name: float(i) for i, f in enumerate(fields(uj.DwaParams))})
    static = uj.DwaStatic(method="improved", n_v=7, plant="heading_first", max_steps=3)
    found: dict[str, Any] = {}
    for record in split(params, static):
        assert not set(found) & set(vars(record))
        found |= vars(record)
    assert found == vars(params) | vars(static)


def test_numbers_are_leaves_and_choices_are_not() -> None:
    radius = np.array([0.5, 0.6])
    settings = split(uj.DwaParams(radius=radius), uj.DwaStatic())
    leaves, structure = jax.tree.flatten(settings)
    assert len(leaves) == len(fields(uj.DwaParams))
    assert any(leaf is radius for leaf in leaves)
    other = split(uj.DwaParams(), replace(uj.DwaStatic(), max_steps=7))
    assert jax.tree.structure(other) != structure
    assert jax.tree.structure(split(uj.DwaParams(), uj.DwaStatic())) == structure


@pytest.mark.parametrize("kind", [uj.DwaParams, uj.DwaStatic])
def test_every_field_is_explained_once(kind: type) -> None:
    assert kind.__doc__ is not None
    explained = re.findall(r"^ {8}(\w+): ", kind.__doc__.partition("Attributes:")[2], re.M)
    assert explained == [f.name for f in fields(kind)]
