"""The numbers of Yu et al. 2022 against each other: Tables 3, 4, 6, 7 and 9."""

import math
from collections.abc import Iterator

from scipy import stats

from experiments.claims import Check
from experiments.yu2022.cruises.published import (
    ALGORITHMS,
    CASES,
    METRICS,
    PROPOSED,
    RUNS,
    STATISTICS,
    Statistics,
)
from experiments.yu2022.cruises.runs import ENVIRONMENTS
from experiments.yu2022.functions import published as functions
from usvjax.report.numbers import number

_NAMES = {"planning_time": "planning time", "length": "length", "inflections": "inflection points"}
_ROUNDED = 0.0005
"""Of means, best, worst and deviations of Tables 3 and 6, which have three decimals."""
_SAME_P = 0.05
"""Relative difference within which two p count as the same."""


def checks() -> list[Check]:
    """All of them; bounds are derived where they are used."""
    found: list[Check] = []
    for environment, table in STATISTICS.items():
        first, second = ENVIRONMENTS[environment].tables
        for metric in METRICS:
            for name in ALGORITHMS:
                row = table[metric][name]
                where = f"Table {first}, {_NAMES[metric]}, {name.upper()}"
                found.extend(_row(where, row))
                if metric == "inflections":
                    found.append(_whole(where, row))
                if name != PROPOSED:
                    found.append(_p(where, row, table[metric][PROPOSED]))
                single = CASES[environment][1][metric][name]
                where = f"Table {second}, Case 1, {_NAMES[metric]}, {name.upper()}"
                found.append(_within(where, single, row, first))
    return [*found, *_functions()]


def _row(where: str, row: Statistics) -> Iterator[Check]:
    """Mean and deviation of n values between the best a and the worst b, both of which occur.

    The deviation is largest where all values lie at an end, which with the mean m gives
    sqrt((b - m) (m - a) n / (n - 1)), and least where all but one at each end lie at what the
    mean leaves for them.
    """
    a, m, b, n = row.best, row.mean, row.worst, RUNS
    yield Check(
        f"{where}: mean",
        number(m),
        f"between {number(a)} and {number(b)}",
        "agrees" if a <= m <= b else "contradicts",
    )
    most = math.sqrt((b - m) * (m - a) * n / (n - 1))
    rest = (n * m - a - b) / (n - 2)
    least = math.sqrt(((a - m) ** 2 + (b - m) ** 2 + (n - 2) * (rest - m) ** 2) / (n - 1))
    # By as much as rounding of the mean and both ends may move the bounds.
    slack = _ROUNDED * (1 + n * (b - a) / most / (n - 1))
    fits = least - slack <= row.std <= most + slack
    yield Check(
        f"{where}: standard deviation",
        number(row.std),
        f"{number(least)} to {number(most)} by best, mean and worst of {n} runs",
        "agrees" if fits else "contradicts",
    )


def _whole(where: str, row: Statistics) -> Check:
    """A mean of whole numbers is a whole number of n-ths, here to three decimals."""
    nearest = round(row.mean * RUNS) / RUNS
    return Check(
        f"{where}: mean of whole numbers",
        number(row.mean),
        f"{nearest:.3f}, a whole number of {RUNS}ths",
        "agrees" if abs(nearest - row.mean) <= _ROUNDED else "contradicts",
    )


def _p(where: str, row: Statistics, proposed: Statistics) -> Check:
    """P of a t-test from the printed means and deviations.

    Pairs that correlate in any way have a deviation of differences between the difference and the
    sum of both; a test of one sample against the other's mean takes the deviation of one of them.
    The least p is that of a one-sided test.
    """
    assert row.p is not None
    samples = (row.mean, row.std, RUNS, proposed.mean, proposed.std, RUNS)
    welch, pooled = (
        float(stats.ttest_ind_from_stats(*samples, equal_var=equal).pvalue)
        for equal in (False, True)
    )
    t = math.sqrt(RUNS) * abs(row.mean - proposed.mean)
    spreads = (abs(row.std - proposed.std), row.std, proposed.std)
    low = float(stats.t.sf(t / min(spreads), RUNS - 1))
    high = 2 * float(stats.t.sf(t / (row.std + proposed.std), RUNS - 1))
    if any(abs(row.p / own - 1) <= _SAME_P for own in (welch, pooled)):
        verdict = "agrees"
    else:
        verdict = "can agree" if low <= row.p <= high else "contradicts"
    recomputed = (
        f"{welch:.2g} (Welch), {pooled:.2g} (equal variances), {low:.2g} to {high:.2g} (pairs or "
        "one sample, any correlation, one- or two-sided)"
    )
    return Check(f"{where}: p", f"{row.p:g}", recomputed, verdict)


def _within(where: str, single: float, row: Statistics, table: str) -> Check:
    """The run of Table 4 or 7 may be one of the 50 of Table 3 or 6; it need not be."""
    fits = row.best <= single <= row.worst
    return Check(
        where,
        number(single),
        f"{number(row.best)} to {number(row.worst)} in {RUNS} runs of Table {table}",
        "agrees" if fits else "can agree",
    )


def _functions() -> Iterator[Check]:
    """Deviation over mean of n values of at least 0 is at most sqrt(n).

    It is largest where all values but one are 0: the sum of squares about the mean m is then
    (n m - m)^2 + (n - 1) m^2 = n (n - 1) m^2, and n - 1 stands below it.
    """
    most = math.sqrt(functions.RUNS)
    for function, means in functions.MEAN.items():
        for name, mean in means.items():
            std = functions.STD[function][name]
            ratio = std / mean if mean else 0.0
            yield Check(
                f"Table 9, {function}, {name.upper()}: standard deviation over mean",
                f"{std:g} / {mean:g}",
                f"{ratio:.2f}; at most {most:.2f} for {functions.RUNS} values of at least 0",
                "agrees" if ratio <= most * 1.01 and (mean or not std) else "contradicts",
            )
