"""What Tan et al. 2022 print: Tables 2, 3 and 4, and whether their numbers agree with each other.

Source: Z. Tan, N. Wei, Z. Liu, "Local Path Planning for Unmanned Surface Vehicle based on the
Improved DWA Algorithm", 2022.
"""

from dataclasses import dataclass
from math import hypot, sqrt

METHODS = ("traditional", "improved")
METRICS = ("time", "path_length", "mean_speed")
RADII = (0.2, 0.5, 0.7)  # m

BRAKING = 0.2  # m/s^2, Table 1
SEARCH_ANGLE_DEG = 60
STRAIGHT = hypot(10.0, 10.0)  # m, from start to goal

_HALF_UNIT = 0.005
"""Everything is printed to two decimals."""


@dataclass(frozen=True)
class PublishedTable:
    """One of the paper's tables, in s, m and m/s.

    Attributes:
        number: of the table.
        rates: obstacle rate at each of `RADII`.
        values: (method, metric) to the value at each of `RADII`.
        change: metric to the printed change (improved against traditional) at each of
            `RADII`, as a share; negative is a reduction. Empty where none is printed.
    """

    number: int
    rates: tuple[float, float, float]
    values: dict[tuple[str, str], tuple[float, float, float]]
    change: dict[str, tuple[float, float, float]]


TABLE2 = PublishedTable(
    number=2,
    rates=(0.2, 0.2, 0.2),
    values={
        ("traditional", "time"): (52.62, 47.46, 61.62),
        ("improved", "time"): (24.47, 22.66, 36.24),
        ("traditional", "path_length"): (14.68, 16.60, 16.86),
        ("improved", "path_length"): (14.26, 14.42, 14.69),
        ("traditional", "mean_speed"): (0.28, 0.35, 0.27),
        ("improved", "mean_speed"): (0.58, 0.64, 0.41),
    },
    change={"path_length": (-0.029, -0.131, -0.129), "mean_speed": (1.07, 0.83, 0.52)},
)
TABLE3 = PublishedTable(
    number=3,
    rates=(0.3, 0.3, 0.2),
    values={
        ("traditional", "time"): (62.62, 77.50, 60.60),
        ("improved", "time"): (26.63, 34.33, 21.13),
        ("traditional", "path_length"): (15.31, 17.13, 20.20),
        ("improved", "path_length"): (14.30, 14.46, 14.88),
        ("traditional", "mean_speed"): (0.24, 0.22, 0.33),
        ("improved", "mean_speed"): (0.57, 0.42, 0.70),
    },
    change={},
)
TABLE4 = PublishedTable(
    number=4,
    rates=(0.3, 0.3, 0.2),
    values={
        ("traditional", "time"): (53.17, 58.82, 57.84),
        ("improved", "time"): (25.92, 33.40, 27.03),
        ("traditional", "path_length"): (14.87, 16.60, 18.50),
        ("improved", "path_length"): (14.27, 14.62, 15.04),
        ("traditional", "mean_speed"): (0.28, 0.31, 0.36),
        ("improved", "mean_speed"): (0.55, 0.48, 0.66),
    },
    change={
        "time": (-0.5062, -0.4252, -0.5391),
        "path_length": (-0.0395, -0.1107, -0.1654),
        "mean_speed": (0.9702, 0.6076, 0.8432),
    },
)
TABLE4_MAPS = 20
"""Maps behind each average of Table 4."""


@dataclass(frozen=True)
class Check:
    """One comparison of a printed number with what other printed numbers make of it.

    Attributes:
        where: which number.
        printed: as printed, with its unit.
        recomputed: from the other numbers.
        verdict: "agrees", "can agree" (an average of ratios need not be the ratio of
            averages), or "contradicts".
    """

    where: str
    printed: str
    recomputed: str
    verdict: str


