"""Property tests draw the same cases in every run, whatever ran before them."""

import importlib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from property_draws import FUZZ, examples

TESTS = Path(__file__).parent


def draws() -> list[tuple[int, float, str]]:
    """What a property test of 50 cases draws."""
    drawn = []

    @examples(50)
    @given(st.integers(), st.floats(allow_nan=False), st.text())
    def see(whole: int, real: float, word: str) -> None:
        drawn.append((whole, real, word))

    see()
    return drawn


def test_the_profile_is_what_was_asked_for() -> None:
    profile = settings()
    assert profile.derandomize is not FUZZ
    assert profile.deadline is None
    assert profile.max_examples == (1000 if FUZZ else 100)
    assert examples(7).max_examples == (70 if FUZZ else 7)
    assert examples(7).derandomize is not FUZZ


def test_property_tests_have_no_settings_of_their_own() -> None:
    """They would not be multiplied under USVJAX_FUZZ."""
    for file in TESTS.rglob("test_*.py"):
        if file != Path(__file__):
            assert "settings(max_examples" not in file.read_text(), file


@pytest.mark.skipif(FUZZ, reason="new cases are wanted")
def test_draws_do_not_depend_on_what_was_imported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = draws()
    numbers = [(7 + 10**6 * i, i + 0.123, f"word {i}") for i in range(500)]
    (tmp_path / "full_of_constants.py").write_text(f"NUMBERS = {numbers}")
    monkeypatch.syspath_prepend(tmp_path)
    importlib.import_module("full_of_constants")
    assert draws() == before


@pytest.mark.skipif(not FUZZ, reason="the same cases are wanted")
def test_fuzzing_draws_new_cases() -> None:
    assert draws() != draws()
