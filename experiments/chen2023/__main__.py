"""Chen et al. 2023: Figs. 15 to 18 and Tables 2 and 3, then the same on 1,000 scenes.

Run it with ``usvjax reproduce chen2023`` or ``python -m experiments.chen2023``; ``--help`` lists
the options.
"""

import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import monotonic
from typing import Annotated, Any

import tyro

import usvjax as uj
from experiments.chen2023 import tables
from experiments.chen2023.charts import draw_corners, draw_monte_carlo
from experiments.chen2023.figures import Shown, chosen_scenes, draw_shown
from experiments.chen2023.published import ENDS, arithmetic
from experiments.chen2023.report import markdown
from experiments.chen2023.routes import METHODS, search
from experiments.chen2023.runs import Job, Results, make_job, run
from experiments.chen2023.scenes import CELL, SIDE, draw_scenes
from experiments.chen2023.timing import timings
from experiments.chen2023.verdicts import judge
from experiments.files import progress
from experiments.program import begin, conclude
from usvjax.errors import BadInputError

PAPER = "chen2023"
SCENES, FEW, REPEATS = 1000, 200, 15
QUICK_SCENES, QUICK_FEW, QUICK_REPEATS = 36, 24, 3


@dataclass(frozen=True)
class Options:
    """Regenerate the path planning of Chen et al. 2023 beside the published values.

    Attributes:
        quick: A look in half a minute: few scenes.
        out: Folder for README.md, results.json and figures/. By default the checkout's
            experiments/results/chen2023, or runs/chen2023_quick with --quick or --scenes.
        scenes: Scenes with the printed expansion; 1,000, or 36 with --quick.
    """

    quick: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    out: Annotated[Path | None, tyro.conf.arg(metavar="FOLDER")] = None
    scenes: Annotated[int | None, tyro.conf.arg(metavar="N")] = None


def main(argv: Sequence[str] | None = None) -> int:
    """Run the experiments.

    Args:
        argv: options; those of the process when None.

    Returns:
        The exit code: 2, after one line on stderr, for a user's mistake.
    """
    ready = begin(PAPER, Options, argv, _job)
    if ready is None:
        return 2
    _, job, folder = ready
    begun = monotonic()
    routes = sum(plan.routes for plan in job.plans)
    with progress("routes", routes) as advance:
        results = run(job, advance)
    found, shown = _found(job, results)
    verdicts = judge(found)
    found["verdicts"] = [asdict(verdict) for verdict in verdicts]
    conclude(
        folder,
        found,
        markdown(found),
        lambda into: [
            *(draw_shown(entry, into) for entry in shown),
            draw_monte_carlo(found, results[job.main], into),
            draw_corners(found, into),
        ],
        ("Chen et al. 2023", verdicts),
        f"{routes:,} routes in {monotonic() - begun:,.0f} s",
    )
    return 0


def _job(options: Options) -> Job:
    """Turn options into plans.

    Raises:
        BadInputError: fewer than one scene.
    """
    scenes = options.scenes
    if scenes is not None and scenes < 1:
        raise BadInputError(f"--scenes: got {scenes}; wanted at least 1")
    if options.quick:
        return make_job(scenes or QUICK_SCENES, QUICK_FEW, QUICK_REPEATS, quick=True)
    return make_job(scenes or SCENES, FEW, REPEATS, quick=False)


def _found(job: Job, results: Results) -> tuple[dict[str, Any], list[Shown]]:
    """Make every table, for results.json, and choose the scenes of the figures."""
    measured = results[job.main]
    bare = next((plan for plan in job.expansions if plan.expansion == 0.0), None)
    shown = chosen_scenes(job.main, bare, results)
    block = search(
        draw_scenes(min(job.main.scenes, job.block), job.main.waters), job.main.expansion
    )
    alone = search(draw_scenes(1, job.main.waters), job.main.expansion)
    found = {
        "format": 1,
        "settings": {
            "usvjax": uj.__version__,
            "cell": CELL,
            "side": SIDE,
            "ends": ENDS,
            "main": {**job.main.described(), "words": job.main.waters.words},
            "expansions": [plan.described() for plan in job.expansions],
            "waters": [plan.described() for plan in job.waters],
        },
        "shown": [entry.described() for entry in shown],
        "sailing": tables.sailing(measured, METHODS),
        "paired_contacts": tables.paired_contacts(measured),
        "bends": tables.bends(measured, METHODS),
        "corners": tables.corners(measured, METHODS),
        "compared": tables.compare(measured),
        "expansions": tables.over_expansions(job.expansions, results),
        "waters": tables.over_waters(job.waters, results),
        "timing": timings(block, alone, job.repeats),
        "arithmetic": [asdict(check) for check in arithmetic()],
    }
    return found, shown


if __name__ == "__main__":
    from usvjax.devices import use_compilation_cache

    use_compilation_cache()
    sys.exit(main())
