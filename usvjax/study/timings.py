"""Wall-clock times of a run, in a file of their own so that all others compare byte for byte."""

import json
from collections.abc import Sequence
from typing import Any

import jax

from usvjax.study.store import RunDirectory, Unit

TIMINGS = "timings.json"


class Timings:
    """Seconds per unit; a resumed run adds to what is there."""

    def __init__(self, run: RunDirectory, devices: Sequence[jax.Device]) -> None:
        self._units = _earlier(run)
        self._devices = [str(device) for device in devices]

    def add(self, unit: Unit, seconds: float) -> None:
        """Note how long a unit took on its device, compilation included."""
        self._units[f"c{unit.condition}-s{unit.shard}"] = round(seconds, 4)

    def save(self, run: RunDirectory) -> None:
        """Write the file; errors as `RunDirectory.write_json`."""
        total = round(sum(self._units.values()), 4)
        content = {"devices": self._devices, "device_seconds": total, "units": self._units}
        run.write_json(TIMINGS, content)


def _earlier(run: RunDirectory) -> dict[str, float]:
    """Return the times of the session before; a killed one leaves none."""
    try:
        content: dict[str, Any] = json.loads((run.path / TIMINGS).read_bytes())
        return dict(content["units"])
    except (OSError, ValueError, KeyError, TypeError):
        return {}
