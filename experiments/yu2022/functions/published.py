"""What Yu et al. 2022 print about the swarms on test functions: Tables 8 and 9, section 5.3."""

PROPOSED = "igwo"

RUNS = 30
WOLVES, ITERATIONS = 20, 200  # Table 2
DIM = 30  # Table 8

MEAN = {
    "f1": {"aco": 4.62e-16, "ga": 5.01e-22, "cmpso": 2.58e-43, "gwo": 1.21e-69, "igwo": 3.23e-93},
    "f2": {"aco": 9.28e-20, "ga": 9.31e-42, "cmpso": 9.35e-77, "gwo": 3.66e-135, "igwo": 7.57e-191},
    "f3": {"aco": 1.24e-2, "ga": 5.78e-4, "cmpso": 6.95e-9, "gwo": 1.71e-15, "igwo": 0.0},
    "f4": {"aco": 5.32e-7, "ga": 4.23e-9, "cmpso": 1.09e-24, "gwo": 9.54e-34, "igwo": 1.95e-49},
}
"""Table 9."""
STD = {
    "f1": {"aco": 3.49e-16, "ga": 1.87e-22, "cmpso": 2.12e-43, "gwo": 7.38e-69, "igwo": 4.66e-93},
    "f2": {"aco": 5.72e-20, "ga": 7.63e-42, "cmpso": 6.27e-77, "gwo": 2.98e-135, "igwo": 8.43e-191},
    "f3": {"aco": 9.36e-2, "ga": 2.33e-4, "cmpso": 3.25e-9, "gwo": 0.62e-15, "igwo": 0.0},
    "f4": {"aco": 7.14e-7, "ga": 2.11e-9, "cmpso": 1.87e-24, "gwo": 6.03e-34, "igwo": 5.82e-49},
}
"""Table 9."""

MU = (0.01, 0.1)  # Table 2
LAMBDAS = (1.0, 0.1)  # Table 2
