"""Wei & Zhang 2023: Figs. 5 and 7 to 21, then the same on thousands of scenes.

Run it with `usvjax reproduce wei2023` or `python -m experiments.wei2023`; `--help` lists the
options.
"""

from dataclasses import dataclass
from typing import Annotated

import tyro

from experiments.paper import Absent, Options, Paper, Part, run_as_program
from experiments.wei2023.aggregation import PART as AGGREGATION
from experiments.wei2023.claims import claims
from experiments.wei2023.compare import measure
from experiments.wei2023.encounters import PART as ENCOUNTERS
from experiments.wei2023.figures import figures
from experiments.wei2023.headings import PART as HEADINGS
from experiments.wei2023.report import readings, sections, summary
from experiments.wei2023.runs import runs


@dataclass(frozen=True)
class Sizes(Options):
    """Regenerate Figs. 5 and 7 to 21 of Wei & Zhang 2023, and do so on many scenes.

    Attributes:
        scenes: Of each kind, on which paths are smoothed; 1,000, or 60 with --quick.
    """

    scenes: Annotated[int | None, tyro.conf.arg(metavar="N")] = None


PAPER = Paper(
    name="wei2023",
    cite="Wei & Zhang 2023",
    title="key points of the global path, the heading at the goal, encounters, and aggregation",
    about="The paper's Figs. 5 and 7 to 21 on scenes of ours, and on many more.",
    options=Sizes,
    parts=[
        Part(
            name="paths",
            title="The global path: Figs. 7 and 8",
            runs=runs,
            measure=measure,
            claims=claims,
            sections=sections,
            figures=figures,
            readings=readings,
            summary=summary,
        ),
        HEADINGS,
        ENCOUNTERS,
        AGGREGATION,
    ],
    absent=[
        Absent("Figs. 1 to 4 and 6", "flow charts and sketches, with nothing to compare"),
        Absent("Tables 1 and 2", "parameters; those of the global path are in use here"),
        Absent("Table 3", "words on a method with velocity obstacles, without numbers"),
    ],
)

if __name__ == "__main__":
    run_as_program(PAPER)
