"""How long a study would take and how large it would be, from a few of its episodes."""

import time
from collections.abc import Hashable
from dataclasses import dataclass, replace

import numpy as np

from usvjax.study.calls import Kindred
from usvjax.study.shards import Unit, encode_shard
from usvjax.study.spec import StudySpec
from usvjax.study.units import run_units

FIRST = 16  # episodes tried of a condition, to begin with
MOST_TRIED = 4  # conditions
GROWTH = 4


@dataclass(frozen=True)
class Forecast:
    """What a study would take.

    Attributes:
        seconds: of work on one device, compilation apart.
        first_seconds: until the first episodes had come, most of it compilation, of the
            conditions that were tried.
        bytes: of its shards on disk.
        tried: episodes of each condition that was tried, with every method.
        conditions: how many were tried.
    """

    seconds: float
    first_seconds: float
    bytes: int
    tried: int
    conditions: int


def forecast(spec: StudySpec, budget: float = 20.0) -> Forecast:
    """Try a few episodes, in memory, and scale up.

    Args:
        spec: the study.
        budget: s, after which no larger number of episodes is tried.
    """
    began = time.perf_counter()
    count = min(MOST_TRIED, len(spec.conditions))
    chosen = sorted(set(np.linspace(0, len(spec.conditions) - 1, count).astype(int).tolist()))
    tried = min(FIRST, spec.episodes)
    _trial(spec, chosen[:1], 1)
    # What one episode takes, compilation and all, bounds how much more is worth trying.
    if (time.perf_counter() - began) * len(chosen) > budget:
        chosen, tried = chosen[:1], min(2, spec.episodes)
    _trial(spec, chosen, tried)
    first = time.perf_counter() - began
    seconds, size = _trial(spec, chosen, tried)
    while tried < min(spec.shard, spec.episodes):
        larger = min(GROWTH * tried, spec.shard, spec.episodes)
        # A larger number may be another program to compile.
        if time.perf_counter() - began + first + 2 * GROWTH * seconds > budget:
            break
        tried = larger
        _trial(spec, chosen, tried)
        seconds, size = _trial(spec, chosen, tried)
    scale = spec.episodes / tried * len(spec.conditions) / len(chosen)
    return Forecast(seconds * scale, first, round(size * scale), tried, len(chosen))


def _trial(spec: StudySpec, conditions: list[int], episodes: int) -> tuple[float, int]:
    """Seconds and bytes of so many episodes of some conditions, all methods."""
    part = replace(spec, episodes=episodes, shard=episodes)
    began = time.perf_counter()
    kindred = Kindred(part)
    shared: dict[Hashable, list[Unit]] = {}
    for condition in conditions:
        key = kindred.key[condition]
        fits = len(conditions) * episodes <= kindred.most[key]
        shared.setdefault(key if fits else condition, []).append(Unit(condition, 0))
    tables = [table for units in shared.values() for table in run_units(part, units, kindred)]
    seconds = time.perf_counter() - began
    return seconds, sum(len(encode_shard(Unit(0, 0), table)[1]) for table in tables)
