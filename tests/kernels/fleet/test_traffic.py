"""Traffic as the window's candidates meet it: who is within reach already comes no nearer."""

import jax.numpy as jnp
import numpy as np
import pytest

from usvkernels.fleet import traffic

TURNING, COURSE = 3.0, 60.0  # s
REACH = 100.0


def clear(place, heading, speed):
    """Whether going straight on at `speed` (m/s) is allowed beside something at rest."""
    ahead = jnp.full(1, np.cos(heading)), jnp.full(1, np.sin(heading))
    legs = traffic.Legs(turn=ahead, course=ahead, bulge=jnp.zeros(1))
    times = traffic.Times(jnp.full(1, TURNING), jnp.full(1, COURSE), jnp.full((1, 1), speed))
    rows = jnp.array([*place, 0.0, 0.0, REACH, REACH]).reshape(6, 1, 1)
    weighing, none = traffic.Circles(rows, 1), traffic.Circles(rows[:, :0], 0)
    there = traffic.Traffic(weighing, none, times.course)
    least = traffic.least_distance(there, legs, times, jnp.full((1, 1), float(speed)))
    return bool(least[0, 0] > -jnp.inf)


@pytest.mark.parametrize("distance", [99.0, 50.0])
def test_nobody_creeps_into_what_is_within_reach(distance):
    assert clear((distance, 0.0), np.pi, 1.0)
    assert clear((distance, 0.0), 0.0, 0.0)
    # 3 mm nearer at the end of the turn: step by step vessels crept into each other.
    assert not clear((distance, 0.0), 0.0, 1e-3)


def test_outside_reach_it_may_come_as_near_as_that():
    assert clear((REACH + 70.0, 0.0), 0.0, 1.0)  # stops after a second, however far it looks
    assert not clear((REACH + 2.0, 0.0), 0.0, 1.0)
    assert clear((0.0, REACH + 0.1), 0.0, 5.0)
    assert not clear((5.0, REACH - 0.1), 0.0, 5.0)
