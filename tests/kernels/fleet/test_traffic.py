"""Traffic as the window's candidates meet it: who is within reach already comes no nearer."""

import jax.numpy as jnp
import numpy as np
import pytest

from usvkernels.dwa import traffic

TURNING, COURSE = 3.0, 60.0  # s
REACH = 100.0


def clear(place, heading, speed):
    """Whether going straight on at `speed` (m/s) is allowed beside something at rest."""
    ahead = jnp.full(1, np.cos(heading)), jnp.full(1, np.sin(heading))
    legs = traffic._Legs(turn=ahead, course=ahead, bulge=jnp.zeros(1))
    times = traffic._Times(jnp.full(1, TURNING), jnp.full(1, COURSE), jnp.full((1, 1), speed))
    there = tuple(jnp.full(1, float(part)) for part in place)
    still, v = (jnp.zeros(1), jnp.zeros(1)), jnp.full((1, 1), float(speed))
    least = traffic._nearer(
        there, still, jnp.full(1, REACH), legs, times, v, True, jnp.full((1, 1), jnp.inf)
    )
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
