"""Tan et al. 2022: the tables are what the episodes say, and the verdicts follow from them."""

from dataclasses import replace
from math import inf, log

import numpy as np
import pytest

import usvjax as uj
from experiments.tan2022 import published as published
from experiments.tan2022 import ranking as ranking
from experiments.tan2022 import readings as read
from experiments.tan2022.episodes import Episodes, Plan, total
from experiments.tan2022.paired import Comparison, compare, ratio, sensitivities
from experiments.tan2022.tables import (
    one_map,
    single_maps,
    three_maps,
    twenty_maps,
)
from experiments.tan2022.verdicts import evidence, judge
from usvkernels.status import Status

PLAN = Plan(seed=5, maps=64, few_maps=4)
METHODS = published.METHODS


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
        min_clearance=np.zeros(n),
        steps=np.round(10 * time).astype(int),
    )


def results_of(plan, readings, make, cases=read.CASES):
    return {
        plan.run(reading, case, method): make(reading, case, method)
        for reading in readings
        for case in cases
        for method in METHODS
    }


# --- the paper's own numbers ------------------------------------------------------------------


def test_the_papers_arithmetic_is_checked_number_by_number():
    checks = {check.where: check for check in published.arithmetic()}
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
    assert published._speed(broken, "improved", 0).verdict == "contradicts"
    assert published._speed(broken, "improved", 1).verdict == "agrees"


def test_eq_4_excludes_the_demos_cap_where_the_mean_speed_is_above_its_bound():
    bounds = {(b.table, b.radius): b for b in published.cap_bounds()}
    assert bounds[4, 0.2].top_speed == pytest.approx(0.4)
    assert bounds[4, 0.2].dist == pytest.approx(0.55**2 / 0.4)
    assert bounds[4, 0.2].excludes_demo_cap
    assert not bounds[4, 0.7].excludes_demo_cap


# --- readings ---------------------------------------------------------------------------------


def test_readings_have_labels_of_their_own_and_hold_what_the_reports_name():
    for listed in (read.readings(), read.combinations()):
        labels = [reading.label for reading in listed]
        assert len(set(labels)) == len(labels)
        assert {"no cap", "cap 2r"} <= set(labels)
    assert set(read.CAPS) <= {reading.label for reading in read.readings()}
    assert read.DEMO_START in read.readings()
    assert read.PRESET in read.quick_readings()


def test_the_preset_reading_is_the_librarys_preset():
    for case in read.CASES:
        for method in METHODS:
            wanted = replace(uj.preset("tan2022").params, radius=case.radius)
            assert read.PRESET.params(case, method) == wanted
            assert read.PRESET.static(method) == replace(uj.preset("tan2022").static, method=method)


def test_the_demos_cap_follows_the_radius_and_holds_where_nothing_counts():
    small, _, large = read.CASES
    assert read.DEMO.params(small, "improved").clearance_cap == pytest.approx(0.4)
    assert read.DEMO.params(large, "improved").clear_distance == pytest.approx(1.4)


def test_the_traditional_method_shares_episodes_that_only_the_improved_one_tells_apart():
    narrow = replace(read.PRESET, search_angle=0.5, clear_distance=9.0)
    case = read.CASES[0]
    runs = [PLAN.run(r, case, "traditional") for r in (read.PRESET, narrow)]
    assert runs[0] == runs[1]
    assert PLAN.run(read.PRESET, case, "improved") != PLAN.run(narrow, case, "improved")
    assert total([*runs, PLAN.run(narrow, case, "improved")]) == 2 * PLAN.maps


# --- which maps are shown ---------------------------------------------------------------------


def flags(n, jobs):
    return np.isin(np.arange(n), jobs)


def test_table_2_shows_the_first_map_that_suits_all_radii():
    suits = {0.2: [3, 7, 9], 0.5: [5, 7, 9], 0.7: [7, 9]}

    def make(reading, case, method):
        jobs = suits[case.radius] if method == "improved" else range(64)
        return made_up(64, 0.4, flags(64, list(jobs)))

    results = results_of(PLAN, [read.PRESET], make, read.ONE_MAP_CASES)
    shown = one_map(results, PLAN, read.PRESET)
    assert [(s.figure, s.job) for s in shown] == [(2, 7), (3, 7), (4, 7)]
    rows = single_maps(shown, results)
    assert rows[1]["passed_over"] == 7
    run = PLAN.run(read.PRESET, read.ONE_MAP_CASES[1], "improved")
    assert rows[1]["values"]["improved"]["time"] == results[run].time[7]


