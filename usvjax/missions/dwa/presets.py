"""Parameter sets by name: the papers', and those of demos that users know."""

from dataclasses import dataclass, fields, replace
from functools import lru_cache
from math import floor, inf, radians
from typing import Any

import numpy as np

from usvjax.checks import one_of, whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvkernels.dwa.params import DwaParams, DwaStatic
from usvkernels.dwa.window import SLACK

KNOT = 1852.0 / 3600.0  # m/s
NAUTICAL_MILE = 1852.0  # m


@dataclass(frozen=True)
class DwaPreset:
    """Parameters and static configuration that belong together.

    Attributes:
      params: numbers of the method.
      static: sizes and choices, with windows that fit `params`.
      source: where the values come from.
    """

    params: DwaParams
    static: DwaStatic
    source: str


def fit_window(params: DwaParams, static: DwaStatic) -> DwaStatic:
    """The static configuration with as many candidates as the window of `params` can hold.

    Args:
      params: leaves scalar or one value per episode.
      static: whose n_v and n_w are replaced.
    """
    n_v, n_w = window_size(params)
    return replace(static, n_v=n_v, n_w=n_w)


def window_size(params: DwaParams) -> tuple[int, int]:
    """Most candidates (n_v, n_w) that the dynamic window can hold at the given resolution."""
    p = {f.name: np.asarray(getattr(params, f.name), np.float64) for f in fields(params)}
    v_span = np.minimum((p["v_acc"] + p["v_dec"]) * p["dt"], p["v_max"] - p["v_min"])
    w_span = np.minimum((p["w_acc"] + p["w_dec"]) * p["dt"], p["w_max"] - p["w_min"])
    with np.errstate(all="ignore"):  # impossible parameters are refused by `check_dwa`
        most = [np.max(v_span / p["v_step"]), np.max(w_span / p["w_step"])]
    n_v, n_w = (floor(n + SLACK) + 1 if n < 1e9 else 10**9 for n in most)
    return n_v, n_w


def _preset(params: DwaParams, source: str, **choices: Any) -> DwaPreset:
    return DwaPreset(params, fit_window(params, DwaStatic(**choices)), source)


PRESETS: dict[str, DwaPreset] = {
    "tan2022": _preset(
        DwaParams(), "Tan et al. 2022, Table 1; control period, resolutions and caps not printed"
    ),
    "wei2023": _preset(
        DwaParams(
            v_min=0.0,
            v_max=20 * KNOT,
            w_min=-radians(15),
            w_max=radians(15),
            v_acc=2 * KNOT,
            v_dec=2 * KNOT,
            w_acc=radians(5),
            w_dec=radians(5),
            v_step=0.1 * KNOT,
            w_step=radians(1),
            heading_weight=0.1,
            clearance_weight=0.1,
            velocity_weight=0.7,
            # Table 2 prints 0.01 h = 36 s, in which 15 deg/s would turn the vessel by 540 deg.
            dt=1.0,
            clearance_cap=2 * 0.25 * NAUTICAL_MILE,
            clear_distance=2 * 0.25 * NAUTICAL_MILE,
            radius=0.25 * NAUTICAL_MILE,
            goal_tolerance=0.05 * NAUTICAL_MILE,
            stuck_distance=50.0,
            stuck_time=300.0,
        ),
        "Wei & Zhang 2023, Tables 1 and 2; control period 1 s, see docs/equations.md",
        horizon=120,
        max_steps=3600,
    ),
    "lake": _preset(
        DwaParams(
            v_min=0.0,
            v_max=5.0,
            w_min=-0.05,
            w_max=0.05,
            v_acc=0.1,
            v_dec=0.1,
            w_acc=0.01,
            w_dec=0.01,
            v_step=0.1,
            w_step=0.004,
            dt=2.0,
            clearance_cap=500.0,
            clear_distance=500.0,
            radius=150.0,
            goal_tolerance=100.0,
            stuck_distance=50.0,
            stuck_time=200.0,
        ),
        "a survey vessel of 5 m/s on a chart with cells up to 200 m; weights of Tan et al. 2022",
        max_steps=2000,
    ),
    "pythonrobotics": _preset(
        DwaParams(
            v_min=-0.5,
            v_max=1.0,
            w_min=-radians(40),
            w_max=radians(40),
            v_acc=0.2,
            v_dec=0.2,
            w_acc=radians(40),
            w_dec=radians(40),
            v_step=0.01,
            w_step=radians(0.1),
            heading_weight=0.15,
            clearance_weight=1.0,
            velocity_weight=1.0,
            dt=0.1,
            clearance_cap=inf,
            clear_distance=1e5,
            radius=1.0,
            goal_tolerance=1.0,
        ),
        "the dynamic window demo of PythonRobotics: a circular robot of 1 m among point obstacles",
        clearance="trajectory_and_start",
        clearance_score="reciprocal",
        normalise="none",
        braking=False,
        heading_first=True,
    ),
}


def preset(name: str) -> DwaPreset:
    """A parameter set by name: "tan2022", "wei2023", "lake" or "pythonrobotics".

    Raises:
      BadInputError: no such preset; names the nearest.
    """
    one_of("preset", name, PRESETS)
    return PRESETS[name]


