"""Vessels that follow their plans, shared out over the devices."""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from usvjax.batches import bucket, few_sizes, filled, most_rows
from usvjax.devices import QUICKLY_COMPILED
from usvjax.missions.cruise.inputs import Expedition
from usvkernels.cruise import following

MOST_CELLS = 1 << 24  # of the maps in one call
LEAST_STEPS = 64  # there is room for at least, in a call


@dataclass(frozen=True)
class Followers:
    """Plans, and the vessels that are to follow them; first axis n.

    Attributes:
        path: int32[n, P, 2], cells (x, y); where there is none, that of the vessel throughout.
        length: int32[n], cells of the path, 0 where there is none.
        proven: bool[n], where there is none, whether that is certain.
        left: int32[n], steps that the leg may still take.
        truth, known: bool[n, H, W], the maps.
        step: int32[n], of the cruise.
        waited: int32[n], steps in a row.
        drawn: bool[n], whether the flips of this step are.
    """

    path: np.ndarray
    length: np.ndarray
    proven: np.ndarray
    left: np.ndarray
    truth: np.ndarray
    known: np.ndarray
    step: np.ndarray
    waited: np.ndarray
    drawn: np.ndarray


@dataclass(frozen=True)
class Halted:
    """The vessels when all have halted; first axis n.

    Attributes:
        truth, known: bool[n, H, W].
        waited, drawn: as in `Followers`.
        halt: int32[n], `following.Halt`.
        at: int32[n], place in the path.
        made: int32[n], steps.
        moves: uint8[n, K], their codes.
    """

    truth: np.ndarray
    known: np.ndarray
    waited: np.ndarray
    drawn: np.ndarray
    halt: np.ndarray
    at: np.ndarray
    made: np.ndarray
    moves: np.ndarray


def follow_paths(
    expedition: Expedition, rows: np.ndarray, seeds: np.ndarray, followers: Followers
) -> Halted:
    """Sail some of the cruises along their paths until each halts.

    Args:
        expedition: all cruises.
        rows: int[n], which of them.
        seeds: uint32[B, 2], of the flips of all.
        followers: of the n.
    """
    height, width = expedition.shape
    room = bucket(max(followers.path.shape[1], LEAST_STEPS))
    path = (followers.path[..., 1] * width + followers.path[..., 0]).astype(np.int32)
    path = filled(path, room, axis=1)
    stations = expedition.stations @ np.array([1, width], np.int32)

    def work(some: np.ndarray, _: int, device: jax.Device) -> tuple[jax.Array, ...]:
        given = {
            "path": path[some].T,
            "length": followers.length[some],
            "proven": followers.proven[some],
            "stations": stations[rows[some]].T,
            "seed": seeds[rows[some]].T,
            "rate": expedition.rate[rows[some]],
            "left": followers.left[some],
            "max_wait": np.int32(expedition.max_wait),
        }
        fleet = (
            followers.truth,
            followers.known,
            followers.step,
            followers.waited,
            followers.drawn,
        )
        given, fleet = jax.device_put((given, tuple(a[some] for a in fleet)), device)
        how = (expedition.scope, expedition.window, expedition.corner_cutting)
        return _follow(following.Orders(**given), *fleet, *how)

    return Halted(*few_sizes(len(rows), most_rows(height * width, MOST_CELLS)).arrays(work))


@partial(jax.jit, static_argnums=(6, 7, 8), compiler_options=QUICKLY_COMPILED)
def _follow(
    orders: following.Orders,
    truth: jax.Array,
    known: jax.Array,
    step: jax.Array,
    waited: jax.Array,
    drawn: jax.Array,
    scope: str,
    window: tuple[int, int],
    corner_cutting: bool,
) -> tuple[jax.Array, ...]:
    """The fields of `Halted`."""
    room = orders.path.shape[0]
    halt = jnp.full_like(step, int(following.Halt.NOT_YET))
    fleet = following.fleet_of(truth, known, step, waited, drawn, halt, room)
    fleet = following.follow(
        orders,
        fleet,
        shape=(truth.shape[1], truth.shape[2]),
        scope=scope,
        window=window,
        corner_cutting=corner_cutting,
    )
    maps = (fleet.truth.reshape(truth.shape), fleet.known.reshape(truth.shape))
    return (*maps, fleet.waited, fleet.drawn, fleet.halt, fleet.at, fleet.made, fleet.moves.T)
