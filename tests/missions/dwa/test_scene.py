"""Which episodes promise to be long."""

from dataclasses import replace

import numpy as np
from navigate_episodes import PARAMS, STATIC
from scipy.stats import spearmanr

import usvjax as uj
from usvjax.missions.dwa.inputs import pack_episodes

START, GOAL = [0.0, 0.0, 0.0], [10.0, 0.0]


def expected(obstacles: object, params: uj.DwaParams = PARAMS) -> np.ndarray:
    scene = pack_episodes(obstacles, START, GOAL, None, params, STATIC, None)
    return scene.expected_steps(params)


def test_steps_are_those_of_the_straight_course_at_full_speed() -> None:
    far = [[0.0, 1e5]]
    straight = 10.0 / (PARAMS.v_max * PARAMS.dt)
    np.testing.assert_allclose(expected(far), straight, rtol=1e-4)
    twice = replace(PARAMS, dt=np.array([0.1, 0.05]))
    np.testing.assert_allclose(expected(far, twice), [straight, 2 * straight], rtol=1e-4)


def test_an_obstacle_on_the_course_doubles_them_at_most() -> None:
    offsets = np.array([0.0, 0.1, 0.5, 2.0, 50.0])
    found = expected(np.stack([np.full(5, 5.0), offsets], axis=-1)[:, None])
    assert (np.diff(found) < 0).all()
    np.testing.assert_allclose(found[0], 2 * 10.0 / (PARAMS.v_max * PARAMS.dt), rtol=1e-6)
    radius = PARAMS.radius
    np.testing.assert_allclose(found / found[0], (1 + radius / (radius + offsets)) / 2, rtol=1e-5)


def test_what_lies_behind_or_past_the_goal_does_not_count() -> None:
    aside = expected([[[-2.0, 0.0]], [[12.0, 0.0]], [[0.0, 1e5]]])
    np.testing.assert_allclose(aside, aside[2], rtol=1e-5)


def test_a_vessel_that_cannot_move_and_a_start_at_the_goal_are_finite() -> None:
    still = replace(PARAMS, v_min=0.0, v_max=0.0, v_acc=0.0, radius=0.0)
    assert np.isfinite(expected([[5.0, 0.0]], still)).all()
    here = pack_episodes([[5.0, 0.0]], START, [0.0, 0.0], None, PARAMS, STATIC, None)
    np.testing.assert_array_equal(here.expected_steps(PARAMS), 0.0)


def test_on_a_chart_the_distance_counts() -> None:
    water = uj.GridMap(np.zeros((20, 20), bool), 10.0)
    params = replace(PARAMS, radius=8.0)
    goals = [[60.0, 50.0], [150.0, 50.0]]
    scene = pack_episodes(water, [50.0, 50.0, 0.0], goals, None, params, STATIC, None)
    near, far = scene.expected_steps(params)
    np.testing.assert_allclose(far / near, 10.0)


def test_far_goals_are_told_from_near_ones() -> None:
    rng = np.random.default_rng(3)
    obstacles = rng.uniform(0.8, 4.2, (100, 3, 2))
    goals = np.linspace([1.5, 1.5], [5.0, 5.0], 100)
    static = replace(STATIC, max_steps=400)
    sailed = uj.navigate_dwa(obstacles, START, goals, params=PARAMS, static=static)
    scene = pack_episodes(obstacles, START, goals, None, PARAMS, static, None)
    there = sailed.status == uj.Status.REACHED
    assert there.sum() > 30
    ranks = spearmanr(scene.expected_steps(PARAMS)[there], sailed.steps[there])
    assert ranks.statistic > 0.7
