"""What Yu et al. 2022 print about whole cruises: Tables 3, 4, 6 and 7.

Tables 3 and 6 are 50 runs of Case 1 in
the ordinary and the complex environment; Tables 4 and 7 give one value for each of the four cases.
"""

from dataclasses import dataclass

ALGORITHMS = ("aco", "ga", "cmpso", "gwo", "proposed")
"""Algorithms 1 to 4 and the proposed one, in the order of the tables' columns."""
PROPOSED = "proposed"
METRICS = ("planning_time", "length", "inflections")
"""Planning time (s), length (m) and inflection points, in the order of the tables' rows."""
RUNS = 50
ALPHA = 0.05
"""Level of the t-tests."""


@dataclass(frozen=True)
class Statistics:
    """One indicator of one algorithm in Table 3 or 6.

    Attributes:
        best: of 50 runs.
        mean: of 50 runs.
        worst: of 50 runs.
        std: standard deviation.
        p: of the t-test against the proposed algorithm; None for itself.
    """

    best: float
    mean: float
    worst: float
    std: float
    p: float | None


def _rows(*columns: tuple[float | None, ...]) -> dict[str, Statistics]:
    """One indicator of the five algorithms, a column of the table for each."""
    return {
        name: Statistics(*column)  # type: ignore[arg-type]
        for name, column in zip(ALGORITHMS, columns, strict=True)
    }


STATISTICS = {
    "ordinary": {
        "planning_time": _rows(
            (21.562, 30.112, 37.608, 5.134, 2.1233e-10),
            (10.185, 10.671, 11.145, 0.626, 0.779),
            (9.667, 10.470, 11.293, 1.015, 4.7421e-5),
            (12.927, 13.823, 14.773, 1.035, 5.7973e-6),
            (9.746, 10.356, 11.106, 0.483, None),
        ),
        "length": _rows(
            (1677.354, 1693.280, 1720.697, 12.171, 0.000067),
            (1769.300, 1812.457, 1855.835, 30.153, 8.5439e-6),
            (1695.650, 1728.564, 1760.541, 15.851, 6.8328e-9),
            (1698.624, 1708.821, 1721.100, 7.511, 5.8455e-8),
            (1669.643, 1678.002, 1691.8235, 5.981, None),
        ),
        "inflections": _rows(
            (54, 56.36, 59, 1.764, 4.7190e-13),
            (53, 62.56, 79, 7.919, 6.9541e-7),
            (48, 51.54, 56, 2.566, 2.7559e-10),
            (38, 42.02, 44, 1.937, 3.3352e-9),
            (35, 36.74, 38, 0.906, None),
        ),
    },
    "complex": {
        "planning_time": _rows(
            (69.319, 76.248, 82.667, 4.387, 5.1372e-25),
            (22.216, 25.635, 27.531, 1.532, 0.000084),
            (21.037, 23.714, 24.311, 1.472, 0.000454),
            (29.200, 31.234, 35.334, 1.989, 6.8413e-8),
            (20.742, 22.891, 23.921, 1.121, None),
        ),
        "length": _rows(
            (4945.233, 5034.751, 5141.769, 52.138, 1.8643e-8),
            (5186.258, 5262.745, 5402.847, 103.700, 1.931e-7),
            (5166.254, 5219.564, 5287.889, 64.732, 2.6843e-12),
            (4998.402, 5048.473, 5109.630, 47.351, 4.2784e-6),
            (4804.200, 4841.964, 4897.646, 33.136, None),
        ),
        "inflections": _rows(
            (103, 115.46, 130, 12.568, 3.3506e-19),
            (136, 150.20, 184, 20.183, 1.746e-11),
            (106, 126.78, 154, 23.976, 8.1961e-21),
            (92, 104.76, 117, 10.806, 7.1776e-15),
            (74, 80.64, 93, 8.585, None),
        ),
    },
}
"""Tables 3 and 6: environment -> indicator -> algorithm."""


def _case(*rows: tuple[float, ...]) -> dict[str, dict[str, float]]:
    """The three rows of a case: indicator -> algorithm -> value."""
    return {
        metric: dict(zip(ALGORITHMS, row, strict=True))
        for metric, row in zip(METRICS, rows, strict=True)
    }


CASES = {
    "ordinary": {
        1: _case(
            (29.583, 11.176, 10.740, 13.823, 10.338),
            (1695.393, 1816.817, 1731.559, 1708.821, 1679.052),
            (56, 61, 52, 39, 35),
        ),
        2: _case(
            (25.235, 10.861, 9.198, 11.043, 8.977),
            (1468.860, 1647.985, 1502.314, 1532.208, 1443.670),
            (36, 54, 40, 32, 26),
        ),
        3: _case(
            (26.402, 12.400, 11.271, 13.043, 9.853),
            (1566.704, 1691.964, 1629.008, 1630.361, 1542.882),
            (51, 70, 49, 42, 34),
        ),
        4: _case(
            (21.743, 8.671, 8.231, 11.562, 8.174),
            (1230.362, 1339.065, 1276.521, 1298.388, 1210.675),
            (32, 44, 39, 29, 26),
        ),
    },
    "complex": {
        1: _case(
            (78.278, 25.680, 23.714, 31.564, 22.891),
            (5012.741, 5292.691, 5263.574, 5054.457, 4830.673),
            (107, 150, 106, 104, 79),
        ),
        2: _case(
            (66.327, 24.010, 23.207, 25.347, 22.355),
            (4051.769, 4511.827, 4309.645, 4109.230, 3989.236),
            (114, 146, 102, 99, 76),
        ),
        3: _case(
            (64.283, 25.738, 25.211, 28.576, 24.336),
            (4366.763, 4685.202, 4554.248, 4568.221, 4279.043),
            (99, 133, 110, 101, 84),
        ),
        4: _case(
            (92.273, 28.472, 27.393, 36.371, 26.284),
            (5264.147, 5668.923, 5554.954, 5461.986, 5093.817),
            (134, 180, 156, 143, 122),
        ),
    },
}
"""Tables 4 and 7: environment -> case -> indicator -> algorithm."""
