"""Reciprocal velocities as the C++ library RVO2 chooses them, by its Python package pyrvo.

Imports nothing of ours, for an environment of the package's own.
"""

import time
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Crowd:
    """Numbers that all agents share, and how many neighbours each heeds."""

    dt: float = 1.0  # s
    horizon: float = 60.0  # s
    radius: float = 20.0  # m
    speed: float = 10.0  # m/s, at most
    neighbours: int = 10
    sight: float = 1e5  # m, past which nobody is a neighbour


def available() -> bool:
    """Whether the package is there."""
    return find_spec("pyrvo") is not None


def _simulator(crowd: Crowd, places: np.ndarray, now: np.ndarray, wanted: np.ndarray) -> Any:
    """One fleet: places, velocities and wanted velocities float[n, 2]."""
    import pyrvo

    c = crowd
    simulator = pyrvo.RVOSimulator(
        c.dt, c.sight, c.neighbours, c.horizon, c.horizon, c.radius, c.speed
    )
    rows = zip(places.tolist(), now.tolist(), wanted.tolist(), strict=True)
    for i, (place, velocity, aim) in enumerate(rows):
        simulator.add_agent(place)
        simulator.set_agent_velocity(i, velocity)
        simulator.set_agent_pref_velocity(i, aim)
    return simulator


def chosen(crowd: Crowd, places: np.ndarray, now: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """The velocities that fleets [S, n, 2] take, each from its situation; float64[S, n, 2]."""
    found = np.empty(places.shape)
    for row in range(len(places)):
        simulator = _simulator(crowd, places[row], now[row], wanted[row])
        simulator.do_step()
        for i in range(places.shape[1]):
            velocity = simulator.get_agent_velocity(i)
            found[row, i] = velocity.x, velocity.y
    return found


def seconds(crowd: Crowd, places: np.ndarray, wanted: np.ndarray, steps: int) -> float:
    """Wall-clock seconds of `steps` steps of fleets [S, n, 2] that begin at rest, set-up apart."""
    still = np.zeros_like(places)
    fleets = [_simulator(crowd, *one) for one in zip(places, still, wanted, strict=True)]
    began = time.perf_counter()
    for simulator in fleets:
        for _ in range(steps):
            simulator.do_step()
    return time.perf_counter() - began
