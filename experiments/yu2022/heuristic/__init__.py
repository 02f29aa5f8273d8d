"""The heuristic of D* Lite: Figs. 3 to 5 of Yu et al. 2022."""

from experiments.paper import Part
from experiments.yu2022.heuristic.claims import claims
from experiments.yu2022.heuristic.compare import measure
from experiments.yu2022.heuristic.figures import figures
from experiments.yu2022.heuristic.report import readings, sections, summary
from experiments.yu2022.heuristic.runs import runs

PART = Part(
    name="heuristic",
    title="The heuristic of D* Lite: Figs. 3 to 5",
    runs=runs,
    measure=measure,
    claims=claims,
    sections=sections,
    figures=figures,
    readings=readings,
    summary=summary,
)
