"""Tan et al. 2022: the tables are what the episodes say, and the verdicts follow from them."""

from dataclasses import replace
from math import inf, log

import numpy as np
import pytest
from scipy import stats
from stuck_edge import sits_on_an_edge

import usvjax as uj
from experiments.claims import judge
from experiments.tan2022 import arithmetic, joint, published, ranking, why
from experiments.tan2022 import readings as read
from experiments.tan2022.claims import claims
from experiments.tan2022.episodes import SHARD, Asked, Episodes, label_of, studies
from experiments.tan2022.measures import COUNTED, HYBRID
from experiments.tan2022.paired import compare, ratio_of_means, sensitivity, slower
from experiments.tan2022.tables import (
    growth,
    one_map,
    put_to_the_test,
    single_maps,
    three_maps,
    twenty_maps,
)
from usvkernels.status import Status

METHODS = published.METHODS
ALL_CASES = tuple(dict.fromkeys((*read.CASES, *read.ONE_MAP_CASES)))


def made_up(n, speed, reached=None, seed=0):
    """Episodes of about 14 m at about the given speed."""
    rng = np.random.default_rng(seed)
    length = rng.uniform(14.0, 15.0, n)
    time = length / (speed * rng.uniform(0.9, 1.1, n))
    arrived = np.ones(n, bool) if reached is None else reached
    return Episodes(
        status=np.where(arrived, int(Status.REACHED), int(Status.COLLIDED)),
        time=time,
        path_length=length,
        mean_speed=length / time,
    )


def pairs_of(make):
    """The episodes of both methods by case, each made by make(case, method)."""
    return {case: {method: make(case, method) for method in METHODS} for case in ALL_CASES}


# --- the paper's own numbers ------------------------------------------------------------------


def test_the_papers_arithmetic_is_checked_number_by_number():
    checks = {check.where: check for check in arithmetic.arithmetic()}
    assert len(checks) == 36
    against = {where for where, check in checks.items() if check.verdict == "contradicts"}
    assert "Table 3, mean speed, improved, r = 0.2 m" in against  # 14.30 / 26.63 is 0.537
    assert len(against) == 4
    assert checks["Table 2, mean speed, improved, r = 0.7 m"].verdict == "agrees"
    assert checks["Table 4, mean speed, improved, r = 0.7 m"].verdict == "can agree"


def test_a_single_map_may_not_disagree_with_itself():
    values = dict(published.TABLE2.values)
    values["improved", "mean_speed"] = (0.60, 0.64, 0.41)
    broken = replace(published.TABLE2, values=values)
    assert arithmetic._speed(broken, "improved", 0).verdict == "contradicts"
    assert arithmetic._speed(broken, "improved", 1).verdict == "agrees"


def test_printed_changes_are_signed_shares():
    assert arithmetic.shares(published.TABLE4, "time")[0] == pytest.approx(-0.5062)
    assert arithmetic.shares(published.TABLE2, "mean_speed") == pytest.approx((1.07, 0.83, 0.52))


def test_eq_4_excludes_the_demos_cap_where_the_mean_speed_is_above_its_bound():
    bounds = {(b.table, b.radius): b for b in arithmetic.cap_bounds()}
    assert bounds[4, 0.2].top_speed == pytest.approx(0.4)
    assert bounds[4, 0.2].dist == pytest.approx(0.55**2 / 0.4)
    assert bounds[4, 0.2].excludes_demo_cap
    assert not bounds[4, 0.7].excludes_demo_cap


# --- readings and studies ---------------------------------------------------------------------


def test_readings_have_labels_of_their_own_and_hold_what_the_reports_name():
    for listed in ([*COUNTED, *read.sensitivities()], read.combinations()):
        labels = [reading.label for reading in listed]
        assert len(set(labels)) == len(labels)
        assert {"no cap", "cap 2r"} <= set(labels)
    assert set(read.CAPS) <= {one.label for one in [*COUNTED, *read.sensitivities()]}
    assert len(read.quick_sensitivities()) == 4


def case_of(reading, case, method="improved"):
    """What the mission makes of a reading's settings."""
    ran = studies([Asked("a", 7, reading, case)])[f"{method}, a"]
    (condition,) = ran.spec.conditions
    return condition.case.given


def test_the_preset_reading_is_the_librarys_preset():
    for case in read.CASES:
        given = case_of(read.PRESET, case)
        assert given.params == replace(uj.preset("tan2022").params, radius=case.radius)
        assert given.static == uj.preset("tan2022").static
        assert given.source.rate == case.rate


