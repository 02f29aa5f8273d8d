"""The base map of every chart: north up, true to its cells, with scale, arrow, unit and source."""

import numpy as np
import pytest
from figure_checks import (
    assert_inside,
    lake,
    lake_tracks,
    legend_texts,
    shore_of,
    texts_of,
    tick_numbers,
)
from matplotlib.text import Annotation
from mpl_toolkits.axes_grid1.anchored_artists import AnchoredSizeBar

from usvjax import plots
from usvjax.maps import GridMap, random_maps

POND = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [1, 1, 0, 1]], bool)


def scale_bar(fig):
    """Box of the scale bar, and length of its bar in m."""
    (bar,) = fig.axes[0].findobj(AnchoredSizeBar)
    (rectangle,) = bar.size_bar.get_children()
    return bar, rectangle.get_width()


@pytest.mark.parametrize(
    ("grid", "unit"),
    [
        (GridMap(POND, 10.0), "m"),
        (GridMap(POND, 2000.0, (-9000.0, 0.0)), "km"),
        (GridMap(POND, 1.0, (400_000.0, 4_500_000.0)), "m"),
    ],
)
def test_a_map_is_in_metres_or_kilometres(grid, unit):
    fig = plots.plot_map(grid)
    (ax,) = fig.axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == (f"x, east ({unit})", f"y, north ({unit})")
    assert ax.get_aspect() == 1.0
    assert (*ax.get_xlim(), *ax.get_ylim()) == grid.extent
    places = ax.get_xticks()
    shown = places[(places >= ax.get_xlim()[0]) & (places <= ax.get_xlim()[1])]
    assert len(shown) >= 3
    scale = 1000.0 if unit == "km" else 1.0
    np.testing.assert_allclose(tick_numbers(ax) * scale, shown, rtol=1e-12)
    assert_inside(fig)


def test_a_map_has_land_where_it_is_and_says_what_is_what():
    grid = lake()
    fig = plots.plot_map(grid)
    (image,) = fig.axes[0].images
    assert image.origin == "lower"
    np.testing.assert_array_equal(image.get_array(), grid.blocked)
    np.testing.assert_allclose(image.get_extent(), grid.extent)
    assert legend_texts(fig) == ["water (free)", "land (blocked)"]
    assert fig.axes[0].get_title() == "40 x 30 cells of 250 m"
    assert {"N", "2 km", "Shore: X, L"} <= texts_of(fig.axes[0])


def test_shore_lines_follow_the_cell_edges():
    blocked = np.zeros((3, 3), bool)
    blocked[1, 1] = True
    grid = GridMap(blocked, 2.0, (10.0, 20.0))
    corners = [(12.0, 22.0), (14.0, 22.0), (14.0, 24.0), (12.0, 24.0)]
    expected = {frozenset({corners[i], corners[i - 1]}) for i in range(4)}
    for fig in (plots.plot_map(grid), plots.plot_chart(grid, [[[11.0, 21.0]]], [1])):
        edges = {frozenset(map(tuple, line.tolist())) for line in shore_of(fig.axes[0])}
        assert edges == expected


@pytest.mark.parametrize(
    ("cell_size", "length", "text"),
    [(1.0, 10.0, "10 m"), (0.02, 0.2, "0.2 m"), (60.0, 500.0, "500 m"), (90.0, 1000.0, "1 km")],
)
def test_the_scale_bar_is_a_round_length_and_as_long_as_it_says(cell_size, length, text):
    grid = GridMap(random_maps(1, 1, (50, 50), 0.1)[0], cell_size)
    fig = plots.plot_map(grid)
    bar, drawn = scale_bar(fig)
    assert drawn == pytest.approx(length)
    assert bar.txt_label.get_text() == text


@pytest.mark.parametrize("shape", [(40, 40), (100, 8), (4, 60)])
def test_what_explains_a_map_stands_below_it_and_apart(shape):
    grid = GridMap(np.zeros(shape, bool), 10.0, attribution="Survey of the Ponds (2024)")
    fig = plots.plot_map(grid)
    fig.canvas.draw()
    (ax,), (legend,) = fig.axes, fig.legends
    bar, _ = scale_bar(fig)
    (arrow,) = (a for a in ax.findobj(Annotation) if a.get_text() == "N")
    (note,) = (a for a in ax.findobj(Annotation) if "Survey" in a.get_text())
    boxes = [a.get_window_extent() for a in (bar, arrow, note)]
    labels = ax.xaxis.get_tightbbox()
    for i, box in enumerate(boxes):
        assert box.y1 <= labels.y0
        assert box.y0 >= legend.get_window_extent().y1
        assert not any(box.overlaps(other) for other in boxes[:i])


def test_the_legend_of_a_map_has_what_is_there():
    for blocked, text in ((True, "land (blocked)"), (False, "water (free)")):
        assert legend_texts(plots.plot_map(GridMap(np.full((3, 4), blocked)))) == [text]


def test_north_is_up():
    fig = plots.plot_map(lake())
    fig.canvas.draw()
    (arrow,) = (a for a in fig.axes[0].findobj(Annotation) if a.get_text() == "N")
    tail, tip = arrow.arrow_patch.get_path().vertices[[0, 2]]
    (_, low), (_, high) = arrow.arrow_patch.get_transform().transform([tail, tip])
    assert high > low
    assert not fig.axes[0].yaxis_inverted()
    assert not fig.axes[0].xaxis_inverted()


def test_a_long_source_is_folded_and_stands_below_the_axes():
    blocked = np.zeros((30, 20), bool)
    grid = GridMap(blocked, 1.0, attribution="Survey of the Ponds (2024), CC-BY-4.0; " * 20)
    fig = plots.plot_map(grid)
    fig.canvas.draw()
    (note,) = (text for text in fig.axes[0].texts if "Survey" in text.get_text())
    assert note.get_text().startswith("Survey of the Ponds (2024)")
    assert note.get_text().endswith("...")
    box, axes = note.get_window_extent(), fig.axes[0].get_window_extent()
    assert axes.x0 < box.x0
    assert box.x1 <= axes.x1 + 1
    labels = fig.axes[0].xaxis.get_tightbbox()
    assert box.y1 <= labels.y0
    (legend,) = fig.legends
    assert legend.get_window_extent().y1 <= box.y0
    assert_inside(fig)


def test_a_chart_may_name_another_source_or_none():
    named = plots.plot_chart(lake(), lake_tracks(1), [1], attribution="Chart: Y")
    assert "Chart: Y" in texts_of(named.axes[0])
    assert "Shore: X, L" not in texts_of(named.axes[0])
    bare = plots.plot_chart(lake(), lake_tracks(1), [1], attribution="")
    assert "Shore: X, L" not in texts_of(bare.axes[0])


@pytest.mark.parametrize("blocked", [np.ones((1, 1), bool), np.zeros((1, 60), bool)])
def test_maps_without_any_shore_are_drawn(blocked, tmp_path):
    fig = plots.plot_map(GridMap(blocked))
    assert len(shore_of(fig.axes[0])) == 0
    assert plots.save(fig, tmp_path / "a.png", dpi=50).exists()
