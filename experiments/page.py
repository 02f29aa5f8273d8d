"""The page of a paper, the same outline for all of them."""

from collections.abc import Sequence
from dataclasses import asdict
from itertools import chain
from typing import TYPE_CHECKING, Any

import usvjax as uj
from experiments import claims
from usvjax.report import Bullets, Picture, Section

if TYPE_CHECKING:
    from experiments.paper import Done, Options, Paper

NOTE = (
    "Yes and no: whether the claim holds under a reading; a dash where the sample does not tell. A "
    '"not excluded" claim passed a test that could only have excluded it. Readings in brackets do '
    "not count, such as what was chosen after the fact to come near to the claim."
)


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
            [claims.sheet(verdicts), NOTE, Bullets(claims.tests(verdicts))],
        ),
        Section("How the paper was read", [Bullets(done.part.readings(done.numbers))]),
        *done.part.sections(done.numbers),
    ]
    if done.drawings:
        pictures = [Picture(f"figures/{name}", caption) for name, caption in done.drawings]
        found.append(Section("Figures", pictures))
    return found
