"""A paper: its claims, what must be run to judge them, and the one program that does it.

Every paper is a package with `published.py` (what is printed), modules that say what to run and
what to measure, and a `__main__.py` that hands a `Paper` to `main`.
"""

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic
from typing import Annotated, Any, Literal, NamedTuple

import tyro
from matplotlib.figure import Figure
from rich.text import Text

from experiments import claims, output, pace, page
from experiments.claims import Check, Claim, Numbers, Verdict
from experiments.runs import Found, Run, carry_out
from usvjax.cli import as_command, usage_in_one_line
from usvjax.cli.console import complain, room, show, show_line, use_any_encoding
from usvjax.errors import BadInputError, BadTypeError
from usvjax.pictures import SUFFIXES, check_dpi
from usvjax.plots import save
from usvjax.report import Section, markdown, terminal
from usvjax.study.runner import StudyStoppedError

DPI = 130
"""Of the figures that are kept in the repository."""


@dataclass(frozen=True)
class Options:
    """What every program can be asked for; those of a paper add sizes, None for the default.

    Attributes:
        quick: A look, on few episodes.
        out: Folder for README.md, results.json and figures/; runs/PAPER by default.
        record: Write over the results that the repository keeps, experiments/results/PAPER.
        format: Of the figures: png, pdf or svg.
        dpi: Dots per inch of figures in png.
    """

    quick: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    out: Annotated[Path | None, tyro.conf.arg(metavar="FOLDER")] = None
    record: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    format: Literal["png", "pdf", "svg"] = "png"
    dpi: Annotated[int, tyro.conf.arg(metavar="N")] = DPI

    @property
    def sizes(self) -> dict[str, Any]:
        """The sizes that were asked for, by the name of their option."""
        common = {f.name for f in fields(Options)}
        named = {name: size for name, size in vars(self).items() if name not in common}
        return {name: size for name, size in named.items() if size is not None}


class Drawing(NamedTuple):
    """A figure.

    Attributes:
        name: of its file, without suffix.
        caption: what it shows, a sentence or two.
        figure: as drawn.
    """

    name: str
    caption: str
    figure: Figure


class Absent(NamedTuple):
    """Tables or figures of a paper that are not here.

    Attributes:
        what: which.
        why: the reason, or what will bring them.
    """

    what: str
    why: str


def _nothing(numbers: Numbers) -> Sequence[str]:
    return ()


@dataclass(frozen=True)
class Part:
    """One line of questions of a paper; most papers have one.

    Attributes:
        name: key in results.json.
        title: heading of its part of the page.
        runs: what to run, by name, at the sizes asked for; refuses options that cannot be used.
        measure: the tables, from what was run: numbers, lists and dictionaries by name, as they go
            into results.json.
        claims: to be judged by these numbers.
        sections: the tables, written.
        figures: drawn.
        summary: the most important findings besides the verdicts, sentences.
        readings: how the paper was read: every choice that it does not print, sentences.
        quick: whether a quick run has it; else it takes minutes to compile at any size.
    """

    name: str
    title: str
    runs: Callable[[Any], Mapping[str, Run]]
    measure: Callable[[Found], dict[str, Any]]
    claims: Callable[[Numbers], Sequence[Claim]]
    sections: Callable[[Numbers], Sequence[Section]]
    figures: Callable[[Found, Numbers], Iterator[Drawing]]
    readings: Callable[[Numbers], Sequence[str]]
    summary: Callable[[Numbers], Sequence[str]] = _nothing
    quick: bool = True


@dataclass(frozen=True)
class Paper:
    """A paper.

    Attributes:
        name: of its package.
        cite: authors and year.
        title: of its page, after the authors.
        about: what the page holds, a sentence.
        options: class of its options.
        parts: what is asked.
        absent: tables and figures of the paper that are not here.
        checks: its numbers against each other.
    """

    name: str
    cite: str
    title: str
    about: str
    options: type[Options]
    parts: Sequence[Part]
    absent: Sequence[Absent]
    checks: Callable[[], Sequence[Check]] = tuple


@dataclass(frozen=True)
class Done:
    """A part, computed.

    Attributes:
        part: which.
        found: what was run.
        numbers: what was measured.
        verdicts: on its claims.
        drawings: names and captions of its figures.
    """

    part: Part
    found: Found
    numbers: dict[str, Any]
    verdicts: list[Verdict]
    drawings: list[tuple[str, str]]


