"""`usvjax animate`: one episode of a run with its dynamic window."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro
from rich.console import Console
from rich.progress import Progress

if TYPE_CHECKING:
    import polars as pl

RunPath = Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RUN")]
AsJson = Annotated[bool, tyro.conf.FlagCreatePairsOff, tyro.conf.arg(name="json")]
Job = Annotated[int | None, tyro.conf.arg(metavar="N")]
Method = Annotated[str | None, tyro.conf.arg(metavar="NAME")]
OutFile = Annotated[Path | None, tyro.conf.arg(metavar="FILE")]


def animate(
    run: RunPath,
    job: Job = None,
    condition: int = 0,
    method: Method = None,
    out: OutFile = None,
    max_frames: int = 120,
    fps: int = 12,
    folder: Path = Path(),
    as_json: AsJson = False,
) -> None:
    """Animate one episode: the vessel, the candidate paths by score, and the dynamic window.

    The episode is simulated again, and must end as the run says it did.

    Example: usvjax animate runs/tan2022 --job 3 --method traditional

    Args:
        run: Directory that `usvjax study` wrote.
        job: Number of the episode; by default the one that `usvjax plot` shows.
        condition: Number of the condition, from 0, in the order of the study.
        method: Method of the run; by default its last.
        out: File to write, .gif, or .mp4 where ffmpeg is installed; by default in RUN/figures.
        max_frames: Frames at most; steps between them are skipped evenly.
        fps: Frames per second.
        folder: What a map file named by the study is relative to, if it uses one of your own.
        as_json: Print the file written as JSON, for scripts.
    """
    from usvjax.devices import use_compilation_cache
    from usvjax.missions.dwa.film import animate_episode
    from usvjax.plots.film import check_animation
    from usvjax.study import load_run
    from usvjax.study.replays import replay

    use_compilation_cache()
    opened = load_run(run)
    table = opened.table()
    method = opened.methods[-1] if method is None else method
    number = _default_job(table, condition, opened.methods) if job is None else job
    name = f"episode-c{condition}-{method}-j{number}.gif"
    target = run / "figures" / name if out is None else out
    check_animation(target, max_frames=max_frames, fps=fps)
    found = replay(opened, table, condition, method, [number], folder=folder)
    with _bar(as_json) as progress:
        animate_episode(
            found.episode(0),
            found.decide(0),
            target,
            max_frames=max_frames,
            fps=fps,
            progress=progress,
        )
    if as_json:
        print(json.dumps({"run": str(run), "animation": str(target)}))
        return
    Console(highlight=False, markup=False, soft_wrap=True).print(f"Animation  {target}")


def _default_job(table: "pl.DataFrame", condition: int, methods: list[str]) -> int:
    """Return the episode that stands for a condition; 0 where there is no such condition."""
    import polars as pl

    from usvjax.missions.dwa.figures import typical_job

    mine = table.filter(pl.col("condition") == condition)
    return 0 if mine.is_empty() else typical_job(mine, methods)[0]


@contextmanager
def _bar(quiet: bool) -> Iterator[Callable[[int, int], None]]:
    """Give a function from (frames done, frames in all) that moves a bar on stderr."""
    with Progress(console=Console(stderr=True), disable=quiet) as progress:
        task = progress.add_task("frames", total=None)
        yield lambda done, total: progress.update(task, completed=done, total=total)
