"""Whether the numbers of Tan et al. 2022 agree with each other."""

from dataclasses import dataclass
from math import sqrt

from experiments.claims import Check
from experiments.tan2022.published import (
    BRAKING,
    METHODS,
    MOST_SAVED,
    MOST_SAVED_AT,
    RADII,
    TABLE2,
    TABLE3,
    TABLE4,
    TIME_SAVED,
    PublishedTable,
)
from usvjax.report.numbers import change, fixed, listed

WORDS = {"time": "time", "path_length": "path length", "mean_speed": "mean speed"}
HALF_UNIT = 0.005
"""Tables are printed to two decimals."""
_NEARLY_HALF = 0.45
"""Of the time: what still counts as "half"."""


def shares(table: PublishedTable, metric: str) -> tuple[float, ...]:
    """The printed change of a value at each radius, as a share of it; negative is a reduction."""
    printed = table.change[metric]
    sign = -1.0 if printed.words == "reduced" else 1.0
    scale = 100.0 if printed.unit == "%" else 1.0
    return tuple(sign * value / scale for value in printed.values)


def arithmetic() -> list[Check]:
    """Compare the paper's numbers with each other: speeds, printed changes, and its text."""
    checks = [
        _speed(table, method, place)
        for table in (TABLE2, TABLE3, TABLE4)
        for method in METHODS
        for place in range(len(RADII))
    ]
    checks += [
        _change(table, metric, place)
        for table in (TABLE2, TABLE4)
        for metric in table.change
        for place in range(len(RADII))
    ]
    return checks + _text()


def _speed(table: PublishedTable, method: str, place: int) -> Check:
    """Mean speed against length over time; a single map allows rounding and nothing else."""
    length, time, speed = (
        table.values[method, m][place] for m in ("path_length", "time", "mean_speed")
    )
    low = (length - HALF_UNIT) / (time + HALF_UNIT) - HALF_UNIT
    high = (length + HALF_UNIT) / (time - HALF_UNIT) + HALF_UNIT
    agrees = low <= speed <= high
    # Over maps, the mean of length / time lies above the ratio of the means when times vary.
    otherwise = "can agree" if table.number == TABLE4.number and speed > high else "contradicts"
    return Check(
        where=f"Table {table.number}, mean speed, {method}, r = {RADII[place]:g} m",
        printed=f"{speed:.2f} m/s",
        recomputed=f"{length:.2f} m / {time:.2f} s = {length / time:.3f} m/s",
        verdict="agrees" if agrees else otherwise,
    )


def _change(table: PublishedTable, metric: str, place: int) -> Check:
    """A printed change against that of the printed values; Table 4 averages over maps."""
    old, new = (table.values[method, metric][place] for method in METHODS)
    printed = shares(table, metric)[place]
    low, high = (new - HALF_UNIT) / (old + HALF_UNIT), (new + HALF_UNIT) / (old - HALF_UNIT)
    # The text gives Table 2's changes to one decimal of a per cent, of speed to one per cent.
    digits = 0.005 if metric == "mean_speed" else 0.0005
    agrees = low - 1.0 - digits <= printed <= high - 1.0 + digits
    otherwise = "can agree" if table.number == TABLE4.number else "contradicts"
    return Check(
        where=f"Table {table.number}, change of {WORDS[metric]}, r = {RADII[place]:g} m",
        printed=change(printed, 2),
        recomputed=f"{old:.2f} to {new:.2f} is {change(new / old - 1.0, 2)}",
        verdict="agrees" if agrees else otherwise,
    )


def _text() -> list[Check]:
    """What the running text says about the tables."""
    saved = [_saved(TABLE2, place) for place in range(len(RADII))]
    least, most = TIME_SAVED
    printed = TABLE4.change["time"].values
    outside = [value for value in printed if not least <= value <= most]
    return [
        Check(
            where=f"Text on Table 2: at r = {MOST_SAVED_AT:g} m the time saved is "
            f'"{MOST_SAVED} % at most"',
            printed=f"{MOST_SAVED} %, the largest",
            recomputed=f"saved: {listed(saved, 1, 100)} %",
            verdict=_verdict(max(saved) == saved[RADII.index(MOST_SAVED_AT)]),
        ),
        Check(
            where='Text on Table 2: the improved method "can save half of the time"',
            printed="half",
            recomputed=f"{fixed(min(saved), 1, 100)} % at r = {RADII[saved.index(min(saved))]:g} m",
            verdict=_verdict(min(saved) >= _NEARLY_HALF),
        ),
        Check(
            where=f'Text on Table 4: time reduction "maintained at {least} % - {most} %"',
            printed=f"{least} to {most} %",
            recomputed=f"printed rates {listed(printed, 2)} %",
            verdict=_verdict(not outside),
        ),
    ]


def _verdict(agrees: bool) -> str:
    return "agrees" if agrees else "contradicts"


def _saved(table: PublishedTable, place: int) -> float:
    old, new = (table.values[method, "time"][place] for method in METHODS)
    return 1.0 - new / old


@dataclass(frozen=True)
class CapBound:
    """How large dist must have been for a published speed, by Eq. 4.

    Attributes:
        table: its number.
        radius: m.
        speed: published mean speed of the improved method, m/s.
        dist: m, least dist at which Eq. 4 admits that speed.
        demo_cap: m, twice the radius.
        top_speed: m/s, what Eq. 4 admits at that cap.
        excludes_demo_cap: whether even the mean speed exceeds what a cap of 2r admits.
    """

    table: int
    radius: float
    speed: float
    dist: float
    demo_cap: float
    top_speed: float
    excludes_demo_cap: bool


def cap_bounds() -> list[CapBound]:
    """Eq. 4, v^2 <= 2 dist v_b, against the improved method's published mean speeds."""
    return [
        _bound(table.number, radius, speed)
        for table in (TABLE2, TABLE3, TABLE4)
        for radius, speed in zip(RADII, table.values["improved", "mean_speed"], strict=True)
    ]


def _bound(table: int, radius: float, speed: float) -> CapBound:
    cap = 2.0 * radius
    top = sqrt(2.0 * cap * BRAKING)
    dist = speed**2 / (2.0 * BRAKING)
    return CapBound(table, radius, speed, dist, cap, top, speed - HALF_UNIT > top)
