"""Cruises of several stations through water that changes under way, thousands at once."""

from collections.abc import Mapping
from typing import Any

import jax
import numpy as np

from usvjax.checks import one_of, shown, whole_number
from usvjax.errors import BadInputError, saying_where
from usvjax.keys import as_key, first_run
from usvjax.missions.cruise.inputs import (
    Expedition,
    check_expedition,
    check_heuristic,
    check_order,
)
from usvjax.missions.cruise.orders import tour_order
from usvjax.missions.cruise.params import CruiseParams, CruiseStatic
from usvjax.missions.cruise.result import CruiseResult, result_of
from usvjax.missions.cruise.rounds import (
    PLANNER_OPTIONS,
    PLANNERS,
    SWARMS,
    LegPlanner,
    sail_in_rounds,
)
from usvjax.missions.cruise.sailing import MOST_LANES, Replanning, sail_in_lanes
from usvjax.missions.cruise.straightening import pulled_straight
from usvjax.public import public
from usvjax.search.replan_inputs import check_method
from usvjax.tours.algorithms import NAMES as TOURS
from usvkernels.draws import seeds as seeds_of

PLANNER_METHODS = ("dstar_lite", *PLANNERS)


@public("usvkernels.cruise")
def cruise(
    blocked: Any,
    stations: Any,
    key: Any,
    *,
    method: str = "dstar_lite",
    heuristic: str = "weighted",
    weight: float | None = None,
    planner_options: Mapping[str, Any] | None = None,
    order: Any = None,
    tour: str = "recommended",
    params: CruiseParams | None = None,
    static: CruiseStatic | None = None,
    runs: int | None = None,
    first: int = 0,
    cell_size: float | None = None,
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

    A stop given up (`walled_in`) is UNREACHABLE where there was no way on the map as known, and
    OUT_OF_BUDGET where `plan_paths` only found none.

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
            and nothing else. "weighted" is the paper's improved D* Lite, "chebyshev" (the
            chess-board distance) or "octile" the traditional. The weighted tracks are longer: 2,056
            m against 1,903 m with "octile" in benchmark cruise_rate.
        planner_options: keyword arguments for `plan_paths`: iterations, population or params.
        order: int[B, d] or int[d], stations in the order of the cruise, 0 first; by default that
            of `solve_tour`.
        tour: algorithm of `solve_tour`, where no order is given.
        params: numbers, by default `CruiseParams()`: how often cells flip, how long a vessel waits,
            how fast it is.
        static: choices, by default `CruiseStatic()`: where cells flip, what a vessel sees, what it
            does while it is cut off, how much it may take.
        runs: B, where map and stations are shared.
        first: number of the first cruise, so that the parts of a longer list can be sailed one by
            one; cruise j of this call takes the (first + j)-th part of the key.
        cell_size: m, by default 10 (the paper's); a `GridMap` has its own.
        max_lanes: of "dstar_lite", most cruises under way at once on a device; for measurements.

    Raises:
        BadTypeError: an argument of the wrong type or dtype.
        BadInputError: a wrong shape, fewer than two stations, one that lies outside the map, on a
            blocked cell or on another, an order that is no permutation, an impossible option, a map
            too large for the heuristic, more cruises than memory holds; the message names the
            argument and the first bad row.
    """
    one_of("method", method, PLANNER_METHODS)
    one_of("tour", tour, TOURS)
    params = CruiseParams() if params is None else params
    static = CruiseStatic() if static is None else static
    expedition = check_expedition(blocked, stations, params, static, runs=runs, cell_size=cell_size)
    if method == "dstar_lite":
        expedition = check_heuristic(expedition, heuristic, weight)
    else:
        check_method(heuristic, weight, None)
    max_lanes = whole_number("max_lanes", max_lanes, 1)
    replanning = Replanning(heuristic, weight, expedition.max_expansions, max_lanes)
    first = first_run(first, len(expedition))
    flip_key, tour_key, plan_key = jax.random.split(as_key(key), 3)
    planner = _planner(expedition, method, planner_options, plan_key, first)
    seeds = np.asarray(seeds_of(flip_key, len(expedition), first)).T
    if order is None:
        chosen = tour_order(expedition, tour_key, tour, static.distances, first)
    else:
        chosen = check_order(order, expedition)
    if method == "dstar_lite":
        voyages = sail_in_lanes(expedition, chosen, seeds, replanning)
    else:
        voyages = sail_in_rounds(expedition, chosen, seeds, planner)
    way = pulled_straight(expedition, voyages, seeds)
    return result_of(expedition, chosen, seeds, voyages, way)


def _planner(
    expedition: Expedition,
    method: str,
    options: Mapping[str, Any] | None,
    key: jax.Array,
    first: int,
) -> LegPlanner:
    swarm = method in SWARMS
    if options and not swarm:
        got = shown(options)
        raise BadInputError(f"planner_options: got {got} with method={method!r}; wanted none")
    for name in options or ():
        one_of("planner_options", name, PLANNER_OPTIONS)
    if swarm and expedition.corner_cutting:
        raise BadInputError(f"static.corner_cutting: got True; wanted False with method={method!r}")
    planner = LegPlanner(method, dict(options or {}), key, first)
    if options:
        with saying_where("planner_options"):
            planner.check()
    return planner
