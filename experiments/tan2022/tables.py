"""Tables 2, 3 and 4 of Tan et al. 2022 on our maps."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from experiments.tan2022.episodes import Episodes, Plan, Results, Run
from experiments.tan2022.published import METHODS, METRICS, TABLE4_MAPS
from experiments.tan2022.readings import CASES, ONE_MAP_CASES, Case, Reading


@dataclass(frozen=True)
class Shown:
    """One map that a table and a figure show.

    Attributes:
        figure: number of the paper's figure that has this layout.
        case: radius and rate.
        job: number of the map in its sequence; as many were passed over before it.
        runs: method to the run that the episode is part of.
    """

    figure: int
    case: Case
    job: int
    runs: dict[str, Run]


def one_map(results: Results, plan: Plan, reading: Reading) -> list[Shown]:
    """Choose the map of Table 2 and Figs. 2 to 4: the first that suits all three radii.

    Returns:
        One entry per radius, or none where no map was found.
    """
    suits = np.logical_and.reduce(
        [both_reached(results, plan, reading, case) for case in ONE_MAP_CASES]
    )
    if not suits.any():
        return []
    job = int(suits.argmax())
    return [
        Shown(2 + i, case, job, runs_of(plan, reading, case))
        for i, case in enumerate(ONE_MAP_CASES)
    ]


def three_maps(results: Results, plan: Plan, reading: Reading) -> list[Shown]:
    """Choose the maps of Table 3 and Figs. 5 to 7: for each radius the first that suits.

    Radii with the same rate draw the same maps, so a map that is shown already is passed over.

    Returns:
        One entry per radius for which a map was found.
    """
    shown: list[Shown] = []
    for i, case in enumerate(CASES):
        suits = both_reached(results, plan, reading, case)
        suits[[other.job for other in shown]] = False
        if suits.any():
            job = int(suits.argmax())
            shown.append(Shown(5 + i, case, job, runs_of(plan, reading, case)))
    return shown


def both_reached(results: Results, plan: Plan, reading: Reading, case: Case) -> np.ndarray:
    """Which maps both methods reach the goal on, bool[n]."""
    runs = runs_of(plan, reading, case)
    return np.logical_and.reduce([results[run].reached for run in runs.values()])


def runs_of(plan: Plan, reading: Reading, case: Case) -> dict[str, Run]:
    """Return the run of each method."""
    return {method: plan.run(reading, case, method) for method in METHODS}


def single_maps(shown: Sequence[Shown], results: Results) -> list[dict[str, Any]]:
    """Return the rows of Table 2 or 3: one map each, with how many were passed over."""
    return [
        {
            "radius": entry.case.radius,
            "rate": entry.case.rate,
            "map": entry.job,
            "passed_over": entry.job,
            "values": {
                method: dict(zip(METRICS, _row(results[run], entry.job), strict=True))
                for method, run in entry.runs.items()
            },
        }
        for entry in shown
    ]


def _row(episodes: Episodes, job: int) -> list[float]:
    return [float(getattr(episodes, metric)[job]) for metric in METRICS]


def twenty_maps(results: Results, plan: Plan, reading: Reading) -> list[dict[str, Any]]:
    """Return Table 4: averages over the first 20 maps on which both methods succeed."""
    return [_average(results, plan, reading, case) for case in CASES]


def _average(results: Results, plan: Plan, reading: Reading, case: Case) -> dict[str, Any]:
    suits = np.flatnonzero(both_reached(results, plan, reading, case))
    jobs = suits[:TABLE4_MAPS]
    row: dict[str, Any] = {"radius": case.radius, "rate": case.rate, "maps": len(jobs)}
    if len(jobs) == 0:
        return {**row, "passed_over": plan.maps, "values": None, "change": None}
    tables = {
        method: results[run].table(jobs) for method, run in runs_of(plan, reading, case).items()
    }
    change = per_map_change(tables["traditional"], tables["improved"]).mean(axis=0)
    return {
        **row,
        "passed_over": int(jobs[-1]) + 1 - len(jobs),
        "values": {
            method: dict(zip(METRICS, map(float, table.mean(axis=0)), strict=True))
            for method, table in tables.items()
        },
        "change": dict(zip(METRICS, map(float, change), strict=True)),
    }


def per_map_change(traditional: np.ndarray, improved: np.ndarray) -> np.ndarray:
    """Change of each value from the traditional to the improved method, as a share of it."""
    change: np.ndarray = improved / traditional - 1.0
    return change


def everything_shown(results: Results, one: Plan, three: Plan, reading: Reading) -> Iterator[Shown]:
    """Yield the maps of Figs. 2 to 7 as far as they were found."""
    yield from one_map(results, one, reading)
    yield from three_maps(results, three, reading)
