"""The short polynomials against float64, where they are hardest, and the same bits anywhere."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from property_draws import examples

from usvkernels.trig import angle_between, sincos, wrap_angle

PI = np.float32(np.pi)
MOST = 1e3  # rad
FULL = 1 << 20  # all large batches have this size, so that each function compiles once

wrap, sine_cosine, between = jax.jit(wrap_angle), jax.jit(sincos), jax.jit(angle_between)


def neighbours(values: np.ndarray, count: int) -> np.ndarray:
    """The float32 nearest to each value and `count` more to either side."""
    centre = values.astype(np.float32)
    found, up, down = [centre], centre, centre
    for _ in range(count):
        up, down = np.nextafter(up, PI * 1e9), np.nextafter(down, -PI * 1e9)
        found += [up, down]
    return np.concatenate(found)


def full(values: np.ndarray) -> np.ndarray:
    """Repeat values up to FULL."""
    assert len(values) <= FULL
    return np.resize(values, FULL).astype(np.float32)


MULTIPLES = np.arange(-636, 637) * (np.pi / 2)  # all of pi / 2 within MOST
HARD = neighbours(MULTIPLES, 300)
SMALL = np.geomspace(1e-38, 1.0, 20_000)


@pytest.mark.parametrize(
    "angles",
    [np.linspace(-MOST, MOST, FULL), HARD, np.concatenate([SMALL, -SMALL, [0.0, -0.0]])],
    ids=["everywhere", "beside multiples of pi/2", "small"],
)
def test_sincos_error(angles: np.ndarray) -> None:
    angles = full(angles)
    sin, cos = (np.asarray(a) for a in sine_cosine(angles))
    exact = angles.astype(np.float64)
    assert sin.dtype == cos.dtype == np.float32
    assert np.abs(sin - np.sin(exact)).max() < 2e-7
    assert np.abs(cos - np.cos(exact)).max() < 2e-7


def test_sincos_signs_at_the_quarters() -> None:
    sin, cos = sine_cosine((np.arange(-4, 5) * np.pi / 2).astype(np.float32))
    np.testing.assert_array_equal(np.round(sin), [0, 1, 0, -1, 0, 1, 0, -1, 0])
    np.testing.assert_array_equal(np.round(cos), [1, 0, -1, 0, 1, 0, -1, 0, 1])


def directions() -> tuple[np.ndarray, np.ndarray]:
    """Vectors (across, along) all round, of every size, and dense about the diagonals and axes."""
    rng = np.random.default_rng(1)
    half = FULL // 2
    near = np.arange(-4, 5) * (np.pi / 4)
    angle = np.concatenate(
        [rng.uniform(-np.pi, np.pi, half), rng.choice(near, half) + rng.normal(0, 1e-6, half)]
    )
    size = 10.0 ** rng.uniform(-10, 10, FULL)
    return (size * np.sin(angle)).astype(np.float32), (size * np.cos(angle)).astype(np.float32)


def test_angle_between_error() -> None:
    across, along = directions()
    got = np.asarray(between(across, along))
    want = np.arctan2(np.abs(across.astype(np.float64)), along.astype(np.float64))
    assert got.dtype == np.float32
    assert np.abs(got - want).max() < 3e-7
    assert (got >= 0.0).all()
    assert (got <= PI).all()


def test_angle_between_does_not_ask_for_the_side() -> None:
    across, along = directions()
    np.testing.assert_array_equal(between(across, along), between(-across, along))


@pytest.mark.parametrize(
    ("across", "along", "angle"),
    [
        (0, 1, 0.0),
        (1, 0, PI / 2),
        (-1, 0, PI / 2),
        (0, -1, PI),
        (2, 2, PI / 4),
        (2, -2, 3 * PI / 4),
    ],
)
def test_angle_between_on_the_axes(across: float, along: float, angle: float) -> None:
    assert float(between(jnp.float32(across), jnp.float32(along))) == pytest.approx(angle, abs=3e-7)


@given(st.floats(-MOST, MOST, width=32))
@example(float(PI))
@example(-float(PI))
@example(float(np.nextafter(PI, np.float32(4))))
@example(float(np.nextafter(-PI, np.float32(-4))))
@example(3 * float(PI))
@example(-0.0)
@example(1e-45)
@examples(200)
def test_wrap_angle(angle: float) -> None:
    wrapped = np.asarray(wrap(jnp.float32(angle)))
    assert wrapped.dtype == np.float32
    assert -PI <= wrapped < PI
    # The multiple of 2 pi that is taken off is rounded, and so is 2 pi itself.
    allowed = 3e-7 + abs(angle) * 1.2e-7
    assert abs(np.exp(1j * float(wrapped)) - np.exp(1j * angle)) <= allowed


def test_wrap_angle_is_half_open_at_every_seam() -> None:
    seams = neighbours(np.arange(-159, 160) * (2 * np.pi) + np.pi, 300)
    wrapped = np.asarray(wrap(full(seams)))
    assert (wrapped >= -PI).all()
    assert (wrapped < PI).all()


def test_wrapped_angles_stay_as_they_are() -> None:
    angles = full(np.linspace(-PI, np.nextafter(PI, np.float32(0)), 300_001, dtype=np.float32))
    np.testing.assert_array_equal(wrap(angles), angles)


@pytest.mark.parametrize("count", [1, 3, 16, 37, 256])
def test_bits_do_not_depend_on_the_length_of_the_array(count: int) -> None:
    angles, (across, along) = full(HARD), directions()
    some = slice(500, 500 + count)
    for got, want in zip(sine_cosine(angles[some]), sine_cosine(angles), strict=True):
        np.testing.assert_array_equal(got, want[some])
    np.testing.assert_array_equal(wrap(angles[some]), wrap(angles)[some])
    np.testing.assert_array_equal(between(across[some], along[some]), between(across, along)[some])
