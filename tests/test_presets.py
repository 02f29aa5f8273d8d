"""Parameter sets by name and mission."""

import sys
from types import ModuleType

import pytest

import usvjax as uj
from usvjax import registry


def test_the_mission_is_dwa_unless_said() -> None:
    assert uj.preset("wei2023") is uj.preset("wei2023", mission="dwa")
    assert uj.preset_names() == uj.preset_names("dwa")
    assert "wei2023" in uj.preset_names()


def test_an_unknown_mission_names_the_nearest() -> None:
    for ask in (lambda: uj.preset("tan2022", mission="dvva"), lambda: uj.preset_names("dvva")):
        with pytest.raises(uj.BadInputError, match="mission: got 'dvva'; did you mean 'dwa'"):
            ask()


def test_another_mission_registers_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    slow = uj.Preset({"gain": 0.1}, {}, "a test")
    home = ModuleType("drift_presets")
    home.SETS = {"slow": slow}  # type: ignore[attr-defined]
    monkeypatch.setattr(registry, "_PRESETS", dict(registry._PRESETS))
    registry.register_presets("drift", "drift_presets:SETS")  # nothing is imported yet
    monkeypatch.setitem(sys.modules, "drift_presets", home)
    assert uj.preset("slow", mission="drift") is slow
    assert uj.preset_names("drift") == ("slow",)
    with pytest.raises(uj.BadInputError, match="preset: got 'tan2022'; valid: slow"):
        uj.preset("tan2022", mission="drift")
