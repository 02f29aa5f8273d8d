"""Verdicts: what a paper says, what was found under each reading of it, what that comes to."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from experiments.markdown import grid
from usvjax.report.sheets import Sheet

UNKNOWN = "too few maps"


@dataclass(frozen=True)
class Finding:
    """One claim under one reading.

    Attributes:
        holds: None where too few maps tell.
        numbers: what was found, in a few words.
    """

    holds: bool | None
    numbers: str


@dataclass(frozen=True)
class Verdict:
    """One table, figure or claim of a paper.

    Attributes:
        claim: what the paper says.
        published: its numbers.
        found: label of a reading to what was found.
        verdict: "reproduces" (under every reading that counts), "does not reproduce" (under
            none), "depends on the reading", or "too few maps".
    """

    claim: str
    published: str
    found: dict[str, Finding]
    verdict: str


def weigh(findings: Sequence[Finding]) -> str:
    """Say what the findings under all readings that count come to."""
    known = [finding.holds for finding in findings if finding.holds is not None]
    if not known:
        return UNKNOWN
    if all(known):
        return "reproduces"
    return "depends on the reading" if any(known) else "does not reproduce"


def verdict(claim: str, published: str, found: dict[str, Finding]) -> Verdict:
    """Give the verdict on a claim, where every reading counts."""
    return Verdict(claim, published, found, weigh(list(found.values())))


def verdict_table(verdicts: Sequence[Mapping[str, Any]]) -> str:
    """Lay verdicts (as in results.json) out in Markdown, a column per reading."""
    labels = list(dict.fromkeys(label for row in verdicts for label in row["found"]))
    rows = [
        [
            row["claim"],
            row["published"],
            f"**{row['verdict']}**",
            *(_cell(row["found"].get(label)) for label in labels),
        ]
        for row in verdicts
    ]
    return grid(["The paper", "Published", "Verdict", *labels], rows)


def _cell(finding: Mapping[str, Any] | None) -> str:
    if finding is None:
        return "-"
    word = {True: "yes", False: "no", None: "-"}[finding["holds"]]
    return f"{word}: {finding['numbers']}"


def console_table(paper: str, verdicts: Sequence[Verdict]) -> Sheet:
    """Lay verdicts out for a terminal."""
    rows = [(row.claim, row.verdict) for row in verdicts]
    return Sheet("What reproduces", (f"{paper} says", "verdict"), rows, words=2)
