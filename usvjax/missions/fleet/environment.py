"""Current and wind, as users give them: checked, and packed for the kernels."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from usvjax.checks import any_array, float_array, positive, public_name
from usvjax.errors import BadInputError, BadTypeError
from usvjax.missions.fleet.params import MOST_SPEED
from usvjax.paths.inputs import MOST_COORDINATE
from usvkernels.fleet import environment as kernels

LEAST_RADIUS = 1e-3
"""Of a vortex's core (m); its square is to be above 0 in single precision."""

Vector = Any
"""Towards east and north: float[2], or float[B, 2], one per episode."""

Number = Any
"""One number, or float[B], one per episode."""


@dataclass(frozen=True)
class UniformCurrent:
    """The same everywhere.

    Attributes:
        velocity: where it sets (m/s).
    """

    velocity: Vector


@dataclass(frozen=True)
class ShearCurrent:
    """A parallel flow whose speed changes linearly across it.

    Attributes:
        direction: where it sets (rad).
        speed: on the line along it through `place` (m/s).
        rate: what the speed gains per metre to the left of the flow (1/s).
        place: x, y (m).
    """

    direction: Number
    speed: Number
    rate: Number
    place: Vector = (0.0, 0.0)


@dataclass(frozen=True)
class VortexCurrent:
    """A Rankine vortex: turns as a solid inside its core, falls as 1 / distance outside.

    Attributes:
        place: of its centre, x, y (m).
        speed: the largest, at the core's edge (m/s); counter-clockwise, clockwise below 0.
        radius: of the core (m).
    """

    place: Vector
    speed: Number
    radius: Number


@dataclass(frozen=True)
class FieldCurrent:
    """Velocities on a grid, bilinear between the cells' centres; beyond, those of the edge.

    Attributes:
        velocity: float[H, W, 2], towards east and north (m/s); y grows with the row.
        cell_size: m.
        origin: x, y of the corner of cell (0, 0) (m).
    """

    velocity: Any
    cell_size: float
    origin: Any = (0.0, 0.0)


Current = UniformCurrent | ShearCurrent | VortexCurrent | FieldCurrent


@dataclass(frozen=True)
class Environment:
    """What vessels sail in; the default is calm and still.

    Speeds of vessels, commands and limits are through the water. Places, paths and distances are
    over ground: of the current, and of the leeway (`FleetParams.leeway`) that the wind makes.

    Attributes:
        current: of the water; None for none.
        wind: where it blows, and how fast (m/s).
    """

    current: Current | None = None
    wind: Vector = (0.0, 0.0)


def pack(environment: Environment, fleets: int, leeway: Any) -> kernels.Environment:
    """Check an environment, and say it in the kernels' terms; leaves are numbers or [B, 1].

    Args:
        environment: as given.
        fleets: B.
        leeway: of the vessels.

    Raises:
        BadTypeError, BadInputError: naming the field.
    """
    current = environment.current
    if current is None:
        current = UniformCurrent((0.0, 0.0))
    if type(current) not in _PACKED:
        got, names = type(current).__name__, [public_name(kind) for kind in _PACKED]
        raise BadTypeError(f"environment.current: got {got}; wanted {', '.join(names)} or None")
    packed = _PACKED[type(current)](current, fleets)
    wind = _vector("wind", environment.wind, fleets, MOST_SPEED)
    return kernels.Environment(packed, wind, leeway)


def moved(environment: kernels.Environment, origin: np.ndarray) -> kernels.Environment:
    """The environment in coordinates whose origin lies at `origin`, float64[2] (m)."""
    current = environment.current
    if isinstance(current, kernels.Uniform) or not origin.any():
        return environment
    east, north = current.place
    place: Any = {"place": (east - origin[0], north - origin[1])}
    return replace(environment, current=replace(current, **place))