def test_the_demos_cap_follows_the_radius_and_holds_where_nothing_counts():
    small, _, large = read.CASES
    assert case_of(read.DEMO, small).params.clearance_cap == pytest.approx(0.4)
    assert case_of(read.DEMO, large).params.clear_distance == pytest.approx(1.4)


def test_another_period_predicts_and_lasts_as_long():
    found = {one.label: one for one in read.sensitivities()}
    for dt in (0.05, 0.2):
        given = case_of(found[f"no cap, period {dt:g} s"], read.CASES[0])
        assert given.params.dt == dt
        assert given.static.horizon * dt == pytest.approx(3.0)
        assert given.static.max_steps * dt == pytest.approx(150.0)


def test_no_reading_sits_on_the_edge_of_being_stuck():
    for reading in (*COUNTED, *read.sensitivities(), *read.combinations()):
        given = case_of(reading, read.CASES[0])
        if given.params.stuck_time < given.static.max_steps * given.params.dt:
            assert not sits_on_an_edge(given.params), reading.label


def test_every_reading_can_be_run_and_has_conditions_of_its_own():
    everything = [*COUNTED, *read.sensitivities(), *read.combinations()]
    case = read.CASES[1]
    ran = studies([Asked("all", 9, reading, case) for reading in everything])
    sizes = {name: len(study.spec.conditions) for name, study in ran.items()}
    settings = {label_of(reading.settings(case, "improved")) for reading in everything}
    assert sizes["improved, all"] == len(settings)
    # What only the improved method can tell apart is run once for the other.
    assert sizes["traditional, all"] < sizes["improved, all"]


def test_what_is_asked_for_twice_is_run_once_on_as_many_maps_as_any_wants():
    case = read.CASES[0]
    narrow = read.PRESET.but("phi", "x", changes={"params.search_angle": 0.5})
    ran = studies([Asked("few", 5, narrow, case), Asked("many", 5000, read.PRESET, case)])
    assert {name: study.size for name, study in ran.items()} == {
        "traditional, many": 5000,
        "improved, many": 5000,
        "improved, few": 5,
    }
    assert ran["improved, many"].spec.shard == SHARD


# --- which maps are shown ---------------------------------------------------------------------


def flags(n, jobs):
    return np.isin(np.arange(n), jobs)


def test_table_2_shows_the_first_map_that_suits_all_radii():
    suits = {0.2: [3, 7, 9], 0.5: [5, 7, 9], 0.7: [7, 9]}

    def make(case, method):
        jobs = list(suits[case.radius]) if method == "improved" else list(range(64))
        n = 64 if case.radius < 0.7 else 80  # some readings have more maps in one case
        return made_up(n, 0.4, flags(n, jobs))

    pairs = pairs_of(make)
    shown = one_map(pairs)
    assert [(s.figure, s.job) for s in shown] == [(2, 7), (3, 7), (4, 7)]
    rows = single_maps(shown, pairs)
    assert rows[1]["passed_over"] == 7
    wanted = pairs[read.ONE_MAP_CASES[1]]["improved"].time[7]
    assert rows[1]["values"]["improved"]["time"] == wanted


def test_table_2_is_empty_where_no_map_suits_all_radii():
    pairs = pairs_of(lambda case, method: made_up(64, 0.4, flags(64, [int(10 * case.radius)])))
    assert one_map(pairs) == []


def test_table_3_shows_three_maps_that_table_2_does_not():
    pairs = pairs_of(lambda case, method: made_up(64, 0.4, flags(64, [4, 6, 8, 9])))
    assert one_map(pairs)[0].job == 4
    assert [(s.figure, s.job) for s in three_maps(pairs)] == [(5, 6), (6, 8), (7, 9)]


def test_table_4_averages_the_first_twenty_maps_and_the_changes_per_map():
    suits = flags(64, list(range(1, 61, 2)))
    speeds = {"traditional": 0.3, "improved": 0.5}
    pairs = pairs_of(lambda case, method: made_up(64, speeds[method], suits))
    row = twenty_maps(pairs)[0]
    assert (row["maps"], row["passed_over"]) == (20, 20)
    jobs = np.arange(1, 41, 2)
    old, new = (pairs[read.CASES[0]][method].time[jobs] for method in METHODS)
    assert row["values"]["improved"]["time"] == pytest.approx(new.mean())
    assert row["change"]["time"] == pytest.approx((new / old - 1).mean())


