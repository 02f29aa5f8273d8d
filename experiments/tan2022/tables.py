"""Tables 2, 3 and 4 of Tan et al. 2022 on our maps, and the tests of the printed ones."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from scipy import stats

from experiments.tan2022.arithmetic import HALF_UNIT, WORDS, shares
from experiments.tan2022.episodes import Pair, both_reached, common_table, per_map_change
from experiments.tan2022.joint import LEAST_MAPS, Values, table_test
from experiments.tan2022.published import (
    METHODS,
    METRICS,
    RADII,
    TABLE2,
    TABLE3,
    TABLE4,
    TABLE4_MAPS,
    PublishedTable,
)
from experiments.tan2022.readings import CASES, ONE_MAP_CASES, Case

Pairs = Mapping[Case, Pair]
"""Case to the episodes of both methods."""
_UNIT = 2 * HALF_UNIT


class Shown(NamedTuple):
    """One map that a table and a figure show.

    Attributes:
        figure: number of the paper's figure that has this layout.
        case: radius and rate.
        job: number of the map in its sequence; as many were passed over before it.
    """

    figure: int
    case: Case
    job: int


def one_map(pairs: Pairs) -> list[Shown]:
    """Choose the map of Table 2 and Figs. 2 to 4: the first that both cross at all three radii."""
    suits = _at_all_radii(pairs)
    job = int(suits.argmax())
    return [Shown(2 + i, case, job) for i, case in enumerate(ONE_MAP_CASES) if suits[job]]


def _at_all_radii(pairs: Pairs) -> np.ndarray:
    """Of the maps that were sailed at all three radii, which ones both cross."""
    crossed = [both_reached(pairs[case]) for case in ONE_MAP_CASES]
    suits: np.ndarray = np.logical_and.reduce([c[: min(map(len, crossed))] for c in crossed])
    return suits


def three_maps(pairs: Pairs) -> list[Shown]:
    """Choose the maps of Table 3 and Figs. 5 to 7: for each radius the first that suits.

    Radii with the same rate draw the same maps, so a map that is shown already, be it in Table 2,
    is passed over.
    """
    before = {other.job for other in one_map(pairs)}
    shown: list[Shown] = []
    for i, case in enumerate(CASES):
        suits = both_reached(pairs[case])
        suits[[*before, *(other.job for other in shown)]] = False
        if suits.any():
            shown.append(Shown(5 + i, case, int(suits.argmax())))
    return shown


def single_maps(shown: Sequence[Shown], pairs: Pairs) -> list[dict[str, Any]]:
    """Rows of Table 2 or 3: one map each, with how many were passed over."""
    return [
        {
            "radius": case.radius,
            "rate": case.rate,
            "map": job,
            "passed_over": job,
            "values": {m: _named(pairs[case][m].table(np.array([job]))[0]) for m in METHODS},
        }
        for _, case, job in shown
    ]


def twenty_maps(pairs: Pairs) -> list[dict[str, Any]]:
    """Table 4: averages over the first 20 maps on which both methods succeed."""
    return [_average(case, pairs[case]) for case in CASES]


def _average(case: Case, pair: Pair) -> dict[str, Any]:
    jobs = np.flatnonzero(both_reached(pair))[:TABLE4_MAPS]
    row: dict[str, Any] = {"radius": case.radius, "rate": case.rate, "maps": len(jobs)}
    if len(jobs) == 0:
        return {**row, "passed_over": len(both_reached(pair)), "values": None, "change": None}
    table = common_table(pair)[:, :TABLE4_MAPS]
    return {
        **row,
        "passed_over": int(jobs[-1]) + 1 - len(jobs),
        "values": {m: _named(table[i].mean(axis=0)) for i, m in enumerate(METHODS)},
        "change": _named(per_map_change(table).mean(axis=0)),
    }


def _named(row: np.ndarray) -> dict[str, float]:
    return dict(zip(METRICS, map(float, row), strict=True))


def put_to_the_test(pairs: Pairs) -> dict[str, dict[str, Any] | None]:
    """Put every printed table, and Table 4's changes one by one, to the test."""
    at_all = np.flatnonzero(_at_all_radii(pairs))
    same = np.concatenate(
        [_rows(np.stack([pairs[c][m].table(at_all) for m in METHODS])) for c in ONE_MAP_CASES], 1
    )
    own = [common_table(pairs[case]) for case in CASES]
    change = {metric: shares(TABLE4, metric) for metric in METRICS}
    return {
        "2": table_test([Values(*_joined(TABLE2), same)], 1, _UNIT),
        "3": table_test(_by_radius(TABLE3, own), 1, _UNIT),
        "4": table_test(_by_radius(TABLE4, own), TABLE4_MAPS, _UNIT),
        **{
            metric: table_test(
                [
                    Values(
                        np.array([1.0 + change[metric][place]]),
                        [f"r = {radius:g} m"],
                        1.0 + per_map_change(own[place])[:, [column]],
                    )
                    for place, radius in enumerate(RADII)
                ],
                TABLE4_MAPS,
                _UNIT / 100,
            )
            for column, metric in enumerate(METRICS)
        },
    }


