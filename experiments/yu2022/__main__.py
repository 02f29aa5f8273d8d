"""Yu et al. 2022: the heuristic of D* Lite, whole cruises, and the swarms on test functions.

Run it with ``usvjax reproduce yu2022`` or ``python -m experiments.yu2022``; ``--help`` lists the
options.
"""

import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from time import monotonic
from typing import Annotated, Any

import jax
import tyro

import usvjax as uj
from experiments.program import begin, conclude
from experiments.yu2022.cruises.run import run as run_cruises
from experiments.yu2022.functions.run import run as run_functions
from experiments.yu2022.heuristic.run import run as run_heuristic
from experiments.yu2022.parts import MANY_RUNS, MAPS, SWARM_RUNS, Part, markdown
from usvjax.errors import BadInputError

SEED = 2022


@dataclass(frozen=True)
class Options:
    """Regenerate the tables and figures of Yu et al. 2022 beside the published values.

    Attributes:
        quick: A look in a minute or two: few maps, one case, few runs.
        out: Folder for README.md, results.json and figures/. By default the checkout's
            experiments/results/yu2022, or runs/yu2022_quick with --quick or a size of yours.
        maps: Random maps of each kind for the heuristic; 1,000, or 100 with --quick.
        runs: Cruises of Case 1, and runs on each test function; 1,000, or 24 with --quick.
        swarm_runs: Cruises of Case 1 by Algorithms 1 to 3, which are slow; 50, as printed, or 2
            with --quick.
    """

    quick: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    out: Annotated[Path | None, tyro.conf.arg(metavar="FOLDER")] = None
    maps: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    runs: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    swarm_runs: Annotated[int | None, tyro.conf.arg(metavar="N")] = None


def main(argv: Sequence[str] | None = None) -> int:
    """Run the experiments.

    Args:
        argv: options; those of the process when None.

    Returns:
        The exit code: 2, after one line on stderr, for a user's mistake.
    """
    ready = begin("yu2022", Options, argv, _plan)
    if ready is None:
        return 2
    options, plan, folder = ready
    begun = monotonic()
    parts = [_alone(run) for run in plan]
    found: dict[str, Any] = {
        "format": 2,
        "settings": {"usvjax": uj.__version__, "seed": SEED, "quick": options.quick},
        **{part.name: part.found for part in parts},
        "verdicts": [asdict(verdict) for part in parts for verdict in part.verdicts],
    }
    done = ", ".join(part.done for part in parts)
    conclude(
        folder,
        found,
        markdown(parts),
        lambda into: [file for part in parts for file in part.draw(into)],
        ("Yu et al. 2022", [verdict for part in parts for verdict in part.verdicts]),
        f"{done} in {monotonic() - begun:,.0f} s",
    )
    return 0


def _plan(options: Options) -> list[Callable[[], Part]]:
    """Turn options into the parts to run.

    Raises:
        BadInputError: fewer than one map or run.
    """
    for name, what in (("maps", "map of each kind"), ("runs", "run"), ("swarm_runs", "run")):
        value = getattr(options, name)
        if value is not None and value < 1:
            option = name.replace("_", "-")
            raise BadInputError(f"--{option}: got {value}; wanted at least 1 {what}")
    quick = options.quick
    maps = options.maps or (100 if quick else MAPS)
    runs = options.runs or (24 if quick else MANY_RUNS)
    swarm_runs = options.swarm_runs or (2 if quick else SWARM_RUNS)
    return [
        partial(run_heuristic, maps, SEED, quick),
        partial(run_cruises, runs, swarm_runs, SEED, quick),
        partial(run_functions, runs, SEED, quick),
    ]


def _alone(run: Callable[[], Part]) -> Part:
    """Run a part and let go of its programs, of which a process can hold only so many."""
    part = run()
    jax.clear_caches()
    return part


if __name__ == "__main__":
    from usvjax.devices import use_compilation_cache

    use_compilation_cache()
    sys.exit(main())
