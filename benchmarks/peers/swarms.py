"""What users minimise functions with today: mealpy, scikit-opt, and NumPy with runs side by side.

Each makes some runs of one swarm on the Sphere function in DIM dimensions and returns the least
values that it found. mealpy is no dependency of anything here, since it holds numpy below 1.27:
install it by hand to compare with it.
"""

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec

import numpy as np

from benchmarks.processes import FreshProcess

DIM, LOW, HIGH = 30, -100.0, 100.0
MEMBERS, ITERATIONS = 20, 200

Solver = Callable[[range], np.ndarray]


def sphere(x: np.ndarray) -> float:
    """The function as users write it."""
    return float(np.sum(x**2))


def mealpy_gwo(seeds: range) -> np.ndarray:
    """OriginalGWO of mealpy."""
    from mealpy import GWO, FloatVar

    problem = {
        "obj_func": sphere,
        "bounds": FloatVar(lb=[LOW] * DIM, ub=[HIGH] * DIM),
        "minmax": "min",
        "log_to": None,
    }
    solver = GWO.OriginalGWO(epoch=ITERATIONS, pop_size=MEMBERS)
    return np.array([solver.solve(problem, seed=seed).target.fitness for seed in seeds])


def scikit_opt_pso(seeds: range) -> np.ndarray:
    """PSO of scikit-opt, with the inertia and factors of Yu et al. 2022."""
    from sko.PSO import PSO

    found = []
    for seed in seeds:
        np.random.seed(seed)  # noqa: NPY002, it draws from the global generator
        swarm = PSO(
            sphere, DIM, pop=MEMBERS, max_iter=ITERATIONS, lb=LOW, ub=HIGH, w=0.4, c1=2, c2=2
        )
        swarm.run()
        found.append(float(np.squeeze(swarm.gbest_y)))
    return np.array(found)


def scikit_opt_ga(seeds: range) -> np.ndarray:
    """GA of scikit-opt, which codes numbers in bits."""
    from sko.GA import GA

    found = []
    for seed in seeds:
        np.random.seed(seed)  # noqa: NPY002, it draws from the global generator
        _, best = GA(sphere, DIM, MEMBERS, ITERATIONS, 0.01, LOW, HIGH, precision=1e-7).run()
        found.append(float(np.squeeze(best)))
    return np.array(found)


def numpy_gwo(seeds: range) -> np.ndarray:
    """Textbook grey wolves in NumPy, the runs side by side in one array."""
    rng = np.random.default_rng(seeds.start)
    runs = np.arange(len(seeds))
    x = rng.uniform(LOW, HIGH, (len(seeds), MEMBERS, DIM))
    kept_value, kept = np.full((len(seeds), 3), np.inf), np.zeros((len(seeds), 3, DIM))
    for t in range(ITERATIONS):
        values = np.concatenate([kept_value, np.sum(x**2, axis=2)], axis=1)
        order = np.argsort(values, axis=1)[:, :3]
        kept_value = np.take_along_axis(values, order, axis=1)
        kept = np.concatenate([kept, x], axis=1)[runs[:, None], order]
        a, moved = 2 - 2 * t / ITERATIONS, np.zeros_like(x)
        for k in range(3):
            leader = kept[:, k, None]
            distance = np.abs(2 * rng.random(x.shape) * leader - x)
            moved += leader - a * (2 * rng.random(x.shape) - 1) * distance
        x = np.clip(moved / 3, LOW, HIGH)
    return kept_value[:, 0]


SOLVERS: dict[str, Solver] = {
    "NumPy GWO, runs side by side": numpy_gwo,
    "scikit-opt PSO": scikit_opt_pso,
    "scikit-opt GA": scikit_opt_ga,
}
if find_spec("mealpy"):
    SOLVERS = {"mealpy OriginalGWO": mealpy_gwo, **SOLVERS}


class Crew:
    """Fresh processes that run the peers, one per core.

    Not those of multiprocessing: scikit-opt sets how processes are started when it is imported.
    """

    def __init__(self, cores: int):
        self.processes = [FreshProcess() for _ in range(cores)]

    def run(self, name: str, each: int) -> tuple[float, np.ndarray]:
        """Make `each` runs per process; the seconds of the slowest, and what all found."""
        shares = [range(k * each, (k + 1) * each) for k in range(len(self.processes))]
        with ThreadPoolExecutor(len(shares)) as pool:
            done = list(
                pool.map(lambda p, seeds: p.call(_work, name, seeds), self.processes, shares)
            )
        return max(seconds for seconds, _ in done), np.concatenate([best for _, best in done])

    def close(self) -> None:
        """End the processes."""
        for process in self.processes:
            process.__exit__(None, None, None)


def _work(name: str, seeds: range) -> tuple[float, np.ndarray]:
    began = time.perf_counter()
    best = SOLVERS[name](seeds)
    return time.perf_counter() - began, best
