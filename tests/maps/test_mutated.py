"""Mutated files: every loader reads them or says in one sentence why not, soon and in little room.

USVJAX_FUZZ=1 hands out ten times as many.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import mutated_files
import numpy as np
import pytest

COUNT = 500 if os.environ.get("USVJAX_FUZZ") else 50


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What came of the files of every loader, in a process of its own."""
    folder = tmp_path_factory.mktemp("mutated")
    command = [sys.executable, mutated_files.__file__, str(COUNT), str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


@pytest.mark.parametrize("loader", mutated_files.LOADERS)
def test_a_mutated_file_is_read_or_refused_in_a_sentence(
    reports: dict[str, Any], loader: str
) -> None:
    found = reports[loader]
    assert found["wrong"] == []
    # The files are not as they were.
    assert found["refused"] > mutated_files.count_of(loader, COUNT) // 3
    assert found["slowest"] < 5.0  # s of the processors
    assert found["peak"] < 2**30  # bytes, of the process so far


class TooLongError(mutated_files.BadInputError):
    """With a message as it never comes: the class cuts its messages."""

    def __str__(self) -> str:
        return "x" * mutated_files.LONGEST


def test_what_is_wrong_is_noticed(tmp_path: Path) -> None:
    def fails() -> None:
        raise ValueError("no")

    def says_much() -> None:
        raise TooLongError("x" * mutated_files.LONGEST)

    assert mutated_files.outcome(fails) == ("raises ValueError: no", False)
    assert mutated_files.outcome(says_much)[0].startswith("says 'xxx")
    rng = np.random.default_rng(0)
    changed = {mutated_files.mutated(b"name = 1\nother = 2\n", rng) for _ in range(40)}
    assert len(changed) > 30
