"""What Yu et al. 2022 say of their swarm, put to the test: Table 9, Figs. 2 and 16."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from experiments.claims import Claim, Finding, Numbers
from experiments.yu2022.functions.compare import EXPERIMENTS, OF_EACH
from experiments.yu2022.functions.mission import MISSION
from experiments.yu2022.functions.published import ITERATIONS, LAMBDAS, MEAN, RUNS, STD
from experiments.yu2022.functions.runs import ALGORITHMS
from usvjax.report.numbers import percent
from usvkernels.swarms.functions import TABLE_8

LEAST_RUNS = 20
TOO_FEW = "too few runs"
SURE = 0.95
"""Share of experiments from which on what is said of one holds; it fails below 1 - SURE."""
NEAR_ZERO = 0.01
"""Share of its first value to which a(t) must have fallen to "tend to 0"."""
ON_BUDGET = {
    "20 members, 200 iterations": "budget",
    "what is not printed set otherwise": "other",
}
READINGS = {**ON_BUDGET, "the paper's own settings": "own"}
FROM_ZERO, FROM_ONE = "t from 0", "t from 1"

Rows = Mapping[str, Any]


def claims(numbers: Numbers) -> list[Claim]:
    """Every claim about the functions."""
    drawn = (
        f"{EXPERIMENTS:,} experiments of {RUNS} runs each are drawn from our runs, with "
        "replacement, so that errors are as near as our runs show what is rare; "
    )
    often = (
        f"the claim holds where it does in {100 * SURE:g} % of them or more, and fails where in "
        f"{100 * (1 - SURE):.0f} % or fewer: so rarely an experiment like the paper's would find "
        "otherwise"
    )
    found = []
    for function in numbers["functions"]:
        name = f"{function}, {TABLE_8[function].name}"
        means, spreads = (
            ", ".join(f"{table[function][key]:.2e}" for key in ALGORITHMS) for table in (MEAN, STD)
        )
        level = (
            f"excluded where a published mean lies outside of all but {100 * OF_EACH:g} % of "
            f"their means; five true ones would be in about {100 * len(ALGORITHMS) * OF_EACH:g} % "
            "at most"
        )
        lowest = f"lowest after a quarter, half and all of the iterations; {often}"
        least, curve = "the least mean", "the lowest mean curve"
        leads = [partial(_leads, what) for what in ("mean", "std", "curve")]
        questions: list[tuple[Callable[[Rows, str], Finding], str, str, str, dict[str, str]]] = [
            (_level, "the means of all five", means, level, READINGS),
            (leads[0], "the proposed one finds least", least, often, READINGS),
            (leads[1], "the proposed one scatters least", spreads, often, READINGS),
            (leads[2], "the proposed one converges fastest", curve, lowest, ON_BUDGET),
        ]
        found += [
            Claim(
                f"{'Fig. 16' if published == curve else 'Table 9'}, {name}: {text}",
                published,
                partial(_of, function, decide),
                given,
                test=drawn + test,
                weak=decide is _level,
            )
            for decide, text, published, test, given in questions
        ]
    return found + _laws()


def _of(
    function: str, decide: Callable[[Rows, str], Finding], numbers: Numbers, kind: str
) -> Finding:
    if numbers["runs"] < LEAST_RUNS:
        return Finding(None, TOO_FEW)
    return decide({**numbers["functions"][function], "function": function}, kind)


def rows_of(table: Rows, kind: str) -> dict[str, Any]:
    """Rows of a reading; where an algorithm has no settings of its own, those of the budget."""
    return {name: table[kind].get(name, table["budget"][name]) for name in ALGORITHMS}


def _level(table: Rows, kind: str) -> Finding:
    """Hold where every published mean may be a mean of ours."""
    published = MEAN[table["function"]]
    within = table["experiments"][kind]["means"]
    holds = all(low <= published[name] <= high for name, (low, high) in within.items())
    ours = [row["printed"]["mean"] for row in rows_of(table, kind).values()]
    return Finding(holds, ", ".join(f"{mean:.2g}" for mean in ours))


def _leads(what: str, table: Rows, kind: str) -> Finding:
    """Hold where the proposed one comes first in nearly all experiments."""
    share = table["experiments"][kind][what]
    word = "std" if what == "std" else "mean"
    values = {name: row["all"][word] for name, row in rows_of(table, kind).items()}
    first = min(values, key=lambda name: values[name])
    numbers = f"in {percent(share, 1)} % of experiments"
    if what != "curve":
        numbers += f"; least {MISSION.methods[first]} {values[first]:.2g}"
    holds = True if share >= SURE else False if share <= 1 - SURE else None
    return Finding(holds, numbers)


def _laws() -> list[Claim]:
    chosen = f"{LAMBDAS[0]:g}, {LAMBDAS[1]:g}"
    readings = {
        FROM_ZERO: lambda numbers: numbers["laws"][chosen],
        FROM_ONE: lambda numbers: numbers["law_from_one"],
    }
    return [
        Claim(
            "Fig. 2: a(t) of Eq. 14 tends to 0 at the last iteration",
            f"nearly 0 after {ITERATIONS}",
            _tends_to_zero,
            readings,
            test=f"a has fallen to {100 * NEAR_ZERO:g} % of its first value or less, a threshold "
            "of ours; what is found says how far it could move; computed, without error",
        ),
        Claim(
            "Fig. 2: a(t) of Eq. 14 falls faster than Eq. 2",
            "the convergence speed of a is faster",
            _falls_faster,
            readings,
            test="it is half of its first value sooner; computed, without error",
        ),
    ]


def _tends_to_zero(numbers: Numbers, of: Callable[[Numbers], Rows]) -> Finding:
    row = of(numbers)
    share = row["last"] / row["first"]
    return Finding(
        share <= NEAR_ZERO,
        f"{row['first']:.2f} at first, {row['sixth']:.2f} after five iterations, "
        f"{row['last']:.2f} at the end, {percent(share, 0)} % of the first",
    )


def _falls_faster(numbers: Numbers, of: Callable[[Numbers], Rows]) -> Finding:
    halved = of(numbers)["halved"]
    return Finding(halved is not None and halved < ITERATIONS / 2, f"after {halved} iterations")
