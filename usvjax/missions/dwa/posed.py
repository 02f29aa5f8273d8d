"""A condition of the mission "dwa", the episodes that its methods meet, and those of several."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

import numpy as np

from usvjax.batches import bucket
from usvjax.maps import GridMap
from usvjax.memory import check_memory
from usvjax.mission import Kin
from usvjax.missions.dwa.inputs import PackedEpisodes, pack_episodes
from usvjax.missions.dwa.params import DwaParams, DwaStatic
from usvjax.missions.dwa.run import MOST_ROWS
from usvjax.missions.dwa.scenes import ChartSource, DwaScenes, Source
from usvkernels.lanes import LEAST_LANES

_MOST_PAIRS = 2**20
"""Of episodes and obstacle rows in a call of joined scenes: 8 MiB of centres."""

_ROOM = 32
"""Maps of as many obstacle rows, rounded up to a multiple of this, share calls; below, powers of 2
do. Rows past an episode's own are computed for nothing."""

_REACH = ("v_min", "v_max", "v_dec", "dt", "radius")
"""Parameters that say how far a vessel on a chart sees."""

_COPIES = 5
"""Of its obstacles that a call has in memory, of 4 bytes a number: drawn, joined, packed, dealt."""


@dataclass(frozen=True)
class DwaCase:
    """One condition.

    Attributes:
        source: draws the scenes.
        params, static: of the method; `static.method` is set per run.
        rows: obstacles of an episode, padding included; 0 on a map.
    """

    source: Source
    params: DwaParams
    static: DwaStatic
    rows: int


@dataclass(frozen=True)
class DwaPosed:
    """Episodes that every method meets.

    Attributes:
        scenes: where they take place.
        params, static: as in `DwaCase`; of joined scenes, a parameter may be float64[J].
        room: episodes that their program has room for, at least.
    """

    scenes: DwaScenes
    params: DwaParams
    static: DwaStatic
    room: int = LEAST_LANES

    def circles(self, row: int) -> np.ndarray:
        """Centres of the obstacles of one episode, float64[K, 2], m; none on a shared map."""
        if isinstance(self.scenes.obstacles, GridMap):
            return np.empty((0, 2))
        centres = np.asarray(self.scenes.obstacles[row], dtype=float)
        return centres if self.scenes.valid is None else centres[self.scenes.valid[row]]

    @property
    def grid_map(self) -> GridMap | None:
        """The shared map, or None where every episode has circles of its own."""
        return self.scenes.obstacles if isinstance(self.scenes.obstacles, GridMap) else None


def pack_scenes(scenes: DwaScenes, params: DwaParams, static: DwaStatic) -> PackedEpisodes:
    """The episodes checked and packed; errors as `navigate_dwa`."""
    where = scenes.obstacles, scenes.starts, scenes.goals, scenes.valid
    return pack_episodes(*where, params, static, None)


def kin_of(case: DwaCase) -> Kin:
    """What must be equal for cases to share a call: whatever is no number of an episode."""
    if isinstance(case.source, ChartSource):
        seen = tuple(float(getattr(case.params, name)) for name in _REACH)
        return Kin((case.static, case.source.chart, seen), MOST_ROWS)
    size = max(_ROOM, -(-case.rows // _ROOM) * _ROOM) if case.rows > _ROOM else bucket(case.rows)
    fitting = max(LEAST_LANES, bucket(_MOST_PAIRS // size + 1) // 2)
    return Kin((case.static, size), min(MOST_ROWS, fitting))


def joined(scenes: Sequence[DwaPosed], cases: Sequence[DwaCase]) -> DwaPosed:
    """One scene of several.

    Args:
        scenes: of `cases`, in order.
        cases: all of one kin in the study. What differs among them is one value per episode, and
            maps are as large as the largest of theirs, so that one program does for all calls.

    Raises:
        BadInputError: it would not fit into memory.
    """
    parts = [scene.scenes for scene in scenes]
    sizes = [len(part.starts) for part in parts]
    rows = max([*(case.rows for case in cases), *(part.rows for part in parts)])
    check_memory(
        _COPIES * 8 * rows * sum(sizes), f"{sum(sizes):,} episodes of {rows:,} obstacles at once"
    )
    every = [asdict(case.params) for case in cases]
    own: dict[str, Any] = {
        f.name: np.repeat([float(getattr(scene.params, f.name)) for scene in scenes], sizes)
        for f in fields(DwaParams)
        if any(params[f.name] != every[0][f.name] for params in every)
    }
    obstacles, valid = parts[0].obstacles, None
    if not isinstance(obstacles, GridMap):
        obstacles, valid = _stacked(parts, rows)
    return DwaPosed(
        scenes=DwaScenes(
            obstacles=obstacles,
            valid=valid,
            starts=np.concatenate([part.starts for part in parts]),
            goals=np.concatenate([part.goals for part in parts]),
        ),
        params=replace(scenes[0].params, **own),
        static=scenes[0].static,
        room=kin_of(cases[0]).most,
    )


def _stacked(parts: Sequence[DwaScenes], rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Obstacles of scenes of circles, float32[J, rows, 2], and bool[J, rows], which they are."""
    count = sum(len(part.starts) for part in parts)
    centres, valid = np.zeros((count, rows, 2), np.float32), np.zeros((count, rows), bool)
    first = 0
    for part in parts:
        own = slice(first, first + len(part.starts)), slice(part.rows)
        centres[own] = np.asarray(part.obstacles)
        valid[own] = True if part.valid is None else part.valid
        first += len(part.starts)
    return centres, valid
