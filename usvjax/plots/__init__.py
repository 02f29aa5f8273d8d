"""Figures of studies and episodes: every function takes data and returns a matplotlib Figure.

Nothing here is imported by ``import usvjax``; matplotlib loads with this package only. Figures
are made without pyplot, so no window opens, no state is shared, and threads may draw at once.
"""

from usvjax.plots.chart import plot_chart
from usvjax.plots.curvature import Bends, bends_of, plot_curvature
from usvjax.plots.distributions import both_reached, plot_distributions
from usvjax.plots.map_sheet import plot_map
from usvjax.plots.overview import plot_overview
from usvjax.plots.paths import Ending, plot_paths
from usvjax.plots.rates import plot_success, wilson_rates
from usvjax.plots.route import plot_route_chart, plot_routes
from usvjax.plots.style import save

__all__ = [
    "Bends",
    "Ending",
    "bends_of",
    "both_reached",
    "plot_chart",
    "plot_curvature",
    "plot_distributions",
    "plot_map",
    "plot_overview",
    "plot_paths",
    "plot_route_chart",
    "plot_routes",
    "plot_success",
    "save",
    "wilson_rates",
]
