"""Work that memory cannot hold is refused."""

import pytest

from usvjax import memory
from usvjax.errors import BadInputError
from usvjax.memory import check_memory, free_memory


def test_memory_is_compared_and_read() -> None:
    left = free_memory()
    assert left is None or 2**20 < left < 2**50
    check_memory(2**20, "a: trifle")
    if left is not None:
        with pytest.raises(
            BadInputError, match=r"^a: monster needs .* GiB of memory; this machine has"
        ):
            check_memory(2**60, "a: monster")


def test_a_group_of_processes_may_have_less(tmp_path, monkeypatch) -> None:
    """Of a container, whose machine has more; pages of files are given up where room is wanted."""
    monkeypatch.setattr(memory, "_GROUP", tmp_path)
    (tmp_path / "memory.current").write_text("700000\n")
    (tmp_path / "memory.stat").write_text("anon 400000\ninactive_file 200000\nactive_file 1\n")
    (tmp_path / "memory.max").write_text("1000000\n")
    assert free_memory() == 1_000_000 - 700_000 + 200_000
    (tmp_path / "memory.max").write_text("max\n")
    assert (free_memory() or 2**40) > 2**20
    monkeypatch.setattr(memory, "_MACHINE", tmp_path / "none")
    assert free_memory() is None
