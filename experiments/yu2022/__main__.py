"""Yu et al. 2022: the heuristic of D* Lite, whole cruises, and the swarms on test functions."""

from experiments.paper import Absent, Paper, run_as_program
from experiments.yu2022 import cruises, functions, heuristic
from experiments.yu2022.arithmetic import checks
from experiments.yu2022.options import YuOptions

PAPER = Paper(
    name="yu2022",
    cite="Yu et al. 2022",
    title="a cruise to many targets",
    about="Tables and figures of the paper on maps of ours, and on many more.",
    options=YuOptions,
    parts=[heuristic.PART, cruises.PART, functions.PART],
    absent=[
        Absent("Fig. 1", "the hierarchy of wolves, a drawing without numbers"),
        Absent("Tables 1, 2, 5 and 8", "coordinates, parameters and functions, used as printed"),
        Absent(
            "Figs. 6 to 15 as printed",
            "the map, of a part of Hongze Lake with obstacles at random, is not published; the "
            "figures here are of maps of ours",
        ),
    ],
    checks=checks,
)

if __name__ == "__main__":
    run_as_program(PAPER)
