"""What the parts of this paper's report have in common."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from experiments.markdown import bullets
from experiments.verdicts import Verdict, verdict_table

WORDS = ("reproduces", "depends on the reading", "does not reproduce", "too few maps")


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
    done: str


def markdown(parts: Sequence[Part]) -> str:
    """Write the whole report."""
    head = [
        "# Yu et al. 2022: a cruise to many targets",
        "Tables and figures of the paper on maps of ours, and on many more. Written by `usvjax "
        "reproduce yu2022`; all numbers are in `results.json`.",
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
