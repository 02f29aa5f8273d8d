"""What Wei & Zhang 2023 say of Figs. 7 and 8, under each search, smoothing and size of scenes."""

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

from experiments.claims import Claim, Finding, Numbers, below, not_excluded
from experiments.estimates import least_rank_p
from experiments.wei2023.mission import STAGES
from experiments.wei2023.published import AFTER, BEFORE
from experiments.wei2023.runs import AS_PRINTED, FITTED, KINDS, SEARCHES
from usvjax.report.numbers import interval, p_value

LEAST_SCENES = 20
"""Scenes that a difference rests on at least."""
LEVEL = 0.05
SMOOTHED = ("keys", "sight")
COUNTED = [kind for kind in AS_PRINTED if kind != FITTED]
OTHERS = [kind for kind in KINDS if kind not in AS_PRINTED]

RANKS = (
    "excluded under a reading where the number lies among the outermost 5 % of our scenes (by the "
    "rank it takes as one more of them, two-sided; mean, 2.5 and 97.5 % quantiles are given); if "
    "the paper's scene were drawn as these are, it would be with at most 5 %; fewer than 39 scenes "
    "could exclude nothing"
)


class Given(NamedTuple):
    """What a reading stands for.

    Attributes:
        search: how the path is found.
        stage: what is made of it.
        kind: of scenes.
    """

    search: str
    stage: str
    kind: str


def claims(numbers: Numbers) -> list[Claim]:
    """Every claim about the global path."""
    return [
        Claim(
            "Fig. 7: turning points before smoothing",
            str(BEFORE),
            _as_printed,
            _readings(["before"], COUNTED),
            _beside(["before"], [FITTED]),
            RANKS,
            weak=True,
        ),
        Claim(
            "Fig. 8: turning points after smoothing",
            str(AFTER),
            _as_printed,
            _readings(SMOOTHED, COUNTED),
            _beside(SMOOTHED, [FITTED]),
            RANKS,
            weak=True,
        ),
        Claim(
            "Turning points are significantly reduced",
            f"{BEFORE} to {AFTER}",
            _reduced,
            _readings(SMOOTHED, COUNTED),
            _beside(SMOOTHED, [FITTED, *OTHERS]),
            "yes under a reading where the mean paired difference lies below 0 with its 95 % t "
            "interval, no where it lies above, each wrongly in at most 2.5 % of samples; none from "
            f"fewer than {LEAST_SCENES} scenes, or from differences that are all equal",
        ),
    ]


def _readings(stages: Sequence[str], kinds: Sequence[str]) -> dict[str, Given]:
    """By search, which is what the page counts together."""
    return {
        f"{SEARCHES[search]}: {_words(stage)}{_side(kind)}": Given(search, stage, kind)
        for search, stage, kind in product(SEARCHES, stages, kinds)
    }


def _beside(stages: Sequence[str], kinds: Sequence[str]) -> dict[str, Given]:
    """By the kind of scenes."""
    return {
        f"{_kind(kind)}: {_words(stage)}{SEARCHES[search]}": Given(search, stage, kind)
        for kind, search, stage in product(kinds, SEARCHES, stages)
    }


def _words(stage: str) -> str:
    return "" if stage == "before" else f"{STAGES[stage]}, "


def _side(kind: str) -> str:
    return kind.partition(",")[0]


def _kind(kind: str) -> str:
    return f"{kind}, chosen to fit" if kind == FITTED else kind


def _stage(numbers: Numbers, given: Given) -> tuple[int, Mapping[str, Any]]:
    """Number of scenes, and what was measured of a stage."""
    table = numbers["tables"][given.kind][given.search]
    return table["n"], table["stages"][given.stage]


def _as_printed(numbers: Numbers, given: Given) -> Finding:
    n, row = _stage(numbers, given)
    p, turns = row["rank_p"], row["spread"]["turns"]
    return Finding(
        not_excluded(p, least_rank_p(n), LEVEL),
        f"p {p_value(p)}: {interval(turns, digits=1)}",
    )


def _reduced(numbers: Numbers, given: Given) -> Finding:
    n, row = _stage(numbers, given)
    if n < LEAST_SCENES:
        return Finding(None, f"only {n} scenes")
    change = row["difference"]["turns"]
    return Finding(below(change), interval(change, sign=True, digits=1))