# --- the test of a table ----------------------------------------------------------------------


def maps_like(rng, n):
    """Values of n maps that hang together as time, length and speed do: float[n, 6], skewed."""
    time = 40.0 * np.exp(rng.normal(0, 0.4, (n, 1)) + rng.normal(0, 0.2, (n, 2)))
    length = 15.0 * np.exp(np.abs(rng.normal(0, 0.1, (n, 2))))
    return np.concatenate([time, length, length / time], axis=1)


@pytest.mark.parametrize("maps", [1, 20])
def test_a_table_of_our_own_maps_is_excluded_as_often_as_is_said(maps, monkeypatch):
    monkeypatch.setattr(joint, "TABLES", 200)
    n = joint.LEAST_MAPS
    rng = np.random.default_rng((maps, n))
    excluded = 0
    for _ in range(1000):
        groups = [
            joint.Values(maps_like(rng, maps).mean(axis=0), "abcdef", maps_like(rng, n))
            for _ in range(3)
        ]
        excluded += joint.table_test(groups, maps, 0.01)["p"] < joint.ALPHA
    assert 30 <= excluded <= 70  # of 50 wanted, within three standard errors


def test_a_table_is_excluded_by_one_value_that_is_far_off_and_says_which():
    rng = np.random.default_rng(3)
    ours = [maps_like(rng, 200) for _ in range(3)]
    groups = [joint.Values(own.mean(axis=0), "abcdef", own) for own in ours]
    assert joint.table_test(groups, 20, 0.01)["p"] > 0.9
    groups[1].printed[2] *= 1.5
    found = joint.table_test(groups, 20, 0.01)
    assert found["p"] < 0.01
    assert found["worst"] == "c"
    assert found["printed"] == pytest.approx(1.5 * found["ours"])


def test_too_few_maps_are_no_test():
    values = joint.Values(np.ones(2), "ab", np.ones((joint.LEAST_MAPS - 1, 2)))
    assert joint.table_test([values], 20, 0.01) is None


GROWTH = "The path is shortened more, the larger the radius"


def shortened_by(shares, noise=0.02, n=400):
    """Episodes whose paths are shortened by these shares, radius by radius."""
    by_radius = dict(zip(published.RADII, shares, strict=True))

    def make(case, method):
        rng = np.random.default_rng(int(10 * case.radius))
        share = by_radius[case.radius] + noise * rng.normal(size=n)
        length = np.full(n, 10.0) if method == "traditional" else 10.0 * (1.0 - share)
        return replace(made_up(n, 0.4), path_length=length)

    return pairs_of(make)


def test_growth_is_tested_on_maps_that_are_paired():
    pairs = shortened_by((0.1, 0.2, 0.15))
    up, down = growth(pairs)
    shares = [
        1.0 - pairs[case]["improved"].path_length / pairs[case]["traditional"].path_length
        for case in read.CASES
    ]
    difference = shares[1] - shares[0]
    assert up["gain"] == pytest.approx(difference.mean())
    tested = stats.ttest_1samp(difference, 0.0)
    assert up["t"] == pytest.approx(tested.statistic)
    assert up["p"] == pytest.approx(tested.pvalue)
    assert down["t"] < -10


def test_growth_that_is_none_is_shown_as_often_as_is_said():
    rng = np.random.default_rng(5)
    n = joint.LEAST_MAPS

    def make(case, method):
        shorter = rng.exponential(size=n) if method == "improved" else np.zeros(n)
        return replace(made_up(n, 0.4), path_length=10.0 - shorter)

    found = [growth(pairs_of(make)) for _ in range(500)]
    shown = sum(step["p"] < joint.ALPHA for steps in found for step in steps)
    assert 30 <= shown <= 70  # of 50 wanted, within three standard errors


def test_few_common_maps_show_no_growth_and_nothing_superior():
    few = judged(shortened_by((0.1, 0.2, 0.3), n=joint.LEAST_MAPS - 1))
    enough = judged(shortened_by((0.1, 0.2, 0.3), n=joint.LEAST_MAPS))
    for claim in (GROWTH, '"Superior" in path length'):
        assert few[claim].verdict == "undecided"
        assert enough[claim].verdict == "reproduces"


