"""What `navigate` is given, checked and packed: fleets, their ground, their routes."""

from dataclasses import dataclass, replace
from typing import Any

import jax
import numpy as np

from usvjax.angles import wrapped
from usvjax.checks import any_array, float_array
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps.sensed import MOST_REMOTE
from usvjax.missions.fleet.environment import Environment, moved, refuse_fast
from usvjax.missions.fleet.environment import pack as pack_environment
from usvjax.missions.fleet.ground import Ground
from usvjax.missions.fleet.params import FleetParams, FleetStatic, check_params
from usvjax.missions.fleet.places import Place, place
from usvjax.missions.fleet.routes import Plan, lay
from usvjax.paths.inputs import MOST_COORDINATE
from usvkernels.dwa.charted import Charted
from usvkernels.fleet import environment as kernels
from usvkernels.fleet.state import ABSENT, Jobs

MOST_VESSELS = 256
"""In a fleet: pairs are its square."""


@dataclass(frozen=True)
class Voyage:
    """Checked fleets on the host.

    Attributes:
        start: float64[B, n, 4], x (m), y (m), psi (rad), v (m/s).
        goal: float64[B, n, 2] (m).
        heading: float64[B, n] (rad), or None.
        status: int32[B, n], at the start.
        plan: their routes.
        params: numbers in force in this scene.
        origin: float64[2] (m), what was subtracted from the world's coordinates.
        obstacles: float32[B or 1, 2, K], centres (m), FAR pads; None on a shared map.
        velocities: float32[B or 1, 2, K], of obstacles (m/s); None where all are at rest.
        chart: the shared map; None among circles.
        environment: in coordinates less the origin; None for neither current nor wind.
    """

    start: np.ndarray
    goal: np.ndarray
    heading: np.ndarray | None
    status: np.ndarray
    plan: Plan
    params: FleetParams
    origin: np.ndarray
    obstacles: np.ndarray | None
    velocities: np.ndarray | None
    chart: Charted | None
    environment: kernels.Environment | None

    @property
    def shape(self) -> tuple[Any, ...]:
        """What of it decides a program."""
        sensed: Any = self.obstacles if self.chart is None else self.chart.table
        whose = _whose(self.obstacles), _whose(self.velocities)
        return self.plan.routes.points.shape[1:], np.shape(sensed)[1:], whose

    def rows(self, rows: np.ndarray) -> Jobs:
        """The fleets of the given rows, in single precision."""
        tables: dict[str, Any] = {
            "start": self.start[rows].astype(np.float32),
            "status": self.status[rows],
            "obstacles": _own(self.obstacles, rows),
            "velocities": _own(self.velocities, rows),
        }
        routes = jax.tree.map(lambda leaf: leaf[rows], self.plan.routes)
        return Jobs(routes=routes, chart=self.chart, **tables)

    def expected_time(self) -> np.ndarray:
        """Guess how long each fleet sails (s), float64[B]: enough to tell long from short."""
        return np.max(self.plan.length / np.asarray(self.params.v_max), axis=1)


def _whose(table: np.ndarray | None) -> str:
    if table is None:
        return "nobody's"
    return "all fleets'" if len(table) == 1 else "each fleet's"


def _own(table: np.ndarray | None, rows: np.ndarray) -> np.ndarray | None:
    return table if table is None or len(table) == 1 else table[rows]


def pack(
    scene: Any,
    starts: Any,
    goals: Any,
    headings: Any,
    valid: Any,
    speeds: Any,
    velocities: Any,
    environment: Environment | None,
    params: FleetParams,
    static: FleetStatic,
    ends: str = "goals",
    via: np.ndarray | None = None,
) -> Voyage:
    """Check and pack the fleets of `navigate`, whose docstring says what is what.

    Args:
        scene, starts, goals, headings, valid, speeds, velocities: as given.
        environment, params, static: as given, or by default.
        ends: what goals are called in messages.
    """
    start = start_places(starts)
    shape = start.shape[:2]
    goal = float_array(ends, goals, (*shape, 2), MOST_COORDINATE)
    heading = None
    if headings is not None:
        heading = float_array("headings", headings, shape, MOST_COORDINATE)
    speed = np.zeros(shape) if speeds is None else float_array("speeds", speeds, shape)
    present = presence(valid, shape)
    params = check_params(params, static, shape)
    _check_speed(speed, params)
    hull = np.broadcast_to(params.hull_radius, shape)
    surrounding = None
    if environment is not None:
        leeway = params.leeway if static.model == "unicycle" else 0.0
        surrounding = pack_environment(environment, shape[0], leeway)
        refuse_fast(surrounding, params.v_max, present)
    where = place(scene, velocities, shape[0], hull, params, static)
    start, goal = start - np.append(where.origin, 0.0), goal - where.origin
    for name, points in (("starts", start[..., :2]), (ends, goal)):
        _refuse_remote(name, points, where.origin)
        _refuse_overlap(name, points, hull, present)
        ground = where.at_start if name == "starts" else where.ground
        _refuse_inside(name, points, present, where, ground)
    plan = lay(
        where.ground,
        start[..., :2],
        goal,
        heading,
        where.reach,
        static,
        None if via is None else via - where.origin,
    )
    psi = wrapped(start[..., 2])
    return Voyage(
        start=np.stack([start[..., 0], start[..., 1], psi, speed], axis=-1),
        goal=goal,
        heading=heading,
        status=np.where(present, plan.status, ABSENT).astype(np.int32),
        plan=plan,
        params=replace(params, obstacle_radius=where.obstacle_radius),
        origin=where.origin,
        obstacles=where.obstacles,
        velocities=where.velocities,
        chart=where.chart,
        environment=surrounding and moved(surrounding, where.origin),
    )


