"""The chart of a cruise: what it shows, what its legend says, what it refuses."""

import numpy as np
import pytest
from figure_checks import assert_inside, assert_labelled, lake, legend_texts, texts_of

from usvjax.errors import BadInputError, BadTypeError
from usvjax.missions.cruise.chart import TOUR_ID, TRACK_ID, duration_words, plot_cruise
from usvjax.plots import style
from usvjax.plots.labels import LABEL_ID
from usvjax.plots.route import length_words

STATIONS = np.array([[3000.0, 4000], [8000.0, 7000], [3000.0, 7000], [8000.0, 4000]])
ORDER = np.array([0, 2, 1, 3])
TRACK = np.array([[3000.0, 4000], [3000, 7000], [5000, 7500], [8000, 7000], [8000, 4000]])
TRACK = np.concatenate([TRACK, TRACK[:1], [[np.nan, np.nan]]])


def line_of(ax, gid):
    (line,) = ax.findobj(lambda artist: artist.get_gid() == gid)
    return line.get_xydata()


def number_at(ax, place):
    (text,) = [t.get_text() for t in ax.texts if t.get_gid() == LABEL_ID and t.xy == tuple(place)]
    return text


def test_stations_have_the_numbers_of_their_visits():
    fig = plot_cruise(lake(), STATIONS, ORDER, TRACK, title="Lake\n4 stations")
    (ax,) = fig.axes
    assert [number_at(ax, STATIONS[s]) for s in ORDER[1:]] == ["1", "2", "3"]
    np.testing.assert_array_equal(line_of(ax, TRACK_ID), TRACK[:-1])
    assert ax.get_title() == "Lake\n4 stations"
    length = np.hypot(*np.diff(TRACK[:-1], axis=0).T).sum()
    assert legend_texts(fig) == [
        "home",
        "station, numbered in the order of visits",
        f"track: {length_words(length)}",
    ]
    assert {"N", "Shore: X, L"} <= texts_of(ax)
    assert any(text.endswith(" km") for text in texts_of(ax))
    assert_labelled(ax)
    assert_inside(fig)


def test_a_tour_to_compare_with_is_closed_and_straight():
    tour = [0, 2, 3, 1]
    fig = plot_cruise(lake(), STATIONS, ORDER, TRACK, tour=tour, tour_label="straight")
    np.testing.assert_array_equal(line_of(fig.axes[0], TOUR_ID), STATIONS[[*tour, 0]])
    assert legend_texts(fig)[-1] == "straight"
    fig = plot_cruise(lake(), STATIONS, ORDER, TRACK, tour=ORDER)
    assert legend_texts(fig)[-1] == "tour in straight lines: 16.00 km"


def test_stations_given_up_are_marked():
    visited = np.array([True, True, True, False])
    fig = plot_cruise(lake(), STATIONS, ORDER, TRACK[:4], visited=visited)
    assert "station given up" in legend_texts(fig)
    grey, white = (
        [line.get_xydata().tolist() for line in fig.axes[0].lines if _is_disc(line, colour)]
        for colour in (style.GREY, "white")
    )
    assert grey == [[STATIONS[3].tolist()]]
    assert white == [STATIONS[[2, 1]].tolist()]


def _is_disc(line, colour):
    return line.get_marker() == "o" and line.get_markerfacecolor() == colour


def test_a_vessel_that_stays_has_no_arrows():
    fig = plot_cruise(lake(), STATIONS, ORDER, TRACK[[0, 0]])
    assert len(fig.axes[0].texts) < len(plot_cruise(lake(), STATIONS, ORDER, TRACK).axes[0].texts)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"stations": STATIONS[:1]}, r"stations has shape \(1, 2\)"),
        ({"stations": STATIONS * np.nan}, "stations has a number that is not finite"),
        ({"order": [0, 1, 2]}, "order is .*; each of 0 to 3"),
        ({"order": [0, 1, 2, 2]}, "order is .*; each of 0 to 3"),
        ({"order": [1, 0, 2, 3]}, r"order is \[1, 0, 2, 3\]; home, 0, was wanted first"),
        ({"tour": [0, 1, 2, 4]}, "tour is .*; each of 0 to 3"),
        ({"visited": [True]}, r"visited has shape \(1,\)"),
        ({"track": np.full((3, 2), np.nan)}, "track"),
        ({"track": TRACK[:, :1]}, r"track has shape \(7, 1\); \(P, 2 or more\) was wanted"),
    ],
)
def test_what_is_no_cruise_is_refused(change, words):
    given = {"stations": STATIONS, "order": ORDER, "track": TRACK, **change}
    rest = {k: v for k, v in given.items() if k in ("tour", "visited")}
    with pytest.raises(BadInputError, match=words):
        plot_cruise(lake(), given["stations"], given["order"], given["track"], **rest)


def test_a_plain_array_is_no_map():
    with pytest.raises(BadTypeError, match=r"grid_map is of type ndarray; a usvjax\.GridMap"):
        plot_cruise(lake().blocked, STATIONS, ORDER, TRACK)


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(41.46, "41.5 s"), (120.0, "2 min"), (5400.0, "90 min"), (30290.0, "8.4 h"), (1e6, "277.8 h")],
)
def test_durations_are_said_in_a_fitting_unit(seconds, words):
    assert duration_words(seconds) == words
