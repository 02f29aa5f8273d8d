"""Which reading, or pair of readings, comes nearest to Table 4; after the fact, none tuned."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp, inf
from typing import Any

import numpy as np

from experiments.tan2022.episodes import Episodes, common_table, label_of
from experiments.tan2022.published import METHODS, METRICS, TABLE4
from experiments.tan2022.readings import CASES, Reading

LEAST_COMMON = 10
"""Maps on which both methods must succeed, at each radius, for an average worth ranking."""
TOP = 12
"""Lines of the ranking that are reported of each kind."""

Outcomes = Mapping[tuple[Reading, str], Sequence[Episodes]]
"""(reading, method) to its episodes in each of `CASES`, all on the same maps."""


@dataclass(frozen=True)
class Match:
    """Averages over the maps on which both methods succeed, beside Table 4's.

    Attributes:
        traditional, improved: labels of the readings that the methods follow.
        common: such maps at each radius.
        values: float[3 radii, 2 methods, 3 metrics], s, m, m/s; NaN where there is none.
        distance: root mean square of ln(ours / published) over the 18 averages; inf where
            fewer than `LEAST_COMMON` maps are behind one.
    """

    traditional: str
    improved: str
    common: tuple[int, ...]
    values: np.ndarray
    distance: float

    @property
    def is_hybrid(self) -> bool:
        """Whether the two methods follow different readings."""
        return self.traditional != self.improved

    def line(self) -> dict[str, Any]:
        """For results.json; the distance as a factor: at 1.2, ours are typically 20 % off."""
        return {
            "traditional": self.traditional,
            "improved": self.improved,
            "common": self.common,
            "values": self.values.tolist(),
            "typical_factor": exp(self.distance),
        }


def ranking(readings: Sequence[Reading], outcomes: Outcomes) -> dict[str, Any]:
    """The nearest readings and the nearest hybrids, and how many there are."""
    ranked = [found for found in rank(readings, outcomes) if found.distance < inf]
    return {
        "readings": len(readings),
        "ranked": len(ranked),
        "single": [found.line() for found in ranked if not found.is_hybrid][:TOP],
        "hybrid": [found.line() for found in ranked if found.is_hybrid][:TOP],
    }


def rank(readings: Sequence[Reading], outcomes: Outcomes) -> list[Match]:
    """Compare every reading, and every pair of readings of the same task, with Table 4.

    Returns:
        The nearest first; those with too few common successes last.
    """
    matches = [
        match(old.label, new.label, outcomes[old, "traditional"], outcomes[new, "improved"])
        for old, new in pairs(readings)
    ]
    return sorted(matches, key=lambda found: (found.distance, found.is_hybrid))


def match(
    traditional: str, improved: str, old: Sequence[Episodes], new: Sequence[Episodes]
) -> Match:
    """Compare one pair of readings with Table 4."""
    tables = [
        common_table(dict(zip(METHODS, both, strict=True))) for both in zip(old, new, strict=True)
    ]
    counts = tuple(table.shape[1] for table in tables)
    shape = len(METHODS), len(METRICS)
    values = np.stack(
        [table.mean(axis=1) if table.shape[1] else np.full(shape, np.nan) for table in tables]
    )
    distance = inf
    if min(counts) >= LEAST_COMMON:
        distance = float(np.sqrt(np.mean(np.log(values / _published()) ** 2)))
    return Match(traditional, improved, counts, values, distance)


def _published() -> np.ndarray:
    """Table 4 as float[3 radii, 2 methods, 3 metrics]."""
    table = [[TABLE4.values[method, metric] for metric in METRICS] for method in METHODS]
    return np.moveaxis(np.asarray(table), -1, 0)


def pairs(readings: Sequence[Reading]) -> list[tuple[Reading, Reading]]:
    """All pairs on the same task that differ in what was simulated, single readings first.

    A hybrid counts once: readings that differ only in what a method does not look at give the
    same episodes.
    """
    single = [(reading, reading) for reading in readings]
    seen = {(_looked_at(a, "traditional"), _looked_at(b, "improved")) for a, b in single}
    hybrids = []
    for old in readings:
        for new in readings:
            pair = _looked_at(old, "traditional"), _looked_at(new, "improved")
            if old.task == new.task and pair not in seen:
                seen.add(pair)
                hybrids.append((old, new))
    return single + hybrids


def _looked_at(reading: Reading, method: str) -> tuple[str, ...]:
    """All that a method's episodes depend on, at every radius."""
    return tuple(label_of(reading.settings(case, method)) for case in CASES)
