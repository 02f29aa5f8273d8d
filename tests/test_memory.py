"""Work that memory cannot hold is refused."""

import pytest

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
