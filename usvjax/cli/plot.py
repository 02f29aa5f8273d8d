"""`usvjax plot`: draw the figures of a run."""

import json
from pathlib import Path
from typing import Annotated

import tyro

from usvjax.cli.console import show_line
from usvjax.cli.figures import Dpi, Formats
from usvjax.pictures import DPI

RunPath = Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RUN")]
AsJson = Annotated[bool, tyro.conf.FlagCreatePairsOff, tyro.conf.arg(name="json")]


def plot(
    run: RunPath,
    formats: Formats = ("png",),
    dpi: Dpi = DPI,
    max_examples: int = 4,
    max_paths: int = 200,
    folder: Path = Path(),
    as_json: AsJson = False,
) -> None:
    """Draw the figures of a run, finished or still under way, into RUN/figures.

    Which ones, the kind of the study says. Mostly: how episodes ended, with intervals; how the
    methods compare where all succeeded; one episode, chosen by a rule, under all methods; many
    on a real map.

    Example: usvjax plot runs/tan2022 --format png pdf

    Args:
        run: Directory that `usvjax study` wrote.
        formats: File formats, one or more: png, pdf or svg.
        dpi: Dots per inch of a png, 20 to 1200.
        max_examples: Conditions, from the first, of which episodes are simulated again for
            paths, charts, routes and cruises; 0 for none.
        max_paths: Trajectories on a chart.
        folder: Of the study; where files that it names have changed there, the run is refused.
            Where they are not, the copies that the run holds are read.
        as_json: Print the files written as JSON, for scripts.
    """
    from usvjax.devices import use_compilation_cache
    from usvjax.study.figures import figures_for_run

    use_compilation_cache()

    def tell(path: Path) -> None:
        if not as_json:
            show_line(f"Figure   {path}")

    written = figures_for_run(
        run,
        formats=formats,
        dpi=dpi,
        max_examples=max_examples,
        max_paths=max_paths,
        folder=folder,
        on_written=tell,
    )
    if as_json:
        print(json.dumps({"run": str(run), "figures": [str(path) for path in written]}))
