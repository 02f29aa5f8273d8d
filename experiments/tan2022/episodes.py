"""Sail the episodes of many readings in a few large calls, and keep how each one ended."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

import usvjax as uj
from experiments.tan2022.published import METRICS
from experiments.tan2022.readings import FEW_MAPS, Case, Reading
from usvjax.missions.dwa.params import DwaParams, DwaStatic
from usvjax.missions.dwa.scenes import DwaScenes, Source
from usvkernels.dwa.clearance import FAR
from usvkernels.status import Status

CALL = 16_384
"""Episodes per call: enough to refill lanes from, few enough that memory stays flat."""
ROOM = 32
"""Obstacle rows are padded to a multiple of this, so that few programs are compiled."""

SWEPT = (
    "radius",
    "clearance_cap",
    "clear_distance",
    "v_min",
    "search_angle",
    "goal_tolerance",
)
"""Parameters given per episode, so that readings that differ in them share a call."""


@dataclass(frozen=True)
class Run:
    """Episodes 0 to n - 1 of one method, identified by all that they depend on.

    Attributes:
        source: of the maps.
        params, static: of the method.
        seed: of the maps.
        episodes: how many.
    """

    source: Source
    params: DwaParams
    static: DwaStatic
    seed: int
    episodes: int


@dataclass(frozen=True)
class Episodes:
    """How the episodes of a run ended; numpy arrays [n].

    Attributes:
        status: `Status`.
        time: s.
        path_length: m.
        mean_speed: m/s.
        min_clearance: m.
        steps: control periods.
    """

    status: np.ndarray
    time: np.ndarray
    path_length: np.ndarray
    mean_speed: np.ndarray
    min_clearance: np.ndarray
    steps: np.ndarray

    @property
    def reached(self) -> np.ndarray:
        """Which episodes reached the goal, bool[n]."""
        return self.status == int(Status.REACHED)

    def table(self, chosen: np.ndarray) -> np.ndarray:
        """Time, length and mean speed of the chosen episodes, float[n', 3]."""
        columns = [getattr(self, metric)[chosen] for metric in METRICS]
        return np.stack(columns, axis=-1).astype(np.float64)


Results = dict[Run, Episodes]


@dataclass(frozen=True)
class Plan:
    """How many maps, and from which seed.

    Attributes:
        seed: of the maps.
        maps: per reading and case.
        few_maps: the same where dist is taken along the trajectory, which is slow.
    """

    seed: int
    maps: int
    few_maps: int

    def run(self, reading: Reading, case: Case, method: str) -> Run:
        """Return the run of one reading, case and method."""
        return Run(
            source=reading.source(case),
            params=reading.params(case, method),
            static=reading.static(method),
            seed=self.seed,
            episodes=self.few_maps if reading.clearance == FEW_MAPS else self.maps,
        )


@dataclass(frozen=True)
class _Piece:
    """Some episodes of a run, with their scenes."""

    run: Run
    scenes: DwaScenes

    def __len__(self) -> int:
        return len(self.scenes.starts)


def sail(runs: Sequence[Run], advance: Callable[[int], object] = lambda episodes: None) -> Results:
    """Sail all episodes of some runs.

    Args:
        runs: repeated ones are sailed once.
        advance: told after each call how many episodes are done since the last time.

    Returns:
        How they ended, by run.
    """
    parts: dict[Run, list[Episodes]] = defaultdict(list)
    for static, group in _by_static(runs).items():
        for pieces in _calls(group):
            result = _call(pieces, static)
            first = 0
            for piece in pieces:
                parts[piece.run].append(_episodes(result, slice(first, first + len(piece))))
                first += len(piece)
            advance(first)
    return {run: _joined(found) for run, found in parts.items()}


def total(runs: Sequence[Run]) -> int:
    """Return how many episodes `sail` will report for these runs."""
    return sum(run.episodes for run in set(runs))


def record(
    chosen: Sequence[tuple[Run, int]],
) -> list[np.ndarray]:
    """Sail single episodes again and keep their trajectories.

    Args:
        chosen: pairs of a run and the number of one of its episodes.

    Returns:
        float[T, 5] each: x (m), y (m), psi (rad), v (m/s), w (rad/s) from start to end.
    """
    found: dict[tuple[Run, int], np.ndarray] = {}
    for static in dict.fromkeys(run.static for run, _ in chosen):
        pairs = [(run, job) for run, job in chosen if run.static == static]
        pieces = [_Piece(run, _draw(run, np.array([job]))) for run, job in pairs]
        result = _call(pieces, static, recorded=True)
        assert result.trajectory is not None
        for i, pair in enumerate(pairs):
            found[pair] = result.trajectory[i, : result.steps[i] + 1]
    return [found[pair] for pair in chosen]


def obstacles(run: Run, job: int) -> np.ndarray:
    """Centres of the obstacles of one episode, float[K, 2] (m)."""
    scenes = _draw(run, np.array([job]))
    assert isinstance(scenes.obstacles, np.ndarray)
    assert scenes.valid is not None
    centres: np.ndarray = scenes.obstacles[0][scenes.valid[0]]
    return centres


def _by_static(runs: Sequence[Run]) -> dict[DwaStatic, list[Run]]:
    groups: dict[DwaStatic, list[Run]] = defaultdict(list)
    for run in dict.fromkeys(runs):
        groups[run.static].append(run)
    return groups


def _calls(runs: Sequence[Run]) -> Iterator[list[_Piece]]:
    """Cut the episodes of some runs into calls of like size and like number of obstacle rows."""
    rooms: dict[int, list[Run]] = defaultdict(list)
    for run in runs:
        rooms[_room(run)].append(run)
    for group in rooms.values():
        jobs = [(run, job) for run in group for job in _blocks(run)]
        episodes = sum(len(block) for _, block in jobs)
        calls = -(-episodes // CALL)
        pieces: list[_Piece] = []
        held = sent = 0
        for run, block in jobs:
            pieces.append(_Piece(run, _draw(run, block)))
            held += len(block)
            if sent < calls - 1 and held >= episodes / calls:
                yield pieces
                pieces, held, sent = [], 0, sent + 1
        if pieces:
            yield pieces


def _blocks(run: Run) -> list[np.ndarray]:
    """Numbers of a run's episodes, in blocks that fill calls evenly."""
    jobs = np.arange(run.episodes)
    return [jobs[i : i + CALL // 16] for i in range(0, run.episodes, CALL // 16)]


def _draw(run: Run, jobs: np.ndarray) -> DwaScenes:
    return run.source.draw(run.seed, jobs, float(run.params.radius))


def _room(run: Run) -> int:
    """Obstacle rows of a run's maps, rounded up."""
    drawn = _draw(run, np.zeros(1, int)).obstacles
    assert isinstance(drawn, np.ndarray)
    return _rounded(drawn.shape[1])


def _rounded(rows: int) -> int:
    return -(-rows // ROOM) * ROOM


def _call(pieces: Sequence[_Piece], static: DwaStatic, recorded: bool = False) -> uj.NavigateResult:
    """Sail the episodes of all pieces at once."""
    rows = max(_rounded(piece.scenes.obstacles.shape[1]) for piece in pieces)
    common = pieces[0].run.params
    swept: dict[str, Any] = {
        name: np.concatenate(
            [np.full(len(piece), float(getattr(piece.run.params, name))) for piece in pieces]
        )
        for name in SWEPT
    }
    rest = {f.name: getattr(common, f.name) for f in fields(common) if f.name not in SWEPT}
    return uj.navigate_dwa(
        np.concatenate([_padded(piece.scenes, rows) for piece in pieces]),
        np.concatenate([piece.scenes.starts for piece in pieces]),
        np.concatenate([piece.scenes.goals for piece in pieces]),
        params=DwaParams(**rest, **swept),
        static=static,
        record=recorded,
    )


def _padded(scenes: DwaScenes, rows: int) -> np.ndarray:
    """Obstacle centres, float32[J, rows, 2]; what is no obstacle lies far away."""
    centres = scenes.obstacles
    assert isinstance(centres, np.ndarray)
    assert scenes.valid is not None
    centres = np.where(scenes.valid[..., None], centres, FAR)
    missing = rows - centres.shape[1]
    padded: np.ndarray = np.pad(centres, ((0, 0), (0, missing), (0, 0)), constant_values=FAR)
    return padded.astype(np.float32)


def _episodes(result: uj.NavigateResult, rows: slice) -> Episodes:
    return Episodes(**{f.name: getattr(result, f.name)[rows] for f in fields(Episodes)})


def _joined(parts: Sequence[Episodes]) -> Episodes:
    return Episodes(
        **{f.name: np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Episodes)}
    )
