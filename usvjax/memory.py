"""Whether work fits into the machine's memory, asked before it begins."""

from pathlib import Path

from usvjax.checks import byte_size
from usvjax.errors import BadInputError


def check_memory(needed: int, what: str) -> None:
    """Refuse work that needs more memory than the machine has left.

    Args:
        needed: bytes.
        what: what needs them, as "blocked: 5 searches at once on a map of 9 x 9 cells".

    Raises:
        BadInputError: naming both figures.
    """
    left = free_memory()
    if left is not None and needed > left:
        raise BadInputError(
            f"{what} needs {byte_size(needed)} of memory; this machine has {byte_size(left)} left"
        )


def free_memory() -> int | None:
    """Bytes that programs can still take without swapping; None where the system hides it.

    The least of what the machine and, in a container, its group of processes have left.
    """
    return min((left for left in (_of_machine(), _of_group()) if left is not None), default=None)


def _of_machine() -> int | None:
    try:
        with open(_MACHINE, encoding="ascii") as lines:
            facts = dict(line.split(":") for line in lines)
        return int(facts["MemAvailable"].split()[0]) * 1024
    except (OSError, KeyError, ValueError):
        return None


def _of_group() -> int | None:
    """What Linux's control groups (version 2) leave; None where they set no limit."""
    try:
        most, used = (int((_GROUP / name).read_text("ascii")) for name in _GROUP_FILES)
        lines = (_GROUP / "memory.stat").read_text("ascii").splitlines()
        stat = dict(line.split() for line in lines)
        # Pages of files count as used, though they are given up where memory runs short.
        return max(most - used + int(stat["inactive_file"]), 0)
    except (OSError, KeyError, ValueError):  # "max" is no number
        return None


_MACHINE = Path("/proc/meminfo")
_GROUP = Path("/sys/fs/cgroup")
_GROUP_FILES = ("memory.max", "memory.current")
