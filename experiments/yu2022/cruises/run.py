"""Tables 3, 4, 6 and 7 and Figs. 6 to 15: all cases, all algorithms."""

from dataclasses import asdict

import numpy as np

import usvjax as uj
from experiments.files import progress
from experiments.yu2022.cruises import report
from experiments.yu2022.cruises.compare import compare, vary
from experiments.yu2022.cruises.figures import draw
from experiments.yu2022.cruises.runs import Plan, Results, Varied, sail_all, sail_varied, time_alone
from experiments.yu2022.cruises.verdicts import judge
from experiments.yu2022.parts import Part

REPEATS = 12
"""Cruises of each algorithm that are timed alone."""
SEARCHES = 1000
"""Runs of the search for the shortest tour."""
VARIED_RUNS = 50
CASE_RUNS, CASE_SWARM_RUNS = 200, 5
"""Runs in Cases 2 to 4, for which the paper gives one value each."""
QUICK_REPEATS = 3


def run(runs: int, swarm_runs: int, seed: int, quick: bool) -> Part:
    """Sail all cruises.

    Args:
        runs: of the algorithms that sail by D* Lite, in Case 1.
        swarm_runs: of Algorithms 1 to 3, in Case 1.
        seed: of maps, flips and swarms.
        quick: a few cruises of one case.
    """
    plan = Plan(
        runs=runs,
        swarm_runs=min(runs, swarm_runs),
        case_runs=min(runs, CASE_RUNS),
        case_swarm_runs=min(swarm_runs, CASE_SWARM_RUNS),
        varied_runs=min(runs, VARIED_RUNS),
        repeats=REPEATS,
        seed=seed,
    )
    if quick:
        few = min(runs, swarm_runs)
        plan = Plan(runs, few, runs, few, runs, QUICK_REPEATS, seed, (1,), ("ordinary",))
    with progress("cruises: batches", plan.total) as advance:
        results = sail_all(plan, advance)
        varied = sail_varied(plan, advance)
        seconds = time_alone(plan, advance)
    optima = {
        (environment.name, case): _shortest(environment.cases[case], seed)
        for environment, case in plan.chosen
    }
    found, flips = compare(results, optima, seconds), vary(varied)
    return Part(
        name="cruises",
        title="Whole cruises: Tables 3, 4, 6 and 7",
        found={"plan": asdict(plan), "cases": found, "flips": flips},
        verdicts=judge(found),
        note=report.note(asdict(plan)),
        summary=report.summary(found),
        readings=report.readings(asdict(plan)),
        text=report.section(found) + "\n\n" + report.flips(flips),
        figures=report.figures(found),
        draw=lambda into: draw(results, found, seed, into),
        counts=report.counts(asdict(plan)),
        done=f"{_cruises(results, varied):,} cruises",
    )


def _shortest(stations: np.ndarray, seed: int) -> float:
    """Length of the shortest tour, cells: exact for 10 stations, the best of many runs for 20."""
    return float(uj.solve_tour(stations, seed, runs=SEARCHES).length.min())


def _cruises(results: Results, varied: Varied) -> int:
    kinds = [algorithms for rows in varied.values() for algorithms in rows.values()]
    every = [own for sailed in [*results.values(), *kinds] for own in sailed.values()]
    return sum(len(own.complete) for own in every)
