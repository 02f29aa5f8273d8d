"""Points of paths on the host: without those that say nothing, and samples along pieces."""

from collections.abc import Callable
from functools import partial
from math import ceil

import jax
import numpy as np

from usvjax.batches import bucket, few_sizes, sized
from usvjax.devices import QUICKLY_COMPILED
from usvjax.errors import BadInputError
from usvjax.memory import check_memory
from usvkernels.paths import arcs
from usvkernels.paths.turning import STRAIGHT

MOST_SAMPLES = 1 << 24  # of a path; single precision counts no further
_SAMPLE_BYTES = 64  # a sample with heading and curvature, and the copies made of it

Idle = Callable[[np.ndarray, np.ndarray], np.ndarray]


def without_repeats(points: np.ndarray, counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Paths, float64[B, P, 2] and int32[B], without points equal to the one before."""
    return _without(points, counts, _repeating)


def without_idle_points(points: np.ndarray, counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Paths, float64[B, P, 2] and int32[B], without points that repeat or lie on a straight."""
    return _without(*without_repeats(points, counts), _straight_on)


def _without(points: np.ndarray, counts: np.ndarray, idle: Idle) -> tuple[np.ndarray, np.ndarray]:
    keep = ~idle(points, counts) & (np.arange(points.shape[1]) < counts[:, None])
    order = np.argsort(~keep, axis=1, kind="stable")
    counts = keep.sum(axis=1, dtype=np.int32)
    width = max(int(counts.max(initial=0)), 1)
    last = np.maximum(counts - 1, 0)[:, None]
    place = np.take_along_axis(order, np.minimum(np.arange(width), last), axis=1)
    return np.take_along_axis(points, place[..., None], axis=1), counts


def _repeating(points: np.ndarray, counts: np.ndarray) -> np.ndarray:
    same = np.zeros(points.shape[:2], bool)
    same[:, 1:] = (points[:, 1:] == points[:, :-1]).all(axis=-1)
    return same


def _straight_on(points: np.ndarray, counts: np.ndarray) -> np.ndarray:
    straight = np.zeros(points.shape[:2], bool)
    step = np.diff(points, axis=1)
    before, after = step[:, :-1], step[:, 1:]
    along = (before * after).sum(axis=-1)
    across = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
    straight[:, 1:-1] = (along > 0) & (np.abs(across) <= STRAIGHT * along)
    straight &= np.arange(points.shape[1]) < counts[:, None] - 1
    return straight


def polyline_pieces(points: np.ndarray) -> tuple[np.ndarray, ...]:
    """Segments of paths, float64[B, P, 2] without repeats, as `sample_pieces` takes them."""
    step = np.diff(points, axis=1)
    length = np.linalg.norm(step, axis=2).astype(np.float32)
    heading = np.arctan2(step[..., 1], step[..., 0]).astype(np.float32)
    return points[:, :-1], heading, length, np.zeros_like(length)


def sample_room(
    longest: float, spacing: float, rows: int, what: str, least: int = 256, factor: int = 2
) -> int:
    """How many points `sample_pieces` is to make room for on each of some paths.

    Args:
        longest: m, of the paths.
        spacing: m.
        rows: number of paths.
        what: the argument that asks for them and its value, for the message.
        least: points, of the room.
        factor: the room is a power of this.

    Raises:
        BadInputError: more than a path or the machine can have.
    """
    wanted = longest / spacing
    if not wanted < MOST_SAMPLES:
        raise BadInputError(
            f"{what}: that makes {wanted:.3g} samples on a path of {longest:.6g} m; wanted fewer "
            f"than {MOST_SAMPLES:,}"
        )
    room = bucket(max(ceil(wanted) + 2, least), factor)
    check_memory(rows * room * _SAMPLE_BYTES, f"{what}: {rows} x {room} samples")
    return room


def sample_pieces(
    pieces: tuple[np.ndarray, ...], spacing: float, capacity: int
) -> tuple[np.ndarray, ...]:
    """Points along segments and arcs.

    Args:
        pieces: start [B, S, 2], heading, length and curvature [B, S].
        spacing: m.
        capacity: most points of a path.

    Returns:
        float32[B, capacity, 2], points; headings and curvatures there; int32[B], their number.
    """
    width = bucket(max(pieces[1].shape[1], 16), 4)

    def work(rows: np.ndarray, _: int, device: jax.Device) -> tuple[jax.Array, ...]:
        some = tuple(sized(a[rows], width, axis=1).astype(np.float32) for a in pieces)
        return _sample(*jax.device_put((some, np.float32(spacing)), device), capacity)

    return few_sizes(len(pieces[0])).arrays(work)


@partial(jax.jit, static_argnums=2, compiler_options=QUICKLY_COMPILED)
def _sample(
    pieces: tuple[jax.Array, ...], spacing: jax.Array, capacity: int
) -> tuple[jax.Array, ...]:
    return arcs.sample(arcs.Primitives(*pieces), spacing, capacity)
