"""DCPA, TCPA and contact: textbook radar plots, edges, and double precision by the definition."""

from math import cos, radians, sin, sqrt

import jax
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usvkernels.fleet.approach import closest_approach, contact_time, least_square

KNOT, MILE = 1852 / 3600, 1852.0

closest = jax.jit(closest_approach)
least = jax.jit(least_square)
contact = jax.jit(contact_time)


def compass(degrees: float, length: float) -> np.ndarray:
    return length * np.array([sin(radians(degrees)), cos(radians(degrees))])


RADAR = {  # own course and speed (kn), bearing and distance (nm), course and speed; DCPA, TCPA
    "reciprocal": ((0, 10), (0, 8), (180, 20), 0.0, 16 * 60),
    "from ahead to starboard": ((0, 10), (0, 1), (90, 10), sqrt(0.5), 3 * 60),
    "from the beam, as fast": ((0, 12), (90, 6), (270, 12), 6 * sqrt(0.5), 15 * 60),
    "overtaken": ((45, 15), (45, 3), (45, 9), 0.0, 30 * 60),
}


@pytest.mark.parametrize("name", RADAR)
def test_textbook_radar_plots(name):
    own, plot, other, miles, seconds = RADAR[name]
    place = compass(plot[0], plot[1] * MILE)
    relative = compass(other[0], other[1] * KNOT) - compass(own[0], own[1] * KNOT)
    found = closest(tuple(place), tuple(relative))
    assert float(found.distance) == pytest.approx(miles * MILE, abs=0.5)
    assert float(found.time) == pytest.approx(seconds, rel=1e-5)


def test_the_same_velocity_keeps_the_distance():
    found = closest((30.0, 40.0), (0.0, 0.0))
    assert (float(found.distance), float(found.time)) == (50.0, 0.0)
    assert np.isinf(contact((30.0, 40.0), (0.0, 0.0), 49.0))
    assert float(contact((30.0, 40.0), (0.0, 0.0), 50.0)) == 0.0


def test_what_is_past_has_a_negative_time_and_no_contact():
    found = closest((-100.0, 10.0), (-5.0, 0.0))
    assert float(found.time) == pytest.approx(-20.0)
    assert float(found.distance) == pytest.approx(10.0)
    assert np.isinf(contact((-100.0, 10.0), (-5.0, 0.0), 20.0))
    assert float(least((-100.0, 10.0), (-5.0, 0.0), 60.0)) == pytest.approx(100.0**2 + 10.0**2)


def test_a_graze_is_contact_and_a_hundredth_less_is_not():
    assert float(contact((100.0, 10.0), (-5.0, 0.0), 10.1)) == pytest.approx(
        (100 - sqrt(10.1**2 - 100)) / 5, rel=1e-4
    )
    assert np.isinf(contact((100.0, 10.0), (-5.0, 0.0), 9.9))


coordinate = st.floats(-5000, 5000, width=32)
speed = st.floats(-15, 15, width=32)


@given(st.tuples(coordinate, coordinate), st.tuples(speed, speed), st.floats(0, 600, width=32))
def test_the_least_distance_is_that_of_the_definition(place, velocity, until):
    found = float(least(place, velocity, until))
    p, v = np.array(place, np.float64), np.array(velocity, np.float64)
    times = np.linspace(0.0, until, 4001)
    sampled = np.min(np.sum((p + v * times[:, None]) ** 2, axis=1))
    scale = 1.0 + np.dot(p, p) + np.dot(v, v) * until**2
    assert found <= sampled + 1e-5 * scale
    step = until / 4000 * np.linalg.norm(v)
    assert sqrt(found + 1e-5 * scale) >= sqrt(sampled) - step - 1e-6


@given(st.tuples(coordinate, coordinate), st.tuples(speed, speed), st.floats(1, 500, width=32))
def test_contact_begins_where_the_distance_is_met(place, velocity, distance):
    time = float(contact(place, velocity, distance))
    p, v = np.array(place, np.float64), np.array(velocity, np.float64)
    if time == 0.0:
        assert np.linalg.norm(p) <= distance * (1 + 1e-5)
    elif np.isfinite(time):
        # In single precision: a few metres of a way of kilometres.
        assert abs(np.linalg.norm(p + v * time) - distance) <= 2e-3 * (1 + np.linalg.norm(p))
    else:
        along = max(0.0, -float(p @ v) / max(float(v @ v), 1e-30))
        assert np.linalg.norm(p + v * along) >= distance * (1 - 1e-3) - 1e-3 * np.linalg.norm(p)
