"""The page of a paper, the same outline for all of them."""

from collections.abc import Sequence
from dataclasses import asdict
from itertools import chain, groupby
from typing import TYPE_CHECKING, Any

import usvjax as uj
from experiments import claims
from usvjax.report import Bullets, Picture, Section, Sheet

if TYPE_CHECKING:
    from experiments.paper import Done, Options, Paper

NOTE = (
    "Yes and no: whether the claim holds under a reading; a dash where the sample does not tell. A "
    "claim reproduces where every reading says yes, does not where every one says no, depends on "
    "the reading where some say yes and some no, and is undecided where a dash stands in the way. "
    'One that is "not excluded" passed a test that could only have excluded it. Readings in '
    "brackets do not count, such as what was chosen after the fact to come near to the claim."
)

MOST_COLUMNS = 10
"""Of the table of verdicts; of more readings, each has a line of its own below."""


def settings(options: "Options") -> dict[str, Any]:
    """What a page was made with, for results.json."""
    return {"usvjax": uj.__version__, "quick": options.quick, **options.sizes}


def as_json(record: Any) -> dict[str, Any]:
    """A dataclass as nested dictionaries."""
    return asdict(record)


def page(paper: "Paper", done: Sequence["Done"]) -> Section:
    """Write the page.

    Args:
        paper: which.
        done: its parts, computed.
    """
    verdicts = list(chain.from_iterable(one.verdicts for one in done))
    found = chain.from_iterable(one.part.summary(one.numbers) for one in done)
    parts: list[Any] = [
        f"{paper.about} Written by `usvjax reproduce {paper.name}`; all numbers are in "
        "`results.json`.",
        Section("Summary", [Bullets([*claims.summary(verdicts), *found])]),
    ]
    for one in done:
        own = _part(one)
        parts += [Section(one.part.title, own)] if len(done) > 1 else own
    checks = paper.checks()
    if checks:
        parts.append(claims.arithmetic(checks))
    if paper.absent:
        lines = [f"{absent.what}: {absent.why}" for absent in paper.absent]
        parts.append(Section("Not here", [Bullets(lines)]))
    return Section(f"{paper.cite}: {paper.title}", parts)


def _part(done: "Done") -> list[Section]:
    verdicts = done.verdicts
    found = [
        Section(
            "Verdicts",
            [*_sheets(verdicts), NOTE, Bullets(claims.tests(verdicts))],
        ),
        Section("How the paper was read", [Bullets(done.part.readings(done.numbers))]),
        *done.part.sections(done.numbers),
    ]
    if done.drawings:
        pictures = [Picture(f"figures/{name}", caption) for name, caption in done.drawings]
        found.append(Section("Figures", pictures))
    return found


def _sheets(verdicts: Sequence[claims.Verdict]) -> list[Sheet]:
    """Verdicts with a column per reading, or, of many, what was found in lines below them."""
    sheet = claims.sheet(verdicts)
    if len(sheet.header) <= MOST_COLUMNS:
        return [sheet]
    (lines,) = claims.section(verdicts).parts
    assert isinstance(lines, Sheet)
    rows = []
    for _, group in groupby(lines.rows, key=lambda row: row[0]):
        first, *others = group
        rows += [list(first), *(["", *row[1:]] for row in others)]
    return [
        Sheet("", sheet.header[:3], [row[:3] for row in sheet.rows], words=3),
        Sheet("Under every reading:", ["The paper", *lines.header[1:]], rows, words=3),
    ]