def _rows(table: np.ndarray) -> np.ndarray:
    """float[2, n, 3] as float[n, 6], a map's values side by side."""
    return np.concatenate(list(table), axis=-1)


def _by_radius(printed: PublishedTable, ours: Sequence[np.ndarray]) -> list[Values]:
    return [Values(*_printed(printed, place), _rows(own)) for place, own in enumerate(ours)]


def _joined(table: PublishedTable) -> tuple[np.ndarray, list[str]]:
    parts = [_printed(table, place) for place in range(len(RADII))]
    return np.concatenate([part[0] for part in parts]), [name for part in parts for name in part[1]]


def _printed(table: PublishedTable, place: int) -> tuple[np.ndarray, list[str]]:
    """A table's values at one radius, in the order of `_rows`, and their names."""
    keys = [(method, metric) for method in METHODS for metric in METRICS]
    names = [f"{method} {WORDS[metric]}, r = {RADII[place]:g} m" for method, metric in keys]
    return np.array([table.values[key][place] for key in keys]), names


def growth(pairs: Pairs) -> list[dict[str, float] | None]:
    """How much more the path is shortened at a radius than at the one before, by a t-test.

    All radii draw the same maps, so a map counts for both sides of a difference. Each radius has
    common successes of its own; the degrees of freedom are those of the fewer.

    Returns:
        "gain" (a share of the length), "t" and two-sided "p" per step from radius to radius; None
        where one of them has fewer than `LEAST_MAPS` common successes, or nothing varies.
    """
    steps = []
    for before, after in pairwise(CASES):
        small, large = (_shortened(pairs[case]) for case in (before, after))
        if small is None or large is None:
            steps.append(None)
            continue
        error = float(np.sqrt(((large[1] - small[1]) ** 2).sum()))
        gain = large[0] - small[0]
        steps.append(_tested(gain, error, min(small[2], large[2])) if error > 0.0 else None)
    return steps


def _tested(gain: float, error: float, count: int) -> dict[str, float]:
    t = gain / error
    return {"gain": gain, "t": t, "p": float(2.0 * stats.t.sf(abs(t), count - 1))}


def _shortened(pair: Pair) -> tuple[float, np.ndarray, int] | None:
    """Mean share by which paths are shortened, what each map adds to its error, and how many."""
    both = both_reached(pair)
    count = int(both.sum())
    if count < LEAST_MAPS:
        return None
    shorter = -per_map_change(common_table(pair))[:, METRICS.index("path_length")]
    parts = np.zeros(len(both))
    parts[both] = (shorter - shorter.mean()) / np.sqrt(count * (count - 1))
    return float(shorter.mean()), parts, count
