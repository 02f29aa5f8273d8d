"""Figures of the curvature along routes."""

import math

import numpy as np
from figure_checks import assert_inside, legend_texts

from usvjax import plots

ROUTE = np.array([[110.0, 50], [110, 250], [150, 290], [330, 290]])


def test_corners_bend_by_their_discrete_curvature():
    bends = plots.bends_of(ROUTE)
    diagonal = 40 * math.sqrt(2)
    assert bends.at_corners
    np.testing.assert_allclose(bends.distance, [200, 200 + diagonal])
    sharp = 2 * math.sin(math.pi / 8)
    first, second = (200 + diagonal) / 2, (diagonal + 180) / 2
    np.testing.assert_allclose(bends.curvature, [-sharp / first, -sharp / second])


def test_a_circle_bends_by_one_over_its_radius():
    angle = np.linspace(0, np.pi, 100)
    circle = 30.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    np.testing.assert_allclose(plots.bends_of(circle).curvature, 1 / 30.0, rtol=1e-6)
    curve = plots.bends_of(circle, np.full(100, 1 / 30.0))
    fig = plots.plot_curvature({"astar": plots.bends_of(ROUTE), "smoothed": curve}, 30.0)
    top, bottom = fig.axes
    for ax in (top, bottom):
        bounds = {round(float(line.get_ydata()[0]), 9) for line in ax.lines}
        assert {round(1 / 30.0, 9), -round(1 / 30.0, 9)} <= bounds
        assert ax.get_ylim() == top.get_ylim()
    assert bottom.get_title(loc="right") == "smoothed: curvature up to 1.00 / R"
    assert "discrete curvature" in top.get_title(loc="right")
    assert bottom.get_xlabel() == "distance along the route (m)"
    assert legend_texts(fig) == ["bounds of a turning radius R = 30 m"]
    assert_inside(fig)


def test_the_axis_goes_to_the_end_of_the_longest_route():
    long = plots.bends_of([[0.0, 0], [100, 0], [100, 100], [100, 900]])
    short = plots.bends_of([[0.0, 0], [300, 0]], np.zeros(2))
    assert (long.end, short.end) == (1000.0, 300.0)
    fig = plots.plot_curvature({"astar": long, "smoothed": short}, 30.0)
    for ax, end in zip(fig.axes, (1000.0, 300.0), strict=True):
        assert ax.get_xlim()[1] >= 1000.0
        (zero,) = (x for x in ax.lines if x.get_zorder() == 1)
        assert zero.get_xdata().tolist() == [0.0, end]
    assert plots.Bends(np.ones(1), np.ones(1), at_corners=True).end == 1.0


def test_corners_that_stayed_are_marked_and_counted():
    line = np.array([[0.0, 0], [50, 0], [100, 0], [100, 50], [100, 100]])
    corners = [[100.0, 0.0], [np.nan, np.nan], [100.0, 50.0]]
    bends = plots.bends_of(line, np.zeros(5), corners)
    assert bends.left.tolist() == [100.0, 150.0]
    fig = plots.plot_curvature({"smoothed": bends, "bspline": plots.bends_of(line)}, 30.0)
    ax, other = fig.axes
    title = "smoothed: curvature up to 0.00 / R, 2 corners not sailable"
    assert ax.get_title(loc="right") == title
    marks = [x for x in ax.lines if x.get_marker() == "X"]
    assert [mark.get_xdata().tolist() for mark in marks] == [[100.0, 150.0]]
    assert legend_texts(fig)[1:] == ["corner that cannot be sailed"]
    assert "sailable" not in other.get_title(loc="right")
    one = plots.plot_curvature({"a": plots.bends_of(line, np.zeros(5), corners[:1])}, 30.0)
    assert one.axes[0].get_title(loc="right").endswith(", 1 corner not sailable")


def test_curvature_of_arcs_jumps():
    line = np.column_stack([np.arange(5.0), np.zeros(5)])
    fig = plots.plot_curvature({"a": plots.bends_of(line, [0, 0, 0.1, 0.1, 0])}, 5.0)
    (curve,) = (x for x in fig.axes[0].lines if len(x.get_xdata()) == 5)
    assert curve.get_drawstyle() == "steps-mid"
