"""Wei & Zhang 2023: Figs. 7 and 8, then the same on a thousand scenes.

Run it with ``usvjax reproduce wei2023`` or ``python -m experiments.wei2023``; ``--help`` lists
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
from experiments.files import progress
from experiments.program import begin, conclude
from experiments.wei2023.compare import as_many, compare, nearest
from experiments.wei2023.figures import draw as draw_figures
from experiments.wei2023.paths import SEARCHES, TEXTBOOK, Stages, plan
from experiments.wei2023.report import markdown
from experiments.wei2023.scenes import KINDS, SHOWN, Waters, draw
from experiments.wei2023.verdicts import judge
from usvjax.errors import BadInputError


@dataclass(frozen=True)
class Options:
    """Regenerate Figs. 7 and 8 of Wei & Zhang 2023, and smooth paths on many scenes.

    Attributes:
        quick: A look in half a minute, on few scenes of one kind.
        out: Folder for README.md, results.json and figures/. By default the checkout's
            experiments/results/wei2023, or runs/wei2023_quick with --quick or --scenes.
        scenes: Of each kind; 1,000, or 100 with --quick.
    """

    quick: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    out: Annotated[Path | None, tyro.conf.arg(metavar="FOLDER")] = None
    scenes: Annotated[int | None, tyro.conf.arg(metavar="N")] = None


@dataclass(frozen=True)
class Plan:
    """What to run.

    Attributes:
        scenes: of each kind.
        textbook_scenes: how many of them the textbook program searches, too.
        seed: of the scenes.
        kinds: the first is shown.
    """

    scenes: int
    textbook_scenes: int
    seed: int = 2023
    kinds: tuple[Waters, ...] = KINDS


def main(argv: Sequence[str] | None = None) -> int:
    """Run the experiments.

    Args:
        argv: options; those of the process when None.

    Returns:
        The exit code: 2, after one line on stderr, for a user's mistake.
    """
    ready = begin("wei2023", Options, argv, _plan)
    if ready is None:
        return 2
    _, chosen, folder = ready
    begun = monotonic()
    scenes = {kind.label: draw(kind, chosen.scenes, chosen.seed) for kind in chosen.kinds}
    with progress("batches", len(SEARCHES) * len(scenes) + len(TEXTBOOK)) as advance:
        results = plan(scenes, chosen.textbook_scenes, advance)
    shown = results[SHOWN.label]
    job = nearest(shown["euclidean"])
    found: dict[str, Any] = {
        "format": 1,
        "settings": {"usvjax": uj.__version__, **asdict(chosen)},
        "tables": {
            kind: {search: compare(stages) for search, stages in searches.items()}
            for kind, searches in results.items()
        },
        "as_many": {search: as_many(stages) for search, stages in shown.items()},
        "shown": _shown(shown["euclidean"], job),
    }
    verdicts = judge(found)
    found["verdicts"] = [asdict(verdict) for verdict in verdicts]
    took = monotonic() - begun
    conclude(
        folder,
        found,
        markdown(found),
        lambda into: draw_figures(scenes[SHOWN.label], job, shown, SHOWN.side, into),
        ("Wei & Zhang 2023", verdicts),
        f"{chosen.scenes * len(scenes):,} scenes in {took:,.0f} s",
    )
    return 0


def _plan(options: Options) -> Plan:
    """Turn options into a plan.

    Raises:
        BadInputError: fewer than one scene.
    """
    scenes = options.scenes
    if scenes is not None and scenes < 1:
        raise BadInputError(f"--scenes: got {scenes}; wanted at least 1 scene of each kind")
    if options.quick:
        scenes = scenes or 100
        return Plan(scenes, min(scenes, 40), kinds=KINDS[:2])
    scenes = scenes or 1000
    return Plan(scenes, min(scenes, 200))


def _shown(stages: Stages, job: int) -> dict[str, Any]:
    """One path at every stage, in numbers."""
    return {
        "scene": job,
        "stages": {
            stage: {
                "turns": int(own.turns[job]),
                "points": int(own.points[job]),
                "length": float(own.length[job]),
                "clearance": float(own.clearance[job]),
            }
            for stage, own in stages.items()
        },
    }


if __name__ == "__main__":
    from usvjax.devices import use_compilation_cache

    use_compilation_cache()
    sys.exit(main())
