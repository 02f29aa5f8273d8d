"""Scenes of cruise studies: what they draw, and what a job's stations may not depend on."""

import pickle

import numpy as np
import pytest
from cruise_scenes import ponds
from scipy import ndimage

from usvjax.maps import random_maps
from usvjax.missions.cruise.scenes import CellTable, ChartSource, ChartTable

JOBS = np.arange(8)
MAPS = CellTable((12, 12), 0.3, 10.0, stations=6, min_distance=30.0)
CHART = ChartSource(
    ponds(), ChartTable("ponds", stations=4, min_distance=150.0, shore_distance=100.0)
)
PLACES = ChartSource(ponds(), ChartTable("ponds", places=((1075.0, -425.0), (1480.0, -60.5))))


pytestmark = pytest.mark.usefixtures("one_device")


def test_random_stations_lie_apart_in_the_largest_water():
    drawn = MAPS.draw(3, JOBS + 4)
    np.testing.assert_array_equal(drawn.blocked, random_maps(3, 8, (12, 12), 0.3, first=4))
    for blocked, stations in zip(drawn.blocked, drawn.stations, strict=True):
        labels, _ = ndimage.label(~blocked)
        body = labels[stations[:, 1], stations[:, 0]]
        assert len(set(body)) == 1
        assert (labels == body[0]).sum() == np.bincount(labels[labels > 0]).max()
        apart = np.hypot(*np.moveaxis(stations[:, None] - stations[None], -1, 0))
        assert apart[~np.eye(6, dtype=bool)].min() >= 3.0
    again = MAPS.draw(3, JOBS + 9)
    np.testing.assert_array_equal(again.stations[:3], drawn.stations[5:])
    assert len(np.unique(drawn.stations[:, 0], axis=0)) > 5


def test_stations_of_a_map_keep_off_the_shore():
    stations = CHART.draw(1, np.arange(50)).stations
    # Two cells from the shore of the western pond, every one of them sometimes drawn.
    cells = {(x, y) for x in range(2, 9) for y in range(2, 8)}
    assert set(map(tuple, stations.reshape(-1, 2).tolist())) == cells


@pytest.mark.parametrize("source", [MAPS, CHART], ids=["maps", "chart"])
def test_a_set_of_stations_is_the_same_alone_as_among_others(source):
    among, alone = source.draw(5, JOBS), source.draw(5, np.asarray([6, 2]))
    np.testing.assert_array_equal(among.stations[[6, 2]], alone.stations)
    assert (source.draw(6, JOBS).stations != among.stations).any()


@pytest.mark.parametrize("source", [MAPS, CHART, PLACES], ids=["maps", "chart", "places"])
def test_a_source_draws_the_same_in_another_process(source):
    drawn = source.draw(7, JOBS[:3])
    again = pickle.loads(pickle.dumps(source))
    assert again == source
    sent = pickle.loads(pickle.dumps(drawn))
    for scenes in (again.draw(7, JOBS[:3]), sent):
        np.testing.assert_array_equal(scenes.stations, drawn.stations)
        np.testing.assert_array_equal(scenes.blocked, drawn.blocked)
