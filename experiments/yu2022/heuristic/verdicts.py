"""What holds of Yu et al. 2022, Fig. 5: each claim under each reading of Eq. 17."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from experiments.verdicts import UNKNOWN, Finding, Verdict, weigh
from experiments.yu2022.heuristic.published import FEWER, SAME_PATH

READINGS = {"weighted": "Eq. 17 as printed", "weighted_octile": "weighted octile"}
"""Heuristics that Eq. 17 may mean; only they count."""
BESIDE = {"octile": "octile, beside them"}
SAME = 0.95
"""Share of maps with a path as short, from which on paths count as the same."""
LEAST_MAPS = 20

_Rows = Sequence[Mapping[str, Any]]


def judge(found: Mapping[str, Any]) -> list[Verdict]:
    """Judge every claim about the heuristic.

    Args:
        found: the tables, as in results.json.
    """
    plans, episodes = list(found["plans"].values()), list(found["episodes"].values())
    claims: list[tuple[str, str, Callable[[_Rows], Finding], _Rows]] = [
        ("Fig. 5: fewer expanded nodes", f'"{FEWER}"', _fewer, plans),
        ("Fig. 5: the path stays the same", f'"{SAME_PATH}"', _same, plans),
        ("Fewer expanded nodes while the map changes", "no number is given", _fewer, episodes),
    ]
    return [
        _verdict(claim, published, decide, tables) for claim, published, decide, tables in claims
    ]


def _verdict(
    claim: str, published: str, decide: Callable[[_Rows], Finding], tables: _Rows
) -> Verdict:
    findings = {
        label: decide([{**table["heuristics"][name], "n": table["n"]} for table in tables])
        for name, label in (READINGS | BESIDE).items()
    }
    return Verdict(
        claim, published, findings, weigh([findings[label] for label in READINGS.values()])
    )


def _fewer(rows: _Rows) -> Finding:
    """Hold when the mean ratio of expansions lies below 1 with its interval everywhere."""
    if any(row["n"] < LEAST_MAPS or row["times"]["high"] is None for row in rows):
        return Finding(None, UNKNOWN)
    numbers = ", ".join(f"{row['times']['value']:.2f}" for row in rows) + " times"
    return Finding(all(row["times"]["high"] < 1.0 for row in rows), numbers)


def _same(rows: _Rows) -> Finding:
    """Hold when nearly all paths are as short everywhere."""
    if any(row["n"] < LEAST_MAPS for row in rows):
        return Finding(None, UNKNOWN)
    shares = [row["same_length"]["value"] for row in rows]
    longer = ", ".join(f"{100 * (row['length_ratio']['value'] - 1):.1f}" for row in rows)
    numbers = ", ".join(f"{100 * share:.0f}" for share in shares)
    return Finding(
        all(share >= SAME for share in shares), f"as short on {numbers} %; longer by {longer} %"
    )
