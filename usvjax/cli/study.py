"""`usvjax study`: run a study with a progress bar, then show what it found."""

import json
import os
import shlex
import sys
from pathlib import Path
from typing import Annotated

import tyro

from usvjax.cli.console import StudyMeter, show, show_line
from usvjax.cli.figures import Dpi, Formats
from usvjax.pictures import DPI, check_pictures

StudyPath = Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE.toml")]
AsJson = Annotated[bool, tyro.conf.FlagCreatePairsOff, tyro.conf.arg(name="json")]
Flag = Annotated[bool, tyro.conf.FlagCreatePairsOff]
Devices = Annotated[int | None, tyro.conf.arg(metavar="N")]


def study(
    file: StudyPath,
    out: Path = Path("runs"),
    as_json: AsJson = False,
    devices: Devices = None,
    quiet: Flag = False,
    no_figures: Flag = False,
    formats: Formats = ("png",),
    dpi: Dpi = DPI,
) -> None:
    """Run a study, or continue one that was stopped or killed.

    Results go to OUT/NAME: Parquet shards, manifest.json, summary.json, summary.md, figures.
    The same command continues a run where it stopped; a run of a changed study, or of another
    version, is refused and left alone.

    Example: usvjax study studies/tan2022.toml --out runs

    Args:
        file: The study; see studies/ for examples.
        out: Folder that holds the run directories.
        as_json: Print the summary as JSON, for scripts.
        devices: How many devices (on a CPU, cores) to use; all by default. Results do not
            depend on it.
        quiet: No progress bar.
        no_figures: Draw no figures; `usvjax plot` draws them later.
        formats: File formats of figures, one or more: png, pdf or svg.
        dpi: Dots per inch of a png, 20 to 1200.
    """
    from usvjax.devices import use_compilation_cache
    from usvjax.study.report import terminal
    from usvjax.study.runner import StudyStoppedError
    from usvjax.study.spec import load_spec
    from usvjax.study.study import run_study

    check_pictures(formats, dpi)
    use_compilation_cache()
    spec = load_spec(file)
    again = shlex.join(["usvjax", "study", str(file), "--out", str(out)])
    try:
        with StudyMeter(spec.name, quiet) as bar:
            result = run_study(spec, out, devices=devices, listener=bar)
    except StudyStoppedError as stop:
        had = f"stopped with {stop.done:,} of {stop.total:,} episodes on disk"
        raise KeyboardInterrupt(f"{had}; continue with: {again}") from None
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"interrupted; continue with: {again}") from None
    figures = [] if no_figures else _figures(result.path, file.parent, formats, dpi)
    if not result.written:
        _tell(f"{result.path} may only be read; its summary was computed and not written")
    if as_json:
        found = {"run": str(result.path), "figures": list(map(str, figures))}
        print(json.dumps({**found, "summary": result.summary}))
        return
    show(*terminal(result.summary))
    show_line(f"Run      {result.path}")
    if result.written:
        show_line(f"Summary  {result.path / 'summary.md'}")
    for figure in figures:
        show_line(f"Figure   {figure}")


def _figures(run: Path, folder: Path, formats: tuple[str, ...], dpi: int) -> list[Path]:
    """The figures of a run, drawn unless they are there; `folder` is that of its study."""
    from usvjax.study.figures import figures_as_drawn, figures_for_run

    drawn = figures_as_drawn(run, folder, formats=formats, dpi=dpi)
    if drawn is not None:
        return drawn
    if not os.access(run, os.W_OK):
        _tell(f"{run} may only be read; its figures are not drawn")
        return []
    return figures_for_run(run, folder=folder, formats=formats, dpi=dpi)


def _tell(line: str) -> None:
    print("usvjax:", line, file=sys.stderr)