def test_table_2_is_empty_where_no_map_suits_all_radii():
    def make(reading, case, method):
        return made_up(64, 0.4, flags(64, [int(10 * case.radius)]))

    results = results_of(PLAN, [read.PRESET], make, read.ONE_MAP_CASES)
    assert one_map(results, PLAN, read.PRESET) == []


def test_table_3_shows_three_different_maps():
    def make(reading, case, method):
        return made_up(64, 0.4, flags(64, [4, 6, 8]))

    shown = three_maps(results_of(PLAN, [read.PRESET], make), PLAN, read.PRESET)
    assert [(s.figure, s.job) for s in shown] == [(5, 4), (6, 6), (7, 8)]


def test_table_4_averages_the_first_twenty_maps_and_the_changes_per_map():
    suits = flags(64, list(range(1, 61, 2)))

    def make(reading, case, method):
        return made_up(64, 0.3 if method == "traditional" else 0.5, suits)

    results = results_of(PLAN, [read.PRESET], make)
    row = twenty_maps(results, PLAN, read.PRESET)[0]
    assert (row["maps"], row["passed_over"]) == (20, 20)
    jobs = np.arange(1, 41, 2)
    old, new = (results[PLAN.run(read.PRESET, read.CASES[0], m)].time[jobs] for m in METHODS)
    assert row["values"]["improved"]["time"] == pytest.approx(new.mean())
    assert row["change"]["time"] == pytest.approx((new / old - 1).mean())


# --- paired comparison ------------------------------------------------------------------------

SAME = Comparison("no cap", read.PRESET, read.PRESET)


def test_the_comparison_rests_on_the_maps_where_both_succeed():
    def make(reading, case, method):
        jobs = range(0, 50) if method == "traditional" else range(20, 64)
        return made_up(64, 0.3 if method == "traditional" else 0.5, flags(64, list(jobs)))

    results = results_of(PLAN, [read.PRESET], make)
    (row,) = compare([SAME], results, PLAN)
    case = row["cases"][0]
    assert case["both"] == 30
    assert case["endings"]["traditional"]["REACHED"]["count"] == 50
    assert case["endings"]["improved"]["COLLIDED"]["count"] == 20
    counts = case["success"]
    assert (counts["method_only"], counts["baseline_only"]) == (14, 20)
    old, new = (results[PLAN.run(read.PRESET, read.CASES[0], m)].time[20:50] for m in METHODS)
    time = case["metrics"]["time"]
    assert time["difference"]["value"] == pytest.approx((new - old).mean())
    assert time["difference"]["high"] < 0
    assert time["difference_bootstrap"]["high"] < 0
    assert time["p_t"] <= time["p_t_holm"] < 1e-6


def test_without_a_common_success_there_are_rates_and_nothing_else():
    def make(reading, case, method):
        jobs = range(0, 32) if method == "traditional" else range(32, 64)
        return made_up(64, 0.4, flags(64, list(jobs)))

    results = results_of(PLAN, [read.PRESET], make)
    case = compare([SAME], results, PLAN)[0]["cases"][0]
    assert case["both"] == 0
    assert case["metrics"]["time"] is None
    row = sensitivities([read.PRESET], results, PLAN)[0]
    assert row["means"] is None
    assert row["time_ratio"]["value"] is None


def test_the_ratio_of_means_has_an_interval_around_it():
    rng = np.random.default_rng(1)
    old = rng.uniform(40.0, 60.0, 200)
    found = ratio(0.5 * old + rng.normal(0, 2, 200), old, seed=3)
    assert found["low"] < found["value"] < found["high"]
    # Of 200 ratios, each with a standard deviation of 2 / 50: to seven of 0.04 / sqrt(200).
    assert found["value"] == pytest.approx(0.5, abs=0.02)
    assert ratio(0.5 * old, old, seed=3)["low"] is None  # without any spread


# --- verdicts and ranking ---------------------------------------------------------------------


