"""Figures of studies and episodes: every function takes data and returns a matplotlib Figure.

Nothing here is imported by ``import usvjax``; matplotlib loads with this package only. Figures
are made without pyplot, so no window opens, no state is shared, and threads may draw at once.
"""

from usvjax.plots.animation import animate_episode
from usvjax.plots.chart import plot_chart
from usvjax.plots.decision import Decision, Episode, EpisodeView, plot_decision
from usvjax.plots.distributions import both_reached, plot_distributions
from usvjax.plots.map_sheet import plot_map
from usvjax.plots.paths import Outcome, plot_paths
from usvjax.plots.rates import plot_success, wilson_rates
from usvjax.plots.replays import Replay, replay
from usvjax.plots.study import figures_for_run
from usvjax.plots.style import save

__all__ = [
    "Decision",
    "Episode",
    "EpisodeView",
    "Outcome",
    "Replay",
    "animate_episode",
    "both_reached",
    "figures_for_run",
    "plot_chart",
    "plot_decision",
    "plot_distributions",
    "plot_map",
    "plot_paths",
    "plot_success",
    "replay",
    "save",
    "wilson_rates",
]
