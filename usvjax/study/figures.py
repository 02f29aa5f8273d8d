"""The figures of a run, as its mission draws them."""

from collections.abc import Callable, Iterator
from pathlib import Path

import polars as pl
from matplotlib.figure import Figure

from usvjax.errors import BadInputError
from usvjax.plots import style
from usvjax.plots.overview import MOST_CONDITIONS, plot_overview
from usvjax.public import public
from usvjax.study.meanings import units_of
from usvjax.study.reader import Run, load_run
from usvjax.study.replay import Replay

FOLDER = "figures"
MAX_EXAMPLES = 4
MAX_PATHS = 200


@public()
def figures_for_run(
    run_dir: str | Path,
    *,
    formats: tuple[str, ...] = (".png",),
    max_examples: int = MAX_EXAMPLES,
    max_paths: int = MAX_PATHS,
    folder: Path | None = None,
    on_written: Callable[[Path], None] | None = None,
) -> list[Path]:
    """Draw the figures of a run into its folder "figures"; which ones, its mission says.

    Args:
        run_dir: directory that `usvjax study` wrote; the run may be unfinished.
        formats: suffixes to write, of ".png", ".pdf" and ".svg"; tables are written as .csv.
        max_examples: conditions to simulate again; 0 simulates nothing.
        max_paths: trajectories of a chart.
        folder: what a map file or plug-in named by the study is relative to; the working
            directory when None. Packaged maps need none.
        on_written: called with every file as soon as it is there.

    Returns:
        The files written.

    Raises:
        BadInputError: it is no run, it has no episodes yet, a format is unknown, its episodes
            cannot be had back (see `usvjax.study.replay.Replay`), or the folder cannot be
            written. What was drawn before stays.
    """
    if not formats:
        raise BadInputError("formats is empty; at least one of .png, .pdf, .svg was wanted")
    for suffix in formats:
        style.check_suffix(Path(f"figure{suffix}"), style.FORMATS)
    for name, value, least in (("max_examples", max_examples, 0), ("max_paths", max_paths, 1)):
        if value < least:
            raise BadInputError(f"{name} is {value}; at least {least} was wanted")
    run = load_run(run_dir)
    replay = Replay(run, folder or Path(), max_examples, max_paths)
    written = []
    for name, drawn in _drawn(run, replay):
        for suffix in formats if isinstance(drawn, Figure) else (".csv",):
            written.append(_saved(drawn, run.path / FOLDER / f"{name}{suffix}"))
            if on_written is not None:
                on_written(written[-1])
    return written


def _drawn(run: Run, replay: Replay) -> Iterator[tuple[str, Figure | pl.DataFrame]]:
    """The figures of the mission; of many conditions, first one of how they all went."""
    mission = replay.mission
    if len(run.settings) > MOST_CONDITIONS:
        fig = plot_overview(
            run.table(),
            dict(enumerate(run.varied)),
            success=int(mission.endings[0]),
            methods=run.methods,
            labels=run.labels,
            words=mission.endings[0].name.lower().replace("_", " "),
            units=units_of(mission.tables),
            confidence=run.level,
            title=run.name,
        )
        yield "overview", fig
    yield from mission.figures(run, replay)


def _saved(drawn: Figure | pl.DataFrame, path: Path) -> Path:
    if isinstance(drawn, Figure):
        return style.save(drawn, path)
    return style.write_atomically(path, drawn.write_csv)
