"""Cruises of several stations through water that changes under way, thousands at once."""

from collections.abc import Mapping
from typing import Any

import jax
import numpy as np

from usvjax.checks import one_of, whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvjax.keys import as_key, first_run
from usvjax.missions.cruise.inputs import (
    SPEED,
    Expedition,
    check_heuristic,
    check_mission,
    check_order,
)
from usvjax.missions.cruise.orders import DISTANCES, tour_order
from usvjax.missions.cruise.result import CruiseResult, result_of
from usvjax.missions.cruise.rounds import (
    PLANNER_OPTIONS,
    PLANNERS,
    SWARMS,
    LegPlanner,
    sail_in_rounds,
)
from usvjax.missions.cruise.sailing import MOST_LANES, Replanning, sail
from usvjax.missions.cruise.straightening import pulled_straight
from usvjax.search.replan_inputs import check_method
from usvjax.tours.algorithms import NAMES as TOURS
from usvkernels.draws import seeds as seeds_of

METHODS = ("dstar_lite", *PLANNERS)
MAX_WAIT = 100
EXPANSIONS_PER_CELL = 16  # of one replanning; without overestimating it takes two at most
MOST_EXPANSIONS = 2**28


def cruise(
    blocked: Any,
    stations: Any,
    key: Any,
    *,
    method: str = "dstar_lite",
    heuristic: str = "weighted",
    weight: float | None = None,
    order: Any = None,
    tour: str = "recommended",
    distances: str = "straight",
    runs: int | None = None,
    first: int = 0,
    flip_rate: Any = 0.03,
    flip_scope: str = "window",
    sensing: tuple[int, int] = (5, 5),
    corner_cutting: bool = False,
    walled_in: str = "wait",
    max_wait: int = MAX_WAIT,
    max_steps: int | None = None,
    max_expansions: int | None = None,
    planner_options: Mapping[str, Any] | None = None,
    cell_size: float | None = None,
    speed: float = SPEED,
    max_lanes: int = MOST_LANES,
) -> CruiseResult:
    """Sail from home to every station and home again while cells flip.

    A step: cells change their state; the vessel sees those in its window, replans, and makes one
    move to one of the 8 cells about it, or waits where no way is known to its stop. Whether a
    cell flips depends on the seed, the step and the cell alone, so that all methods meet the same
    changes. The vessel's own cell and the stations never flip. A leg begins on the map as it is
    known by then; the first map is known. Afterwards the track is pulled straight: from each way
    point on to the last cell in sight, where a chord must be clear on the true map of each step
    that it replaces (Yu et al. 2022, section 4.2.2, on one map).

    Source: Yu et al. 2022, sections 3.4 and 4.3. Runs on all devices, or on that of an enclosing
    `jax.default_device`; a cruise does not depend on the others.

    Args:
      blocked: bool[H, W] shared by all (True = not navigable), bool[B, H, W], or a `GridMap`.
      stations: int[B, d, 2], cells (x, y), or int[d, 2], shared; station 0 is home.
      key: a seed or a JAX key. Cruise j takes the j-th part of it, the same whatever the method.
      method: "dstar_lite" repairs its way with every change seen. "astar" plans anew, along a
        shortest path, when what has been seen blocks the way ahead; "aco", "ga" and "cmpso" do
        the same with `plan_paths` (Algorithms 1 to 3 of the paper), which may miss a way that
        there is: they are asked again at every step that the vessel waits.
      heuristic, weight: of "dstar_lite", as there; with another method their names are checked
        and nothing else. "weighted" is the paper's improved D* Lite, "chebyshev" (the chess-board
        distance) or "octile" the traditional. The weighted tracks are longer: 2,056 m against
        1,903 m with "octile" in benchmark cruise_rate.
      order: int[B, d] or int[d], stations in the order of the cruise, 0 first; by default that
        of `solve_tour`.
      tour: algorithm of `solve_tour`, where no order is given.
      distances: that the tour adds up: "straight" (the paper's), or "water", along shortest
        paths on the first map.
      runs: B, where map and stations are shared.
      first: number of the first cruise, so that the parts of a longer list can be sailed one by
        one; cruise j of this call takes the (first + j)-th part of the key.
      flip_rate: probability with which a cell flips at a step, in [0, 1], to the nearest 2^-24;
        or one for each cruise.
      flip_scope: "window": cells in the vessel's window flip. "map": all cells do, which is
        noticed where and when they come into the window; 3 % a step brings any map to half of
        its cells blocked within a few dozen steps.
      sensing: (h, w), odd and at least 3: rows and columns of the window about the vessel.
      corner_cutting: whether moves and chords may pass the corner of a blocked cell.
      walled_in: while no way to its stop is known, the vessel should "wait", up to `max_wait`
        steps in a row, and then leave the stop out; "skip" it at once; or "fail" at once. A stop
        given up is UNREACHABLE where there was no way on the map as known, and OUT_OF_BUDGET
        where `plan_paths` only found none.
      max_wait: steps.
      max_steps: moves and waits of a leg; by default 8 times height plus width of the map, of
        "dstar_lite" at most as many as its keys can count on a map of this size: 5,694 on
        854 x 730 cells with "weighted", 8,577 with "octile" or "chebyshev".
      max_expansions: of "dstar_lite" in one step, before it is given up (OUT_OF_BUDGET); by
        default 16 per cell of the map.
      planner_options: keyword arguments for `plan_paths`: iterations, population or params.
      cell_size: m, by default 10 (the paper's); a `GridMap` has its own.
      speed: m/s.
      max_lanes: of "dstar_lite", most cruises under way at once on a device; for measurements.

    Raises:
      BadTypeError: an argument of the wrong type or dtype.
      BadInputError: a wrong shape, fewer than two stations, one that lies outside the map, on a
        blocked cell or on another, an order that is no permutation, an impossible option, a map
        too large for the heuristic, more cruises than memory holds; the message names the
        argument and the first bad row.
    """
    one_of("method", method, METHODS)
    one_of("distances", distances, DISTANCES)
    one_of("tour", tour, TOURS)
    expedition = check_mission(
        blocked,
        stations,
        runs=runs,
        flip_rate=flip_rate,
        flip_scope=flip_scope,
        sensing=sensing,
        corner_cutting=corner_cutting,
        walled_in=walled_in,
        max_wait=max_wait,
        max_steps=max_steps,
        cell_size=cell_size,
        speed=speed,
    )
    if method == "dstar_lite":
        expedition = check_heuristic(expedition, heuristic, weight)
    else:
        check_method(heuristic, weight, corner_cutting, None)
    replanning = _replanning(expedition, heuristic, weight, max_expansions, max_lanes)
    planner = _planner(expedition, method, planner_options)
    first = first_run(first, len(expedition))
    flip_key, tour_key, plan_key = jax.random.split(as_key(key), 3)
    seeds = np.asarray(seeds_of(flip_key, len(expedition), first)).T
    if order is None:
        chosen = tour_order(expedition, tour_key, tour, distances, first)
    else:
        chosen = check_order(order, expedition)
    if method == "dstar_lite":
        voyages = sail(expedition, chosen, seeds, replanning)
    else:
        voyages = sail_in_rounds(expedition, chosen, seeds, planner, plan_key, first)
    way = pulled_straight(expedition, voyages, seeds)
    return result_of(expedition, chosen, seeds, voyages, way)


def _planner(expedition: Expedition, method: str, options: Any) -> LegPlanner:
    if options is not None and not isinstance(options, Mapping):
        raise BadTypeError(
            f"planner_options: got {options!r}; wanted a mapping of keyword arguments"
        )
    swarm = method in SWARMS
    if options and not swarm:
        raise BadInputError(f"planner_options: got {options!r} with method={method!r}; wanted none")
    for name in options or ():
        one_of("planner_options", name, PLANNER_OPTIONS)
    if swarm and expedition.corner_cutting:
        raise BadInputError(f"corner_cutting: got True; wanted False with method={method!r}")
    planner = LegPlanner(method, dict(options or {}))
    if options:
        planner.check()
    return planner


def _replanning(
    expedition: Expedition, heuristic: Any, weight: Any, max_expansions: Any, max_lanes: Any
) -> Replanning:
    height, width = expedition.shape
    if max_expansions is None:
        max_expansions = EXPANSIONS_PER_CELL * height * width
    return Replanning(
        heuristic=heuristic,
        weight=weight,
        max_expansions=min(whole_number("max_expansions", max_expansions, 1), MOST_EXPANSIONS),
        max_lanes=whole_number("max_lanes", max_lanes, 1),
    )
