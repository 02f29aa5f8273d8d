"""The `[maps]` tables of all missions: each key is explained where it is declared."""

import dataclasses
import inspect
import re

import pytest

from usvjax.missions.cruise import scenes as cruise
from usvjax.missions.dwa import scenes as dwa
from usvjax.missions.fleet import crowds, situations
from usvjax.missions.fleet import scenes as fleet
from usvjax.missions.route import scenes as route

TABLES = [
    *(dwa.LatticeTable, dwa.DiscTable, dwa.ChartTable),
    *(route.CellTable, route.ChartTable, route.ScenTable),
    *(cruise.CellTable, cruise.ChartTable),
    *(fleet.EncounterTable, fleet.SwapTable, situations.ImazuTable),
    *(crowds.CrowdTable, crowds.ChartTable),
]


@pytest.mark.parametrize(
    "table", TABLES, ids=lambda t: f"{t.__module__.split('.')[2]}-{t.__name__}"
)
def test_every_key_has_an_entry_of_its_own(table):
    entries = inspect.getdoc(table).partition("Attributes:\n")[2]
    named = re.findall(r"^ {4}(\w+): \S", entries, re.M)
    assert named == [field.name for field in dataclasses.fields(table)]
