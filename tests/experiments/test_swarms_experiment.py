"""Tables 8 and 9 of Yu et al. 2022: verdicts and tables from results that are made up."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiments.yu2022.functions import report
from experiments.yu2022.functions.compare import budgets_met, compare
from experiments.yu2022.functions.figures import LOOKS, budgets, draw
from experiments.yu2022.functions.published import ALGORITHMS, DIM, MEAN
from experiments.yu2022.functions.runs import Job, Results, jobs_for, moved
from experiments.yu2022.functions.verdicts import judge
from usvjax.swarms.minimising import MinimiseResult
from usvkernels.swarms.functions import TABLE_8


def made_up(factor: float, runs: int = 30, order: int = 1) -> Results:
    """Every swarm ends at so many times its published mean; ten times less when run longer."""
    results = {}
    for job in jobs_for(runs, runs, quick=False):
        names = list(ALGORITHMS)[::order]
        end = MEAN[job.function][dict(zip(ALGORITHMS, names, strict=True))[job.algorithm]] * factor
        if job.kind == "longer":
            end /= 10
        history = np.geomspace(1e3, max(end, 1e-300), job.iterations) + np.zeros((runs, 1))
        history[:, -1] = end
        nans = np.zeros(runs, int)
        evaluations = job.population * job.iterations
        results[job] = MinimiseResult(
            history[:, -1], np.zeros((runs, DIM)), history, nans, evaluations
        )
    return results


def words(results: Results) -> dict[str, str]:
    return {one.claim: one.verdict for one in judge(compare(results))}


def test_what_the_paper_prints_reproduces() -> None:
    for claim, word in words(made_up(1.0)).items():
        # The law of Eq. 14 is computed, and so is what its text says of it.
        assert word == ("does not reproduce" if "Fig. 2" in claim else "reproduces"), claim


def test_other_levels_do_not() -> None:
    found = words(made_up(30.0))
    for function, own in TABLE_8.items():
        level = found[f"Table 9, {function}, {own.name}: the means of all five"]
        assert level == "does not reproduce"
        least = found[f"Table 9, {function}, {own.name}: the proposed one finds least"]
        assert least == "reproduces"


def test_other_orders_do_not() -> None:
    found = words(made_up(1.0, order=-1))
    assert {word for claim, word in found.items() if "finds least" in claim} == {
        "does not reproduce"
    }
    assert {word for claim, word in found.items() if "Fig. 16" in claim} == {"does not reproduce"}


def test_few_runs_tell_nothing() -> None:
    found = words(made_up(1.0, runs=5))
    assert {word for claim, word in found.items() if "Fig. 2" not in claim} == {"undecided"}
    judged = judge(compare(made_up(1.0, runs=5)))
    numbers = {one.numbers for v in judged if "Fig. 2" not in v.claim for one in v.found.values()}
    assert numbers == {"too few runs"}


@pytest.mark.parametrize(("factor", "met"), [(0.99, 200), (5.0, 500), (20.0, None)])
def test_budget_at_which_the_published_mean_is_met(factor: float, met: int | None) -> None:
    tables = compare(made_up(factor))["functions"]["f1"]
    assert tables["met_by_mean"]["gwo"] == met
    assert tables["met_by_median"]["igwo"] == met


def test_a_budget_meets_only_if_longer_ones_do() -> None:
    tables = compare(made_up(5.0))["functions"]["f1"]
    assert tables["met_by_mean"]["gwo"] == 500
    tables["longer"]["gwo"]["2500"]["mean"] = 1.0
    assert budgets_met("f1", tables)["met_by_mean"]["gwo"] == 5000
    tables["longer"]["gwo"]["5000"]["mean"] = 1.0
    assert budgets_met("f1", tables)["met_by_mean"]["gwo"] is None
    assert budgets_met("f1", tables)["met_by_median"]["gwo"] == 500


def test_zeros_are_drawn_on_a_line_of_their_own() -> None:
    found = compare(made_up(1e10))["functions"]
    found["f3"]["longer"]["gwo"]["2500"]["mean"] = 0.0
    axes = {ax.get_title()[:2]: ax for ax in budgets(found).axes}
    lines = [line for line in axes["f3"].get_lines() if len(line.get_xdata()) > 2]
    gwo = lines[list(LOOKS).index("gwo")]
    assert list(gwo.get_xdata()) == [200, 500, 1000, 1250, 2500, 5000]
    floor = np.asarray(gwo.get_ydata())[4]
    positive = [MEAN["f3"][name] for name in ALGORITHMS if MEAN["f3"][name] > 0]
    assert 0 < floor < min(positive) / 10
    labels = [text.get_text() for text in axes["f3"].get_yticklabels()]
    assert dict(zip(axes["f3"].get_yticks(), labels, strict=True))[floor] == "0"
    # IGWO's published 0 stands there too.
    assert any(list(line.get_ydata()) == [floor] for line in axes["f3"].get_lines())
    assert "0" not in [text.get_text() for text in axes["f1"].get_yticklabels()]


def test_report_and_figures(tmp_path: Path) -> None:
    results = {job: one for job, one in made_up(1e40).items() if job.function in ("f1", "f3")}
    found = compare(results)
    text = report.tables(found) + "\n".join([*report.summary(found), *report.readings()])
    for part in ("1.21e-29", "### Table 9: f3, Rastrigin", "does not with up to 5,000"):
        assert part in text
    assert "nan" not in text
    files = draw(results, found, tmp_path)
    assert all(file.stat().st_size > 10_000 for file in files)
    assert sorted(file.name for file in files) == sorted(
        name for line in report.FIGURES for name in _names(line)
    )


def _names(line: str) -> list[str]:
    return [line.split("`")[1].removeprefix("figures/")]


def test_moved_optimum() -> None:
    for name, function in TABLE_8.items():
        fn: Any = moved(name, 5)
        low, high = function.bounds
        assert len(fn.shift) == DIM
        assert (low / 2 <= np.array(fn.shift)).all()
        assert (np.array(fn.shift) <= high / 2).all()
        assert np.std(fn.shift) > high / 10
        assert fn == moved(name, 5) != moved(name, 6)


def test_every_swarm_runs_everywhere() -> None:
    jobs = jobs_for(40, 30, quick=False)
    for kind in ("printed", "shifted", "longer"):
        pairs = {(job.function, job.algorithm) for job in jobs if job.kind == kind}
        assert pairs == {(f, a) for f in TABLE_8 for a in ALGORITHMS}
    own = {job for job in jobs if job.kind == "own" and job.function == "f1"}
    assert own == {
        Job("own", "f1", "aco", 200, 100, 40),
        Job("own", "f1", "ga", 80, 50, 40),
    }
