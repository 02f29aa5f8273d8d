"""Tan et al. 2022: every table and figure, then the same on thousands of paired maps.

Run it with ``usvjax reproduce tan2022`` or ``python -m experiments.tan2022``; ``--help`` lists
the options.
"""

from dataclasses import dataclass
from typing import Annotated

import tyro

from experiments.paper import Absent, Options, Paper, Part, run_as_program
from experiments.runs import Study
from experiments.tan2022.arithmetic import arithmetic
from experiments.tan2022.claims import claims
from experiments.tan2022.episodes import Asked, studies
from experiments.tan2022.figures import figures
from experiments.tan2022.measures import COUNTED, measure
from experiments.tan2022.readings import (
    ALONG_DEMO,
    ALONG_PRESET,
    CASES,
    MAIN,
    ONE_MAP_CASES,
    combinations,
    quick_sensitivities,
    sensitivities,
)
from experiments.tan2022.sections import sections
from experiments.tan2022.why import readings, summary
from usvjax.errors import BadInputError

MAPS, MANY, FEW, VARIED, RANKED = 10_000, 5_000, 2_000, 500, 300
"""Paired maps per radius: of the main readings, of the others that count for verdicts, of those
with dist along the trajectory, of the sensitivities, and of the ranking."""
QUICK = 100


@dataclass(frozen=True)
class TanOptions(Options):
    """Regenerate the tables and figures of Tan et al. 2022 beside the published values.

    Attributes:
        episodes: Paired maps per radius; 10,000, or 100 with --quick.
    """

    episodes: Annotated[int | None, tyro.conf.arg(metavar="N")] = None


def runs(options: TanOptions) -> dict[str, Study]:
    """What to run.

    Raises:
        BadInputError: fewer than one episode.
    """
    maps = options.episodes
    if maps is not None and maps < 1:
        raise BadInputError(f"--episodes: got {maps}; wanted at least 1 map per radius")
    maps = maps or (QUICK if options.quick else MAPS)
    many, few, varied, ranked = (min(maps, most) for most in (MANY, FEW, VARIED, RANKED))
    counted = [
        ("along the trajectory", few, one)
        if one in (ALONG_PRESET, ALONG_DEMO)
        else ("others that count", many, one)
        for one in COUNTED
    ]
    cases = (*CASES, *ONE_MAP_CASES)
    alone = quick_sensitivities() if options.quick else sensitivities()
    combined = [] if options.quick else combinations()
    return studies(
        [
            *(Asked("main readings", maps, reading, case) for reading in MAIN for case in CASES),
            *(Asked(*which, case) for which in counted for case in cases),
            *(Asked("varied", varied, reading, case) for reading in alone for case in CASES),
            *(Asked("ranked", ranked, reading, case) for reading in combined for case in CASES),
        ]
    )


PAPER = Paper(
    name="tan2022",
    cite="Tan et al. 2022",
    title="DWA with an obstacle search angle",
    about="The paper's Tables 2 to 4 and Figs. 2 to 7 on maps of ours, published values beside "
    "them; then both methods on thousands of paired maps; then what the result owes to everything "
    "that the paper does not print.",
    options=TanOptions,
    parts=[
        Part(
            name="dwa",
            title="Traditional against improved",
            runs=runs,
            measure=measure,
            claims=claims,
            sections=sections,
            figures=figures,
            readings=readings,
            summary=summary,
        )
    ],
    absent=[
        Absent("Fig. 1", "it sketches the search sector and holds no result"),
        Absent("Table 1", "parameters, which the preset `tan2022` holds"),
        Absent(
            "that paths of the improved method turn less (text on Figs. 2 to 7)",
            "no number is given, and episodes keep no measure of turning",
        ),
    ],
    checks=arithmetic,
)

if __name__ == "__main__":
    run_as_program(PAPER)
