"""The swarms on test functions: Tables 8 and 9, Figs. 2 and 16 of Yu et al. 2022."""

from experiments.paper import Part
from experiments.yu2022.functions.claims import claims
from experiments.yu2022.functions.compare import measure
from experiments.yu2022.functions.figures import figures
from experiments.yu2022.functions.report import readings, sections, summary
from experiments.yu2022.functions.runs import runs

PART = Part(
    name="functions",
    title="Test functions: Tables 8 and 9, Figs. 2 and 16",
    runs=runs,
    measure=measure,
    claims=claims,
    sections=sections,
    figures=figures,
    readings=readings,
    summary=summary,
)
