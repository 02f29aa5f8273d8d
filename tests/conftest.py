"""What holds for all tests: the same terminal, which is none."""

import pytest


@pytest.fixture(autouse=True)
def no_terminal(monkeypatch):
    """Whoever runs the tests may have set how wide and colourful output is to be."""
    for name in ("COLUMNS", "LINES", "NO_COLOR", "FORCE_COLOR", "TTY_COMPATIBLE"):
        monkeypatch.delenv(name, raising=False)
