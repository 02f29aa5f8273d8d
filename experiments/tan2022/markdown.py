"""What the report on Tan et al. 2022 calls things, and one value per radius."""

from collections.abc import Sequence

UNITS = {"time": "s", "path_length": "m", "mean_speed": "m/s"}
WORDS = {"time": "Time", "path_length": "Path length", "mean_speed": "Mean speed"}
ENDINGS = {
    "REACHED": "Reached",
    "COLLIDED": "Collided",
    "STUCK": "Stuck",
    "TIMED_OUT": "Timed out",
}


def radii(values: Sequence[float | None], digits: int = 1, sign: bool = False) -> str:
    """Write one value per radius; "-" where there is none."""
    plus = "+" if sign else ""
    return ", ".join("-" if v is None else f"{v:{plus}.{digits}f}" for v in values)
