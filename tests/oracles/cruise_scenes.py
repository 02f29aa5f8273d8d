"""Cruises that the tests share, of one shape, so that each method compiles once."""

from dataclasses import dataclass
from typing import Any

import cruise_replay as replay
import numpy as np

from usvjax.maps import GridMap
from usvjax.missions.cruise import CruiseParams, CruiseResult, CruiseStatic, cruise
from usvjax.tables import field_names
from usvkernels.status import Status

HEIGHT, WIDTH, STATIONS, CRUISES = 11, 13, 5, 64
KEY = 7


def arguments(**options: Any) -> dict[str, Any]:
    """Keyword arguments of `cruise`, from those and the fields of `params` and `static`."""
    given = {name: value for name, value in options.items() if name not in _FIELDS}
    for name, cls in _CLASSES.items():
        chosen = {key: options[key] for key in field_names(cls) if key in options}
        if chosen:
            given[name] = cls(**chosen)
    return given


_CLASSES: dict[str, Any] = {"params": CruiseParams, "static": CruiseStatic}
_FIELDS = field_names(*_CLASSES.values())


@dataclass(frozen=True)
class Scenes:
    """Arguments of `cruise`."""

    blocked: np.ndarray  # bool[B, HEIGHT, WIDTH]
    stations: np.ndarray  # int[B, STATIONS, 2]
    order: np.ndarray  # int[B, STATIONS]

    def first(self, count: int) -> "Scenes":
        return Scenes(self.blocked[:count], self.stations[:count], self.order[:count])

    def sail(self, key: Any = KEY, **options: Any) -> CruiseResult:
        """Sail them; options as `arguments` takes them."""
        options = {"order": self.order, "heuristic": "octile", **options}
        return cruise(self.blocked, self.stations, key, **arguments(**options))

    def stops(self, row: int) -> np.ndarray:
        return self.stations[row][np.append(self.order[row], 0)]


def random_scenes(seed: int, count: int = CRUISES, most: float = 0.4) -> Scenes:
    """Maps from open water to mazes, stations anywhere on the water, in any order."""
    rng = np.random.default_rng(seed)
    blocked = rng.random((count, HEIGHT, WIDTH)) < np.linspace(0.0, most, count)[:, None, None]
    cells = rng.permuted(np.tile(np.arange(HEIGHT * WIDTH), (count, 1)), axis=1)[:, :STATIONS]
    stations = np.stack([cells % WIDTH, cells // WIDTH], axis=-1)
    rows = np.arange(count)[:, None]
    blocked[rows, stations[..., 1], stations[..., 0]] = False
    shuffled = rng.permuted(np.tile(np.arange(1, STATIONS), (count, 1)), axis=1)
    order = np.concatenate([np.zeros((count, 1), int), shuffled], axis=1)
    return Scenes(blocked, stations, order)


def walked(scenes: Scenes, result: CruiseResult, row: int, options: replay.Options) -> Any:
    """The replay of a cruise, which asserts that its steps are right."""
    return replay.walk(
        scenes.blocked[row],
        scenes.stops(row),
        result.seeds[row],
        result.track[row, : result.steps[row] + 1],
        result.leg_status[row],
        result.leg_step[row],
        options,
    )


def assert_right(scenes: Scenes, result: CruiseResult, row: int, options: replay.Options) -> None:
    """Replay a cruise, and compare all that the result says of it."""
    seen = walked(scenes, result, row, options)
    order, steps = scenes.order[row], int(result.steps[row])
    visits = np.full(STATIONS, -1)
    visits[0] = 0
    for leg, step in seen.visit_step.items():
        if leg < STATIONS:
            visits[order[leg]] = step
    assert result.order[row].tolist() == order.tolist()
    assert result.visit_step[row].tolist() == visits.tolist()
    assert result.visited[row].tolist() == (visits >= 0).tolist()
    assert seen.home == (int(result.status[row]) in (Status.REACHED, Status.PARTIAL))
    assert (int(result.status[row]) == Status.REACHED) == (seen.home and min(visits) >= 0)
    track = result.track[row, : steps + 1]
    if seen.home:
        assert np.array_equal(track[-1], track[0])
    moves = np.diff(track, axis=0)
    length = 10.0 * np.hypot(*moves.T).sum()
    assert result.waits[row] == seen.waits == np.sum(~moves.any(axis=1))
    assert np.isclose(result.length[row], length)
    assert np.isclose(result.time[row], (length + 10.0 * seen.waits) / 10.0)
    moves = moves[moves.any(axis=1)]
    assert result.inflections[row] == np.sum((moves[1:] != moves[:-1]).any(axis=1))
    _assert_smoothed(result, row, track, seen, visits, options)


def _assert_smoothed(
    result: CruiseResult,
    row: int,
    track: np.ndarray,
    seen: replay.Walked,
    visits: np.ndarray,
    options: replay.Options,
) -> None:
    count = result.smoothed_count[row]
    way, at = result.smoothed[row, :count], result.smoothed_step[row, :count]
    replay.assert_chords_clear(way, at, track, seen, options.corner_cutting)
    replay.assert_no_needless_point(at, track, seen, visits, options.corner_cutting)
    length = 10.0 * np.hypot(*np.diff(way, axis=0).T).sum()
    assert np.isclose(result.smooth_length[row], length)
    assert result.smooth_length[row] <= result.length[row] + 1e-9
    assert result.smooth_inflections[row] <= max(count - 2, 0)


def ponds():
    """Two bodies of water, the larger one in the west, 18 cells of 50 m by 10."""
    blocked = np.ones((10, 18), bool)
    blocked[1:9, 1:10] = False
    blocked[1:9, 12:17] = False
    return GridMap(blocked, cell_size=50.0, origin=(1000.0, -500.0))
