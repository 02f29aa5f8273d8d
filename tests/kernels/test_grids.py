"""Grid kernels against scipy and brute force."""

from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from property_draws import examples
from scipy import ndimage

from usvkernels import grids

SHAPE = (13, 19)  # one shape, so that hypothesis does not compile anew for each example
BOUND = 24  # beyond the diagonal of SHAPE
MAPS = st.floats(0.0, 1.0).flatmap(
    lambda density: st.integers(0, 2**32 - 1).map(
        lambda seed: np.random.default_rng(seed).random(SHAPE) < density
    )
)

draw = jax.jit(grids.random_blocked, static_argnums=(1, 2))
inflate = jax.jit(grids.inflate, static_argnums=2)
shoreline = jax.jit(grids.shoreline)


def disc(radius: float) -> np.ndarray:
    reach = int(radius)
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    return x * x + y * y <= radius * radius


# --- random maps -----------------------------------------------------------------------------


def test_a_random_map_depends_on_its_index_alone() -> None:
    key = jax.random.key(7)
    many = np.asarray(draw(key, 40, (9, 11), 0.3))
    few = np.asarray(draw(key, 5, (9, 11), 0.3))
    shard = np.asarray(draw(key, 5, (9, 11), 0.3, 20))
    np.testing.assert_array_equal(many[:5], few)
    np.testing.assert_array_equal(many[20:25], shard)
    alone = jax.random.uniform(jax.random.fold_in(key, 33), (9, 11)) < 0.3
    np.testing.assert_array_equal(many[33], np.asarray(alone))
    assert len({m.tobytes() for m in many}) == 40


def test_density_is_the_share_of_blocked_cells_and_nested() -> None:
    key = jax.random.key(1)
    levels = (0.0, 0.1, 0.35, 0.8, 1.0)
    maps = [np.asarray(draw(key, 50, (40, 50), level)) for level in levels]
    for level, drawn in zip(levels, maps, strict=True):
        assert drawn.mean() == pytest.approx(level, abs=0.006)  # 4 sigma over 100,000 cells
    for sparser, denser in pairwise(maps):
        assert not (sparser & ~denser).any()


def test_density_may_differ_between_maps() -> None:
    key = jax.random.key(3)
    mixed = np.asarray(draw(key, 5, (9, 11), jnp.array([0.0, 0.4, 1.0, 0.2, 0.4])))
    assert not mixed[0].any()
    assert mixed[2].all()
    same = np.asarray(draw(key, 5, (9, 11), 0.4))
    np.testing.assert_array_equal(mixed[[1, 4]], same[[1, 4]])


def test_random_maps_are_the_same_under_x64() -> None:
    single = np.asarray(draw(jax.random.key(5), 5, (9, 11), 0.25))
    with jax.enable_x64(True):
        double = np.asarray(draw(jax.random.key(5), 5, (9, 11), 0.25))
    np.testing.assert_array_equal(single, double)


# --- inflation -------------------------------------------------------------------------------


@examples(60)
@given(MAPS, st.integers(0, 96).map(lambda quarter: quarter / 4))
def test_inflate_is_dilation_by_a_disc(blocked: np.ndarray, radius: float) -> None:
    ours = np.asarray(inflate(blocked, radius, BOUND))
    np.testing.assert_array_equal(ours, ndimage.binary_dilation(blocked, disc(radius)))


@examples(60)
@given(MAPS, st.integers(0, 600))
def test_inflate_counts_cells_exactly_on_the_circle(blocked: np.ndarray, squared: int) -> None:
    """The radius is the root of a whole number: float rounding decides unless allowed for."""
    y, x = np.nonzero(blocked)
    rows, columns = np.mgrid[: SHAPE[0], : SHAPE[1]]
    gap = (rows[..., None] - y) ** 2 + (columns[..., None] - x) ** 2
    expected = (gap <= squared).any(axis=-1)
    ours = np.asarray(inflate(blocked, np.sqrt(squared), 25))
    np.testing.assert_array_equal(ours, expected)