def main(paper: Paper, argv: Sequence[str] | None = None) -> int:
    """Run a paper's experiments, write its page, and say what reproduces.

    Args:
        paper: which.
        argv: options; those of the process when None.

    Returns:
        The exit code: 2, after one line on stderr, for a user's mistake.
    """
    use_any_encoding()
    prog = f"usvjax reproduce {paper.name}"
    try:
        with usage_in_one_line(prog):
            options = tyro.cli(paper.options, args=argv, prog=prog)
        check_dpi("--dpi", options.dpi)
        if options.quick:
            paper = _quick(paper)
        runs = [part.runs(options) for part in paper.parts]
        folder = output.results_folder(paper.name, options.out, options.record, _is_a_look(options))
    except (BadInputError, BadTypeError) as error:
        complain(f"{paper.name}: {error}")
        return 2
    begun = monotonic()
    complain(pace.forecast(paper.name, _named(paper, runs)))
    try:
        with TemporaryDirectory(prefix=".", dir=folder) as drawn:
            done, took = _computed(paper, runs, Path(drawn), options)
            sizes = {name: run.size for name, run in _named(paper, runs).items()}
            written = _written(paper, options, done, pace.record(took, sizes), Path(drawn), folder)
    except StudyStoppedError as stop:
        raise KeyboardInterrupt(
            f"stopped with {stop.done:,} of {stop.total:,} episodes of a study on disk; the same "
            "command continues"
        ) from None
    for one in done:
        show_line(Text(terminal(claims.section(one.verdicts), room())))
    show(f"All of it took {monotonic() - begun:,.0f} s.")
    for file in written:
        show_line(f"Written  {file}")
    return 0


def _quick(paper: Paper) -> Paper:
    """The paper without what a quick run leaves out, which its page says."""
    left_out = [Absent(part.title, "at full size only") for part in paper.parts if not part.quick]
    kept = [part for part in paper.parts if part.quick]
    return replace(paper, parts=kept, absent=[*paper.absent, *left_out])


def _named(paper: Paper, runs: Sequence[Mapping[str, Run]]) -> dict[str, Run]:
    """All runs by the name of their part and their own."""
    parts = zip(paper.parts, runs, strict=True)
    return {f"{part.name}: {name}": run for part, own in parts for name, run in own.items()}


def _is_a_look(options: Options) -> bool:
    """Whether a run is quick or of a size of one's own, and so not one for the record."""
    return options.quick or bool(options.sizes)


def _computed(
    paper: Paper, runs: Sequence[Mapping[str, Run]], figures: Path, options: Options
) -> tuple[list[Done], dict[str, float]]:
    """Run, measure, judge and draw, part by part."""
    done, took = [], {}
    for part, wanted in zip(paper.parts, runs, strict=True):
        found, seconds = carry_out(paper.name, wanted)
        numbers = part.measure(found)
        verdicts = claims.judge(part.claims(numbers), numbers)
        drawings = []
        for drawing in part.figures(found, numbers):
            name = f"{drawing.name}.{options.format}"
            save(drawing.figure, figures / name, dpi=options.dpi)
            drawings.append((name, drawing.caption))
        done.append(Done(part, found, numbers, verdicts, drawings))
        took |= {f"{part.name}: {name}": time for name, time in seconds.items()}
    return done, took


def _written(
    paper: Paper,
    options: Options,
    done: Sequence[Done],
    paced: dict[str, Any],
    drawn: Path,
    folder: Path,
) -> list[Path]:
    """Write the page and the numbers, and put the figures beside them; returns all files.

    All of it together, so that a page never stands beside figures of other numbers.
    """
    found = {
        "format": 3,
        "settings": page.settings(options),
        "verdicts": [claim for one in done for claim in map(page.as_json, one.verdicts)],
        **{one.part.name: one.numbers for one in done},
        "arithmetic": [page.as_json(check) for check in paper.checks()],
        "pace": paced,
    }
    figures = folder / "figures"
    figures.mkdir(exist_ok=True)
    named = [name for one in done for name, _ in one.drawings]
    files = [
        output.write_text(folder / "README.md", markdown(page.page(paper, done))),
        output.write_json(folder / "results.json", found),
        *((drawn / name).replace(figures / name) for name in named),
    ]
    for file in figures.iterdir():
        if file.suffix in SUFFIXES and file.name not in named:
            file.unlink()  # of an earlier page
    return files


def run_as_program(paper: Paper) -> None:
    """What `python -m experiments.PAPER` does."""
    from usvjax.devices import use_compilation_cache

    use_compilation_cache()
    sys.exit(as_command(partial(main, paper), whole=True))
