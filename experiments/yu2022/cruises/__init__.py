"""Whole cruises: Tables 3, 4, 6 and 7 and Figs. 6 to 15 of Yu et al. 2022."""

from experiments.paper import Part
from experiments.yu2022.cruises.claims import claims
from experiments.yu2022.cruises.compare import measure
from experiments.yu2022.cruises.figures import figures
from experiments.yu2022.cruises.report import readings, sections, summary
from experiments.yu2022.cruises.runs import runs

PART = Part(
    name="cruises",
    title="Whole cruises: Tables 3, 4, 6 and 7",
    runs=runs,
    measure=measure,
    claims=claims,
    sections=sections,
    figures=figures,
    readings=readings,
    summary=summary,
)
