"""Episodes on a map: blocked cells as obstacles."""

from dataclasses import replace
from types import SimpleNamespace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from navigate_episodes import PARAMS, STATIC, B, assert_same, sail

import usvjax as uj
from usvjax.maps.sensed import charted
from usvjax.missions.dwa.inputs import PackedEpisodes, pack_episodes
from usvjax.missions.dwa.run import NavigateResult
from usvkernels.dwa.episodes import sensed
from usvkernels.dwa.window import Motion

NEAR_SHORE = replace(PARAMS, radius=0.6)
SEE_ALL = 20.0  # m, from shore to shore


def lake(origin: tuple[float, float] = (0.0, 0.0)) -> uj.GridMap:
    """A lake of 6.75 m x 6 m, land all round, one island; the cells are exact in float32."""
    blocked = np.ones((10, 11), bool)
    blocked[1:-1, 1:-1] = False
    blocked[4, 5] = True  # centre (4.125, 3.375) m
    return uj.GridMap(blocked, cell_size=0.75, origin=origin)


def voyages(origin: tuple[float, float] = (0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
    """Starts and goals on open water, multiples of 1/64 m."""
    rng = np.random.default_rng(6)
    points = np.round(rng.uniform([1.0, 1.0], [7.0, 6.5], (400, 2)) * 64) / 64
    away = np.linalg.norm(points[:, None] - shore(), axis=2).min(axis=1)
    points = points[away > 0.7][: 2 * B] + origin
    return np.column_stack((points[:B], rng.uniform(-3.0, 3.0, B))), points[B:]


def shore() -> np.ndarray:
    """Centres [39, 2] of the blocked cells beside water."""
    blocked = lake().blocked
    rows, columns = np.nonzero(blocked)
    beside = [
        (~blocked[max(y - 1, 0) : y + 2, max(x - 1, 0) : x + 2]).any()
        for y, x in zip(rows, columns, strict=True)
    ]
    return lake().points_of(np.column_stack((columns, rows))[beside])


@pytest.fixture(scope="module")
def on_lake() -> NavigateResult:
    options = {"params": NEAR_SHORE, "sensing_range": SEE_ALL, "record": True}
    return sail(lake(), *voyages(), **options)


def test_shore_cells_are_circles(on_lake: NavigateResult) -> None:
    circles = sail(shore(), *voyages(), params=NEAR_SHORE, record=True)
    assert_same(on_lake, circles)
    np.testing.assert_array_equal(on_lake.trajectory, circles.trajectory)
    assert len(set(on_lake.status)) > 1


def test_where_the_lake_lies_does_not_matter(on_lake: NavigateResult) -> None:
    at = (4096.0, -1024.0)
    options = {"params": NEAR_SHORE, "sensing_range": SEE_ALL, "record": True}
    moved = sail(lake(at), *voyages(at), **options)
    assert_same(moved, on_lake)
    assert moved.trajectory is not None
    assert on_lake.trajectory is not None
    shift = np.array([*at, 0.0, 0.0, 0.0])
    # Places of 4,100 m are recorded in single precision: to 2.5e-4 m.
    np.testing.assert_allclose(moved.trajectory - shift, on_lake.trajectory, atol=3e-4)


def test_steps_recorded_at_utm_coordinates_are_those_sailed() -> None:
    at = (500_000.0, 4_400_000.0)
    options = {"params": NEAR_SHORE, "sensing_range": SEE_ALL, "record": True}
    r = sail(lake(at), *voyages(at), **options)
    assert r.trajectory is not None
    legs = np.hypot(*np.moveaxis(np.diff(r.trajectory[..., :2], axis=1), -1, 0))
    np.testing.assert_allclose(legs.sum(axis=1), r.path_length, rtol=1e-4, atol=1e-5)


def test_recording_on_a_lake_changes_nothing(on_lake: NavigateResult) -> None:
    assert_same(sail(lake(), *voyages(), params=NEAR_SHORE, sensing_range=SEE_ALL), on_lake)


@pytest.mark.parametrize(
    ("start", "goal", "land"),
    [
        ((2.625, 3.375, 0.0), (6.5, 3.375), (4.125, 3.375)),
        ((2.625, 5.0, np.pi / 2), (2.625, 6.74), (2.625, 7.125)),
    ],
    ids=["island", "shore"],
)
def test_running_aground_is_seen(
    start: tuple[float, ...], goal: tuple[float, ...], land: tuple[float, ...]
) -> None:
    # At full speed from the first step on, the predicted end lies beyond the land.
    brisk = {"v_min": 0.0, "v_acc": 10.0, "v_dec": 10.0, "v_step": 0.25, "w_step": 0.05}
    params = replace(NEAR_SHORE, **brisk, velocity_weight=1.0, goal_tolerance=0.05)
    options = {"params": params, "sensing_range": SEE_ALL, "record": True}
    r = sail(lake(), np.tile(start, (B, 1)), goal, **options)
    np.testing.assert_array_equal(r.status, uj.Status.COLLIDED)
    assert r.trajectory is not None
    away = np.hypot(*(r.trajectory[0, -1, :2] - land))
    assert away - 0.6 == pytest.approx(r.min_clearance[0], abs=1e-6)
    assert -0.1 <= r.min_clearance[0] < 0.0, "not seen at the first step inside the circle"


def test_open_water_on_a_map() -> None:
    open_water = uj.GridMap(np.zeros((10, 11), bool), cell_size=0.75)
    scene = pack_episodes(open_water, *voyages(), None, NEAR_SHORE, STATIC, None)
    assert scene.chart is not None
    np.testing.assert_array_equal(scene.chart.table, -1)


def test_a_swept_reach_wants_a_sensing_range() -> None:
    water = uj.GridMap(np.zeros((20, 20), bool), 10.0)
    params = replace(uj.preset("lake").params, radius=np.array([10.0, 20.0]), v_step=0.1)
    starts = np.array([[50.0, 50.0, 0.0], [60.0, 50.0, 0.0]])
    with pytest.raises(uj.BadInputError, match="sensing_range: not given"):
        uj.navigate_dwa(water, starts, [150.0, 50.0], params=params)


def test_past_the_edge_of_a_map_the_nearest_cell_is_sensed() -> None:
    blocked = np.zeros((12, 40), bool)
    blocked[8:, 10:14] = True
    chart = charted(uj.GridMap(blocked), 5.0)

    def seen(y: float) -> np.ndarray:
        motion = Motion(jnp.array([[9.0], [y], [0.0], [0.0], [0.0]]))
        episode = SimpleNamespace(motion=motion)
        return np.asarray(sensed(jax.device_put(chart), episode))

    np.testing.assert_array_equal(seen(12.1), seen(11.9))
    assert (seen(12.1) < 100.0).any()
    scene = PackedEpisodes(np.zeros((1, 3)), np.zeros((1, 2)), np.zeros(2), None, chart)
    for x, y in ((9.0, 12.1), (9.0, 11.9), (9.0, 40.0)):
        np.testing.assert_array_equal(scene.sensed(np.array([[x, y]]))[0], seen(y)[..., 0])


def test_no_shore_lies_farther_than_the_map_is_across() -> None:
    # A vessel that hardly brakes would see for 1e5 km.
    params = replace(NEAR_SHORE, v_dec=1e-8)
    whole = pack_episodes(lake(), *voyages(), None, params, STATIC, None).chart
    assert whole is not None
    assert whole.table.shape[1] == 40, "all 39 cells of the shore"


def test_a_table_too_large_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("usvjax.maps.obstacles.MOST_BYTES", 110 * 40 * 4 - 1)
    with pytest.raises(uj.BadInputError, match=r"map: the obstacles within .* by a shorter"):
        pack_episodes(lake(), *voyages(), None, NEAR_SHORE, STATIC, 9.01)
