"""Parameters of the dynamic window approach as users write them, flat, and what they may be."""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import lru_cache, partial
from math import floor
from typing import Any

import jax
import numpy as np

from usvjax.checks import LEAST_SINGLE, MOST_SINGLE, any_array, one_of, shown, whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvjax.public import public
from usvkernels.dwa.clearance import Scalar
from usvkernels.dwa.params import Objective, Rules, Sampling, Settings, Vessel
from usvkernels.dwa.window import SLACK
from usvkernels.lanes import LEAST_LANES
from usvkernels.vessel import PLANTS, Plant


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class DwaParams:
    """Numbers of the method; each leaf a float, or float[B] with one value per episode.

    Defaults are Table 1 of Tan et al. 2022; what the paper does not print says so.

    Attributes:
        v_min: smallest speed, astern negative (m/s; at most v_max). Table 1.
        v_max: largest speed, ahead positive (m/s; at least v_min). Table 1.
        w_min: smallest yaw rate, to starboard negative (rad/s; at most w_max). Table 1.
        w_max: largest yaw rate, to port positive (rad/s; at least w_min). Table 1.
        v_acc: most that the speed gains (m/s^2; 0 or more). Table 1.
        v_dec: most that the speed loses, and brakes with, a magnitude (m/s^2; 0 or more). Table 1.
        w_acc: most that the yaw rate gains (rad/s^2; 0 or more). Table 1.
        w_dec: most that the yaw rate loses, and brakes with, a magnitude (rad/s^2; 0 or more).
            Table 1.
        v_step: speed between neighbouring candidates (m/s; above 0). Not printed. v_dec * dt makes
            exactly two; where that is no whole number, a vessel has no candidate at rest, and its
            speeds drift: 1e-5 less, and improved without a cap reaches 9 % of goals instead of 21.
        w_step: yaw rate between neighbouring candidates (rad/s; above 0). Not printed.
        heading_weight: alpha, weight of heading for the goal in the score (any number). Table 1.
        clearance_weight: beta, weight of the distance to obstacles (any number). Table 1.
        velocity_weight: gamma, weight of the speed (any number). Table 1.
        dt: control period, for which a command is held (s; above 0, and short enough that a step
            at full speed is no longer than radius). Not printed.
        search_angle: phi, half the angle of the sector in which the improved method sees
            obstacles (rad; above 0, at most pi). Table 1.
        clearance_cap: largest distance to obstacles that scores (m; 0 or more, inf for no cap).
            Not printed.
        clear_distance: distance to obstacles that scores where none counts (m; above 0). Not
            printed.
        radius: of the circle about an obstacle's centre which must not be entered (m; 0 or more,
            and at least one step dt at full speed). Tables 2 to 4.
        goal_tolerance: distance from the goal at which it is reached (m; above 0). Not printed.
        stuck_distance: a vessel that stays within this (m; 0 or more) for stuck_time is stuck.
            Not printed. A quarter of what the slowest command, one v_step, sails in stuck_time:
            at that product itself rounding decides who is stuck, past it vessels that creep are.
            And between two whole numbers of v_step * dt, by which a straight course grows.
        stuck_time: a vessel that stays within stuck_distance for this (s; above 0) is stuck. Not
            printed.
    """

    v_min: Scalar = -1.0
    v_max: Scalar = 1.0
    w_min: Scalar = -0.5236
    w_max: Scalar = 0.5236
    v_acc: Scalar = 0.2
    v_dec: Scalar = 0.2
    w_acc: Scalar = 0.8727
    w_dec: Scalar = 0.8727
    v_step: Scalar = 0.01
    w_step: Scalar = np.pi / 180
    heading_weight: Scalar = 0.05
    clearance_weight: Scalar = 0.2
    velocity_weight: Scalar = 0.1
    dt: Scalar = 0.1
    search_angle: Scalar = np.pi / 3
    clearance_cap: Scalar = np.inf
    clear_distance: Scalar = 2.0
    radius: Scalar = 0.5
    goal_tolerance: Scalar = 0.5
    stuck_distance: Scalar = 0.0525
    stuck_time: Scalar = 20.0

    @property
    def top_speed(self) -> Any:
        """Largest speed, ahead or astern (m/s), of parameters on the host."""
        return np.maximum(np.abs(self.v_min), np.abs(self.v_max))

    @property
    def sets(self) -> int:
        """How many sets of numbers there are, by the longest leaf; 1 where all are one number."""
        arrays: list[Any] = [leaf for leaf in vars(self).values() if np.iterable(leaf)]
        return max([1, *(len(leaf) for leaf in arrays if hasattr(leaf, "__len__"))])


