"""Random maps of the jobs of a study; `random_maps` itself is tested with the other maps."""

import numpy as np
import pytest

from usvjax.errors import BadInputError
from usvjax.maps import random_maps
from usvjax.maps.cells import check_cells, maps_of_jobs


@pytest.mark.parametrize("jobs", [[4, 5, 6], [9], [7, 2, 31]])
def test_a_job_has_the_random_map_of_its_number(jobs):
    found = maps_of_jobs(5, np.asarray(jobs), (6, 9), 0.4)
    np.testing.assert_array_equal(found, random_maps(5, 32, (6, 9), 0.4)[jobs])


def test_no_job_has_no_map():
    assert maps_of_jobs(5, np.arange(0), (6, 9), 0.4).shape == (0, 6, 9)


@pytest.mark.parametrize(
    ("density", "size", "words"),
    [
        (1.1, 1.0, "s.toml: 'density' must lie in"),
        (np.nan, 1.0, "'density' must lie in"),
        (0.1, 0.0, "'cell_size' must be above 0, got 0"),
        (0.1, np.inf, "'cell_size' must be above 0, got inf"),
    ],
)
def test_cells_that_cannot_be_are_refused(density, size, words):
    with pytest.raises(BadInputError, match=words):
        check_cells((9, 9), density, size, "s.toml")


def test_maps_of_more_cells_than_there_is_room_for_are_refused():
    with pytest.raises(BadInputError, match=r"s\.toml: a map of 'shape' has 20,000 x 20,000 cells"):
        check_cells((20_000, 20_000), 0.1, 1.0, "s.toml")
    for shape in ((10**7, 10**7), (10**18, 10)):
        with pytest.raises(BadInputError, match=r"n: 2 maps of 1000.* cells needs .* of memory"):
            random_maps(0, 2, shape)
