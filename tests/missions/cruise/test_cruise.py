"""How cruises end, what they are told to do, and in which order they visit their stations."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import cruise_replay as replay
import jax
import numpy as np
import pytest
from cruise_scenes import HEIGHT, WIDTH, Scenes, random_scenes

from usvjax import planners
from usvjax.maps import GridMap
from usvjax.missions.cruise import CruiseResult, orders
from usvjax.search.astar import astar
from usvkernels.status import Status

FREE = np.zeros((HEIGHT, WIDTH), bool)
PLACES = np.array([[1, 1], [11, 1], [11, 9], [6, 5], [1, 9]])  # (6, 5) in the middle
METHODS = ("dstar_lite", "astar")


@pytest.fixture(autouse=True)
def _one_device() -> Iterator[None]:
    with jax.default_device(jax.devices()[0]):
        yield


def walled(*cells: tuple[int, int]) -> np.ndarray:
    """Open water but for walls around some cells."""
    grid = FREE.copy()
    for x, y in cells:
        grid[max(y - 1, 0) : y + 2, max(x - 1, 0) : x + 2] = True
        grid[y, x] = False
    return grid


def sail(blocked: np.ndarray = FREE, **options: Any) -> CruiseResult:
    """One cruise in the order given, with nothing that flips."""
    scenes = Scenes(blocked, PLACES, np.arange(5))
    return scenes.sail(**{"flip_rate": 0.0, "max_lanes": 16, **options})


def test_open_water() -> None:
    result = sail(speed=2.0, cell_size=3.0)
    assert result.status.tolist() == [Status.REACHED]
    assert result.visit_step.tolist() == [[0, 10, 18, 23, 28]]
    assert result.steps.tolist() == [36]
    length = 10 + 8 + (4 * np.sqrt(2) + 1) * 2 + 8
    assert np.allclose(result.length, 3.0 * length)
    assert np.allclose(result.time, 1.5 * length)
    # Pulled straight, the way is the polygon through the stations.
    assert result.smoothed.tolist() == [[*PLACES.tolist(), [1, 1]]]
    assert result.smoothed_step.tolist() == [[0, 10, 18, 23, 28, 36]]
    polygon = np.linalg.norm(PLACES - np.roll(PLACES, 1, axis=0), axis=1).sum()
    assert np.allclose(result.smooth_length, 3.0 * polygon)
    assert result.smooth_inflections.tolist() == [4]
    assert result.inflections[0] > 3


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("how", "waits"), [("wait", 6), ("skip", 0)])
def test_walled_in_station_is_left_out(method: str, how: str, waits: int) -> None:
    result = sail(walled((6, 5)), walled_in=how, max_wait=6, method=method)
    assert result.status.tolist() == [Status.PARTIAL]
    assert result.visited.tolist() == [[True, True, True, False, True]]
    assert result.visit_step[0, 3] == -1
    assert result.waits.tolist() == [waits]
    assert result.leg_status.tolist() == [[1, 1, Status.UNREACHABLE, 1, 1]]
    if waits:
        assert result.track[0, 18 : 18 + 7].tolist() == [[11, 9]] * 7
    assert np.allclose(result.time, result.length / 10.0 + waits)


@pytest.mark.parametrize("method", METHODS)
def test_walled_in_station_fails(method: str) -> None:
    result = sail(walled((6, 5)), walled_in="fail", method=method)
    assert result.status.tolist() == [Status.UNREACHABLE]
    assert result.visited.tolist() == [[True, True, True, False, False]]
    assert result.leg_status.tolist() == [[1, 1, Status.UNREACHABLE, 0, 0]]


@pytest.mark.parametrize("method", METHODS)
def test_walled_in_home(method: str) -> None:
    """It waits for each station, then ends where it began."""
    result = sail(walled((1, 1)), max_wait=2, method=method)
    assert result.status.tolist() == [Status.PARTIAL]
    assert result.visited.tolist() == [[True, False, False, False, False]]
    assert result.steps.tolist() == result.waits.tolist() == [8]
    assert result.length.tolist() == result.smooth_length.tolist() == [0.0]


@pytest.mark.parametrize("method", METHODS)
def test_out_of_time(method: str) -> None:
    result = sail(max_steps=9, method=method)
    assert result.status.tolist() == [Status.TIMED_OUT]
    assert result.steps.tolist() == [9]
    assert result.track[0, -1].tolist() == [10, 1]
    assert sail(max_steps=10, method=method).status.tolist() == [Status.REACHED]


def test_out_of_budget() -> None:
    result = sail(max_expansions=3)
    assert result.status.tolist() == [Status.OUT_OF_BUDGET]
    assert result.steps.tolist() == [0]


def test_speed_of_each_cruise() -> None:
    one = sail(walled((6, 5)), max_wait=6, speed=2.5)
    two = sail(walled((6, 5)), max_wait=6, speed=[2.5, 10.0], runs=2)
    assert np.array_equal(two.time, one.time * [1.0, 0.25])
    assert np.array_equal(two.smooth_time, one.smooth_time * [1.0, 0.25])


def test_a_map_in_the_world_and_many_seeds() -> None:
    lake = GridMap(walled((6, 5)), cell_size=250.0)
    scenes = Scenes(lake, PLACES, np.arange(5))  # type: ignore[arg-type]
    rates = [0.0, 0.0, 0.1, 0.1, 0.1, 0.1]
    many = scenes.sail(runs=6, flip_rate=rates, max_wait=4, max_lanes=16)
    assert many.status.shape == (6,)
    assert len({track.tobytes() for track in many.track}) == 5  # the first two see no change
    for row, rate in enumerate(rates):
        stops, steps = PLACES[[0, 1, 2, 3, 4, 0]], many.steps[row]
        legs = (many.leg_status[row], many.leg_step[row])
        options = replay.Options(rate=rate, max_wait=4)
        track = many.track[row, : steps + 1]
        replay.walk(lake.blocked, stops, many.seeds[row], track, *legs, options)
        moves = np.diff(track, axis=0)
        assert np.isclose(many.length[row], 250.0 * np.hypot(*moves.T).sum())


# --- no way found is not no way there -----------------------------------------------------------


@pytest.fixture
def misses_home(monkeypatch: pytest.MonkeyPatch) -> None:
    """`plan_paths` finds shortest paths, but none to home nor to (11, 9)."""

    def plan_paths(blocked: Any, starts: Any, goals: Any, key: Any, **options: Any) -> Any:
        found = astar(blocked, starts, goals)
        missed = np.all(goals == PLACES[0], axis=1) | np.all(goals == PLACES[2], axis=1)
        missed &= found.status == Status.FOUND
        status = np.where(missed, int(Status.OUT_OF_BUDGET), found.status)
        return SimpleNamespace(status=status, path=found.path, path_cells=found.path_cells)

    monkeypatch.setattr(planners, "plan_paths", plan_paths)


@pytest.mark.parametrize(("how", "waits"), [("wait", 6), ("skip", 0)])
@pytest.mark.usefixtures("misses_home")
def test_way_that_is_not_found(how: str, waits: int) -> None:
    result = sail(walled((6, 5)), walled_in=how, max_wait=2, method="ga")
    none, missed = Status.UNREACHABLE, Status.OUT_OF_BUDGET
    assert result.leg_status.tolist() == [[1, missed, none, 1, missed]]
    assert result.status.tolist() == [missed]
    assert result.waits.tolist() == [waits]
    assert result.visited.tolist() == [[True, True, False, False, True]]


@pytest.mark.usefixtures("misses_home")
def test_way_that_is_not_found_fails() -> None:
    result = sail(walled_in="fail", method="ga")
    assert result.leg_status.tolist() == [[1, Status.OUT_OF_BUDGET, 0, 0, 0]]
    assert result.status.tolist() == [Status.OUT_OF_BUDGET]


@pytest.mark.usefixtures("misses_home")
def test_station_that_is_not_found_makes_a_cruise_partial() -> None:
    """The vessel is home already when it gives up (11, 9), and needs no way there."""
    result = Scenes(FREE, PLACES[[0, 2]], np.arange(2)).sail(walled_in="skip", method="ga")
    assert result.leg_status.tolist() == [[Status.OUT_OF_BUDGET, Status.REACHED]]
    assert result.status.tolist() == [Status.PARTIAL]


# --- the order ------------------------------------------------------------------------------


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What `solve_tour` was asked for; it answers with the stations in reverse."""
    calls: list[Any] = []

    def solve_tour(points: Any, key: Any, **options: Any) -> SimpleNamespace:
        given = options["distances"] if points is None else points
        calls.append(SimpleNamespace(points=points, key=key, **{"distances": None, **options}))
        count, legs = np.shape(given)[:2]
        order = np.append(0, np.arange(legs - 1, 0, -1))
        return SimpleNamespace(order=np.tile(order, (count, 1)))

    monkeypatch.setattr(orders, "solve_tour", solve_tour)
    return calls


