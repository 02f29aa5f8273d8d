"""A condition of the mission "route", and the queries that its methods meet."""

from dataclasses import dataclass

import numpy as np

from usvjax.maps import GridMap
from usvjax.missions.route.run import Area, SearchOptions, SmoothingOptions
from usvjax.missions.route.scenes import Source
from usvjax.search.astar import AstarResult


@dataclass(frozen=True)
class RouteCase:
    """One condition.

    Attributes:
        source: draws the queries.
        search: settings of the searches.
        smoothing: settings of what is done to their paths.
    """

    source: Source
    search: SearchOptions
    smoothing: SmoothingOptions

    @property
    def turning_radius(self) -> float:
        """R, m; the edge of a cell where none was given."""
        return self.smoothing.turning_radius or self.source.cell_size


@dataclass(frozen=True)
class RoutePosed:
    """Queries that every method meets.

    Attributes:
        case: the condition.
        area: the queries.
        shortest: the search for the shortest routes.
        optimum: float64[J], their lengths, m; inf where there is none.
    """

    case: RouteCase
    area: Area
    shortest: AstarResult
    optimum: np.ndarray

    def land(self, row: int) -> GridMap:
        """The map of one query, as it was before it was inflated."""
        source = self.case.source
        if source.chart is not None:
            return source.chart
        return GridMap(self.area.scenes.land[row], source.cell_size, source.origin)
