"""`usvjax export`: where the vessels of an episode were, as a table."""

import json
from pathlib import Path
from typing import Annotated

import tyro

from usvjax.cli.console import show_line
from usvjax.cli.episodes import Job, Method, OutFile, RunPath, choose

AsJson = Annotated[bool, tyro.conf.FlagCreatePairsOff, tyro.conf.arg(name="json")]


def export(
    run: RunPath,
    job: Job = None,
    condition: int = 0,
    method: Method = None,
    out: OutFile = None,
    folder: Path = Path(),
    as_json: AsJson = False,
) -> None:
    """Write the tracks of one episode of a run as CSV: when, which vessel, and where.

    The episode is simulated again, and must end as the run says it did.

    Example: usvjax export runs/tan2022 --job 3 --method traditional

    Args:
        run: Directory that `usvjax study` wrote.
        job: Number of the episode; by default the one that `usvjax plot` shows.
        condition: Number of the condition, from 0, in the order of the study.
        method: Method of the run; by default its last.
        out: File to write; by default a .csv in RUN/figures.
        folder: Of the study; where files that it names have changed there, the run is refused.
            Where they are not, the copies that the run holds are read.
        as_json: Print the file written as JSON, for scripts.
    """
    from usvjax.devices import use_compilation_cache
    from usvjax.study.export import write_tracks

    use_compilation_cache()
    chosen = choose(run, condition, method, job, folder)
    target = chosen.place(f"track-{chosen.name}.csv") if out is None else out
    write_tracks(chosen.again(), target)
    if as_json:
        print(json.dumps({"run": str(run), "tracks": str(target)}))
        return
    show_line(f"Tracks   {target}")
