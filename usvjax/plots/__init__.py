"""Figures of studies and episodes: every function takes data and returns a matplotlib Figure.

Nothing here is imported by ``import usvjax``; matplotlib loads with this package only. Figures
are made without pyplot, so no window opens, no state is shared, and threads may draw at once.
"""

from usvjax.plots.animation import animate_episode
from usvjax.plots.chart import plot_chart
from usvjax.plots.cruise import plot_cruise
from usvjax.plots.curvature import Bends, bends_of, plot_curvature
from usvjax.plots.decision import Decision, Episode, EpisodeView, plot_decision
from usvjax.plots.distributions import both_reached, plot_distributions
from usvjax.plots.expanded import Expanded, expanded_cells, plot_expanded
from usvjax.plots.map_sheet import plot_map
from usvjax.plots.paths import Outcome, plot_paths
from usvjax.plots.rates import plot_success, wilson_rates
from usvjax.plots.replanning import (
    Replanning,
    animate_replanning,
    plot_replanning,
    replanning_of,
)
from usvjax.plots.replays import Replay, replay
from usvjax.plots.route import plot_route_chart, plot_routes
from usvjax.plots.route_study import plot_methods
from usvjax.plots.study import figures_for_run
from usvjax.plots.style import save

__all__ = [
    "Bends",
    "Decision",
    "Episode",
    "EpisodeView",
    "Expanded",
    "Outcome",
    "Replanning",
    "Replay",
    "animate_episode",
    "animate_replanning",
    "bends_of",
    "both_reached",
    "expanded_cells",
    "figures_for_run",
    "plot_chart",
    "plot_cruise",
    "plot_curvature",
    "plot_decision",
    "plot_distributions",
    "plot_expanded",
    "plot_map",
    "plot_methods",
    "plot_paths",
    "plot_replanning",
    "plot_route_chart",
    "plot_routes",
    "plot_success",
    "replanning_of",
    "replay",
    "save",
    "wilson_rates",
]
