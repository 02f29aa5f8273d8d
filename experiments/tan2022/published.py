"""What Tan et al. 2022 print: Tables 1 to 4, and what the text says about them.

Source: Z. Tan, N. Wei, Z. Liu, "Local Path Planning for Unmanned Surface Vehicle based on the
Improved DWA Algorithm", 2022.
"""

from dataclasses import dataclass, field

METHODS = ("traditional", "improved")
METRICS = ("time", "path_length", "mean_speed")
RADII = (0.2, 0.5, 0.7)  # m

BRAKING = 0.2  # m/s^2, Table 1


@dataclass(frozen=True)
class Change:
    """How the improved method changes a value, as printed.

    Attributes:
        words: "reduced" or "increased".
        unit: "%" or "times".
        values: at each of `RADII`.
    """

    words: str
    unit: str
    values: tuple[float, float, float]


@dataclass(frozen=True)
class PublishedTable:
    """One of the paper's tables, in s, m and m/s.

    Attributes:
        number: of the table.
        rates: obstacle rate at each of `RADII`.
        values: (method, metric) to the value at each of `RADII`.
        change: metric to the printed change, where one is printed.
    """

    number: int
    rates: tuple[float, float, float]
    values: dict[tuple[str, str], tuple[float, float, float]]
    change: dict[str, Change] = field(default_factory=dict)


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
    change={
        "path_length": Change("reduced", "%", (2.9, 13.1, 12.9)),
        "mean_speed": Change("increased", "times", (1.07, 0.83, 0.52)),
    },
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
        "time": Change("reduced", "%", (50.62, 42.52, 53.91)),
        "path_length": Change("reduced", "%", (3.95, 11.07, 16.54)),
        "mean_speed": Change("increased", "%", (97.02, 60.76, 84.32)),
    },
)
TABLE4_MAPS = 20
"""Maps behind each average of Table 4."""

MOST_SAVED = 52.9  # %: text on Table 2, of the time, "at most", when the radius is `MOST_SAVED_AT`
MOST_SAVED_AT = 0.5  # m
TIME_SAVED = (40, 50)  # %: text on Table 4, where the reduction "is maintained"
