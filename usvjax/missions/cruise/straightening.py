"""Way points of tracks pulled straight, in blocks shared out over the devices."""

from dataclasses import dataclass
from functools import partial

import jax
import numpy as np

from usvjax.missions.cruise.inputs import Expedition
from usvjax.missions.cruise.voyages import Voyages
from usvjax.paths.blocks import QUICKLY_COMPILED, SIZES, bucket, in_blocks
from usvkernels.cruise.straighten import Sailed, straighten
from usvkernels.status import Status

MOST_CELLS = 1 << 24  # of the maps in one call
LEAST_STEPS = 256  # there is room for at least, so that few sizes are compiled


@dataclass(frozen=True)
class WayPoints:
    """Tracks through some of their points.

    Attributes:
      cells: int32[B, Q, 2], cells (x, y); the last is repeated.
      step: int32[B, Q], when the vessel is there; the last is repeated.
      count: int32[B].
    """

    cells: np.ndarray
    step: np.ndarray
    count: np.ndarray


def pulled_straight(expedition: Expedition, voyages: Voyages, seeds: np.ndarray) -> WayPoints:
    """Pull tracks straight; see `usvkernels.cruise.straighten`.

    Args:
      expedition: the cruises.
      voyages: how they went.
      seeds: uint32[B, 2], of their flips.
    """
    room = bucket(max(voyages.track.shape[1], LEAST_STEPS), 4)
    padded = np.minimum(np.arange(room), voyages.track.shape[1] - 1)
    stop = _stops(voyages)
    height, width = expedition.shape
    most = max((n for n in SIZES if n * height * width <= MOST_CELLS), default=1)

    def work(rows: np.ndarray) -> tuple[jax.Array]:
        numbers = expedition.stations[rows] @ np.array([1, width], np.int32)
        stops = np.zeros((len(rows), room), bool)
        stops[:, : stop.shape[1]] = stop[rows]
        sailed = Sailed(
            blocked=expedition.blocked[expedition.layers(rows)],
            track=voyages.track[rows][:, padded].transpose(1, 0, 2),
            steps=voyages.steps[rows],
            stop=jax.device_put(stops.T),
            stations=numbers.T,
            seed=seeds[rows].T,
            rate=expedition.rate[rows],
        )
        kept = _straighten(sailed, expedition.scope, expedition.window, expedition.corner_cutting)
        return (kept.T,)

    (kept,) = in_blocks(work, len(expedition), most)
    return _way_points(voyages.track, kept[:, : voyages.track.shape[1]])


@partial(jax.jit, static_argnums=(1, 2, 3), compiler_options=QUICKLY_COMPILED)
def _straighten(
    sailed: Sailed, scope: str, window: tuple[int, int], corner_cutting: bool
) -> jax.Array:
    return straighten(sailed, scope=scope, window=window, corner_cutting=corner_cutting)


def _stops(voyages: Voyages) -> np.ndarray:
    """bool[B, T + 1]: where points are kept, home, the stations visited and the last step."""
    stop = np.zeros(voyages.track.shape[:2], bool)
    row, leg = np.nonzero(voyages.leg_status == int(Status.REACHED))
    stop[row, voyages.leg_step[row, leg]] = True
    stop[:, 0] = True
    stop[np.arange(len(stop)), voyages.steps] = True
    return stop


def _way_points(track: np.ndarray, kept: np.ndarray) -> WayPoints:
    count = kept.sum(axis=1, dtype=np.int32)
    step = np.argsort(~kept, axis=1, kind="stable")[:, : count.max()]
    slot = np.minimum(np.arange(step.shape[1]), count[:, None] - 1)
    step = np.take_along_axis(step, slot, axis=1).astype(np.int32)
    return WayPoints(np.take_along_axis(track, step[..., None], axis=1), step, count)
