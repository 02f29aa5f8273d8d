"""Small waters and studies of routes, shared by the tests."""

import numpy as np

from usvjax.maps import GridMap

SHAPE = (16, 16)
CELL = 10.0  # m


def pond():
    """Two bodies of water, the larger one with an island: 18 x 14 cells of 50 m."""
    blocked = np.ones((14, 18), bool)
    blocked[1:13, 1:12] = False
    blocked[5:8, 4:7] = True
    blocked[1:13, 13:17] = False
    return GridMap(blocked, 50.0, (100.0, -200.0))


def route_study(**changes):
    study = {
        "name": "small",
        "kind": "route",
        "seed": 4,
        "episodes": 40,
        "shard": 20,
        "maps": {"shape": list(SHAPE), "density": 0.3, "cell_size": CELL, "min_distance": 50.0},
        "smoothing": {"turning_radius": 6.0, "repair": 0},
    }
    return {**study, **changes}
