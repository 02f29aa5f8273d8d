"""Tan et al. 2022: every table and figure, then the same on thousands of paired maps.

Run it with ``usvjax reproduce tan2022`` or ``python -m experiments.tan2022``; ``--help`` lists
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
from experiments.tan2022.episodes import Plan, Results, Run, sail, total
from experiments.tan2022.figures import cap_figure, draw_maps, draw_paired
from experiments.tan2022.paired import Comparison, compare, sensitivities
from experiments.tan2022.published import METHODS, arithmetic, cap_bounds
from experiments.tan2022.ranking import Match, rank, with_hits
from experiments.tan2022.readings import (
    CAPS,
    CASES,
    DEMO,
    DEMO_START,
    ONE_MAP_CASES,
    PRESET,
    Reading,
    combinations,
    quick_readings,
    readings,
)
from experiments.tan2022.report import markdown
from experiments.tan2022.tables import (
    everything_shown,
    one_map,
    single_maps,
    three_maps,
    twenty_maps,
)
from experiments.tan2022.verdicts import evidence, judge
from experiments.verdicts import Verdict
from usvjax.errors import BadInputError
from usvjax.plots import save

MAIN = (PRESET, DEMO, DEMO_START)
"""Readings that are run on all paired maps."""
SHOWN = (PRESET, DEMO)
"""Readings that Tables 2 to 4 and Figs. 2 to 7 are made under."""
COMPARISONS = (
    *(Comparison(reading.label, reading, reading) for reading in MAIN),
    Comparison("hybrid", DEMO, PRESET),
)
TOP = 12
"""Lines of the ranking that are reported of each kind."""


@dataclass(frozen=True)
class Options:
    """Regenerate the tables and figures of Tan et al. 2022 beside the published values.

    Attributes:
        quick: A look in under a minute: few maps and few readings.
        out: Folder for README.md, results.json and figures/. By default the checkout's
            experiments/results/tan2022, or runs/tan2022_quick with --quick or --episodes.
        episodes: Paired maps per radius; 10,000, or 200 with --quick.
    """

    quick: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    out: Annotated[Path | None, tyro.conf.arg(metavar="FOLDER")] = None
    episodes: Annotated[int | None, tyro.conf.arg(metavar="N")] = None


@dataclass(frozen=True)
class Job:
    """What to run.

    Attributes:
        paired: maps of the paired runs, and of Tables 3 and 4.
        one_map: maps that Table 2's is chosen from.
        varied: maps of the sensitivity study.
        readings: that the study goes through.
        ranked: maps of the ranking.
        combinations: readings that are ranked.
    """

    paired: Plan
    one_map: Plan
    varied: Plan
    readings: list[Reading]
    ranked: Plan
    combinations: list[Reading]

    def runs(self) -> list[Run]:
        """Return all runs; what several tables need is in it several times."""
        wanted = [
            (self.paired, list(MAIN), CASES),
            (self.one_map, list(MAIN), ONE_MAP_CASES),
            (self.varied, self.readings, CASES),
            (self.ranked, self.combinations, CASES),
        ]
        return [
            plan.run(reading, case, method)
            for plan, chosen, cases in wanted
            for reading in chosen
            for case in cases
            for method in METHODS
        ]


def main(argv: Sequence[str] | None = None) -> int:
    """Run the experiments.

    Args:
        argv: options; those of the process when None.

    Returns:
        The exit code: 2, after one line on stderr, for a user's mistake.
    """
    ready = begin("tan2022", Options, argv, _job)
    if ready is None:
        return 2
    _, job, folder = ready
    episodes, begun = total(job.runs()), monotonic()
    with progress("episodes", episodes) as advance:
        results = sail(job.runs(), advance)
    took = monotonic() - begun
    found, verdicts = _found(job, results)
    conclude(
        folder,
        found,
        markdown(found),
        lambda into: _figures(job, results, found, into),
        ("Tan et al. 2022", verdicts),
        f"{episodes:,} episodes in {took:,.0f} s",
    )
    return 0


def _job(options: Options) -> Job:
    """Turn options into plans.

    Raises:
        BadInputError: fewer than one episode.
    """
    episodes = options.episodes
    if episodes is not None and episodes < 1:
        raise BadInputError(f"--episodes: got {episodes}; wanted at least 1 map per radius")
    quick = options.quick
    return Job(
        paired=Plan(2022, episodes or (200 if quick else 10_000), few_maps=0),
        varied=Plan(2023, 40, 8) if quick else Plan(2023, 1000, 200),
        one_map=Plan(2024, 200 if quick else 1000, few_maps=0),
        readings=quick_readings() if quick else readings(),
        ranked=Plan(2023, 100 if quick else 300, few_maps=0),
        combinations=[PRESET, DEMO] if quick else combinations(),
    )


def _found(job: Job, results: Results) -> tuple[dict[str, Any], list[Verdict]]:
    """Make every table; the first part is what goes to results.json."""
    paired = compare(COMPARISONS, results, job.paired)
    known = [
        evidence(comparison, row, results, job.paired, job.one_map)
        for comparison, row in zip(COMPARISONS, paired, strict=True)
    ]
    verdicts = judge(known)
    found = {
        "format": 1,
        "settings": {
            "usvjax": uj.__version__,
            "paired": asdict(job.paired),
            "one_map": asdict(job.one_map),
            "varied": asdict(job.varied),
            "ranked": asdict(job.ranked),
        },
        "verdicts": [asdict(verdict) for verdict in verdicts],
        "tables": {reading.label: _tables(job, results, reading) for reading in SHOWN},
        "paired": paired,
        "sensitivities": sensitivities(job.readings, results, job.varied),
        "ranking": _ranking(job, results),
        "arithmetic": [asdict(check) for check in arithmetic()],
        "cap_bounds": [
            {**asdict(bound), "excludes_demo_cap": bound.excludes_demo_cap}
            for bound in cap_bounds()
        ],
    }
    return found, verdicts


def _tables(job: Job, results: Results, reading: Reading) -> dict[str, Any]:
    return {
        "2": single_maps(one_map(results, job.one_map, reading), results),
        "3": single_maps(three_maps(results, job.paired, reading), results),
        "4": twenty_maps(results, job.paired, reading),
    }


def _ranking(job: Job, results: Results) -> dict[str, Any]:
    """Return the nearest readings and the nearest hybrids."""
    outcomes = {
        (reading, method): [results[job.ranked.run(reading, case, method)] for case in CASES]
        for reading in job.combinations
        for method in METHODS
    }
    by_label = {reading.label: reading for reading in job.combinations}

    def line(match: Match) -> dict[str, Any]:
        own = {m: outcomes[by_label[getattr(match, m)], m] for m in METHODS}
        counted = with_hits(match, own, job.ranked.seed)
        values = {"values": match.values.tolist(), "typical_factor": match.typical_factor}
        return {**asdict(counted), **values}

    ranked = [m for m in rank(job.combinations, outcomes) if m.distance < float("inf")]
    return {
        "readings": len(job.combinations),
        "ranked": len(ranked),
        "single": [line(m) for m in ranked if not m.is_hybrid][:TOP],
        "hybrid": [line(m) for m in ranked if m.is_hybrid][:TOP],
    }


def _figures(job: Job, results: Results, found: dict[str, Any], folder: Path) -> list[Path]:
    files = []
    for reading in SHOWN:
        shown = list(everything_shown(results, job.one_map, job.paired, reading))
        files += draw_maps(shown, results, reading.label, folder)
    files += draw_paired(COMPARISONS, results, job.paired, folder)
    figure = cap_figure(found["sensitivities"], CAPS)
    return [*files, save(figure, folder / "cap.png", dpi=130)]


if __name__ == "__main__":
    from usvjax.devices import use_compilation_cache

    use_compilation_cache()
    sys.exit(main())
