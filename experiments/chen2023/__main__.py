"""Chen et al. 2023: Figs. 15 to 18 and Tables 1 to 3, on scenes of ours.

Run it with ``usvjax reproduce chen2023`` or ``python -m experiments.chen2023``; ``--help`` lists
the options.
"""

from experiments.chen2023.arithmetic import checks
from experiments.chen2023.claims import claims
from experiments.chen2023.figures import figures
from experiments.chen2023.report import readings, sections, summary
from experiments.chen2023.studies import Chen, runs
from experiments.chen2023.tables import measure
from experiments.paper import Absent, Paper, Part, run_as_program

PAPER = Paper(
    name="chen2023",
    cite="Chen et al. 2023",
    title="A* smoothed to a vessel's turning circle",
    about="Figs. 15 to 18 and Tables 1 to 3 on scenes of ours with the printed start and end "
    "points, published values beside them.",
    options=Chen,
    parts=[
        Part(
            name="paths",
            title="Path planning",
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
        Absent("Figs. 1 to 14", "they explain the method and hold no results"),
        Absent(
            "Figs. 19 to 25, and v_goal, the target's rate, a and b of Table 1",
            "comes with hunting",
        ),
        Absent(
            "The planning time of an enumeration of all paths, which post-order traversal replaces",
            "the paper does not say what is enumerated, and A* as in the books follows parents",
        ),
    ],
    checks=checks,
)

if __name__ == "__main__":
    run_as_program(PAPER)
