"""The figures of a run, as its mission draws them."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import polars as pl

from usvjax.errors import BadInputError
from usvjax.mission import MOST_CONDITIONS
from usvjax.pictures import DPI, check_pictures
from usvjax.public import public
from usvjax.study.finished import FIGURES, as_recorded, maker, record
from usvjax.study.folder import check_no_link, in_one_line, json_bytes, write_plain
from usvjax.study.meanings import units_of
from usvjax.study.reader import Run, load_run
from usvjax.study.replay import Replay
from usvjax.study.shards import Layout, find_shards

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FOLDER = "figures"
FORMATS = ("png",)
MAX_EXAMPLES = 4
MAX_PATHS = 200


@public()
def figures_for_run(
    run_dir: str | Path,
    *,
    formats: tuple[str, ...] = FORMATS,
    dpi: int = DPI,
    max_examples: int = MAX_EXAMPLES,
    max_paths: int = MAX_PATHS,
    folder: Path | None = None,
    on_written: Callable[[Path], None] | None = None,
) -> list[Path]:
    """Draw the figures of a run into its folder "figures"; which ones, its mission says.

    Args:
        run_dir: directory that `usvjax study` wrote; the run may be unfinished.
        formats: to write, of "png", "pdf" and "svg"; tables are written as .csv.
        dpi: dots per inch of a PNG, 20 to 1200.
        max_examples: conditions to simulate again; 0 simulates nothing.
        max_paths: trajectories of a chart.
        folder: of the study; the working directory when None. Where it has all files that the
            study names, they must be as they were; else the copies that the run holds are read.
        on_written: called with every file as soon as it is there.

    Returns:
        The files written.

    Raises:
        BadInputError: it is no run, it has no episodes yet, a format is unknown, its episodes
            cannot be had back (see `usvjax.study.replay.Replay`), or the folder cannot be
            written. What was drawn before stays.
    """
    check_pictures(formats, dpi)
    for name, value, least in (("max_examples", max_examples, 0), ("max_paths", max_paths, 1)):
        if value < least:
            raise BadInputError(f"{name} is {value}; at least {least} was wanted")
    run = load_run(run_dir)
    replay = Replay(run, folder or Path(), max_examples, max_paths)
    check_no_link(run.path / FOLDER)
    written = []
    for name, drawn in _drawn(run, replay):
        for file in _saved(drawn, run.path / FOLDER / name, formats, dpi):
            written.append(file)
            if on_written is not None:
                on_written(file)
    _note(replay, written, _asked(formats, dpi, max_examples, max_paths))
    return written


def _drawn(run: Run, replay: Replay) -> Iterator[tuple[str, "Figure | pl.DataFrame"]]:
    """The figures of the mission; of many conditions, first one of how they all went."""
    mission = replay.mission
    if len(run.settings) > MOST_CONDITIONS:
        from usvjax.plots.overview import plot_overview

        fig = plot_overview(
            replay.table,
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


def figures_as_drawn(
    run_dir: str | Path, folder: Path, *, formats: tuple[str, ...] = FORMATS, dpi: int = DPI
) -> list[Path] | None:
    """The figures of a run, where `figures_for_run` would draw them just so again.

    Args:
        run_dir, folder, formats, dpi: as for `figures_for_run`.

    Returns:
        The files; None where any is missing, or would be another now.
    """
    run = load_run(run_dir)
    replay = Replay(run, folder)
    asked = _asked(formats, dpi, MAX_EXAMPLES, MAX_PATHS)
    made = as_recorded(run.path, FIGURES, _maker(replay), _shards(run), **asked)
    return None if made is None else [run.path / name for name in made]


def _note(replay: Replay, written: list[Path], asked: dict[str, Any]) -> None:
    """Write down what figures were drawn from."""
    run = replay.run
    made = {f"{FOLDER}/{path.name}": path.read_bytes() for path in written}
    content = json_bytes(record(_maker(replay), _shards(run), made, **asked))
    with in_one_line(f"write {run.path / FIGURES}"):
        write_plain(run.path / FIGURES, content)


def _asked(formats: tuple[str, ...], dpi: int, max_examples: int, max_paths: int) -> dict[str, Any]:
    return {
        "formats": list(formats),
        "dpi": dpi,
        "max_examples": max_examples,
        "max_paths": max_paths,
    }


def _maker(replay: Replay) -> str:
    return maker(replay.plugin.path if replay.plugin else None)


def _shards(run: Run) -> list[Path]:
    return list(find_shards(run.path, Layout.of(run.manifest["study"])).values())


def _saved(
    drawn: "Figure | pl.DataFrame", path: Path, formats: tuple[str, ...], dpi: int
) -> Iterator[Path]:
    """Write one figure in each format, or a table; `path` has no suffix."""
    from usvjax.plots import style

    if not isinstance(drawn, pl.DataFrame):
        for name in formats:
            yield style.save(drawn, path.with_name(f"{path.name}.{name}"), dpi=dpi)
        return
    text = drawn.write_csv()
    target = path.with_name(f"{path.name}.csv")
    yield style.write_atomically(target, lambda file: file.write_text(text, encoding="utf-8"))