@pytest.mark.parametrize("radius", [0, 1, 2.5, 0.3 / 0.1, 40])
def test_inflate_with_a_number_needs_no_bound(radius: float) -> None:
    blocked = np.random.default_rng(0).random((12, 9)) < 0.05
    expected = ndimage.binary_dilation(blocked, disc(radius + 1e-9))
    np.testing.assert_array_equal(np.asarray(grids.inflate(blocked, radius)), expected)


def test_inflate_takes_batches_and_a_radius_per_map() -> None:
    blocked = np.random.default_rng(1).random((2, 3, 10, 8)) < 0.05
    together = np.asarray(grids.inflate(jnp.asarray(blocked), 2.0))
    for index in np.ndindex(2, 3):
        np.testing.assert_array_equal(together[index], grids.inflate(blocked[index], 2.0))
    radii = jnp.array([0.0, 1.5, 3.0])
    mapped = jax.vmap(lambda b, r: grids.inflate(b, r, 3))(jnp.asarray(blocked[0]), radii)
    for index, radius in enumerate((0.0, 1.5, 3.0)):
        np.testing.assert_array_equal(mapped[index], grids.inflate(blocked[0, index], radius))


def test_inflating_open_water_blocks_nothing() -> None:
    assert not np.asarray(grids.inflate(np.zeros((6, 7), bool), 3.0)).any()


# --- Chen's expansion ------------------------------------------------------------------------


def test_expansion_scales_in_the_obstacles_own_frame() -> None:
    square = np.array([[9.0, 19.0], [11.0, 19.0], [11.0, 21.0], [9.0, 21.0]])
    grown = grids.expand_about_centre(square, np.array([10.0, 20.0]), 0.5)
    expected = [[8.5, 18.5], [11.5, 18.5], [11.5, 21.5], [8.5, 21.5]]
    np.testing.assert_allclose(grown, expected, rtol=1e-6)


@examples(30)
@given(st.integers(0, 2**32 - 1))
def test_expansion_is_undone_by_its_inverse(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-10, 10, (4, 6, 2)).astype(np.float32)
    centres = rng.uniform(-10, 10, (4, 2)).astype(np.float32)
    expansion = rng.uniform(0, 3, 4).astype(np.float32)
    grown = np.asarray(grids.expand_about_centre(points, centres, expansion))
    exact = [a.astype(np.float64) for a in (points, centres[:, None], expansion[:, None, None])]
    place, centre, more = exact
    # Single precision: differences of 20, grown to 80, are rounded three times by 5e-6 at most, a
    # sum of 90 by 4e-6. The way back divides all of it again, and rounds once more.
    wanted = centre + (1 + more) * (place - centre)
    np.testing.assert_allclose(grown, wanted, rtol=0, atol=2e-5)
    back = grids.expand_about_centre(grown, centres, -expansion / (1 + expansion))
    np.testing.assert_allclose(back, points, rtol=0, atol=3e-5)


# --- shoreline -------------------------------------------------------------------------------


@examples(40)
@given(MAPS)
def test_shoreline_is_blocked_cells_beside_water(blocked: np.ndarray) -> None:
    expected = np.zeros(SHAPE, bool)
    for y, x in np.argwhere(blocked):
        window = blocked[max(y - 1, 0) : y + 2, max(x - 1, 0) : x + 2]
        expected[y, x] = not window.all()
    np.testing.assert_array_equal(np.asarray(shoreline(blocked)), expected)


def test_the_edge_of_the_map_is_no_shore() -> None:
    assert not np.asarray(grids.shoreline(np.ones((4, 5), bool))).any()


@examples(30)
@given(MAPS)
def test_the_nearest_land_is_always_shoreline(blocked: np.ndarray) -> None:
    if not blocked.any():
        return
    shore = np.asarray(shoreline(blocked))
    to_land = ndimage.distance_transform_edt(~blocked)
    to_shore = ndimage.distance_transform_edt(~shore) if shore.any() else to_land
    np.testing.assert_array_equal(to_shore[~blocked], to_land[~blocked])
