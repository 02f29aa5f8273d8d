"""`usvjax animate`: one episode of a run."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import tyro

from usvjax.cli.console import Meter, show_line
from usvjax.cli.episodes import Job, Method, OutFile, RunPath, choose
from usvjax.cli.figures import Dpi

AsJson = Annotated[bool, tyro.conf.FlagCreatePairsOff, tyro.conf.arg(name="json")]


def animate(
    run: RunPath,
    job: Job = None,
    condition: int = 0,
    method: Method = None,
    out: OutFile = None,
    max_frames: int = 120,
    fps: int = 12,
    dpi: Dpi = 110,
    folder: Path = Path(),
    as_json: AsJson = False,
) -> None:
    """Animate one episode of a run of any kind.

    Of DWA: the vessel, the candidate paths by score, and the dynamic window; of the others, the
    vessel on its way. The episode is simulated again, and must end as the run says it did.

    Example: usvjax animate runs/tan2022 --job 3 --method traditional

    Args:
        run: Directory that `usvjax study` wrote.
        job: Number of the episode; by default the one that `usvjax plot` shows.
        condition: Number of the condition, from 0, in the order of the study.
        method: Method of the run; by default its last.
        out: File to write, .gif, or .mp4 where ffmpeg is installed; by default in RUN/figures.
        max_frames: Frames at most; steps between them are skipped evenly.
        fps: Frames per second.
        dpi: Dots per inch, 20 to 1200.
        folder: Of the study; where files that it names have changed there, the run is refused.
            Where they are not, the copies that the run holds are read.
        as_json: Print the file written as JSON, for scripts.
    """
    from usvjax.devices import use_compilation_cache
    from usvjax.plots.film import check_animation, write_film

    use_compilation_cache()
    chosen = choose(run, condition, method, job, folder)
    target = chosen.place(f"episode-{chosen.name}.gif") if out is None else out
    check_animation(target, max_frames=max_frames, fps=fps, dpi=dpi)
    film = chosen.replay.mission.film(chosen.again(), 0)
    with _bar(as_json) as progress:
        write_film(film, target, max_frames=max_frames, fps=fps, dpi=dpi, progress=progress)
    if as_json:
        print(json.dumps({"run": str(run), "animation": str(target)}))
        return
    show_line(f"Animation  {target}")


@contextmanager
def _bar(quiet: bool) -> Iterator[Callable[[int, int], None]]:
    """Give a function from (frames done, frames in all) that moves a bar on stderr."""
    meter = Meter("film", "frames", quiet)

    def drawn(done: int, total: int) -> None:
        if done <= 1:
            meter.begin(done, total)
        else:
            meter.advance(1)

    try:
        yield drawn
    finally:
        meter.end(whole=False)