@dataclass(frozen=True)
class DwaStatic:
    """Sizes and choices of method; hashable, a change compiles anew.

    Attributes:
        method: which obstacles count ("traditional": all of them; "improved": those that the
            search sector at the predicted position meets; Tan et al. 2022, section 3).
        n_v: candidates along the speed (1 to 1000, at least what the window can hold; n_v * n_w at
            most 20,000). In a study as many as the window can hold, when left out.
        n_w: candidates along the yaw rate (1 to 1000, at least what the window can hold). In a
            study as many as that, when left out.
        horizon: steps of the predicted trajectory, which lasts horizon * dt (1 to 10000).
        clearance: where the distance to obstacles is taken ("endpoint": at the predicted
            position, as in Tan's Fig. 1; "trajectory": the least over all predicted positions, as
            its text may mean; "trajectory_and_start": the present one too).
        clearance_score: what of it scores ("distance"; "reciprocal": minus one over the distance
            to the centre).
        normalise: how the parts of the score are made comparable over the admissible candidates
            ("sum": by the sum of magnitudes; "range": to 0..1 between the worst and the best;
            "none").
        braking: whether Eq. 4, able to stop before the obstacle, bounds the candidates (true or
            false).
        plant: how the vessel moves in a control period ("unicycle": along the old heading, then
            it turns, Eq. 1; "heading_first": it turns, then moves, as one widely used demo has
            it; in Python also a function of one's own).
        when_blocked: what a vessel without an admissible candidate does ("brake": both rates
            towards zero; "turn": brake, and turn on towards the goal).
        max_steps: bound on the steps of an episode (1 to 10000000). The default, 150 s, is twice
            the longest time in Tan et al. 2022.

    A plant of one's own is a pure function of jax.numpy, `plant(x, y, psi, v, w, dt)` -> (x, y,
    psi) after the period: x, y (m), psi (rad), v (m/s) and w (rad/s) are float[lanes], dt (s) a
    scalar or float[lanes]; the heading need not be wrapped. It is traced, once for each function
    object, so pass the same one to every call. The method does not know of it: candidates are
    predicted as a unicycle's, `path_length` counts speed through the water, and a drift comes on
    top of the step that `radius` must cover.
    """

    method: str = "traditional"
    n_v: int = 5
    n_w: int = 11
    horizon: int = 30
    clearance: str = "endpoint"
    clearance_score: str = "distance"
    normalise: str = "sum"
    braking: bool = True
    plant: str | Plant = "unicycle"
    when_blocked: str = "brake"
    max_steps: int = 1500

    def __post_init__(self) -> None:
        for name in _MOST:
            if isinstance(value := getattr(self, name), np.integer):
                object.__setattr__(self, name, int(value))  # those of NumPy overflow in products


def split(params: DwaParams, static: DwaStatic) -> Settings:
    """Parameters and choices apart by what they are about, as the kernels take them."""
    given = vars(params) | vars(static)

    def of(kind: Callable[..., Any]) -> Any:
        return kind(**{f.name: given[f.name] for f in fields(kind)})  # type: ignore[arg-type]

    return Settings(of(Vessel), of(Sampling), of(Objective), of(Rules))


@public()
def fit_window(params: DwaParams, static: DwaStatic) -> DwaStatic:
    """The static configuration with as many candidates as the window of `params` can hold.

    Args:
        params: leaves scalar or one value per episode.
        static: whose n_v and n_w are replaced.

    Raises:
        BadTypeError, BadInputError: parameters that `navigate_dwa` refuses.
    """
    check_numbers(params, params.sets)
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
# Of a decision: with more, a program takes minutes to compile and a step of it seconds.
_MOST_COMMANDS, _MOST_POSITIONS = 20_000, 5_000_000
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
    check_numbers(params, episodes)
    _check_static(params, static)


