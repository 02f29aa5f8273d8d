"""The mission "yu2022_swarms": swarms that minimise the test functions of Table 8."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np

import usvjax as uj
from experiments.missions import PaperMission
from experiments.yu2022.functions.published import DIM
from usvjax.checks import one_of, whole_number
from usvjax.mission import Case, Files, Ground, Metric, Outcome, Recording, Track
from usvjax.sections import Table
from usvjax.swarms import AcoParams, CmpsoParams, GaParams, GwoParams, GwoStatic
from usvjax.swarms.algorithms import ALGORITHMS
from usvjax.tables import read_table
from usvkernels.status import Status
from usvkernels.swarms.functions import TABLE_8, Shifted, shifted

MARKS = 40
"""The least value so far is kept at so many even shares of the iterations."""
SHIFT = 0.5
"""Most that the optimum is moved, as a share of the upper bound."""
SETTINGS: dict[str, dict[str, dict[str, Any]]] = {
    "tuned": {},
    "other": {
        "aco": {"params": AcoParams(locality=1e-4)},
        "ga": {"params": GaParams(blend=0.5)},
        "cmpso": {"params": CmpsoParams(max_speed=0.5)},
        "gwo": {"static": GwoStatic(leaders="pack")},
        "igwo": {
            "params": GwoParams(lambda1=2.0),
            "static": GwoStatic(law="beta", leaders="pack"),
        },
    },
}
"""What the paper does not print: of the baselines chosen by results on f1 and f4, or otherwise: q
of Socha and Dorigo (2008), BLX-0.5 of Eshelman and Schaffer (1993), the greatest speed as far as
from the middle to a bound; wolves led by the best of the pack as it is; and t of Eq. 14 counted
from 1, which is one more of lambda1."""


@dataclass(frozen=True)
class SwarmTable:
    """What is minimised, and how.

    Attributes:
        function: key of Table 8.
        moved: whether its optimum is moved away from the origin, to the same point for all runs.
        population: members; the paper's of each swarm when left out.
        iterations: number; the paper's of each swarm when left out.
        settings: "tuned" or "other", of what the paper does not print.
    """

    function: str = "f1"
    moved: bool = False
    population: int | None = None
    iterations: int | None = None
    settings: str = "tuned"


@dataclass(frozen=True)
class Runs:
    """Runs of some jobs.

    Attributes:
        table: what is minimised, and how.
        seed: of the study.
        jobs: int64[J], numbers of the runs.
    """

    table: SwarmTable
    seed: int
    jobs: np.ndarray


class SwarmMission(PaperMission):
    """Minimise; see `usvjax.mission.Mission`."""

    tables = MappingProxyType({"swarm": Table("what is minimised, and how", {"": SwarmTable})})
    methods = MappingProxyType(
        {"aco": "ACO", "ga": "GA", "cmpso": "CMPSO", "gwo": "GWO", "igwo": "IGWO (proposed)"}
    )
    metrics = (
        Metric("best", "", "Least value", double=True),
        Metric("evaluations", "", "Evaluations", integer=True, summarised=False),
        *(
            Metric(f"at_{mark}", "", f"After {mark}/{MARKS}", double=True, summarised=False)
            for mark in range(1, MARKS + 1)
        ),
    )
    endings = (Status.FOUND,)

    def case(self, tables: Mapping[str, Mapping[str, Any]], files: Files) -> Case:
        """Check one condition; see `Mission.case`."""
        where = files.table("swarm")
        table = read_table(SwarmTable, tables["swarm"], where)
        one_of(f"{where}: 'function'", table.function, TABLE_8)
        one_of(f"{where}: 'settings'", table.settings, SETTINGS)
        for name in ("population", "iterations"):
            if getattr(table, name) is not None:
                whole_number(f"{where}: {name!r}", getattr(table, name), 1)
        return Case({"swarm": asdict(table)}, {}, table)

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> Runs:
        """Nothing is drawn before the swarms draw; see `Mission.pose`."""
        return Runs(case.given, seed, jobs)

    def run(self, scene: Runs, method: str, record: bool = False) -> Outcome:
        """Minimise in double precision: the published values lie far below the least float32."""
        table, jobs = scene.table, scene.jobs
        function = TABLE_8[table.function]
        first = int(jobs.min())
        found = uj.minimise(
            moved(table.function, scene.seed) if table.moved else function.fn,
            function.bounds,
            scene.seed,
            algorithm=method,
            dim=DIM,
            runs=int(jobs.max()) + 1 - first,
            first=first,
            population=table.population,
            iterations=table.iterations,
            dtype="float64",
            **SETTINGS[table.settings].get(method, {}),
        )
        history = found.history[jobs - first]
        columns = {
            "status": np.full(len(jobs), int(Status.FOUND)),
            "best": history[:, -1],
            "evaluations": np.full(len(jobs), found.evaluations),
        }
        for mark in range(1, MARKS + 1):
            columns[f"at_{mark}"] = history[:, iteration_at(mark, history.shape[1]) - 1]
        return Outcome(columns, _recorded(history) if record else None)


MISSION = SwarmMission()
assert set(MISSION.methods) == set(ALGORITHMS)


def iteration_at(mark: int, iterations: int) -> int:
    """The iteration, from 1, at whose end the value of a mark is taken."""
    return max(1, round(mark * iterations / MARKS))


@cache
def moved(name: str, seed: int) -> Shifted:
    """The function with its optimum at a random point, drawn once for all swarms."""
    function = TABLE_8[name]
    rng = np.random.default_rng([seed, int(name[1:])])
    return shifted(function.fn, SHIFT * function.bounds[1] * rng.uniform(-1, 1, DIM))


def _recorded(history: np.ndarray) -> Recording:
    """The least value so far, as a track along x."""
    nowhere = Ground(None, np.empty((0, 2)), 0.0, {})
    along = np.arange(history.shape[1], dtype=float)
    tracks = [
        Track(along, "s", np.stack([values, np.zeros_like(values)], axis=-1)[:, None])
        for values in history
    ]
    return Recording((nowhere,) * len(history), tuple(tracks), history)
