"""Short episodes among circles, shared by the navigation tests."""

import jax
import numpy as np

import usvjax as uj
from usvjax.missions.dwa.run import NavigateResult

B = 12
MANY = 1000
NUMBERS = ("status", "time", "path_length", "mean_speed", "min_clearance", "steps")
PARAMS = uj.DwaParams(
    radius=0.3, clearance_cap=1.0, goal_tolerance=0.4, stuck_distance=0.7, stuck_time=4.0
)
STATIC = uj.DwaStatic(method="improved", max_steps=100)

Waters = tuple[np.ndarray, np.ndarray, np.ndarray]


def waters(n: int = B, seed: int = 8) -> Waters:
    """Obstacles [n, 6, 2], starts and goals of short episodes that end in every way."""
    rng = np.random.default_rng(seed)
    obstacles = rng.uniform(0.5, 5.0, (MANY, 6, 2))
    starts = np.column_stack((np.zeros((MANY, 2)), rng.uniform(0.0, 1.57, MANY)))
    goals = rng.uniform(1.0, 4.0, (MANY, 2))
    return obstacles[:n], starts[:n], goals[:n]


def sail(*episodes: np.ndarray, **options: object) -> NavigateResult:
    """Sail under the parameters of this file; one device, so that all compiles once."""
    with jax.default_device(jax.devices("cpu")[0]):
        return uj.navigate_dwa(*episodes, **{"params": PARAMS, "static": STATIC, **options})


def assert_same(got: NavigateResult, want: NavigateResult, rows: object = slice(None)) -> None:
    """Equal bit for bit."""
    for name in NUMBERS:
        np.testing.assert_array_equal(getattr(got, name), getattr(want, name)[rows], err_msg=name)