def arithmetic() -> list[Check]:
    """Compare the paper's numbers with each other: speeds, printed changes, and its text."""
    checks = [
        _speed(table, method, place)
        for table in (TABLE2, TABLE3, TABLE4)
        for method in METHODS
        for place in range(3)
    ]
    checks += [
        _change(table, metric, place)
        for table in (TABLE2, TABLE4)
        for metric in table.change
        for place in range(3)
    ]
    return checks + _text()


def _speed(table: PublishedTable, method: str, place: int) -> Check:
    """Mean speed against length over time; a single map allows rounding and nothing else."""
    length, time, speed = (
        table.values[method, m][place] for m in ("path_length", "time", "mean_speed")
    )
    low = (length - _HALF_UNIT) / (time + _HALF_UNIT) - _HALF_UNIT
    high = (length + _HALF_UNIT) / (time - _HALF_UNIT) + _HALF_UNIT
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
    printed = table.change[metric][place]
    low, high = (new - _HALF_UNIT) / (old + _HALF_UNIT), (new + _HALF_UNIT) / (old - _HALF_UNIT)
    # The text gives Table 2's changes to one decimal of a per cent, of speed to one per cent.
    digits = 0.005 if metric == "mean_speed" else 0.0005
    agrees = low - 1.0 - digits <= printed <= high - 1.0 + digits
    otherwise = "can agree" if table.number == TABLE4.number else "contradicts"
    return Check(
        where=f"Table {table.number}, change of {_WORDS[metric]}, r = {RADII[place]:g} m",
        printed=f"{100 * printed:+.2f} %",
        recomputed=f"{old:.2f} to {new:.2f} is {100 * (new / old - 1.0):+.2f} %",
        verdict="agrees" if agrees else otherwise,
    )


_WORDS = {"time": "time", "path_length": "path length", "mean_speed": "mean speed"}


def _text() -> list[Check]:
    """What the running text says about the tables."""
    saved = [_saved(TABLE2, place) for place in range(3)]
    printed4 = [-100 * share for share in TABLE4.change["time"]]
    outside = sum(not 40.0 <= value <= 50.0 for value in printed4)
    return [
        Check(
            where='Text on Table 2: at r = 0.5 m the time saved is "52.9 % at most"',
            printed="52.9 %, the largest",
            recomputed="saved: " + ", ".join(f"{value:.1f} %" for value in saved),
            verdict="agrees" if max(saved) == saved[1] else "contradicts",
        ),
        Check(
            where='Text on Table 2: the improved method "can save half of the time"',
            printed="50 %",
            recomputed=f"{min(saved):.1f} % at r = {RADII[saved.index(min(saved))]:g} m",
            verdict="agrees" if min(saved) >= 45.0 else "contradicts",
        ),
        Check(
            where='Text on Table 4: time reduction "maintained at 40 % - 50 %"',
            printed="40 to 50 %",
            recomputed="printed rates " + ", ".join(f"{value:.2f} %" for value in printed4),
            verdict="agrees" if outside == 0 else "contradicts",
        ),
    ]


def _saved(table: PublishedTable, place: int) -> float:
    old, new = (table.values[method, "time"][place] for method in METHODS)
    return 100.0 * (1.0 - new / old)


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
    """

    table: int
    radius: float
    speed: float
    dist: float
    demo_cap: float
    top_speed: float

    @property
    def excludes_demo_cap(self) -> bool:
        """Whether even the mean speed exceeds what a cap of 2r admits."""
        return self.speed - _HALF_UNIT > self.top_speed


def cap_bounds() -> list[CapBound]:
    """Eq. 4, v^2 <= 2 dist v_b, against the improved method's published mean speeds."""
    return [
        CapBound(
            table=table.number,
            radius=radius,
            speed=speed,
            dist=speed**2 / (2.0 * BRAKING),
            demo_cap=2.0 * radius,
            top_speed=sqrt(2.0 * 2.0 * radius * BRAKING),
        )
        for table in (TABLE2, TABLE3, TABLE4)
        for radius, speed in zip(RADII, table.values["improved", "mean_speed"], strict=True)
    ]