def refuse_fast(environment: kernels.Environment, v_max: Any, present: np.ndarray) -> None:
    """Refuse a drift that is the same everywhere and that a vessel cannot stem.

    Args:
        environment: packed.
        v_max: one number, or float[B or 1, n] (m/s).
        present: bool[B, n].
    """
    if not isinstance(environment.current, kernels.Uniform):
        return
    flow, wind, leeway = environment.current.velocity, environment.wind, environment.leeway
    parts = [
        np.asarray(c) + np.asarray(leeway) * np.asarray(w) for c, w in zip(flow, wind, strict=True)
    ]
    drift = np.broadcast_to(np.hypot(*parts), present.shape)
    most = np.broadcast_to(np.asarray(v_max, np.float64), present.shape)
    bad = (drift >= most) & (drift > 0) & present
    if bad.any():
        row, i = (int(k) for k in np.argwhere(bad)[0])
        beyond = np.degrees(np.arcsin(most[row, i] / drift[row, i]))
        raise BadInputError(
            f"environment: vessel {i} of fleet {row} drifts at {drift[row, i]:g} m/s and makes at "
            f"most {most[row, i]:g} m/s through the water; it cannot reach any goal that bears "
            f"more than {beyond:.0f} deg from where the drift sets"
        )


def _uniform(current: UniformCurrent, fleets: int) -> kernels.Uniform:
    return kernels.Uniform(_vector("current.velocity", current.velocity, fleets, MOST_SPEED))


def _shear(current: ShearCurrent, fleets: int) -> kernels.Shear:
    direction = _number("current.direction", current.direction, fleets)
    return kernels.Shear(
        place=_vector("current.place", current.place, fleets),
        direction=(np.cos(direction), np.sin(direction)),
        speed=_number("current.speed", current.speed, fleets, MOST_SPEED),
        rate=_number("current.rate", current.rate, fleets, 1.0),
    )


def _vortex(current: VortexCurrent, fleets: int) -> kernels.Vortex:
    radius = _number("current.radius", current.radius, fleets)
    if not np.all(radius >= LEAST_RADIUS):
        raise BadInputError(
            f"environment.current.radius: got {np.min(radius):g} m; wanted {LEAST_RADIUS:g} m or "
            "more"
        )
    return kernels.Vortex(
        place=_vector("current.place", current.place, fleets),
        speed=_number("current.speed", current.speed, fleets, MOST_SPEED),
        radius=radius,
    )


def _field(current: FieldCurrent, fleets: int) -> kernels.Field:
    velocity = float_array(
        "environment.current.velocity", current.velocity, (None, None, 2), MOST_SPEED
    )
    if not velocity.size:
        raise BadInputError(
            f"environment.current.velocity: got shape {velocity.shape}; wanted at least one cell"
        )
    origin = float_array("environment.current.origin", current.origin, (2,), MOST_COORDINATE)
    rows_first: Any = np.moveaxis(velocity, -1, 0)
    return kernels.Field(
        velocity=rows_first,
        place=(origin[0], origin[1]),
        cell_size=np.float64(positive("environment.current.cell_size", current.cell_size)),
    )


_PACKED: dict[type, Callable[[Any, int], kernels.Current]] = {
    UniformCurrent: _uniform,
    ShearCurrent: _shear,
    VortexCurrent: _vortex,
    FieldCurrent: _field,
}


def _number(name: str, value: Number, fleets: int, most: float = MOST_COORDINATE) -> Any:
    """A scalar, or float64[B, 1]; at most so much."""
    many = any_array(f"environment.{name}", value, "a number or float[B]").ndim > 0
    array = float_array(f"environment.{name}", value, (fleets,) if many else (), most)
    return array[:, None] if many else array


def _vector(
    name: str, value: Vector, fleets: int, most: float = MOST_COORDINATE
) -> tuple[Any, Any]:
    """Two scalars, or two of float64[B, 1]; at most so much."""
    many = any_array(f"environment.{name}", value, "float[2] or float[B, 2]").ndim == 2
    array = float_array(f"environment.{name}", value, (fleets, 2) if many else (2,), most)
    return (array[:, :1], array[:, 1:]) if many else (array[0], array[1])
