"""Zhang et al. 2019: Figs. 9 and 10, Tables 3 and 4, then the same on thousands of maps.

Run it with ``usvjax reproduce zhang2019`` or ``python -m experiments.zhang2019``; ``--help``
lists the options.
"""

from experiments.paper import Absent, Paper, Part, run_as_program
from experiments.zhang2019 import arithmetic, sections
from experiments.zhang2019.compare import measure
from experiments.zhang2019.figures import figures
from experiments.zhang2019.runs import ZhangOptions, runs
from experiments.zhang2019.verdicts import claims

_LATER = "comes with target search"

PAPER = Paper(
    name="zhang2019",
    cite="Zhang et al. 2019",
    title="A* with a turning cost",
    about="The paper's Figs. 9 and 10 and Tables 3 and 4 on random maps of several sizes, since "
    "its own map is not published; the exact optimum of length and turning cost beside them.",
    options=ZhangOptions,
    parts=[
        Part(
            name="searches",
            title="Searches",
            runs=runs,
            measure=measure,
            claims=claims,
            sections=sections.sections,
            figures=figures,
            readings=sections.readings,
            summary=sections.summary,
        )
    ],
    absent=[
        Absent("Fig. 1 and Table 1 (parallel search against the extended spiral)", _LATER),
        Absent("Table 2 and Fig. 8 (a simulated search for two targets)", _LATER),
        Absent(
            "Fig. 2 (global path), Figs. 3 to 5 (the three local modes)",
            f"sketches without numbers; what they show {_LATER}",
        ),
        Absent("Fig. 6 (grid map), Fig. 7 (extended nodes)", "sketches without numbers"),
        Absent("the map of Figs. 9 and 10", "a drawing; its cells are printed nowhere"),
    ],
    checks=arithmetic.checks,
)

if __name__ == "__main__":
    run_as_program(PAPER)
