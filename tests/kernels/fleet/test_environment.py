"""Currents by their formulas in double precision, and headings that make a course good."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from usvkernels.fleet.environment import (
    Environment,
    Field,
    Shear,
    Uniform,
    Vortex,
    crab,
    current_at,
    drift,
)

CRAB = jax.jit(crab)
RNG = np.random.default_rng(3)
PLACES = RNG.uniform(-500, 500, (2, 3, 400))
GRID = RNG.normal(0, 1, (2, 4, 6))
CORNER, CELL = np.array([-300.0, -150.0]), 90.0


def shear(x, y):
    left = -np.sin(0.7) * (x - 20.0) + np.cos(0.7) * (y + 30.0)
    return (1.2 + 0.004 * left) * np.cos(0.7), (1.2 + 0.004 * left) * np.sin(0.7)


def vortex(x, y):
    """By angle and distance."""
    east, north = x - 50.0, y + 40.0
    distance, angle = np.hypot(east, north), np.arctan2(north, east)
    speed = np.where(distance < 120.0, -2.0 * distance / 120.0, -2.0 * 120.0 / distance)
    return -speed * np.sin(angle), speed * np.cos(angle)


def field(x, y):
    """Each cell's centre weighs as a tent over the clipped place."""
    out = []
    column = np.clip((x - CORNER[0]) / CELL - 0.5, 0, 5)[..., None]
    row = np.clip((y - CORNER[1]) / CELL - 0.5, 0, 3)[..., None]
    weight = np.maximum(1 - np.abs(row - np.arange(4)), 0)[..., None]
    weight = weight * np.maximum(1 - np.abs(column - np.arange(6)), 0)[..., None, :]
    for part in GRID:
        out.append(np.sum(weight * part, axis=(-1, -2)))
    return tuple(out)


CASES = {
    "uniform": (Uniform((0.3, -0.8)), lambda x, y: (0.3 + 0 * x, -0.8 + 0 * y)),
    "shear": (Shear((20.0, -30.0), (np.cos(0.7), np.sin(0.7)), 1.2, 0.004), shear),
    "vortex": (Vortex((50.0, -40.0), -2.0, 120.0), vortex),
    "field": (Field(jnp.asarray(GRID, jnp.float32), tuple(CORNER), CELL), field),
}


@pytest.mark.parametrize("name", CASES)
def test_currents_are_their_formulas(name):
    current, formula = CASES[name]
    places = PLACES.astype(np.float32)
    found = jax.jit(lambda x, y: current_at(current, (x, y)))(*places)
    wanted = formula(*places.astype(np.float64))
    assert np.abs(np.array(found) - np.array(wanted)).max() < 2e-5
    assert np.abs(wanted).max() > 0.5


def test_a_vortex_rests_at_its_centre_and_is_fastest_at_its_core():
    current = CASES["vortex"][0]
    x = np.float32([50.0, 170.0, 290.0])
    _, north = current_at(current, (x, np.full(3, -40.0, np.float32)))
    assert np.array(north) == pytest.approx([0.0, -2.0, -1.0], abs=1e-6)


def test_wind_drifts_by_its_leeway():
    found = drift(Environment(Uniform((0.5, 0.0)), (4.0, -8.0), 0.03), (np.zeros(2), np.zeros(2)))
    assert np.array(found) == pytest.approx(np.array([[0.62, 0.62], [-0.24, -0.24]]))


def test_a_crabbed_heading_makes_the_course_good():
    angle, set_to = RNG.uniform(-np.pi, np.pi, (2, 500))
    speed, rate, most = RNG.uniform(0.5, 6, 500), RNG.uniform(0, 2.9, 500), 3.0
    course = np.cos(angle), np.sin(angle)
    flow = np.array([rate * np.cos(set_to), rate * np.sin(set_to)])
    heading, through, made = (np.array(part) for part in CRAB(course, speed, tuple(flow), most))
    over_ground = heading * through + flow
    across = course[0] * over_ground[1] - course[1] * over_ground[0]
    assert np.hypot(*heading) == pytest.approx(np.ones(500), abs=1e-6)
    assert np.abs(across).max() < 2e-5
    assert made == pytest.approx(np.sum(np.array(course) * over_ground, axis=0), abs=2e-5)
    assert through.max() < most + 1e-5
    along = np.sum(np.array(course) * flow, axis=0)
    able = along + np.sqrt(most**2 - (rate**2 - along**2))
    assert made == pytest.approx(np.clip(speed, along, able), abs=2e-5)


def test_a_drift_that_cannot_be_stemmed_is_stemmed_as_far_as_can_be():
    one = np.ones(1)
    heading, through, made = CRAB((one, 0 * one), 2 * one, (0.5 * one, -4 * one), 3.0)
    assert np.array(heading)[:, 0] == pytest.approx([0.0, 1.0])
    assert (float(through[0]), float(made[0])) == (3.0, 0.5)
