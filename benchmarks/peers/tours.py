"""What users order stations with today: scikit-opt, python-tsp and LKH by elkai.

Each takes distances float[n, d, d] and returns the lengths of the tours that it found. python-tsp
is no dependency of anything here: install it by hand to compare with it.
"""

import contextlib
import io
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec

import numpy as np

from benchmarks.processes import FreshProcess

Solver = Callable[[np.ndarray], list[float]]


def closed_length(order: np.ndarray, distances: np.ndarray) -> float:
    """Of a closed tour."""
    return float(distances[order, np.roll(order, -1)].sum())


def _measure(table: np.ndarray) -> Callable[[np.ndarray], float]:
    """A function of one argument, which is how scikit-opt knows that it takes a whole tour."""
    return lambda order: closed_length(np.asarray(order, int), table)


def _of_scikit_opt(name: str, most: int, **options: float) -> Solver:
    """An algorithm of scikit-opt; its own defaults but for what is given."""

    def solve(tables: np.ndarray) -> list[float]:
        from sko.ACA import ACA_TSP
        from sko.GA import GA_TSP

        vars(np).setdefault("int", int)  # its ants use a name that NumPy has dropped
        made = {"ga": GA_TSP, "aca": ACA_TSP}[name]
        found = []
        for table in tables:
            search = made(
                _measure(table),
                n_dim=len(table),
                max_iter=most,
                **({"distance_matrix": table} if name == "aca" else {}),
                **options,
            )
            with contextlib.redirect_stdout(io.StringIO()):
                order, _ = search.run()
            found.append(closed_length(np.asarray(order, int), table))
        return found

    return solve


def python_tsp_two_opt(tables: np.ndarray) -> list[float]:
    """Local search of python-tsp by 2-opt, from a random tour."""
    from python_tsp.heuristics import solve_tsp_local_search

    orders = [solve_tsp_local_search(table, perturbation_scheme="two_opt")[0] for table in tables]
    return [closed_length(np.array(o), t) for o, t in zip(orders, tables, strict=True)]


def python_tsp_annealing(tables: np.ndarray) -> list[float]:
    """Simulated annealing of python-tsp."""
    from python_tsp.heuristics import solve_tsp_simulated_annealing

    orders = [solve_tsp_simulated_annealing(table)[0] for table in tables]
    return [closed_length(np.array(o), t) for o, t in zip(orders, tables, strict=True)]


def lin_kernighan(tables: np.ndarray) -> list[float]:
    """LKH (C) by elkai, one run, on distances in thousandths."""
    import elkai

    found = []
    for table in tables:
        whole = elkai.DistanceMatrix(np.round(1000 * table).astype(int).tolist())
        found.append(closed_length(np.array(whole.solve_tsp(runs=1)[:-1]), table))
    return found


SOLVERS: dict[str, Solver] = {
    "LKH (elkai, C)": lin_kernighan,
    "scikit-opt, GA_TSP": _of_scikit_opt("ga", 200),
    "scikit-opt, ACA_TSP": _of_scikit_opt("aca", 20, size_pop=20),
}
"""scikit-opt's ants with the tenth part of its example's iterations: they take minutes else."""
if find_spec("python_tsp"):
    SOLVERS = {
        "python-tsp, 2-opt": python_tsp_two_opt,
        "python-tsp, annealing": python_tsp_annealing,
        **SOLVERS,
    }


class Crew:
    """Processes that search for the peers, one per core.

    Not of multiprocessing, whose start method scikit-opt wants to set itself.
    """

    def __init__(self, cores: int):
        self._stack = contextlib.ExitStack()
        self.members = [self._stack.enter_context(FreshProcess()) for _ in range(cores)]

    def run(self, name: str, tables: np.ndarray) -> tuple[float, list[float]]:
        """Solve every problem; the seconds of the slowest process, and all lengths."""
        shares = np.array_split(tables, len(self.members))
        with ThreadPoolExecutor(len(shares)) as threads:
            done = list(threads.map(lambda m, s: m.call(work, name, s), self.members, shares))
        return max(seconds for seconds, _ in done), [x for _, lengths in done for x in lengths]

    def close(self) -> None:
        """End the processes."""
        self._stack.close()


def work(name: str, tables: np.ndarray) -> tuple[float, list[float]]:
    """Solve every problem in this process; the seconds, and all lengths."""
    solve = SOLVERS[name]
    solve(tables[:1])  # imports and compiles
    began = time.perf_counter()
    found = solve(tables)
    return time.perf_counter() - began, found
