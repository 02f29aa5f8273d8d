"""Yu et al. 2022, whole cruises: the tables are what the cruises say, verdicts follow from them."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from experiments.yu2022.cases import COMPLEX, ORDINARY
from experiments.yu2022.cruises import figures as drawing
from experiments.yu2022.cruises.compare import compare
from experiments.yu2022.cruises.published import ALGORITHMS, CASES, METRICS, PROPOSED, STATISTICS
from experiments.yu2022.cruises.report import counts, figures, note, readings, section, summary
from experiments.yu2022.cruises.runs import ENVIRONMENTS, Cruises, maps_of
from experiments.yu2022.cruises.verdicts import judge
from experiments.yu2022.parts import Part, markdown
from usvkernels.status import Status

OPTIMUM = 160.0
CASES_CLAIM = "Table 4: so in all cases (length)"
PLAN = {
    "runs": 200,
    "swarm_runs": 20,
    "case_runs": 190,
    "case_swarm_runs": 5,
    "repeats": 12,
    "cases": (1, 2, 3, 4),
}


def made_up(length, inflections, n=50, tour=OPTIMUM, failed=(), seed=0):
    """Cruises of about the given length and turns; those in `failed` never came home."""
    rng = np.random.default_rng(seed)
    status = np.full(n, int(Status.REACHED))
    status[list(failed)] = int(Status.TIMED_OUT)
    result = SimpleNamespace(
        status=status,
        length=length + rng.normal(0.0, 5.0, n),
        smooth_length=length + rng.normal(0.0, 5.0, n),
        inflections=np.full(n, inflections),
        smooth_inflections=inflections + rng.integers(-1, 2, n),
        waits=np.zeros(n, int),
        expanded=np.full(n, 1000),
    )
    return Cruises(result, np.full(n, tour), smoothed=True)


def as_published(environment):
    table = STATISTICS[environment]
    return {
        name: made_up(
            table["length"][name].mean,
            round(table["inflections"][name].mean),
            seed=number,
        )
        for number, name in enumerate(ALGORITHMS)
    }


def compared(sailed, cases=(1,), environment="ordinary", proposed_seconds=None):
    results = {(environment, case): sailed for case in cases}
    times = {name: [s.mean] for name, s in STATISTICS[environment]["planning_time"].items()}
    times[PROPOSED] = proposed_seconds or times[PROPOSED]
    return compare(results, dict.fromkeys(results, OPTIMUM), {environment: times})


def judged(sailed, **options):
    return judge(compared(sailed, **options))


def verdicts_of(sailed, **options):
    found = compared(sailed, **options)
    return {v.claim: v.verdict for v in judge(found)}, found


def test_the_cases_are_those_of_the_tables():
    assert [len(case) for case in ORDINARY.values()] == [10] * 4
    assert [len(case) for case in COMPLEX.values()] == [20] * 4
    assert ORDINARY[1][0].tolist() == [4, 46]
    assert COMPLEX[4][-1].tolist() == [50, 94]
    for environment in ENVIRONMENTS:
        for stations in environment.cases.values():
            assert len(np.unique(stations, axis=0)) == len(stations)
            assert ((stations >= 0) & (stations < environment.side)).all()


def test_published_tables_name_every_algorithm_and_agree_on_case_1():
    for environment, table in STATISTICS.items():
        for metric in METRICS:
            row = table[metric]
            assert tuple(row) == ALGORITHMS
            assert row[PROPOSED].p is None
            assert all(s.best <= s.mean <= s.worst for s in row.values())
        assert list(CASES[environment]) == [1, 2, 3, 4]


def test_stations_are_free_and_maps_are_those_of_their_number():
    environment = ENVIRONMENTS[0]
    few, more = (maps_of(environment, 2, n, seed=5) for n in (3, 6))
    assert np.array_equal(few, more[:3])
    x, y = environment.cases[2].T
    assert not more[:, y, x].any()
    assert 0.07 < more.mean() < 0.12
    assert not np.array_equal(more, maps_of(environment, 3, 6, seed=5))


def test_numbers_as_published_reproduce():
    verdicts, _ = verdicts_of(as_published("ordinary"), cases=(1, 2, 3, 4))
    assert set(verdicts.values()) == {"reproduces"}


def test_longer_cruises_do_not_reproduce():
    sailed = as_published("ordinary")
    sailed[PROPOSED] = made_up(2000.0, 90)
    verdicts, _ = verdicts_of(sailed, cases=(1, 2, 3, 4), proposed_seconds=[99.0])
    del verdicts["Figs. 6 to 10: all five find the same order (ordinary, Case 1)"]
    assert set(verdicts.values()) == {"does not reproduce"}


def test_one_algorithm_off_the_level_is_told():
    sailed = as_published("ordinary")
    sailed["ga"] = made_up(1.2 * STATISTICS["ordinary"]["length"]["ga"].mean, 62)
    verdicts, _ = verdicts_of(sailed)
    assert verdicts["Table 3: the level of length"] == "does not reproduce"
    assert verdicts["Table 3: the level of inflection points"] == "reproduces"


def test_few_runs_and_missing_cases_give_no_verdict():
    few = {name: made_up(1700.0, 40, n=4) for name in ALGORITHMS}
    told = {v.claim: v for v in judged(few) if "time" not in v.claim}
    assert {v.verdict for v in told.values()} == {"undecided"}
    level = told["Table 3: the level of length"].found["as printed"].numbers
    assert "too few runs: ACO 4, GA 4, CMPSO 4, GWO 4, IGWO 4 of 20" in level
    one = {v.claim: v for v in judged(as_published("ordinary"))}
    assert one[CASES_CLAIM].verdict == "undecided"
    assert one[CASES_CLAIM].found["as printed"].numbers == "not all cases were run"


def test_one_well_sampled_rival_refutes_whatever_the_others_lack():
    sailed = as_published("complex")
    sailed["gwo"] = made_up(4000.0, 60)
    sailed["cmpso"] = made_up(5220.0, 127, n=20, failed=[3, 7])
    verdicts, _ = verdicts_of(sailed, environment="complex")
    for claim in ("shortest", "fewest inflection points"):
        assert verdicts[f"Table 6: the proposed one has the {claim} of all"] == "does not reproduce"
    for indicator in ("length", "inflection points"):
        assert verdicts[f"Table 6: the level of {indicator}"] == "does not reproduce"
        assert verdicts[f"Table 7: so in all cases ({indicator})"] == "does not reproduce"
    sailed["gwo"] = as_published("complex")["gwo"]
    found = {v.claim: v for v in judged(sailed, environment="complex")}
    shortest = found["Table 6: the proposed one has the shortest of all"]
    assert shortest.verdict == "undecided"
    assert "too few runs: CMPSO 18 of 20" in shortest.found["as printed"].numbers


def test_no_significant_difference_decides_nothing():
    sailed = as_published("ordinary")
    sailed["gwo"] = made_up(STATISTICS["ordinary"]["length"][PROPOSED].mean, 42, seed=7)
    found = {v.claim: v for v in judged(sailed, cases=(1, 2, 3, 4))}
    for claim in ("Table 3: the proposed one has the shortest of all", CASES_CLAIM):
        assert found[claim].verdict == "undecided"
        assert "GWO" in found[claim].found["as printed"].numbers


def test_cases_are_compared_on_the_maps_that_both_sailed():
    # The first five maps are hard for all: a swarm that sails only those looks worse than it is.
    n = 40
    hard = np.where(np.arange(n) < 5, 500.0, 0.0)
    sailed = {name: made_up(1700.0 + hard, 40, n=n, seed=k) for k, name in enumerate(ALGORITHMS)}
    sailed[PROPOSED] = made_up(1600.0 + hard, 30, n=n, seed=9)
    sailed["aco"] = made_up(2000.0 + np.zeros(5), 40, n=5, seed=11)
    found = {v.claim: v for v in judged(sailed, cases=(1, 2, 3, 4))}
    own = found[CASES_CLAIM]
    assert own.verdict == "does not reproduce"
    assert "Case 1 ACO -1" in own.found["as printed"].numbers
    assert "(n 5)" in own.found["as printed"].numbers
    sailed["aco"] = made_up(2000.0 + np.zeros(4), 40, n=4, seed=11)
    assert {v.claim: v for v in judged(sailed, cases=(1, 2, 3, 4))}[CASES_CLAIM].verdict == (
        "undecided"
    )


@pytest.mark.parametrize(
    ("seconds", "word"),
    [
        ([9.0, 10.0], "reproduces"),
        ([9.0, 10.5], "undecided"),
        ([10.5, 60.0], "does not reproduce"),
        ([10.4, 60.0], "undecided"),
    ],
)
def test_times_tell_only_where_their_ranges_lie_apart(seconds, word):
    # The others: 10.470 s and more.
    verdicts, _ = verdicts_of(as_published("ordinary"), proposed_seconds=seconds)
    assert verdicts["Table 3: the proposed one plans in the least time"] == word


def test_tours_with_a_gap_are_not_the_same():
    sailed = as_published("ordinary")
    sailed["gwo"] = made_up(1700.0, 40, tour=1.01 * OPTIMUM)
    verdicts, found = verdicts_of(sailed)
    claim = "Figs. 6 to 10: all five find the same order (ordinary, Case 1)"
    assert verdicts[claim] == "does not reproduce"
    gap = found["ordinary"]["1"]["algorithms"]["gwo"]["gap"]
    assert gap["mean"] == pytest.approx(0.01)
    assert gap["optimal"]["value"] == 0.0


def test_failures_are_counted_and_not_averaged():
    sailed = as_published("complex")
    lost = made_up(1e9, 40, failed=range(50))
    sailed["aco"] = lost
    sailed["ga"] = made_up(5000.0, 150, failed=[0, 1, 2])
    _, found = verdicts_of(sailed, environment="complex")
    case = found["complex"]["1"]
    assert case["algorithms"]["aco"]["complete"]["value"] == 0.0
    assert case["algorithms"]["aco"]["length"]["value"] is None
    assert case["algorithms"]["ga"]["endings"] == {"reached": 0.94, "timed_out": 0.06}
    assert case["printed"]["length"]["ga"]["n"] == 47
    assert "p" not in case["printed"]["length"]["aco"]
    assert case["against_proposed"]["aco"]["n"] == 0


def test_the_t_test_is_welchs_on_the_printed_number_of_runs():
    sailed = as_published("ordinary")
    sailed["gwo"] = made_up(1690.0, 42, n=400, seed=9)
    _, found = verdicts_of(sailed)
    row = found["ordinary"]["1"]["printed"]["length"]["gwo"]
    values = sailed["gwo"].result.smooth_length[:50]
    wanted = stats.ttest_ind(values, sailed[PROPOSED].result.smooth_length, equal_var=False)
    assert row["p"] == pytest.approx(wanted.pvalue)
    assert row["n"] == 50
    assert row["worst"] == pytest.approx(values.max())


def test_the_report_shows_ours_beside_the_published():
    _, found = verdicts_of(as_published("ordinary") | {"best": made_up(1650.0, 30)})
    text = section(found)
    for published in ("1677", "1856", "30.1", "160.0000"):
        assert published in text
    assert "Table 3" in text
    assert "published 1678 m" in summary(found)[0]


def test_the_report_tells_how_much_was_run():
    assert counts(PLAN) == (
        "cruises of Case 1: 200 by each algorithm that sails by D* Lite, 20 by each of "
        "Algorithms 1 to 3, of each other case 190 and 5"
    )
    assert "each other case" not in counts(PLAN | {"cases": (1,)})
    (tables,) = (line for line in readings(PLAN) if line.startswith("Tables 3 and 6"))
    assert "first 50 maps for the algorithms that sail by D* Lite and the first 20" in tables
    assert "ranges of 12 cruises" in note(PLAN)
    parts = [
        Part("a", "A", {}, [], "", [], [], "", [], lambda into: [], counts=text, done="")
        for text in ("7 maps", "8 runs")
    ]
    head = markdown(parts).split("## Summary")[0]
    assert "How much was run here: 7 maps; 8 runs." in head
    assert "1,000 maps of each kind" in head


@pytest.mark.parametrize("environments", [("ordinary",), ("ordinary", "complex")])
def test_the_report_names_the_figures_that_are_drawn(environments, monkeypatch, tmp_path):
    monkeypatch.setattr(drawing, "maps_figure", lambda *_: None)
    monkeypatch.setattr(drawing, "spread_figure", lambda _: None)
    monkeypatch.setattr(drawing, "save", lambda _, path, dpi: path)
    results = {(environment, 1): as_published(environment) for environment in environments}
    found = {environment: {} for environment in environments}
    drawn = {file.name for file in drawing.draw(results, found, 0, tmp_path)}
    named = {part.removeprefix("figures/") for part in " ".join(figures(found)).split("`")[1::2]}
    assert named == drawn
