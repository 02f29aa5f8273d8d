"""Which reading, or pair of readings, comes nearest to Table 4; after the fact, none tuned."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import exp

import numpy as np

from experiments.tan2022.episodes import Episodes
from experiments.tan2022.published import METHODS, METRICS, RADII, TABLE4, TABLE4_MAPS
from experiments.tan2022.readings import CASES, Reading

LEAST_COMMON = 10
"""Maps on which both methods must succeed, at each radius, for an average worth ranking."""
RESAMPLES = 2000
LEVEL = 0.95

Outcomes = Mapping[str, Sequence[Episodes]]
"""Method to its episodes at each of `RADII`, all on the same maps."""


@dataclass(frozen=True)
class Match:
    """Averages over the maps on which both methods succeed, beside Table 4's.

    Attributes:
        traditional, improved: labels of the readings that the methods follow.
        common: such maps at each of `RADII`.
        values: float[3 radii, 2 methods, 3 metrics], s, m, m/s; NaN where there is none.
        distance: root mean square of ln(ours / published) over the 18 averages; inf where
            fewer than `LEAST_COMMON` maps are behind one.
        within: of the 18, how many published averages lie where the mean over 20 of our maps
            would in 95 % of draws.
        misses: names of the others.
    """

    traditional: str
    improved: str
    common: tuple[int, ...]
    values: np.ndarray
    distance: float
    within: int | None = None
    misses: tuple[str, ...] = ()

    @property
    def typical_factor(self) -> float:
        """The distance as a factor: at 1.2, ours are typically off by 20 %."""
        return exp(self.distance)

    @property
    def is_hybrid(self) -> bool:
        """Whether the two methods follow different readings."""
        return self.traditional != self.improved


def published() -> np.ndarray:
    """Table 4 as float[3 radii, 2 methods, 3 metrics]."""
    table = [[TABLE4.values[method, metric] for metric in METRICS] for method in METHODS]
    return np.moveaxis(np.asarray(table), -1, 0)


def match(traditional: str, improved: str, outcomes: Outcomes) -> Match:
    """Compare one pair of readings with Table 4."""
    tables = common_tables(outcomes)
    counts = tuple(table.shape[1] for table in tables)
    values = np.stack([mean_or_nan(table) for table in tables])
    distance = np.inf
    if min(counts) >= LEAST_COMMON:
        distance = float(np.sqrt(np.mean(np.log(values / published()) ** 2)))
    return Match(traditional, improved, counts, values, distance)


def common_tables(outcomes: Outcomes) -> list[np.ndarray]:
    """Values on the maps that both methods reach the goal on, float[2, n, 3] at each radius."""
    tables = []
    for place in range(len(RADII)):
        pair = _same_maps([outcomes[method][place] for method in METHODS])
        both = pair[0].reached & pair[1].reached
        tables.append(np.stack([episodes.table(both) for episodes in pair]))
    return tables


def _same_maps(pair: Sequence[Episodes]) -> list[Episodes]:
    """Cut both to the maps that both sailed: the first ones of the same sequence."""
    n = min(len(episodes.status) for episodes in pair)
    return [Episodes(**{k: v[:n] for k, v in vars(episodes).items()}) for episodes in pair]


def mean_or_nan(table: np.ndarray) -> np.ndarray:
    """Mean over the maps of float[2, n, 3]; NaN where there is none."""
    if table.shape[1] == 0:
        return np.full((table.shape[0], table.shape[2]), np.nan)
    mean: np.ndarray = table.mean(axis=1)
    return mean


def of_twenty(values: np.ndarray, seed: int) -> np.ndarray:
    """Where the mean over 20 maps lies in 95 % of draws from ours.

    Args:
        values: float[n, ...], one row per map, n >= 1.
        seed: of the draws.

    Returns:
        float[2, ...], lower and upper end.
    """
    rng = np.random.default_rng(seed)
    rows = rng.integers(0, len(values), size=(RESAMPLES, TABLE4_MAPS))
    tail = (1.0 - LEVEL) / 2.0
    ends: np.ndarray = np.quantile(values[rows].mean(axis=1), [tail, 1.0 - tail], axis=0)
    return ends


def with_hits(found: Match, outcomes: Outcomes, seed: int) -> Match:
    """Count which published averages 20 of our maps could give; printing rounds them."""
    misses = []
    for place, table in enumerate(common_tables(outcomes)):
        low, high = of_twenty(np.moveaxis(table, 0, 1), seed)
        wanted = published()[place]
        for i, method in enumerate(METHODS):
            for j, metric in enumerate(METRICS):
                if not low[i, j] - 0.005 <= wanted[i, j] <= high[i, j] + 0.005:
                    misses.append(f"{method} {metric} at r = {RADII[place]:g}")
    within = published().size - len(misses)
    return replace(found, within=within, misses=tuple(misses))


def rank(
    readings: Sequence[Reading], outcomes: Mapping[tuple[Reading, str], Sequence[Episodes]]
) -> list[Match]:
    """Compare every reading, and every pair of readings of the same task, with Table 4.

    Args:
        readings: all of them.
        outcomes: (reading, method) to its episodes at each of `RADII`.

    Returns:
        The nearest first; those with too few common successes last.
    """
    matches = [
        match(
            old.label,
            new.label,
            {"traditional": outcomes[old, "traditional"], "improved": outcomes[new, "improved"]},
        )
        for old, new in pairs(readings)
    ]
    return sorted(matches, key=lambda found: (found.distance, found.is_hybrid))


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


def _looked_at(reading: Reading, method: str) -> tuple[object, ...]:
    """All that a method's episodes depend on, at every radius."""
    return tuple(
        (reading.source(case), reading.params(case, method), reading.static(method))
        for case in CASES
    )
