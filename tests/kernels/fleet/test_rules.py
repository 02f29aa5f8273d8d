"""The rules of the road: each vessel by its own settings."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from usvkernels.fleet import orca, rules, wei2023
from usvkernels.fleet.params import Encounters
from usvkernels.fleet.sight import Obstacles, Vessels

NOTHING = Obstacles(jnp.full((2, 1, 1, 1), 1e9), None)


def vessels(places, courses, speed=5.0) -> Vessels:
    """Vessels of one lane on straight courses to goals far away (m, deg from x)."""
    x, y = (jnp.asarray(v, float)[:, None] for v in np.transpose(places))
    course = (
        jnp.cos(jnp.radians(jnp.asarray(courses)))[:, None],
        (jnp.sin(jnp.radians(jnp.asarray(courses)))[:, None]),
    )
    speeds, there = jnp.full_like(x, speed), jnp.ones(x.shape, bool)
    goal = x + 1e4 * course[0], y + 1e4 * course[1]
    guide = x + 400.0 * course[0], y + 400.0 * course[1]
    return Vessels(
        place=(x, y),
        bow=course,
        velocity=(speed * course[0], speed * course[1]),
        drift=None,
        course=course,
        guide=guide,
        led=~there,
        goal=goal,
        speed=speeds,
        made_good=speeds,
        hull=jnp.full_like(x, 20.0),
        arrival=jnp.full_like(x, 2000.0),
        under_way=there,
        present=there,
    )


def how(strategy="rules", **own) -> Encounters:
    """The first vessel's setting and the second's, or one for both."""
    given = {"passing": 90.0, "sight_time": 300.0, "act_time": 60.0, "threshold": 900.0, **own}
    leaves = {
        name: jnp.asarray(value)[:, None] if np.ndim(value) else value
        for name, value in given.items()
    }
    return Encounters(**leaves, strategy=strategy, equal="both_yield", ring="all_yield")


def met(vessels: Vessels, settings: Encounters, role=rules.NONE, altered=0, idle=0.0):
    n = len(vessels.speed)
    roles, before = jnp.full((n, n, 1), role, jnp.int32), jnp.full((n, 1), altered, jnp.int32)
    reach = vessels.hull + 100.0
    waited = jnp.full((n, 1), idle)
    return jax.jit(rules.meet)(settings, vessels, NOTHING, reach, roles, before, waited)


@pytest.mark.parametrize(("own", "sees"), [((300.0, 100.0), 0), ((100.0, 300.0), 1)])
def test_a_vessel_acts_at_its_own_time_of_sight(own, sees):
    reciprocal = vessels([[0, 0], [2000, 0]], [0, 180])
    _, roles, altered = met(reciprocal, how(sight_time=own))
    assert roles[sees, 1 - sees] == rules.HEAD_ON
    assert roles[1 - sees, sees] == rules.NONE
    assert altered[sees, 0] > 0
    assert altered[1 - sees, 0] == 0


@pytest.mark.parametrize(("own", "sees"), [((90.0, 0.0), 0), ((0.0, 90.0), 1)])
def test_a_vessel_asks_for_its_own_distance(own, sees):
    # 80 m apart at the closest point: hulls of 20 m each would pass.
    reciprocal = vessels([[0, 0], [2000, 80]], [0, 180])
    _, roles, _ = met(reciprocal, how(passing=own))
    assert (roles[sees, 1 - sees] != rules.NONE) & (roles[1 - sees, sees] == rules.NONE)


@pytest.mark.parametrize(("own", "acts"), [((10.0, 60.0), True), ((60.0, 10.0), False)])
def test_a_vessel_that_stands_on_acts_at_its_own_last_moment(own, acts):
    # The first has the second to starboard; contact would be in 34 s.
    crossing = vessels([[-200, 0], [0, -200]], [0, 90])
    orders, roles, altered = met(crossing, how(act_time=own))
    assert roles[0, 1] == rules.GIVE_WAY
    assert roles[1, 0] == rules.STAND_ON
    assert bool(orders.sees[1, 0, 0]) == acts
    assert (altered[1, 0] > 0) == acts


@pytest.mark.parametrize(
    ("aside", "altered", "role", "goes_on"),
    [
        (1.1, 0, rules.HEAD_ON, True),  # wide enough for who has not altered
        (1.1, 4, rules.HEAD_ON, False),  # but not to take an alteration back
        (1.1, rules.PARALLEL, rules.HEAD_ON, False),
        (1.3, 4, rules.NONE, True),  # the pair has no roles any more
        (0.9, 0, rules.HEAD_ON, False),
    ],
)
def test_who_has_altered_holds_on_until_the_pair_is_released(aside, altered, role, goes_on):
    reciprocal = vessels([[0, 0], [2000, 130 * aside]], [0, 180])
    _, roles, now = met(reciprocal, how(), rules.HEAD_ON, altered)
    assert roles[0, 1] == role
    assert (now[0, 0] == 0) == goes_on


def test_who_comes_back_to_its_route_too_soon_is_not_clear():
    # On its course to the guidance point it would pass 300 m off; on its route beyond, 40.
    beside = vessels([[0, -100], [3000, 40]], [0, 180])
    guide = beside.guide[0], beside.guide[1].at[0].set(0.0)
    way = jnp.hypot(400.0, 100.0)
    course = beside.course[0].at[0].set(400.0 / way), beside.course[1].at[0].set(100.0 / way)
    goal = beside.goal[0], beside.goal[1].at[0].set(0.0)
    back = beside._replace(guide=guide, course=course, goal=goal)
    orders, roles, altered = met(back, how(), rules.HEAD_ON, rules.PARALLEL)
    assert roles[0, 1] == rules.HEAD_ON
    assert altered[0, 0] == rules.PARALLEL
    assert (orders.course[0][0, 0], orders.course[1][0, 0]) == pytest.approx((1.0, 0.0), abs=1e-6)


def test_who_has_arrived_is_seen_as_early_as_any():
    ahead = vessels([[0, 0], [1500, 20]], [0, 180])
    anchored = ahead._replace(
        under_way=ahead.under_way.at[1].set(False),
        velocity=tuple(part.at[1].set(0.0) for part in ahead.velocity),
        arrival=ahead.arrival.at[1].set(0.0),
    )
    _, roles, altered = met(anchored, how())
    assert roles[0, 1] == rules.OVERTAKING
    assert altered[0, 0] > 0


def test_guidance_points_meet_within_ones_own_threshold():
    crossing = vessels([[-600, 0], [0, -600]], [0, 90])
    v_dec = jnp.ones_like(crossing.speed)
    for threshold, yields in (((300.0, 100.0), [True, False]), ((100.0, 300.0), [False, True])):
        _, found = jax.jit(wei2023.meet)(how("wei2023", threshold=threshold), crossing, v_dec)
        assert found[:, 0].tolist() == yields


def test_reciprocal_velocities_look_ahead_as_each_has_it():
    reciprocal = vessels([[0, 0], [1000, 5]], [0, 180])
    reach = reciprocal.hull + 100.0

    def turned(act_time):
        settings = how("orca", act_time=act_time)
        north = jax.jit(orca.meet)(settings, reciprocal, NOTHING, reach, 1.0)[1]
        return np.abs(np.asarray(north))[:, 0] > 1e-3

    assert turned((200.0, 10.0)).tolist() == [True, False]
    assert turned((10.0, 200.0)).tolist() == [False, True]


@pytest.mark.parametrize(
    ("apart", "acts"), [(84.0, True), (86.0, False)], ids=["within what is kept", "beyond"]
)
def test_a_vessel_that_stands_on_sees_who_is_too_near(apart, acts):
    """Side by side on one course: the other closes not at all, but may turn any moment."""
    beside = vessels([[0, 0], [0, apart]], [0, 0])
    orders, roles, _ = met(beside, how(act_time=1e-3))
    stands_on = roles[..., 0] == rules.NONE
    assert stands_on.all()
    # Both have no role, and so see each other; one that stands on sees only who is near.
    held = roles.at[0, 1].set(rules.STAND_ON).at[1, 0].set(rules.GIVE_WAY)
    seen = rules._look(how(act_time=1e-3), beside, held)
    assert bool(seen.must[0, 1, 0]) is acts
    assert np.asarray(orders.apart)[0, 1, 0] == pytest.approx(40.0 + rules.SPARE * 90.0)


def test_who_has_waited_long_may_turn_to_port():
    """Touching, with the other on the starboard bow: every turn to starboard comes nearer."""
    facing = vessels([[0, 0], [60, -45]], [0, 135])
    waiting = met(facing, how(), idle=rules.PATIENCE - 1.0)[2]
    parting = met(facing, how(), idle=rules.PATIENCE + 1.0)[2]
    degrees = [rules.CANDIDATES[int(k)][0] for k in parting[:, 0]]
    assert (np.asarray(waiting) < rules.FIRST_OTHERWISE).all()
    assert (np.asarray(parting) >= rules.FIRST_OTHERWISE).any(), degrees
