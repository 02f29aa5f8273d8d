"""Stations of cruises."""

import numpy as np
import pytest
from scipy.stats import chisquare

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.maps.chart import cells_where
from usvjax.maps.stations import check_places, check_stations, draw_stations

OPEN = cells_where(np.ones((4, 5), bool))
JOBS = np.arange(130)


pytestmark = pytest.mark.usefixtures("one_device")


def draw(jobs, count=3, least=0.0, cells=OPEN, seed=4):
    return draw_stations(seed, jobs, [cells] * len(jobs), count, least, "the pond", "'stations'")


def test_stations_are_uniform_and_differ():
    drawn = draw(np.arange(2000), 2)
    for station in (0, 1):
        counts = np.bincount(drawn[:, station, 1] * 5 + drawn[:, station, 0], minlength=20)
        assert chisquare(counts).pvalue > 1e-4
    assert (drawn[:, 0] != drawn[:, 1]).any(axis=1).all()


def test_stations_do_not_depend_on_who_else_draws():
    np.testing.assert_array_equal(draw(JOBS)[[128, 5]], draw(np.asarray([128, 5])))
    # Those that are drawn again because there was no room do not, either.
    tight = draw(JOBS, 4, 3.0)
    np.testing.assert_array_equal(tight[[128, 5]], draw(np.asarray([128, 5]), 4, 3.0))
    apart = np.hypot(*np.moveaxis(tight[:, :, None] - tight[:, None], -1, 0))
    assert apart[:, ~np.eye(4, dtype=bool)].min() >= 3.0


def test_the_first_stations_are_the_same_whatever_their_number():
    np.testing.assert_array_equal(draw(JOBS, 3), draw(JOBS, 7)[:, :3])


def test_no_room_is_a_clear_message():
    words = r"the pond, 20 cells where a station may be, has no room for 5 stations 4 cells apart "
    with pytest.raises(BadInputError, match=words + r"\(job 7\); lower 'stations'"):
        draw(np.asarray([7, 8]), 5, 4.0)


@pytest.mark.parametrize(
    ("count", "distance", "words"),
    [
        (1, 0.0, "2 to 200 stations, home included, got 1"),
        (201, 0.0, "got 201"),
        (2, -1.0, "'min_distance' must be 0 or more, got -1"),
        (2, np.nan, "'min_distance' must be 0 or more, got nan"),
    ],
)
def test_too_few_or_too_many_are_refused(count, distance, words):
    with pytest.raises(BadInputError, match=words):
        check_stations(count, distance, "s.toml")


@pytest.mark.parametrize(
    ("places", "words"),
    [
        (((0.5, 0.5),), "must have 2 to 200 stations"),
        (((0.5, 0.5), (2.5, 0.5)), r"\(2.5, 0.5\) is not on the map's water"),
        (((0.5, 0.5), (9.0, 0.5)), r"\(9, 0.5\) is not on the map's water"),
        (((0.5, 0.5), (3.5, 0.5)), r"no water joins \(3.5, 0.5\) to \(0.5, 0.5\)"),
        (((0.5, 0.5), (0.6, 0.7)), "two stations in one cell"),
        (((0.5, 0.5), (1e300, 0.0)), "no place in metres"),
        (((0.5, 0.5), (np.nan, 0.0)), "no place in metres"),
    ],
)
def test_places_that_are_no_stations_are_refused(places, words):
    blocked = np.zeros((3, 5), bool)
    blocked[:, 2] = True
    with pytest.raises(BadInputError, match=f"s.toml: .*{words}"):
        check_places(places, GridMap(blocked), "s.toml")