def check_numbers(params: DwaParams, episodes: int | None) -> None:
    """What `check_dwa` asks of `params` alone."""
    values = {f.name: _leaf(f.name, getattr(params, f.name), episodes) for f in fields(params)}
    for name in _POSITIVE:
        fine = values[name] >= LEAST_SINGLE
        _demand(name, values[name], fine, "more than 0 in single precision")
    for name in _NOT_NEGATIVE:
        _demand(name, values[name], values[name] >= 0, "0 or more")
    angle = values["search_angle"]
    _demand("search_angle", angle, (angle > 0) & (angle <= np.pi), "an angle in (0, pi] rad")
    for rate in ("v", "w"):
        low, high = values[f"{rate}_min"], values[f"{rate}_max"]
        _demand(f"{rate}_min", low, low <= high, f"at most {rate}_max = {np.max(high):g}")
    _demand_short_steps(values)


def _demand_short_steps(values: dict[str, Any]) -> None:
    """Collisions are seen at executed positions: a longer step may pass through an obstacle.

    With steps of up to the radius, what stays unseen is at most 13 % of it deep.
    """
    step = DwaParams(**values).top_speed * values["dt"]
    short = values["radius"] >= step * (1.0 - _ROUNDING)
    wanted = f"at least {np.max(step):g} m, one step dt at full speed, or obstacles are jumped"
    _demand("radius", values["radius"], short, wanted)


def _leaf(name: str, value: Any, episodes: int | None) -> np.ndarray:
    array = any_array(f"params.{name}", value, "numbers")
    if array.dtype.kind not in "iuf":
        raise BadTypeError(f"params.{name}: got {shown(value)}; wanted a number")
    if array.ndim and array.shape != (episodes,):
        wanted = "one number" if episodes is None else f"one number, or shape ({episodes},)"
        raise BadInputError(f"params.{name}: got shape {array.shape}; wanted {wanted}")
    array = array.astype(np.float64)
    usable = ~np.isnan(array) if name in _MAY_BE_INFINITE else np.isfinite(array)
    _demand(name, array, usable, "a finite number")
    held = ~np.isfinite(array) | (np.abs(array) <= MOST_SINGLE)
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
    commands = static.n_v * static.n_w
    evaluated = commands * (1 if static.clearance == "endpoint" else static.horizon)
    if commands > _MOST_COMMANDS or evaluated > _MOST_POSITIONS:
        raise BadInputError(
            f"static: {static.n_v} x {static.n_w} candidates of {static.horizon} steps; wanted at "
            f"most {_MOST_COMMANDS:,} candidates, and {_MOST_POSITIONS:,} positions where "
            "clearance is taken along their trajectories"
        )
    if not isinstance(static.braking, bool):
        raise BadTypeError(f"static.braking: got {shown(static.braking)}; wanted a bool")
    _check_plant(static.plant, np.ndim(params.dt) > 0)
    for name, needed in zip(("n_v", "n_w"), window_size(params), strict=True):
        if getattr(static, name) < needed:
            raise BadInputError(
                f"static.{name}: {getattr(static, name)} candidates; the window of these "
                f"parameters holds {needed} (usvjax.fit_window sets both counts)"
            )


def _check_plant(plant: Any, swept_dt: bool) -> None:
    if not isinstance(plant, str) and not callable(plant):
        names = ", ".join(sorted(PLANTS))
        raise BadTypeError(
            f"static.plant: got {shown(plant)}; wanted a function, or one of {names}"
        )
    if isinstance(plant, str):
        one_of("static.plant", plant, PLANTS)
        return
    try:
        hash(plant)
    except TypeError:
        got = shown(plant)
        raise BadTypeError(f"static.plant: got {got}; wanted a function that hashes") from None
    _try_plant(plant, swept_dt)


@lru_cache(maxsize=16)
def _try_plant(plant: Plant, swept_dt: bool) -> None:
    """Trace a user's function once, so that what is wrong with it is said in a sentence."""
    lanes = (LEAST_LANES,)
    real = jax.ShapeDtypeStruct(lanes, np.float32)
    dt = real if swept_dt else jax.ShapeDtypeStruct((), np.float32)
    name = getattr(plant, "__name__", repr(plant))
    wanted = "wanted a function of jax.numpy from (x, y, psi, v, w, dt) to (x, y, psi)"
    try:
        found = jax.eval_shape(plant, real, real, real, real, real, dt)
    except Exception as error:  # whatever a user's function may raise
        first = str(error).partition("\n")[0]
        said = f"{type(error).__name__}: {first}"
        raise BadInputError(f"static.plant: {name} cannot be traced ({said}); {wanted}") from error
    parts = found if isinstance(found, tuple | list) else ()
    if [getattr(part, "shape", None) for part in parts] != [lanes] * 3:
        raise BadInputError(f"static.plant: {name} returned {found}; {wanted}, each float[lanes]")
