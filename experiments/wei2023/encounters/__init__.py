"""Encounters: Figs. 13 to 18 of Wei & Zhang 2023, random ones by type, and Imazu's situations."""

from experiments.paper import Part
from experiments.wei2023.encounters.claims import claims
from experiments.wei2023.encounters.compare import measure
from experiments.wei2023.encounters.figures import figures
from experiments.wei2023.encounters.report import readings, sections, summary
from experiments.wei2023.encounters.runs import runs

PART = Part(
    name="encounters",
    title="Encounters: Figs. 13 to 18",
    runs=runs,
    measure=measure,
    claims=claims,
    sections=sections,
    figures=figures,
    readings=readings,
    summary=summary,
    quick=False,
)
