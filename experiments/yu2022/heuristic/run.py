"""Fig. 5, then the same on many maps of each kind."""

from typing import Any

from experiments.files import progress
from experiments.yu2022.heuristic import report
from experiments.yu2022.heuristic.compare import episodes, first_plans
from experiments.yu2022.heuristic.expansion import Cell, expanded_cells
from experiments.yu2022.heuristic.figures import draw as draw_figures
from experiments.yu2022.heuristic.plans import EPISODES, PLANS, Replanned, Scenes, draw, sail
from experiments.yu2022.heuristic.published import HEURISTICS
from experiments.yu2022.heuristic.verdicts import judge
from experiments.yu2022.parts import Part


def run(maps: int, seed: int, quick: bool) -> Part:
    """Sail all episodes.

    Args:
        maps: of each kind.
        seed: of the maps.
        quick: leave out the large ones.
    """
    plans = tuple(c for c in PLANS if c.side == PLANS[0].side) if quick else PLANS
    conditions = (*plans, *EPISODES)
    scenes = {c.label: draw(c, maps, seed) for c in conditions}
    with progress("heuristic: batches", len(scenes) * len(HEURISTICS)) as advance:
        results = sail(scenes, advance)
    first = plans[0].label
    expanded = _expanded(scenes[first])
    found: dict[str, Any] = {
        "maps": maps,
        "plans": {c.label: first_plans(results[c.label], seed) for c in plans},
        "episodes": {c.label: episodes(results[c.label], seed) for c in EPISODES},
        "shown": _shown(first, results[first], expanded),
    }
    return Part(
        name="heuristic",
        title="The heuristic of D* Lite: Fig. 5",
        found=found,
        verdicts=judge(found),
        note=report.note(),
        summary=report.summary(found),
        readings=report.readings(found),
        text=report.tables(found),
        figures=report.FIGURES,
        draw=lambda into: draw_figures(scenes[first], results[first], expanded, found, into),
        counts=report.counts(found),
        done=f"{len(scenes) * len(HEURISTICS) * maps:,} episodes of D* Lite",
    )


def _expanded(scene: Scenes) -> dict[str, list[Cell]]:
    """The cells that each heuristic expands on the first map."""
    start, goal = (tuple(map(int, ends[0])) for ends in (scene.starts, scene.goals))
    return {
        heuristic: expanded_cells(scene.blocked[0], start, goal, heuristic)  # type: ignore[arg-type]
        for heuristic in HEURISTICS
    }


def _shown(
    label: str, sailed: dict[str, Replanned], expanded: dict[str, list[Cell]]
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