# --- paired comparison ------------------------------------------------------------------------


def test_the_comparison_rests_on_the_maps_where_both_succeed():
    def make(case, method):
        jobs = range(0, 50) if method == "traditional" else range(20, 64)
        return made_up(64, 0.3 if method == "traditional" else 0.5, flags(64, list(jobs)))

    pairs = pairs_of(make)
    case = compare({"a": pairs})["a"]["cases"][0]
    assert case["both"] == 30
    assert case["endings"]["traditional"]["REACHED"]["count"] == 50
    assert case["endings"]["improved"]["COLLIDED"]["count"] == 20
    counts = case["success"]
    assert (counts["method_only"], counts["baseline_only"]) == (14, 20)
    assert case["collisions"]["difference"]["value"] == pytest.approx(6 / 64)
    old, new = (pairs[read.CASES[0]][method].time[20:50] for method in METHODS)
    time = case["metrics"]["time"]
    assert time["difference"]["value"] == pytest.approx((new - old).mean())
    assert time["difference"]["high"] < 0
    assert time["difference_bootstrap"]["high"] < 0
    assert time["p_t"] <= time["p_t_holm"] < 1e-6


def test_without_a_common_success_there_are_rates_and_nothing_else():
    def make(case, method):
        jobs = range(0, 32) if method == "traditional" else range(32, 64)
        return made_up(64, 0.4, flags(64, list(jobs)))

    pairs = pairs_of(make)
    case = compare({"a": pairs})["a"]["cases"][0]
    assert case["both"] == 0
    assert case["metrics"]["time"] is None
    row = sensitivity(read.PRESET, read.CASES[0], pairs[read.CASES[0]])
    assert row["means"] is None
    assert row["time_ratio"]["value"] is None


def test_one_method_is_compared_with_itself_on_the_maps_that_it_crosses_both_times():
    quick = made_up(60, 0.4, flags(60, list(range(10, 60))))
    slow = replace(made_up(80, 0.4, flags(80, list(range(40)))), time=made_up(80, 0.4).time + 3.0)
    slow.time[:60] = quick.time + np.linspace(2.0, 4.0, 60)
    found = slower(quick, slow)
    assert found["maps"] == 30
    assert found["value"] == pytest.approx(np.linspace(2.0, 4.0, 60)[10:40].mean())
    assert 2.0 < found["low"] < found["value"] < found["high"] < 4.0


def test_the_words_on_sailing_astern_follow_its_intervals():
    def told(low, high, maps=joint.LEAST_MAPS):
        one = {"maps": maps, "value": (low + high) / 2, "low": low, "high": high, "p": 0.0}
        return why._astern({"astern": [one] * 3})

    assert told(1.0, 2.0).count(": longer)") == 3
    assert told(-2.0, -1.0).count(": shorter)") == 3
    assert told(-1.0, 2.0).count(": not shown to differ)") == 3
    assert told(1.0, 2.0, joint.LEAST_MAPS - 1).count(": not shown to differ)") == 3


def test_the_ratio_of_means_has_an_interval_around_it():
    rng = np.random.default_rng(1)
    old = rng.uniform(40.0, 60.0, 200)
    found = ratio_of_means(0.5 * old + rng.normal(0, 2, 200), old)
    assert found["low"] < found["value"] < found["high"]
    # Of 200 ratios, each with a standard deviation of 2 / 50: to seven of 0.04 / sqrt(200).
    assert found["value"] == pytest.approx(0.5, abs=0.02)
    assert ratio_of_means(0.5 * old, old)["low"] is None  # without any spread


# --- verdicts and ranking ---------------------------------------------------------------------


def as_published(case, method):
    """Episodes whose means are Table 4's, with a spread that covers Tables 2 and 3."""
    place = published.RADII.index(case.radius)
    n = 400
    time, length, speed = (published.TABLE4.values[method, m][place] for m in published.METRICS)
    rng = np.random.default_rng((place, len(method)))

    def spread(value, by):
        return value * np.exp(rng.normal(0, by, n) - by**2 / 2)

    return replace(
        made_up(n, 0.4),
        time=spread(time, 0.3),
        path_length=spread(length, 0.05),
        mean_speed=spread(speed, 0.3),
    )


