"""What the tests of figures share: a small scene, a small lake, and checks of any figure."""

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.text import Text

from usvjax.maps import GridMap
from usvjax.plots.base_map import SHORE_ID

OBSTACLES = np.array([(2.0, 3.0), (5.0, 5.0), (7.0, 4.0)])
GOAL = np.array([10.0, 10.0])
LINE = np.column_stack([np.linspace(0, 10, 41)] * 2 + [np.zeros((41, 3))])


def legend_texts(fig):
    return [text.get_text() for legend in fig.legends for text in legend.get_texts()]


def texts_of(ax):
    """Every text in the axes, those of scale bar, arrow and source included."""
    return {text.get_text() for text in ax.findobj(Text)} - {""}


def tick_numbers(ax):
    """Numbers written along x, those within the limits."""
    west, east = ax.get_xlim()
    texts = [
        text.get_text()
        for place, text in zip(ax.get_xticks(), ax.get_xticklabels(), strict=True)
        if west <= place <= east
    ]
    return np.array([float(text.replace("\N{MINUS SIGN}", "-")) for text in texts])


def shore_of(ax):
    """Lines between land and water."""
    (shore,) = (c for c in ax.collections if c.get_gid() == SHORE_ID)
    return shore.get_segments()


def tracks_of(ax):
    """Collections of lines that are not the shore."""
    lines = [c for c in ax.collections if isinstance(c, LineCollection)]
    return [c for c in lines if c.get_gid() != SHORE_ID]


def assert_labelled(ax):
    for label in (ax.get_xlabel(), ax.get_ylabel()):
        assert label.endswith(")"), f"axis label {label!r} has no unit"


def assert_inside(fig):
    """No title, label or legend is cut off by the edge of the figure."""
    fig.canvas.draw()
    width, height = fig.canvas.get_width_height()
    box = fig.get_tightbbox().extents * fig.dpi
    assert (box[:2] > -1).all()
    assert (box[2:] < np.array([width, height]) + 1).all()


def lake():
    blocked = np.ones((30, 40), bool)
    blocked[5:25, 5:35] = False
    return GridMap(blocked, cell_size=250.0, origin=(1000.0, 2000.0), attribution="Shore: X, L")


def lake_tracks(count=40):
    tracks = np.full((count, 20, 5), np.nan)
    tracks[:, :15] = np.linspace([3000.0, 4000, 0, 0, 0], [8000.0, 7000, 0, 0, 0], 15)
    return tracks
