"""What holds of Wei & Zhang 2023, Figs. 7 and 8: each claim under each search."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from experiments.verdicts import UNKNOWN, Finding, Verdict, verdict
from experiments.wei2023.published import AFTER, BEFORE
from experiments.wei2023.scenes import SHOWN

SEARCHES = {
    "euclidean": "A*, Euclidean distance",
    "octile": "A*, octile distance",
    "textbook": "textbook A*, Euclidean distance",
    "textbook, octile": "textbook A*, octile distance",
}
LEAST_SCENES = 20

_Tables = Mapping[str, Mapping[str, Any]]


def judge(found: Mapping[str, Any]) -> list[Verdict]:
    """Judge every claim about the global path.

    Args:
        found: the tables, as in results.json.
    """
    claims: list[tuple[str, str, Callable[[_Tables], Finding]]] = [
        ("Fig. 7: turning points before smoothing", str(BEFORE), _as_many("before", BEFORE)),
        ("Fig. 8: turning points after smoothing", str(AFTER), _as_many("key points", AFTER)),
        ("Turning points are significantly reduced", f"{BEFORE} to {AFTER}", _reduced),
    ]
    return [
        verdict(
            claim,
            published,
            {label: decide(_of(found, search)) for search, label in SEARCHES.items()},
        )
        for claim, published, decide in claims
    ]


def _of(found: Mapping[str, Any], search: str) -> _Tables:
    """Tables of one search by kind of scenes."""
    tables = found["tables"]
    return {kind: rows[search] for kind, rows in tables.items() if search in rows}


def _as_many(stage: str, wanted: int) -> Callable[[_Tables], Finding]:
    """Hold when the number lies between the 2.5 and 97.5 % quantiles of our scenes."""

    def decide(tables: _Tables) -> Finding:
        table = tables.get(SHOWN.label)
        if table is None or table["n"] < LEAST_SCENES:
            return Finding(None, UNKNOWN)
        spread = table["stages"][stage]["spread"]["turns"]
        return Finding(
            bool(spread["low"] <= wanted <= spread["high"]),
            f"{spread['value']:.1f} [{spread['low']:.0f}, {spread['high']:.0f}] on "
            f"{table['n']:,} scenes",
        )

    return decide


def _reduced(tables: _Tables) -> Finding:
    """Hold when the mean paired difference lies below 0 with its interval on every kind."""
    rows: Sequence[Mapping[str, Any]] = [
        table["stages"]["key points"]["difference"]["turns"] for table in tables.values()
    ]
    if not rows or any(row["high"] is None for row in rows):
        return Finding(None, UNKNOWN)
    numbers = ", ".join(f"{row['value']:+.1f}" for row in rows)
    return Finding(all(row["high"] < 0 for row in rows), numbers)
