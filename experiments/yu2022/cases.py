"""Where the paper's targets are: Yu et al. 2022, Tables 1 and 5. The first is the start."""

import numpy as np

ORDINARY_SIDE = 50
"""Cells along a side of the map of Table 1."""
COMPLEX_SIDE = 100
"""Cells along a side of the map of Table 5."""


def _cells(text: str) -> np.ndarray:
    """Cells int[d, 2] as (x, y)."""
    numbers = np.array(text.split(), int)
    return numbers.reshape(-1, 2)


ORDINARY = {
    1: _cells("4 46  8 28  6 19  14 10  17 22  26 29  29 11  41 4  39 26  37 41"),
    2: _cells("37 26  38 3  26 9  11 8  2 18  3 24  6 27  16 28  25 32  36 30"),
    3: _cells("17 23  31 22  8 9  11 11  19 18  5 14  38 17  26 18  14 33  35 37"),
    4: _cells("26 24  13 31  6 9  15 7  12 28  33 24  6 4  36 33  16 37  6 13"),
}
"""Cases of Table 1; int[10, 2]."""

COMPLEX = {
    1: _cells(
        "4 9  39 8  65 16  75 26  93 9  89 53  95 70  82 74  88 95  52 72  "
        "68 69  65 55  58 35  43 42  30 42  35 82  8 91  5 54  18 40  25 25"
    ),
    2: _cells(
        "3 19  4 38  8 28  13 10  14 75  17 22  22 32  25 50  28 11  30 30  "
        "38 25  38 51  39 5  39 64  53 76  58 40  63 60  70 13  75 77  76 42"
    ),
    3: _cells(
        "17 54  56 82  21 25  26 28  31 10  30 72  36 15  36 36  40 92  45 34  "
        "98 72  56 23  53 54  49 29  60 61  67 20  69 77  74 37  23 58  93 61"
    ),
    4: _cells(
        "56 3  46 34  12 67  6 28  61 45  90 12  46 87  61 63  64 72  87 34  "
        "58 52  46 43  33 51  39 39  65 61  87 70  19 87  4 35  7 5  50 94"
    ),
}
"""Cases of Table 5; int[20, 2]."""

CASES = {
    **{f"ordinary {number}": cells for number, cells in ORDINARY.items()},
    **{f"complex {number}": cells for number, cells in COMPLEX.items()},
}
"""All eight by name."""
