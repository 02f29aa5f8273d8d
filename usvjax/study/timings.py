"""Wall-clock times of a run, in a file of their own so that all others compare byte for byte."""

import re
from collections.abc import Sequence
from typing import Any

import jax

from usvjax.study.folder import read_json
from usvjax.study.shards import Unit
from usvjax.study.store import RunDirectory

TIMINGS = "timings.json"

_MOST_SECONDS = 1e9
_UNIT = re.compile(r"c\d+-s\d+")


class Timings:
    """Seconds per unit; a resumed run adds to what is there."""

    def __init__(self, run: RunDirectory, devices: Sequence[jax.Device]) -> None:
        self._units = _earlier(run)
        self._devices = [str(device) for device in devices]

    def add(self, unit: Unit, seconds: float) -> None:
        """Note how long a unit took on its device, compilation included."""
        self._units[f"c{unit.condition}-s{unit.shard}"] = round(seconds, 4)

    def save(self, run: RunDirectory) -> None:
        """Write the file, where it can be; errors as `RunDirectory.write_json`."""
        if not run.writable:
            return
        total = round(sum(self._units.values()), 4)
        content = {"devices": self._devices, "device_seconds": total, "units": self._units}
        run.write_json(TIMINGS, content)


def _earlier(run: RunDirectory) -> dict[str, float]:
    """Return the times of the session before; a killed one leaves none.

    No result rests on them, so whatever else stands there is passed over and written anew.
    """
    try:
        content = read_json(run.path / TIMINGS)
    except (OSError, ValueError):
        return {}
    units = content.get("units") if isinstance(content, dict) else None
    found = units.items() if isinstance(units, dict) else ()
    return {name: float(value) for name, value in found if _is_time(name, value)}


def _is_time(name: str, value: Any) -> bool:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return bool(_UNIT.fullmatch(name)) and number and 0 <= value <= _MOST_SECONDS
