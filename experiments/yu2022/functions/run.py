"""Tables 8 and 9, Figs. 2 and 16: the printed budget, longer ones, moved optima."""

from experiments.files import progress
from experiments.yu2022.functions import report
from experiments.yu2022.functions.compare import compare
from experiments.yu2022.functions.figures import draw
from experiments.yu2022.functions.published import RUNS
from experiments.yu2022.functions.runs import jobs_for, run_all
from experiments.yu2022.functions.verdicts import judge
from experiments.yu2022.parts import Part


def run(runs: int, seed: int, quick: bool) -> Part:
    """Run all swarms.

    Args:
        runs: of each on each function, on the printed budget; longer ones have 30 at most.
        seed: of the draws.
        quick: one function and few budgets.
    """
    jobs = jobs_for(runs, min(runs, RUNS), quick)
    with progress("functions: swarms", len(jobs)) as advance:
        results = run_all(jobs, seed, advance)
    found = compare(results)
    return Part(
        name="functions",
        title="Test functions: Tables 8 and 9, Figs. 2 and 16",
        found=found,
        verdicts=judge(found),
        note=report.note(found),
        summary=report.summary(found),
        readings=report.readings(),
        text=report.tables(found),
        figures=report.FIGURES,
        draw=lambda into: draw(results, found, into),
        counts=report.counts(found),
        done=f"{sum(job.runs for job in jobs):,} runs of swarms",
    )
