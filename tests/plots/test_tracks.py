"""Films of recorded episodes."""

import numpy as np
import pytest
from figure_checks import GOAL, LINE, OBSTACLES, assert_inside, lake, lake_tracks, legend_texts

from usvjax.plots.tracks import track_film


def open_water():
    marks = {"start": np.zeros((1, 2)), "goal": GOAL[None]}
    places, along = LINE[:, None, :2], np.arange(len(LINE)) / 10
    return track_film(
        places, along, "s", circles=OBSTACLES, radius=0.5, marks=marks, title="r 0.5 m, job 3"
    )


def on_a_lake():
    places = np.swapaxes(lake_tracks(1)[:, :15, :2], 0, 1)
    ends = {"start": places[0], "goal": places[-1]}
    return track_film(places, np.arange(15.0), "m", grid_map=lake(), marks=ends, title="a, job 3")


@pytest.mark.parametrize("make", [open_water, on_a_lake])
def test_the_title_stands_clear_of_the_map_in_every_frame(make):
    film = make()
    for step in (0, film.steps - 1):
        film.show(step)
        assert_inside(film.fig)
        heading, (ax,) = film.fig._suptitle, film.fig.axes
        assert "job 3\nafter " in heading.get_text()
        assert heading.get_window_extent().y0 > ax.get_window_extent().y1
        assert len(film.fig.texts) == 1


def test_the_legend_fits_a_narrow_figure():
    film = open_water()
    assert legend_texts(film.fig) == ["obstacle, expanded by r = 0.5 m", "start", "goal", "vessel"]
    (legend,) = film.fig.legends
    box = legend.get_window_extent()
    assert box.x0 >= 0
    assert box.x1 <= film.fig.bbox.x1


def test_a_vessel_at_the_goal_hides_no_mark():
    film = on_a_lake()
    film.show(film.steps - 1)
    by_name = {line.get_label(): line for line in film.fig.axes[0].lines}
    vessel, goal = by_name["vessel"], by_name["goal"]
    np.testing.assert_allclose(vessel.get_xydata(), goal.get_xydata())
    assert vessel.get_zorder() > goal.get_zorder()
    # The core of a five-pointed star is 0.38 of its width.
    assert vessel.get_markersize() <= 0.4 * goal.get_markersize()
    assert vessel.get_markersize() < 0.7 * by_name["start"].get_markersize()
