"""Runs of every swarm on every function: the printed budget, longer ones, shifted functions."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import jax
import numpy as np

from experiments.parallel import on_own_devices
from experiments.yu2022.functions.published import ALGORITHMS, DIM, ITERATIONS, WOLVES
from usvjax.swarms.algorithms import ALGORITHMS as METHODS
from usvjax.swarms.minimising import MinimiseResult, minimise
from usvkernels.swarms.functions import TABLE_8, Shifted, shifted

WOLF_BUDGETS = (500, 1000, 1250, 2500, 5000)
"""Iterations of longer runs of the wolves, whose a(t) depends on their number."""
LONGEST = 5000
"""Iterations of one longer run of the others."""
SHIFT = 0.5
"""Most that the optimum is moved, as a share of the upper bound."""


@dataclass(frozen=True)
class Job:
    """Runs of one swarm on one function.

    Attributes:
        kind: "printed" (20 members, 200 iterations), "own" (the paper's settings of each),
            "shifted" (as printed, the optimum moved) or "longer".
        function: key of Table 8.
        algorithm: as `minimise` names it.
        population: members.
        iterations: number.
        runs: number.
    """

    kind: str
    function: str
    algorithm: str
    population: int
    iterations: int
    runs: int


Results = dict[Job, MinimiseResult]


def jobs_for(runs: int, longer_runs: int, quick: bool) -> list[Job]:
    """Everything that the report needs.

    Args:
        runs: on the printed budget.
        longer_runs: on longer ones.
        quick: one function and few budgets.
    """
    functions = ("f1",) if quick else tuple(TABLE_8)
    budgets = WOLF_BUDGETS[:2] if quick else WOLF_BUDGETS
    longest = budgets[-1] if quick else LONGEST
    jobs = []
    for function in functions:
        for algorithm in ALGORITHMS:
            method = METHODS[algorithm]
            job = partial(Job, function=function, algorithm=algorithm)
            jobs.append(job("printed", population=WOLVES, iterations=ITERATIONS, runs=runs))
            jobs.append(job("shifted", population=WOLVES, iterations=ITERATIONS, runs=runs))
            if (method.population, method.iterations) != (WOLVES, ITERATIONS):
                size = {"population": method.population, "iterations": method.iterations}
                jobs.append(job("own", runs=runs, **size))
            for iterations in budgets if algorithm in ("gwo", "igwo") else (longest,):
                jobs.append(
                    job("longer", population=WOLVES, iterations=iterations, runs=longer_runs)
                )
    return jobs


def run_all(jobs: Sequence[Job], seed: int, advance: Callable[[int], None]) -> Results:
    """Run all jobs in float64, the devices side by side.

    Args:
        jobs: what to run.
        seed: of the draws, the same for all.
        advance: called with 1 after each.
    """

    def work(job: Job) -> MinimiseResult:
        found = run_job(job, seed)
        advance(1)
        return found

    results: Results = {}
    for function in dict.fromkeys(job.function for job in jobs):
        chosen = [job for job in jobs if job.function == function]
        done = on_own_devices([partial(work, job) for job in chosen])
        results.update(zip(chosen, done, strict=True))
        # A process can hold only so many programs.
        jax.clear_caches()
    return results


def run_job(job: Job, seed: int) -> MinimiseResult:
    """Run one in float64: the published values lie far below the least float32."""
    function = TABLE_8[job.function]
    fn = function.fn if job.kind != "shifted" else moved(job.function, seed)
    return minimise(
        fn,
        function.bounds,
        seed,
        algorithm=job.algorithm,
        dim=DIM,
        runs=job.runs,
        population=job.population,
        iterations=job.iterations,
        dtype="float64",
    )


def moved(name: str, seed: int) -> Shifted:
    """The function with its optimum at a random point, drawn once for all swarms."""
    function = TABLE_8[name]
    rng = np.random.default_rng([seed, int(name[1:])])
    return shifted(function.fn, SHIFT * function.bounds[1] * rng.uniform(-1, 1, DIM))
