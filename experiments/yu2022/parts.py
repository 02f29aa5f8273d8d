"""What the parts of this paper's report have in common."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from experiments.markdown import bullets
from experiments.verdicts import UNKNOWN, Finding, Verdict, verdict_table, weigh
from experiments.yu2022.cruises.published import RUNS

MAPS, MANY_RUNS, SWARM_RUNS = 1000, 1000, RUNS
"""By default: maps of each kind, cruises of Case 1 and runs on each function, and those cruises
that Algorithms 1 to 3 make."""
UNDECIDED = "undecided"
"""Verdict where no finding holds or fails; the findings say why."""
WORDS = ("reproduces", "depends on the reading", "does not reproduce", UNDECIDED, UNKNOWN)


@dataclass(frozen=True)
class Part:
    """One part of the paper, computed.

    Attributes:
        name: key in results.json.
        title: heading of its section.
        found: for results.json.
        verdicts: on its claims.
        note: how to read the verdicts.
        summary: its most important findings, sentences.
        readings: how the paper was read, sentences.
        text: its tables.
        figures: what its figures show, sentences.
        draw: draws into a folder and returns the files.
        counts: how many maps and runs there are of each, for the head.
        done: how much was run.
    """

    name: str
    title: str
    found: dict[str, Any]
    verdicts: Sequence[Verdict]
    note: str
    summary: Sequence[str]
    readings: Sequence[str]
    text: str
    figures: Sequence[str]
    draw: Callable[[Path], list[Path]]
    counts: str
    done: str


def verdict(claim: str, published: str, found: dict[str, Finding]) -> Verdict:
    """Give the verdict on a claim, where every reading counts."""
    word = weigh(list(found.values()))
    return Verdict(claim, published, found, UNDECIDED if word == UNKNOWN else word)


def markdown(parts: Sequence[Part]) -> str:
    """Write the whole report."""
    head = [
        "# Yu et al. 2022: a cruise to many targets",
        "Tables and figures of the paper on maps of ours, and on many more. Written by `usvjax "
        "reproduce yu2022`; all numbers are in `results.json`.",
        "How much was run here: "
        + "; ".join(part.counts for part in parts)
        + f". By default: {MAPS:,} maps of each kind, {MANY_RUNS:,} cruises of Case 1 and runs on "
        f"each function, {SWARM_RUNS} cruises of Case 1 by Algorithms 1 to 3.",
        "## Summary\n\n" + bullets(_summary(parts)),
    ]
    return "\n\n".join([*head, *map(_section, parts)]) + "\n"


def _summary(parts: Sequence[Part]) -> list[str]:
    lines = []
    for word in WORDS:
        claims = [v.claim for part in parts for v in part.verdicts if v.verdict == word]
        if claims:
            lines.append(f"**{word[0].upper()}{word[1:]}**: {'; '.join(claims)}.")
    return lines + [line for part in parts for line in part.summary]


def _section(part: Part) -> str:
    return "\n\n".join(
        [
            f"## {part.title}",
            "### Verdicts\n\n"
            + verdict_table([asdict(verdict) for verdict in part.verdicts])
            + (f"\n\n{part.note}" if part.note else ""),
            "### How the paper was read\n\n" + bullets(part.readings),
            part.text,
            "### Figures\n\n" + bullets(part.figures),
        ]
    )
