"""Whether work fits into the machine's memory, asked before it begins."""

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
    """Bytes that programs can still take without swapping; None where the system hides it."""
    try:
        with open("/proc/meminfo", encoding="ascii") as lines:
            facts = dict(line.split(":") for line in lines)
        return int(facts["MemAvailable"].split()[0]) * 1024
    except (OSError, KeyError, ValueError):
        return None
