"""Everything that is measured for the page on Tan et al. 2022."""

from dataclasses import asdict
from typing import Any

from experiments.runs import Found
from experiments.tan2022.arithmetic import cap_bounds
from experiments.tan2022.episodes import Sailed
from experiments.tan2022.paired import compare, sensitivity, slower
from experiments.tan2022.published import METHODS
from experiments.tan2022.ranking import ranking
from experiments.tan2022.readings import (
    ALONG_PRESET,
    BESIDE,
    CASES,
    DEMO,
    MAIN,
    NO_ASTERN,
    ONE_MAP_CASES,
    PRESET,
    Reading,
    combinations,
    sensitivities,
)
from experiments.tan2022.tables import (
    Pairs,
    growth,
    one_map,
    put_to_the_test,
    single_maps,
    three_maps,
    twenty_maps,
)

COUNTED = (*MAIN, *BESIDE)
"""Readings that count for verdicts."""
SHOWN = (PRESET, DEMO, ALONG_PRESET)
"""Readings that Tables 2 to 4 and Figs. 2 to 7 are made under."""
HYBRID = "hybrid"
"""The traditional method with a cap of 2r against the improved one without a cap."""


def measure(found: Found) -> dict[str, Any]:
    """Make every table."""
    sailed = Sailed(found)
    compared = {reading.label: pairs_of(sailed, reading) for reading in COUNTED}
    compared[HYBRID] = pairs_of(sailed, DEMO, PRESET)
    paired = compare(compared)
    for label, pairs in compared.items():
        paired[label] |= {"tests": put_to_the_test(pairs), "growth": growth(pairs)}
    return {
        "tables": {reading.label: _tables(compared[reading.label]) for reading in SHOWN},
        "paired": paired,
        "sensitivities": _sensitivities(sailed),
        "astern": _astern(sailed),
        "ranking": _ranking(sailed),
        "cap_bounds": [asdict(bound) for bound in cap_bounds()],
    }


def pairs_of(sailed: Sailed, reading: Reading, improved: Reading | None = None) -> Pairs:
    """The episodes of both methods in all cases of the paper."""
    cases = dict.fromkeys((*CASES, *ONE_MAP_CASES))
    return {case: sailed.pair(reading, case, improved) for case in cases}


def _tables(pairs: Pairs) -> dict[str, Any]:
    return {
        "2": single_maps(one_map(pairs), pairs),
        "3": single_maps(three_maps(pairs), pairs),
        "4": twenty_maps(pairs),
    }


def _sensitivities(sailed: Sailed) -> list[dict[str, Any]]:
    """One row per reading and radius, what is varied together."""
    readings = [*COUNTED, *sensitivities()]
    groups = list(dict.fromkeys(reading.group for reading in readings))
    return [
        sensitivity(reading, case, sailed.pair(reading, case))
        for reading in sorted(readings, key=lambda one: groups.index(one.group))
        if _was_run(sailed, reading)
        for case in CASES
    ]


def _astern(sailed: Sailed) -> list[dict[str, Any]]:
    """What sailing astern costs the improved method without a cap, radius by radius."""
    return [
        slower(*(sailed.one(reading, case, "improved") for reading in (NO_ASTERN, PRESET)))
        for case in CASES
    ]


def _was_run(sailed: Sailed, reading: Reading) -> bool:
    """Whether this is no quick run that leaves it out."""
    return all(sailed.has(reading, case) for case in CASES)


def _ranking(sailed: Sailed) -> dict[str, Any]:
    readings = [reading for reading in combinations() if _was_run(sailed, reading)]
    outcomes = {
        (reading, method): [sailed.one(reading, case, method) for case in CASES]
        for reading in readings
        for method in METHODS
    }
    maps = min(len(one.status) for episodes in outcomes.values() for one in episodes)
    same = {key: [one.first(maps) for one in episodes] for key, episodes in outcomes.items()}
    return {"maps": maps, **ranking(readings, same)}
