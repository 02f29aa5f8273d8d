"""What Wei & Zhang 2023 say of Figs. 7 and 8, under each search, smoothing and size of scenes."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from experiments.claims import Claim, Finding, Numbers
from experiments.wei2023.mission import STAGES
from experiments.wei2023.published import AFTER, BEFORE
from experiments.wei2023.runs import AS_PRINTED, FITTED, SEARCHES
from usvjax.report.numbers import listed

LEAST_SCENES = 20
TOO_FEW = "too few scenes"


class Given(NamedTuple):
    """What a reading stands for.

    Attributes:
        search: how the path is found.
        stage: what is made of it.
        kinds: of scenes.
    """

    search: str
    stage: str
    kinds: Sequence[str]


def claims(numbers: Numbers) -> list[Claim]:
    """Every claim about the global path."""
    smoothed = {
        f"{words}: {STAGES[stage]}": Given(search, stage, AS_PRINTED)
        for search, words in SEARCHES.items()
        for stage in ("keys", "sight")
    }
    everywhere = {
        label: given._replace(kinds=list(numbers["tables"])) for label, given in smoothed.items()
    }
    within = (
        "the number lies between the 2.5 and 97.5 % quantiles of our scenes (mean and these are "
        "given); if the paper's scene were one of these, it would not in 5 % of cases"
    )
    return [
        Claim(
            "Fig. 7: turning points before smoothing",
            str(BEFORE),
            _before,
            _by_side([kind for kind in AS_PRINTED if kind != FITTED]),
            _by_side([FITTED]),
            within,
            weak=True,
        ),
        Claim(
            "Fig. 8: turning points after smoothing",
            str(AFTER),
            _after,
            smoothed,
            test=f"on every kind of scenes with three obstacles {within}",
            weak=True,
        ),
        Claim(
            "Turning points are significantly reduced",
            f"{BEFORE} to {AFTER}",
            _reduced,
            everywhere,
            test="the mean paired difference lies below 0 with its 95 % t interval on every kind "
            "of scenes; without a reduction it would in at most 2.5 % of samples",
        ),
    ]


def _by_side(kinds: Sequence[str]) -> dict[str, Given]:
    return {
        f"{words}: {kind.partition(',')[0]}": Given(search, "before", [kind])
        for search, words in SEARCHES.items()
        for kind in kinds
    }


def _tables(numbers: Numbers, given: Given) -> list[Mapping[str, Any]]:
    return [numbers["tables"][kind][given.search] for kind in given.kinds]


def _before(numbers: Numbers, given: Given) -> Finding:
    return _within(numbers, given, BEFORE)


def _after(numbers: Numbers, given: Given) -> Finding:
    return _within(numbers, given, AFTER)


def _within(numbers: Numbers, given: Given, wanted: int) -> Finding:
    tables = _tables(numbers, given)
    if any(table["n"] < LEAST_SCENES for table in tables):
        return Finding(None, TOO_FEW)
    spreads = [table["stages"][given.stage]["spread"]["turns"] for table in tables]
    return Finding(
        all(one["low"] <= wanted <= one["high"] for one in spreads),
        ", ".join(f"{one['value']:.1f} [{one['low']:.0f}, {one['high']:.0f}]" for one in spreads),
    )


def _reduced(numbers: Numbers, given: Given) -> Finding:
    rows = [
        table["stages"][given.stage]["difference"]["turns"] for table in _tables(numbers, given)
    ]
    if any(row["high"] is None for row in rows):
        return Finding(None, TOO_FEW)
    return Finding(
        all(row["high"] < 0 for row in rows), listed([row["value"] for row in rows], 1, sign=True)
    )