def judged(pairs):
    """Verdicts where the same episodes stand for every reading."""
    labels = [*(reading.label for reading in COUNTED), HYBRID]
    row = compare({"": pairs})[""] | {"tests": put_to_the_test(pairs), "growth": growth(pairs)}
    numbers = {"paired": dict.fromkeys(labels, row)}
    return {verdict.claim: verdict for verdict in judge(claims(numbers), numbers)}


TABLES = (
    "Table 2: one map at three radii",
    "Table 3: one map per radius",
    "Table 4: averages over 20 maps",
)


def test_verdicts_say_so_when_the_published_numbers_are_met():
    found = judged(pairs_of(as_published))
    for claim in (*TABLES, "Table 4: the path is shortened by so much"):
        assert found[claim].verdict == "not excluded"
    assert found[GROWTH].verdict == "reproduces"
    assert found['"Superior" in navigation time'].verdict == "reproduces"


def test_verdicts_say_so_when_the_published_numbers_are_missed():
    found = judged(pairs_of(lambda case, method: made_up(400, 0.4, seed=len(method))))
    for claim in (*TABLES, "Table 4: time is reduced by so much"):
        assert found[claim].verdict == "does not reproduce"
    assert found['"Superior" in navigation time'].verdict == "undecided"
    swapped = judged(pairs_of(lambda c, m: as_published(c, METHODS[m == METHODS[0]])))
    assert swapped['"Superior" in navigation time'].verdict == "does not reproduce"


def test_a_shortening_that_falls_or_that_is_not_shown_to_grow_is_no_growth():
    assert judged(shortened_by((0.1, 0.2, 0.15)))[GROWTH].verdict == "does not reproduce"
    assert judged(shortened_by((0.1, 0.2, 0.2001)))[GROWTH].verdict == "undecided"
    assert judged(shortened_by((0.1, 0.2, 0.3)))[GROWTH].verdict == "reproduces"


def test_avoidance_is_judged_by_arrivals_and_by_collisions():
    def make(case, method):
        arrived = flags(400, list(range(400 if method == "traditional" else 300)))
        return made_up(400, 0.4, arrived)

    found = judged(pairs_of(make))
    claim = '"Stronger obstacle avoidance adjustment ability": it collides less often'
    assert found[claim].verdict == "does not reproduce"
    assert "0.0, 0.0, 0.0 to 25.0, 25.0, 25.0 %" in found[claim].found["no cap"].numbers


def test_too_few_maps_give_no_verdict():
    found = judged(pairs_of(lambda case, method: made_up(400, 0.4, flags(400, [0]))))
    for claim in (*TABLES, GROWTH):
        assert found[claim].verdict == "undecided"


def test_the_ranking_finds_the_reading_that_made_the_numbers():
    outcomes = {
        (reading, method): [
            as_published(case, method) if reading is read.PRESET else made_up(400, 0.2)
            for case in read.CASES
        ]
        for reading in (read.DEMO, read.PRESET)
        for method in METHODS
    }
    ranked = ranking.rank([read.DEMO, read.PRESET], outcomes)
    assert len(ranked) == 4
    assert (ranked[0].traditional, ranked[0].improved) == ("no cap", "no cap")
    lines = [found.line() for found in ranked]
    assert lines[0]["typical_factor"] < 1.15 < lines[-1]["typical_factor"]


def test_the_distance_is_the_rms_log_ratio():
    def exact(method):
        return [
            replace(
                made_up(12, 0.4),
                time=np.full(12, 2.0 * published.TABLE4.values[method, "time"][place]),
                path_length=np.full(12, published.TABLE4.values[method, "path_length"][place]),
                mean_speed=np.full(12, published.TABLE4.values[method, "mean_speed"][place]),
            )
            for place in range(3)
        ]

    found = ranking.match("a", "b", exact("traditional"), exact("improved"))
    assert found.distance == pytest.approx(log(2.0) / 3**0.5)


def test_pairs_with_few_common_successes_are_not_ranked():
    few = [made_up(50, 0.4, flags(50, list(range(9)))) for _ in range(3)]
    assert ranking.match("a", "b", few, few).distance == inf


def test_hybrids_share_maps_start_and_goal():
    tolerant = read.DEMO.but("tolerant", "x", changes={"params.goal_tolerance": 1.0})
    pairs = ranking.pairs([read.PRESET, read.DEMO, tolerant, read.DEMO_START])
    assert (read.PRESET, read.DEMO) in pairs
    for other in (tolerant, read.DEMO_START):
        assert not any(other in pair and pair[0] is not pair[1] for pair in pairs)
