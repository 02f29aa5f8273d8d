"""Whole cruises: Tables 3, 4, 6 and 7 and Figs. 6 to 15 of Yu et al. 2022."""

from experiments.paper import Part
from experiments.yu2022.cruises import claims, compare, figures, report, runs

PART = Part(
    name="cruises",
    title="Whole cruises: Tables 3, 4, 6 and 7",
    runs=runs.runs,
    measure=compare.measure,
    claims=claims.claims,
    sections=report.sections,
    figures=figures.figures,
    readings=report.readings,
    summary=report.summary,
)
