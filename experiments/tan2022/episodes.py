"""The episodes that everything here rests on: as studies, and as what became of them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np

from experiments.runs import Found, Study
from experiments.tan2022.published import METHODS, METRICS
from experiments.tan2022.readings import Case, Reading
from usvjax.mission import Replayed
from usvkernels.status import Status

SEED = 2022
SHARD = 2000


class Asked(NamedTuple):
    """Episodes 0 to maps - 1 of both methods under a reading, at one radius.

    Attributes:
        role: what they are for, the same word at any size; what is asked for one role is asked on
            as many maps.
    """

    role: str
    maps: int
    reading: Reading
    case: Case


@dataclass(frozen=True)
class Episodes:
    """How some episodes of one method ended; numpy arrays [n].

    Attributes:
        status: `Status`.
        time: s.
        path_length: m.
        mean_speed: m/s.
    """

    status: np.ndarray
    time: np.ndarray
    path_length: np.ndarray
    mean_speed: np.ndarray

    def first(self, count: int) -> "Episodes":
        """Those on the first maps."""
        return Episodes(**{name: values[:count] for name, values in vars(self).items()})

    @property
    def reached(self) -> np.ndarray:
        """Which episodes reached the goal, bool[n]."""
        return self.status == int(Status.REACHED)

    def table(self, chosen: np.ndarray) -> np.ndarray:
        """Time, length and mean speed of the chosen episodes, float[n', 3]."""
        columns = [getattr(self, metric)[chosen] for metric in METRICS]
        return np.stack(columns, axis=-1).astype(np.float64)


Pair = Mapping[str, Episodes]
"""Method to its episodes, all on the same maps."""


def studies(asked: Iterable[Asked]) -> dict[str, Study]:
    """What to run: a study per role and method, since a method's own conditions differ.

    Of conditions that a method cannot tell apart one is run, on as many maps as any of them is
    asked for, in the role that asks for them first. There is one seed: job j is the same map
    everywhere.
    """
    most: dict[tuple[str, str], tuple[int, str, dict[str, Any]]] = {}
    for role, maps, reading, case in asked:
        for method in METHODS:
            settings = reading.settings(case, method)
            key = method, label_of(settings)
            if key not in most or most[key][0] < maps:
                most[key] = maps, role, settings
    conditions: dict[tuple[int, str, str], list[dict[str, Any]]] = {}
    for (method, label), (maps, role, settings) in most.items():
        conditions.setdefault((maps, role, method), []).append({"label": label, **settings})
    return {
        f"{method}, {role}": Study(
            {
                "name": method,
                "kind": "dwa",
                "seed": SEED,
                "episodes": maps,
                "shard": min(maps, SHARD),
                "methods": [method],
                "conditions": own,
            }
        )
        for (maps, role, method), own in conditions.items()
    }


def label_of(settings: Mapping[str, Any]) -> str:
    """Words for a condition that no other has."""
    return ", ".join(f"{key.partition('.')[2]} {value}" for key, value in sorted(settings.items()))


class Sailed:
    """What became of the episodes, by reading, case and method."""

    def __init__(self, found: Found) -> None:
        self._place = {
            (method, condition.label): ran
            for ran in found.studies.values()
            for method in ran.spec.methods
            for condition in ran.spec.conditions
        }

    def has(self, reading: Reading, case: Case) -> bool:
        """Whether both methods were run."""
        return all((m, label_of(reading.settings(case, m))) in self._place for m in METHODS)

    def one(self, reading: Reading, case: Case, method: str) -> Episodes:
        """All episodes of one method."""
        label = label_of(reading.settings(case, method))
        columns = self._place[method, label].columns(label, method)
        return Episodes(**{field.name: columns[field.name] for field in fields(Episodes)})

    def pair(self, reading: Reading, case: Case, improved: Reading | None = None) -> Pair:
        """The episodes of both methods, the improved one under another reading if one is given."""
        found = (
            self.one(reading, case, "traditional"),
            self.one(improved or reading, case, "improved"),
        )
        count = min(len(episodes.status) for episodes in found)
        return {m: episodes.first(count) for m, episodes in zip(METHODS, found, strict=True)}

    def replay(self, reading: Reading, case: Case, method: str, jobs: list[int]) -> Replayed:
        """Some episodes of one method, recorded."""
        label = label_of(reading.settings(case, method))
        return self._place[method, label].replay(label, method, jobs)


def common_table(pair: Pair) -> np.ndarray:
    """Values on the maps where both methods reach the goal, float[2, n, 3]."""
    both = both_reached(pair)
    return np.stack([pair[method].table(both) for method in METHODS])


def both_reached(pair: Pair) -> np.ndarray:
    """Which maps both methods reach the goal on, bool[n]."""
    both: np.ndarray = pair["traditional"].reached & pair["improved"].reached
    return both


def per_map_change(table: np.ndarray) -> np.ndarray:
    """Change of each value from the traditional to the improved method as a share, float[n, 3]."""
    change: np.ndarray = table[1] / table[0] - 1.0
    return change
