"""What holds of Table 9, Fig. 2 and Fig. 16 of Yu et al. 2022."""

from collections.abc import Callable, Mapping
from typing import Any

from experiments.verdicts import Finding, Verdict
from experiments.yu2022.functions.compare import CHECKPOINTS
from experiments.yu2022.functions.published import ALGORITHMS, ITERATIONS, LAMBDAS, MEAN, PROPOSED
from experiments.yu2022.parts import verdict
from usvkernels.swarms.functions import TABLE_8

FACTOR = 10.0
"""Up to which ours and the published mean are of one order."""
LEAST_RUNS = 20
TOO_FEW = "too few runs"
NEAR_ZERO = 0.02
"""Share of its first value to which a(t) must have fallen to "tend to 0"."""
READINGS = {"printed": "20 members, 200 iterations", "own": "the paper's own settings"}

Rows = Mapping[str, Any]


def judge(found: Mapping[str, Any]) -> list[Verdict]:
    """Judge every claim.

    Args:
        found: of `compare`.
    """
    verdicts = []
    for function, tables in found["functions"].items():
        name = f"{function}, {TABLE_8[function].name}"
        means = ", ".join(f"{MEAN[function][key]:.2g}" for key in ALGORITHMS)
        claims: list[tuple[str, str, Callable[[str, Rows], Finding]]] = [
            (f"Table 9, {name}: the means of all five", means, _level),
            (f"Table 9, {name}: the proposed one finds least", "the least mean", _least),
        ]
        for claim, published, decide in claims:
            findings = {
                label: decide(function, rows_of(tables, kind)) for kind, label in READINGS.items()
            }
            verdicts.append(verdict(claim, published, findings))
        verdicts.append(
            verdict(
                f"Fig. 16, {name}: the proposed one converges fastest",
                "the lowest curve",
                {READINGS["printed"]: _fastest(tables["printed"])},
            )
        )
    return [*verdicts, _law(found["laws"])]


def rows_of(tables: Rows, kind: str) -> dict[str, Any]:
    """Rows of a reading; where an algorithm has no settings of its own, those of the budget."""
    return {name: tables.get(kind, {}).get(name, tables["printed"][name]) for name in ALGORITHMS}


def _enough(rows: Rows) -> bool:
    return all(row["printed"]["n"] >= LEAST_RUNS for row in rows.values())


def _level(function: str, rows: Rows) -> Finding:
    """Hold when every mean lies within a factor of the published one."""
    if not _enough(rows):
        return Finding(None, TOO_FEW)
    ours = {name: row["printed"]["mean"] for name, row in rows.items()}
    near = all(
        MEAN[function][name] / FACTOR <= mean <= MEAN[function][name] * FACTOR
        for name, mean in ours.items()
    )
    return Finding(near, ", ".join(f"{mean:.2g}" for mean in ours.values()))


def _least(_: str, rows: Rows) -> Finding:
    if not _enough(rows):
        return Finding(None, TOO_FEW)
    means = {name: row["printed"]["mean"] for name, row in rows.items()}
    return _ranked(means)


def _ranked(values: Mapping[str, float]) -> Finding:
    order = sorted(values, key=lambda name: values[name])
    place = order.index(PROPOSED) + 1
    best = f"{ALGORITHMS[order[0]]} {values[order[0]]:.2g}"
    return Finding(place == 1, f"place {place} of {len(order)}; first {best}")


def _fastest(rows: Rows) -> Finding:
    """Hold when its median is the lowest early, half-way and at the end."""
    if not _enough(rows):
        return Finding(None, TOO_FEW)
    places = []
    for mark in CHECKPOINTS:
        values = {name: row["at"][str(mark)] for name, row in rows.items()}
        places.append(sorted(values, key=lambda name: values[name]).index(PROPOSED) + 1)
    at = ", ".join(map(str, CHECKPOINTS))
    return Finding(
        all(place == 1 for place in places),
        f"place {', '.join(map(str, places))} after {at} iterations",
    )


def _law(laws: Rows) -> Verdict:
    row = laws[f"{LAMBDAS[0]:g}, {LAMBDAS[1]:g}"]
    numbers = f"{row['first']:.2f} at first, {row['sixth']:.2f} after five iterations, "
    numbers += f"{row['last']:.2f} at the end"
    return verdict(
        "Fig. 2: a(t) of Eq. 14 tends to 0 at the last iteration",
        f"nearly 0 after {ITERATIONS}",
        {"Eq. 14 with the printed factors": Finding(row["last"] < NEAR_ZERO * 2, numbers)},
    )