def test_order_of_a_tour_on_straight_distances(asked: list[Any]) -> None:
    result = sail(order=None, tour="igwo")
    assert result.order.tolist() == [[0, 4, 3, 2, 1]]
    assert result.visit_step[0, 4] < result.visit_step[0, 3] < result.visit_step[0, 2]
    assert asked[0].algorithm == "igwo"
    assert np.array_equal(asked[0].points, PLACES[None])


def test_order_of_a_tour_on_water(asked: list[Any]) -> None:
    sail(walled((6, 5)), order=None, distances="water", max_wait=0)
    assert asked[0].points is None
    assert asked[0].distances.shape == (1, 5, 5)
    assert np.isinf(asked[0].distances[0, 3, [0, 1, 2, 4]]).all()


@pytest.mark.parametrize("shared", [False, True])
def test_water_distances(shared: bool) -> None:
    scenes = random_scenes(3, 8, 0.3)
    blocked = FREE if shared else scenes.blocked
    mission: Any = SimpleNamespace(
        blocked=blocked[None] if shared else blocked,
        stations=scenes.stations,
        shape=FREE.shape,
        legs=5,
    )
    mission = _sized(mission, 8)
    got = orders.water_distances(mission)
    for row in range(8):
        grid = FREE if shared else blocked[row]
        for k, (x, y) in enumerate(scenes.stations[row].tolist()):
            left = replay.plain.distances(grid, (x, y), False) / replay.plain.STRAIGHT
            want = left[scenes.stations[row, :, 1], scenes.stations[row, :, 0]]
            assert np.allclose(got[row, k], want, rtol=1e-6)


def _sized(mission: Any, count: int) -> Any:
    class Sized(SimpleNamespace):
        def __len__(self) -> int:
            return count

    return Sized(**vars(mission))


def test_replayed_flips_come_at_the_rate() -> None:
    """The tape that the replay shares with the kernels."""
    seed = np.array([3, 5], np.uint32)
    share = replay.tape(seed, 500, (HEIGHT, WIDTH), 0.03).mean()
    assert abs(share - 0.03) < 5 * np.sqrt(0.03 * 0.97 / (500 * HEIGHT * WIDTH))
    assert not replay.tape(seed, 500, (HEIGHT, WIDTH), 0.0).any()
    assert replay.tape(seed, 500, (HEIGHT, WIDTH), 1.0).all()