def start_places(starts: Any) -> np.ndarray:
    """The starts of B fleets of n vessels, float64[B, n, 3], both at least 1."""
    start = float_array("starts", starts, (None, None, 3), MOST_COORDINATE)
    if not start.shape[0] >= 1 or not 1 <= start.shape[1] <= MOST_VESSELS:
        raise BadInputError(
            f"starts: got shape {start.shape}; wanted at least one fleet of 1 to {MOST_VESSELS} "
            "vessels"
        )
    return start


def presence(valid: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Which places in the fleets are taken, bool[B, n]."""
    if valid is None:
        return np.ones(shape, bool)
    mask = any_array("valid", valid, "bools")
    if mask.dtype != bool:
        raise BadTypeError(f"valid: got dtype {mask.dtype}; wanted bool")
    if mask.shape != shape:
        raise BadInputError(f"valid: got shape {mask.shape}; wanted {shape}, as the starts")
    if not mask.any(axis=1).all():
        row = int(np.argmin(mask.any(axis=1)))
        raise BadInputError(f"valid: fleet {row} has no vessel; wanted at least one")
    return mask


def _check_speed(speed: np.ndarray, params: FleetParams) -> None:
    most = np.broadcast_to(params.v_max, speed.shape)
    bad = (speed < 0) | (speed > most * (1 + 1e-6))
    if bad.any():
        row, i = (int(k) for k in np.argwhere(bad)[0])
        raise BadInputError(
            f"speeds: vessel {i} of fleet {row} starts at {speed[row, i]:g} m/s; wanted 0 to "
            f"v_max, {most[row, i]:g} m/s"
        )


def _refuse_remote(name: str, points: np.ndarray, origin: np.ndarray) -> None:
    remote = np.any(np.abs(points) > MOST_REMOTE, axis=-1)
    if remote.any():
        row, i = (int(k) for k in np.argwhere(remote)[0])
        x, y = points[row, i] + origin
        raise BadInputError(
            f"{name}: vessel {i} of fleet {row} lies at ({x:g}, {y:g}) m; wanted within "
            f"{MOST_REMOTE:g} m of ({origin[0]:g}, {origin[1]:g}), for single precision: subtract "
            "a local origin"
        )


def _refuse_overlap(name: str, points: np.ndarray, hull: np.ndarray, present: np.ndarray) -> None:
    for i in range(1, points.shape[1]):
        apart = np.linalg.norm(points[:, :i] - points[:, i : i + 1], axis=2)
        near = apart < hull[:, :i] + hull[:, i : i + 1]
        near &= present[:, :i] & present[:, i : i + 1]
        if near.any():
            row, j = (int(k) for k in np.argwhere(near)[0])
            need = hull[row, i] + hull[row, j]
            raise BadInputError(
                f"{name}: vessels {j} and {i} of fleet {row} are {apart[row, j]:g} m apart; wanted "
                f"at least {need:g} m, their hulls"
            )


def _refuse_inside(
    name: str, points: np.ndarray, present: np.ndarray, where: Place, ground: Ground
) -> None:
    fleets, n = present.shape
    flat = points.reshape(-1, 2)
    rows = np.repeat(np.arange(fleets), n)
    clear = ground.clear(rows, flat, flat, where.reach.reshape(-1))
    bad = ~clear.reshape(fleets, n) & present
    if bad.any():
        row, i = (int(k) for k in np.argwhere(bad)[0])
        x, y = points[row, i] + where.origin
        raise BadInputError(
            f"{name}: vessel {i} of fleet {row} at ({x:g}, {y:g}) m touches an obstacle, or lies "
            f"off the map; wanted it {where.reach[row, i]:g} m from every obstacle's centre"
        )
