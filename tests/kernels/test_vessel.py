"""Plants and their trigonometry against complex numbers."""

import cmath
import math

import jax.numpy as jnp
import numpy as np
import pytest
from dwa_situations import enable_x64
from hypothesis import example, given
from hypothesis import strategies as st
from property_draws import examples

from usvkernels.trig import angle_between, sincos, wrap_angle
from usvkernels.vessel import PLANTS, complex_product, geometric_sum

METRES = st.floats(-1e3, 1e3)
HEADINGS = st.floats(-math.pi, math.pi)
SPEEDS = st.floats(-10.0, 10.0)
RATES = st.floats(-1.0, 1.0)
PERIODS = st.floats(0.01, 1.0)
ANGLES = st.floats(-1e3, 1e3)
TINY = float(np.finfo(np.float64).tiny)  # XLA takes products below it for 0


def turns_apart(a: float, b: float) -> float:
    """How far two angles are from being congruent, rad."""
    return abs(math.remainder(a - b, 2.0 * math.pi))


@given(HEADINGS, st.integers(1, 200))
@example(0.0, 200)
@examples(60)
def test_geometric_sum_is_the_sum_of_powers(angle: float, n: int) -> None:
    z = cmath.exp(1j * angle)
    with enable_x64():
        total, power = geometric_sum((jnp.float64(z.real), jnp.float64(z.imag)), n)
    # The oracle's powers err by less than 2 k roundings of 1.1e-16 each, k up to 200: by 5e-14.
    assert abs(complex(*map(float, total)) - sum(z**k for k in range(n))) <= 1e-12 * n
    assert abs(complex(*map(float, power)) - z**n) <= 1e-12


def test_geometric_sum_is_exact_without_rotation() -> None:
    for n in (1, 2, 3, 29, 30, 31, 64, 1000):
        total, power = geometric_sum((jnp.float32(1.0), jnp.float32(0.0)), n)
        assert (float(total[0]), float(total[1])) == (n, 0.0)
        assert (float(power[0]), float(power[1])) == (1.0, 0.0)


@given(METRES, METRES, HEADINGS, SPEEDS, RATES, PERIODS)
@examples(80)
def test_plants_against_complex_numbers(
    x: float, y: float, psi: float, v: float, w: float, dt: float
) -> None:
    along = {"unicycle": psi, "heading_first": psi + w * dt}
    assert set(along) == set(PLANTS)
    with enable_x64():
        now = [jnp.float64(value) for value in (x, y, psi, v, w)]
        found = {name: [float(a) for a in step(*now, dt)] for name, step in PLANTS.items()}
    error = 1e-14 * (abs(x) + abs(y) + dt * abs(v)) + 4.0 * TINY
    for name, (got_x, got_y, heading) in found.items():
        eq1 = complex(x, y) + v * dt * cmath.exp(1j * along[name])
        assert abs(complex(got_x, got_y) - eq1) <= error
        assert -math.pi <= heading < math.pi
        assert turns_apart(heading, psi + w * dt) <= 1e-14


@given(ANGLES)
@example(math.pi)
@example(-math.pi)
@example(3.0 * math.pi)
@example(math.nextafter(math.pi, 0.0))
@example(math.nextafter(-math.pi, -4.0))
@example(-1e-17)
@examples(300)
def test_wrap_angle_float64(angle: float) -> None:
    with enable_x64():
        wrapped = float(wrap_angle(jnp.float64(angle)))
    assert -math.pi <= wrapped < math.pi
    assert turns_apart(wrapped, angle) <= 4e-16 * (1.0 + abs(angle))


def test_wrap_angle_float32() -> None:
    rng = np.random.default_rng(2)
    pi = np.float32(np.pi)
    odd = pi * np.arange(-9, 10, 2, dtype=np.float32)
    near = [odd, np.nextafter(odd, np.float32(np.inf)), np.nextafter(odd, np.float32(-np.inf))]
    angles = np.concatenate([rng.uniform(-50, 50, 100_000).astype(np.float32), *near])
    wrapped = np.asarray(wrap_angle(jnp.asarray(angles)))
    assert wrapped.dtype == np.float32
    assert (wrapped >= -pi).all()
    assert (wrapped < pi).all()
    off = np.exp(1j * wrapped.astype(np.float64)) - np.exp(1j * angles.astype(np.float64))
    assert np.abs(off).max() <= 1e-6 * (1.0 + np.abs(angles).max() / np.pi)


def test_sincos_float32_error() -> None:
    rng = np.random.default_rng(3)
    angles = np.concatenate(
        [rng.uniform(-1e3, 1e3, 400_000), np.arange(-600, 601) * np.pi / 2, [0.0, -0.0]]
    ).astype(np.float32)
    sin, cos = (np.asarray(a) for a in sincos(jnp.asarray(angles)))
    exact = angles.astype(np.float64)
    assert sin.dtype == cos.dtype == np.float32
    assert np.abs(sin - np.sin(exact)).max() < 2e-7
    assert np.abs(cos - np.cos(exact)).max() < 2e-7


def test_sincos_float64_is_the_library() -> None:
    angles = np.linspace(-20.0, 20.0, 10_001)
    with enable_x64():
        sin, cos = (np.asarray(a) for a in sincos(jnp.asarray(angles)))
    assert np.abs(sin - np.sin(angles)).max() < 1e-15
    assert np.abs(cos - np.cos(angles)).max() < 1e-15


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
def test_angle_between_float32_error(scale: float) -> None:
    rng = np.random.default_rng(4)
    across, along = (rng.normal(size=(2, 200_000)) * scale).astype(np.float32)
    along[:4], across[:4] = (scale, -scale, 0.0, 0.0), (0.0, 0.0, scale, -scale)
    got = np.asarray(angle_between(across, along))
    want = np.arctan2(np.abs(across.astype(np.float64)), along.astype(np.float64))
    assert got.dtype == np.float32
    assert np.abs(got - want).max() < 4e-7


def test_angle_between_nothing_is_dead_ahead() -> None:
    assert float(angle_between(jnp.float32(0.0), jnp.float32(0.0))) == 0.0


@given(METRES, METRES, METRES, METRES)
@examples(40)
def test_complex_product(a: float, b: float, c: float, d: float) -> None:
    with enable_x64():
        got = complex_product((jnp.float64(a), jnp.float64(b)), (jnp.float64(c), jnp.float64(d)))
        got_re, got_im = float(got[0]), float(got[1])
    want = complex(a, b) * complex(c, d)
    size = abs(a) + abs(b)
    assert abs(complex(got_re, got_im) - want) <= 1e-15 * size * (abs(c) + abs(d)) + 1e-300
