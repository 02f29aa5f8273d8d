"""A condition of the mission "dwa", and the episodes that its methods meet."""

from dataclasses import dataclass

import numpy as np

from usvjax.maps import GridMap
from usvjax.missions.dwa.params import DwaParams, DwaStatic
from usvjax.missions.dwa.scenes import DwaScenes, Source


@dataclass(frozen=True)
class DwaCase:
    """One condition.

    Attributes:
        source: draws the scenes.
        params, static: of the method; `static.method` is set per run.
    """

    source: Source
    params: DwaParams
    static: DwaStatic


@dataclass(frozen=True)
class DwaPosed:
    """Episodes that every method meets.

    Attributes:
        scenes: where they take place.
        params, static: as in `DwaCase`.
    """

    scenes: DwaScenes
    params: DwaParams
    static: DwaStatic

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