def as_published(reading, case, method):
    """Episodes whose means are Table 4's, with a spread that covers Tables 2 and 3."""
    place = [c.radius for c in read.CASES].index(case.radius)
    n = 400
    time, length, _ = (published.TABLE4.values[method, m][place] for m in published.METRICS)
    rng = np.random.default_rng((place, len(method)))
    times = time * np.exp(rng.normal(0, 0.3, n) - 0.3**2 / 2)
    lengths = length * np.exp(rng.normal(0, 0.05, n))
    return replace(made_up(n, 0.4), time=times, path_length=lengths, mean_speed=lengths / times)


def judged(make):
    plan = replace(PLAN, maps=400)
    results = results_of(plan, [read.PRESET], make) | results_of(
        plan, [read.PRESET], make, read.ONE_MAP_CASES
    )
    (row,) = compare([SAME], results, plan)
    return {v.claim: v for v in judge([evidence(SAME, row, results, plan, plan)])}


def test_verdicts_say_so_when_the_published_numbers_are_met():
    found = judged(as_published)
    assert found["Table 4: time is reduced"].verdict == "reproduces"
    assert found["The path is shortened more, the larger the radius"].verdict == "reproduces"
    assert found['"Superior" in navigation time'].verdict == "reproduces"


def test_verdicts_say_so_when_the_published_numbers_are_missed():
    found = judged(lambda reading, case, method: made_up(400, 0.4, seed=len(method)))
    for claim in ("Table 2: one map, three radii", "Table 4: averages over 20 maps"):
        assert found[claim].verdict == "does not reproduce"
    assert found["Table 4: time is reduced"].verdict == "does not reproduce"
    assert found['"Superior" in navigation time'].verdict == "does not reproduce"


def test_more_collisions_are_not_a_stronger_avoidance():
    def make(reading, case, method):
        arrived = flags(400, list(range(400 if method == "traditional" else 300)))
        return made_up(400, 0.4, arrived)

    claim = '"Stronger obstacle avoidance adjustment ability"'
    assert judged(make)[claim].verdict == "does not reproduce"
    assert "0.0 to 25.0" in judged(make)[claim].found["no cap"].numbers


def test_too_few_maps_give_no_verdict():
    def make(reading, case, method):
        return made_up(400, 0.4, flags(400, [0, 1]))

    found = judged(make)
    assert found["Table 4: averages over 20 maps"].verdict == "too few maps"


def test_the_ranking_finds_the_reading_that_made_the_numbers():
    other = read.DEMO
    readings = [other, read.PRESET]
    outcomes = {
        (reading, method): [
            as_published(reading, case, method) if reading is read.PRESET else made_up(400, 0.2)
            for case in read.CASES
        ]
        for reading in readings
        for method in METHODS
    }
    ranked = ranking.rank(readings, outcomes)
    assert len(ranked) == 4
    assert (ranked[0].traditional, ranked[0].improved) == ("no cap", "no cap")
    assert ranked[0].typical_factor < 1.15 < ranked[-1].typical_factor
    own = {method: outcomes[read.PRESET, method] for method in METHODS}
    hits = ranking.with_hits(ranked[0], own, seed=1)
    assert hits.within + len(hits.misses) == 18
    assert hits.within >= 12


def test_the_distance_is_the_rms_log_ratio():
    exact = [
        {m: published.TABLE4.values[method, m][place] for m in published.METRICS}
        for method in METHODS
        for place in range(3)
    ]
    episodes = iter(
        replace(
            made_up(12, 0.4),
            time=np.full(12, 2.0 * values["time"]),
            path_length=np.full(12, values["path_length"]),
            mean_speed=np.full(12, values["mean_speed"]),
        )
        for values in exact
    )
    outcomes = {method: [next(episodes) for _ in range(3)] for method in METHODS}
    found = ranking.match("a", "b", outcomes)
    assert found.distance == pytest.approx(log(2.0) / 3**0.5)


def test_pairs_with_few_common_successes_are_not_ranked():
    few = [made_up(50, 0.4, flags(50, list(range(9)))) for _ in range(3)]
    assert ranking.match("a", "b", {method: few for method in METHODS}).distance == inf


def test_hybrids_share_maps_start_and_goal():
    tolerant = replace(read.DEMO, label="tolerant", goal_tolerance=1.0)
    pairs = ranking.pairs([read.PRESET, read.DEMO, tolerant])
    assert (read.PRESET, read.DEMO) in pairs
    assert not any((tolerant in pair) and pair[0] != pair[1] for pair in pairs)
