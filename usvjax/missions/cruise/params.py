"""What a cruise leaves to choose: `CruiseParams`, its numbers, and `CruiseStatic`, its choices."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import numpy as np

from usvjax.checks import any_array, fraction, one_of, positive, truth, whole_number
from usvjax.errors import BadInputError
from usvjax.search.replan_inputs import check_window
from usvkernels.cruise.sailing import SCOPES

DISTANCES = ("straight", "water")
WALLED_IN = ("wait", "skip", "fail")

Scalar = jax.Array | np.ndarray | float


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class CruiseParams:
    """Numbers of cruises; `flip_rate` and `speed` may be float[B], one for each cruise.

    Defaults are those of Yu et al. 2022; what the paper does not print says so.

    Attributes:
        flip_rate: probability with which a cell flips at a step; in [0, 1], to the nearest 2^-24.
        max_wait: steps in a row that a vessel waits while no way to its stop is known, before it
            leaves the stop out, with `walled_in` "wait"; steps; 0 or more.
        speed: how fast the vessel sails; m/s; above 0.
    """

    flip_rate: Scalar = 0.03  # section 5.1
    max_wait: int = 100  # not printed
    speed: Scalar = 10.0  # section 5.1


@dataclass(frozen=True)
class CruiseStatic:
    """Sizes and choices of method of cruises; hashable.

    Attributes:
        distances: what tours add up, where no order is given; "straight" (the paper's), or
            "water", along shortest paths on the first map.
        flip_scope: where cells flip; "window", those that the vessel sees, or "map", all, which
            is noticed where and when they come into view: 3 % a step brings any map to half of
            its cells blocked within a few dozen steps.
        sensing: (h, w), rows and columns of the window about the vessel that it sees; cells; two
            odd whole numbers of 3 or more.
        corner_cutting: whether moves and chords may pass the corner of a blocked cell; true or
            false, of methods "aco", "ga" and "cmpso" false.
        walled_in: what a vessel does while no way to its stop is known; "wait", up to `max_wait`
            steps in a row, and then leave the stop out, "skip" it at once, or "fail" at once.
        max_steps: moves and waits of a leg; steps; 1 or more. By default 8 times height plus width
            of the map, with D* Lite at most as many as its keys can count on a map of this size:
            5,694 on 854 x 730 cells with heuristic "weighted", 8,577 with "octile" or "chebyshev".
        max_expansions: of D* Lite in one step, before it is given up (OUT_OF_BUDGET); cells; 1 or
            more. By default 16 for each cell of the map.
    """

    distances: str = "straight"
    flip_scope: str = "window"
    sensing: tuple[int, int] = (5, 5)  # Yu et al. 2022, section 5.1
    corner_cutting: bool = False
    walled_in: str = "wait"
    max_steps: int | None = None
    max_expansions: int | None = None


def check_params(params: CruiseParams, count: int) -> CruiseParams:
    """Refuse numbers that make no sense.

    Args:
        params: of `count` cruises.
        count: B.

    Returns:
        The same with float64[B] for leaves that may differ between cruises.

    Raises:
        BadTypeError: a leaf that is no number.
        BadInputError: naming the leaf, what it is and what was wanted.
    """
    return CruiseParams(
        flip_rate=_of_each("params.flip_rate", params.flip_rate, count, fraction),
        max_wait=whole_number("params.max_wait", params.max_wait, 0),
        speed=_of_each("params.speed", params.speed, count, positive),
    )


def check_static(static: CruiseStatic) -> CruiseStatic:
    """Refuse choices that there are not.

    Returns:
        The same with plain numbers of Python.

    Raises:
        BadTypeError: a field of the wrong type.
        BadInputError: naming the field, what it is and what was wanted.
    """
    one_of("static.distances", static.distances, DISTANCES)
    one_of("static.flip_scope", static.flip_scope, SCOPES)
    one_of("static.walled_in", static.walled_in, WALLED_IN)
    return CruiseStatic(
        distances=static.distances,
        flip_scope=static.flip_scope,
        sensing=check_window(static.sensing, "static.sensing"),
        corner_cutting=truth("static.corner_cutting", static.corner_cutting),
        walled_in=static.walled_in,
        max_steps=_bound("static.max_steps", static.max_steps),
        max_expansions=_bound("static.max_expansions", static.max_expansions),
    )


def _bound(name: str, value: Any) -> int | None:
    return None if value is None else whole_number(name, value, 1)


def _of_each(name: str, value: Any, count: int, check: Callable[[str, Any], float]) -> np.ndarray:
    """A number for each cruise, float64[B], from one or B of them."""
    if isinstance(value, jax.Array | np.ndarray):
        value = any_array(name, value, "real numbers")
        if value.ndim > 1:
            raise BadInputError(f"{name}: got shape {value.shape}; wanted one, or {count} numbers")
        value = value[()]  # a number where there is no axis
    if not isinstance(value, np.ndarray | list | tuple):
        return np.full(count, check(name, value))
    if len(value) != count:
        raise BadInputError(f"{name}: got {len(value)} numbers; wanted one, or {count}")
    return np.array([check(f"{name}[{i}]", one) for i, one in enumerate(value)])
