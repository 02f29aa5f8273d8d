"""Way points of tracks pulled straight, in blocks shared out over the devices."""

from dataclasses import dataclass
from functools import partial

import jax
import numpy as np

from usvjax.batches import bucket, few_sizes, filled, most_rows, sized
from usvjax.devices import QUICKLY_COMPILED
from usvjax.missions.cruise.inputs import Expedition
from usvjax.missions.cruise.voyages import Voyages
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
    stop = _stops(voyages)
    height, width = expedition.shape

    def work(rows: np.ndarray, _: int, device: jax.Device) -> tuple[jax.Array]:
        arrays = {
            "blocked": expedition.blocked[expedition.layers(rows)],
            "track": filled(voyages.track[rows], room, axis=1).transpose(1, 0, 2),
            "steps": voyages.steps[rows],
            "stop": sized(stop[rows], room, axis=1).T,
            "stations": (expedition.stations[rows] @ np.array([1, width], np.int32)).T,
            "seed": seeds[rows].T,
            "rate": expedition.rate[rows],
        }
        sailed = Sailed(**jax.device_put(arrays, device))
        kept = _straighten(sailed, expedition.scope, expedition.window, expedition.corner_cutting)
        return (kept.T,)

    (kept,) = few_sizes(len(expedition), most_rows(height * width, MOST_CELLS)).arrays(work)
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
