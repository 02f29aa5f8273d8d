"""One decision of the dynamic window approach opened up."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from usvjax.checks import MOST_SINGLE, float_array
from usvjax.errors import BadInputError
from usvjax.maps.sensed import padded
from usvjax.memory import check_memory
from usvjax.missions.dwa.inputs import refuse_remote
from usvjax.missions.dwa.params import DwaParams, DwaStatic, check_dwa, split
from usvjax.public import public
from usvkernels.dwa import candidates, window


@dataclass(frozen=True)
class DwaCandidates:
    """One decision opened up; numpy arrays.

    Attributes:
        v: float32[n_v], candidate speeds (m/s).
        w: float32[n_w], candidate yaw rates (rad/s).
        end: float32[n_v, n_w, 2], predicted positions (m).
        paths: float32[n_v, n_w, horizon + 1, 2], predicted trajectories (m).
        clearance: float32[n_v, n_w], dist (m), capped.
        admissible: bool[n_v, n_w].
        score: float32[n_v, n_w], -inf where not admissible.
        chosen: (i, j) of the executed candidate; None where none is admissible.
        command: (v, w) executed (m/s, rad/s).
    """

    v: np.ndarray
    w: np.ndarray
    end: np.ndarray
    paths: np.ndarray
    clearance: np.ndarray
    admissible: np.ndarray
    score: np.ndarray
    chosen: tuple[int, int] | None
    command: tuple[float, float]


@public("usvkernels.dwa")
def dwa_candidates(
    obstacles: Any,
    state: Any,
    goal: Any,
    *,
    params: DwaParams | None = None,
    static: DwaStatic | None = None,
) -> DwaCandidates:
    """Open up one decision: what each command of the window leads to and how it scores.

    Args:
        obstacles: float[K, 2], centres (m).
        state: float[5], x (m), y (m), psi (rad), v (m/s), w (rad/s).
        goal: float[2] (m). Coordinates stay below 200 km, as of `navigate_dwa`.
        params: defaults to Tan's Table 1; scalars.
        static: choices of method.

    Raises:
        BadTypeError, BadInputError: as `navigate_dwa`.
    """
    params = DwaParams() if params is None else params
    static = DwaStatic() if static is None else static
    check_dwa(params, static)
    points = float_array("obstacles", obstacles, (None, 2))
    now = float_array("state", state, (5,))
    _demand_single("state", now)
    _check_size(static)
    target = float_array("goal", goal, (2,))
    for name, point in (("state", now[:2]), ("goal", target)):
        refuse_remote(name, point[None])
    motion = window.Motion(jnp.asarray(now[:, None], jnp.float32))
    centres = jnp.asarray(padded(points[None])[0])[:, :, None]
    ahead = jnp.asarray(target[:, None], jnp.float32)
    numbers = jax.tree.map(np.float32, params)  # the same program for whole numbers
    found, paths, (row, column, any_admissible), command = _open_up(
        numbers, static, motion, centres, ahead
    )
    return DwaCandidates(
        v=np.asarray(found.v[:, 0]),
        w=np.asarray(found.w[:, 0]),
        end=np.stack([found.end_x[..., 0], found.end_y[..., 0]], -1),
        paths=np.asarray(paths[..., 0, :]),
        clearance=np.asarray(found.clearance[..., 0]),
        admissible=np.asarray(found.admissible[..., 0]),
        score=np.asarray(found.score[..., 0]),
        chosen=(int(row[0]), int(column[0])) if bool(any_admissible[0]) else None,
        command=(float(command[0][0]), float(command[1][0])),
    )


def _demand_single(name: str, array: np.ndarray) -> None:
    large = np.abs(array) > MOST_SINGLE
    if large.any():
        raise BadInputError(
            f"{name}: got {array[large][0]:g}; wanted numbers that single precision holds"
        )


def _check_size(static: DwaStatic) -> None:
    """Refuse predicted paths that memory does not hold, on the device and on the host."""
    commands = static.n_v * static.n_w
    check_memory(
        4 * commands * (2 * 2 * (static.horizon + 1) + _FIGURES),
        f"static: {static.n_v} x {static.n_w} candidates of {static.horizon} steps",
    )


_FIGURES = 16  # of a candidate, beside its path


@partial(jax.jit, static_argnames="static")
def _open_up(
    params: DwaParams,
    static: DwaStatic,
    motion: window.Motion,
    obstacles: jax.Array,
    goal: jax.Array,
) -> tuple[candidates.Candidates, jax.Array, candidates.Choice, candidates.Command]:
    vessel, sampling, objective, rules = split(params, static)
    sight = motion, obstacles, rules.radius, goal
    found = candidates.candidates(vessel, sampling, objective, *sight)
    paths = window.predicted_paths(vessel, sampling, motion)
    command = candidates.decide(vessel, sampling, objective, *sight)
    return found, paths, candidates.choose(found), command