_CHOICES: dict[str, tuple[str, ...]] = {
    "method": ("traditional", "improved"),
    "clearance": ("endpoint", "trajectory", "trajectory_and_start"),
    "clearance_score": ("distance", "reciprocal"),
    "normalise": ("sum", "range", "none"),
    "when_blocked": ("brake", "turn"),
}
_POSITIVE = ("v_step", "w_step", "dt", "goal_tolerance", "stuck_time", "clear_distance")
_NOT_NEGATIVE = ("v_acc", "v_dec", "w_acc", "w_dec", "radius", "stuck_distance", "clearance_cap")
_MAY_BE_INFINITE = ("clearance_cap",)
_MOST = {"n_v": 1000, "n_w": 1000, "horizon": 10_000, "max_steps": 10_000_000}
_PLAIN = (bool, int, float, str)
_LARGEST = float(np.finfo(np.float32).max)
_ROUNDING = 1e-6  # of a product such as 3 * 0.1 s


def check_dwa(params: DwaParams, static: DwaStatic, episodes: int | None = None) -> None:
    """Refuse parameters that make no sense, before anything is compiled.

    Args:
      params: leaves scalar, or float[episodes].
      static: choices of method.
      episodes: length that array leaves must have; None where only scalars will do.

    Raises:
      BadTypeError: a leaf that is not a number, or of the wrong class.
      BadInputError: naming the parameter, what it is and what was wanted.
    """
    if not isinstance(params, DwaParams):
        raise BadTypeError(f"params: got {type(params).__name__}; wanted DwaParams")
    if not isinstance(static, DwaStatic):
        raise BadTypeError(f"static: got {type(static).__name__}; wanted DwaStatic")
    leaves = [*vars(params).values(), *vars(static).values()]
    if all(isinstance(leaf, _PLAIN) for leaf in leaves):
        _check_plain(*leaves)
    else:
        _check(params, static, episodes)


@lru_cache(maxsize=256, typed=True)  # the same parameters call after call: 0.4 ms each
def _check_plain(*leaves: Any) -> None:
    count = len(fields(DwaParams))
    _check(DwaParams(*leaves[:count]), DwaStatic(*leaves[count:]), None)


def _check(params: DwaParams, static: DwaStatic, episodes: int | None) -> None:
    values = {f.name: _leaf(f.name, getattr(params, f.name), episodes) for f in fields(params)}
    for name in _POSITIVE:
        single = values[name].astype(np.float32)
        _demand(name, values[name], single > 0, "more than 0 in single precision")
    for name in _NOT_NEGATIVE:
        _demand(name, values[name], values[name] >= 0, "0 or more")
    angle = values["search_angle"]
    _demand("search_angle", angle, (angle > 0) & (angle <= np.pi), "an angle in (0, pi] rad")
    for rate in ("v", "w"):
        low, high = values[f"{rate}_min"], values[f"{rate}_max"]
        _demand(f"{rate}_min", low, low <= high, f"at most {rate}_max = {np.max(high):g}")
    _demand_short_steps(values)
    _check_static(params, static)


def _demand_short_steps(values: dict[str, Any]) -> None:
    """Collisions are seen at executed positions: a longer step may pass through an obstacle.

    With steps of up to the radius, what stays unseen is at most 13 % of it deep.
    """
    step = DwaParams(**values).top_speed * values["dt"]
    short = values["radius"] >= step * (1.0 - _ROUNDING)
    wanted = f"at least {np.max(step):g} m, one step dt at full speed, or obstacles are jumped"
    _demand("radius", values["radius"], short, wanted)


def _leaf(name: str, value: Any, episodes: int | None) -> np.ndarray:
    try:
        array = np.asarray(value)
    except ValueError:
        raise BadInputError(f"params.{name}: rows of unequal length; wanted numbers") from None
    if array.dtype.kind not in "iuf":
        raise BadTypeError(f"params.{name}: got {value!r}; wanted a number")
    if array.ndim and array.shape != (episodes,):
        wanted = "one number" if episodes is None else f"one number, or shape ({episodes},)"
        raise BadInputError(f"params.{name}: got shape {array.shape}; wanted {wanted}")
    array = array.astype(np.float64)
    usable = ~np.isnan(array) if name in _MAY_BE_INFINITE else np.isfinite(array)
    _demand(name, array, usable, "a finite number")
    held = ~np.isfinite(array) | (np.abs(array) <= _LARGEST)
    _demand(name, array, held, "a number that single precision holds")
    return array


def _demand(name: str, value: np.ndarray, holds: np.ndarray, wanted: str) -> None:
    if not np.all(holds):
        value, holds = np.broadcast_arrays(value, holds)
        raise BadInputError(f"params.{name}: got {value[~holds].flat[0]:g}; wanted {wanted}")


def _check_static(params: DwaParams, static: DwaStatic) -> None:
    for name, allowed in _CHOICES.items():
        one_of(f"static.{name}", getattr(static, name), allowed)
    for name, most in _MOST.items():
        if whole_number(f"static.{name}", getattr(static, name), 1) > most:
            raise BadInputError(
                f"static.{name}: got {getattr(static, name)}; wanted at most {most:,}"
            )
    for name in ("braking", "heading_first"):
        if not isinstance(getattr(static, name), bool):
            raise BadTypeError(f"static.{name}: got {getattr(static, name)!r}; wanted a bool")
    for name, needed in zip(("n_v", "n_w"), window_size(params), strict=True):
        if getattr(static, name) < needed:
            raise BadInputError(
                f"static.{name}: {getattr(static, name)} candidates; the window of these "
                f"parameters holds {needed} (usvjax.fit_window sets both counts)"
            )
