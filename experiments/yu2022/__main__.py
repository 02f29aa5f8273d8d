"""Yu et al. 2022: Fig. 5, then the same on a thousand maps of each kind.

Run it with ``usvjax reproduce yu2022`` or ``python -m experiments.yu2022``; ``--help`` lists the
options.
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
from experiments.yu2022.compare import episodes, first_plans
from experiments.yu2022.expansion import Cell, expanded_cells
from experiments.yu2022.figures import draw as draw_figures
from experiments.yu2022.plans import EPISODES, PLANS, Condition, Sailed, Scenes, draw, sail
from experiments.yu2022.published import HEURISTICS
from experiments.yu2022.report import markdown
from experiments.yu2022.verdicts import judge
from usvjax.errors import BadInputError


@dataclass(frozen=True)
class Options:
    """Regenerate Fig. 5 of Yu et al. 2022, and count expanded nodes on many maps.

    Attributes:
        quick: A look in half a minute, on few maps and without the large ones.
        out: Folder for README.md, results.json and figures/. By default the checkout's
            experiments/results/yu2022, or runs/yu2022_quick with --quick.
        maps: Random maps of each kind; 1,000, or 100 with --quick.
    """

    quick: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    out: Annotated[Path | None, tyro.conf.arg(metavar="FOLDER")] = None
    maps: Annotated[int | None, tyro.conf.arg(metavar="N")] = None


@dataclass(frozen=True)
class Plan:
    """What to run.

    Attributes:
        seed: of the maps.
        maps: of each kind.
        plans: kinds of maps for first plans; the first is shown.
        episodes: kinds of maps that change.
    """

    maps: int
    seed: int = 2022
    plans: tuple[Condition, ...] = PLANS
    episodes: tuple[Condition, ...] = EPISODES


def main(argv: Sequence[str] | None = None) -> int:
    """Run the experiments.

    Args:
        argv: options; those of the process when None.

    Returns:
        The exit code: 2, after one line on stderr, for a user's mistake.
    """
    options = tyro.cli(Options, args=argv, prog="usvjax reproduce yu2022")
    ready = begin("yu2022", options, _plan)
    if ready is None:
        return 2
    plan, folder = ready
    begun = monotonic()
    conditions = (*plan.plans, *plan.episodes)
    scenes = {c.label: draw(c, plan.maps, plan.seed) for c in conditions}
    with progress("batches", len(scenes) * len(HEURISTICS)) as advance:
        results = sail(scenes, advance)
    first = plan.plans[0].label
    expanded = _expanded(scenes[first])
    found: dict[str, Any] = {
        "format": 1,
        "settings": {"usvjax": uj.__version__, **asdict(plan)},
        "plans": {c.label: first_plans(results[c.label], plan.seed) for c in plan.plans},
        "episodes": {c.label: episodes(results[c.label], plan.seed) for c in plan.episodes},
        "shown": _shown(first, results[first], expanded),
    }
    verdicts = judge(found)
    found["verdicts"] = [asdict(verdict) for verdict in verdicts]
    took = monotonic() - begun
    conclude(
        folder,
        found,
        markdown(found),
        lambda into: draw_figures(scenes[first], results[first], expanded, found, into),
        ("Yu et al. 2022", verdicts),
        f"{len(scenes) * len(HEURISTICS) * plan.maps:,} episodes in {took:,.0f} s",
    )
    return 0


def _plan(options: Options) -> Plan:
    """Turn options into a plan.

    Raises:
        BadInputError: fewer than one map.
    """
    maps = options.maps
    if maps is not None and maps < 1:
        raise BadInputError(f"--maps: got {maps}; wanted at least 1 map of each kind")
    if options.quick:
        small = PLANS[0].side
        few = tuple(condition for condition in PLANS if condition.side == small)
        return Plan(maps or 100, plans=few)
    return Plan(maps or 1000)


def _expanded(scene: Scenes) -> dict[str, list[Cell]]:
    """The cells that each heuristic expands on the first map."""
    start, goal = (tuple(map(int, ends[0])) for ends in (scene.starts, scene.goals))
    return {
        heuristic: expanded_cells(scene.blocked[0], start, goal, heuristic)  # type: ignore[arg-type]
        for heuristic in HEURISTICS
    }


def _shown(
    label: str, sailed: dict[str, Sailed], expanded: dict[str, list[Cell]]
) -> dict[str, Any]:
    """What the figure shows, in numbers."""
    return {
        "condition": label,
        "counts_agree": all(len(expanded[h]) == sailed[h].first[0] for h in HEURISTICS),
        "heuristics": {
            h: {"expanded": int(own.first[0]), "length": float(own.length[0])}
            for h, own in sailed.items()
        },
    }


if __name__ == "__main__":
    from usvjax.devices import use_compilation_cache

    use_compilation_cache()
    sys.exit(main())
