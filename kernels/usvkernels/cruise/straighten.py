"""A track pulled straight, clear of all that was blocked while it was sailed.

Yu et al. 2022, section 4.2.2, keep a point where the line of sight from the last point kept is
about to be lost, on one map. Here cells flip under way: a chord that replaces some steps must be
clear on the map of each of them, since somewhere on the chord is where the vessel is meanwhile.
So a lane carries which cells were blocked at any step since its last point kept.
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.cruise.flips import flipped, view, view_flips
from usvkernels.paths.charts import Charts
from usvkernels.paths.smoothing import line_of_sight


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Sailed:
    """Tracks, one per lane, and what their maps were.

    Attributes:
        blocked: bool[lanes, H, W], the first maps.
        track: int32[T + 1, lanes, 2], cells (x, y) after each step.
        steps: int32[lanes], at most T.
        stop: bool[T + 1, lanes], True at the last step and where a point is to be kept.
        stations: int32[d, lanes], cells that never flip, row * W + column.
        seed: uint32[2, lanes], of the flips.
        rate: int32[lanes], probability of a flip times 2^`flips.BITS`.
    """

    blocked: Array
    track: Array
    steps: Array
    stop: Array
    stations: Array
    seed: Array
    rate: Array


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Pull:
    """Tracks being pulled straight; planes flat, lanes one after the other."""

    truth: Array  # bool[lanes * H * W], the map now
    met: Array  # bool[lanes * H * W], blocked at some step since the last point kept
    last: Array  # int32[lanes], step of the last point kept
    kept: Array  # bool[T + 1, lanes]


def straighten(
    sailed: Sailed, *, scope: str, window: tuple[int, int], corner_cutting: bool
) -> Array:
    """Choose the points to keep.

    Args:
        sailed: the tracks.
        scope: where cells flip, as `sailing.SCOPES`.
        window: (h, w) of the vessel's view, in which they do.
        corner_cutting: as `line_of_sight`.

    Returns:
        bool[T + 1, lanes].
    """
    lanes, height, width = sailed.blocked.shape
    first = jnp.arange(lanes, dtype=jnp.int32) * (height * width)

    def on(step: Array, pull: _Pull) -> _Pull:
        under_way = step < sailed.steps
        here, ahead = sailed.track[step], sailed.track[step + 1]
        pull = flip(step, under_way, here, pull)
        held = sailed.stop[step]
        last = jnp.where(held, step, pull.last)
        start = jnp.take_along_axis(sailed.track, last[None, :, None], axis=0)[0]
        charts = Charts(pull.met, first, jnp.int32(height), jnp.int32(width))
        end = jnp.where(under_way[:, None], ahead, start)
        clear = line_of_sight(charts, start, end, corner_cutting=corner_cutting)
        # Not clear from the last point: the step before was, so this one is kept. From there on
        # count the maps of now and later; the step ahead itself is one that was sailed.
        anew = under_way & (held | ~clear)
        return _Pull(
            truth=pull.truth,
            met=_copied(anew, pull.truth, pull.met),
            last=jnp.where(anew, step, last),
            kept=pull.kept.at[step].set(pull.kept[step] | anew),
        )

    def flip(step: Array, under_way: Array, here: Array, pull: _Pull) -> _Pull:
        if scope == "map":
            number = jnp.arange(height * width, dtype=jnp.int32)
            flips = flipped(sailed.seed[:, :, None], step, number, sailed.rate[:, None])
            own = here[:, 1] * width + here[:, 0]
            fixed = jnp.concatenate([sailed.stations, own[None]]) + first
            flips = (flips & under_way[:, None]).reshape(-1).at[fixed].set(False)
            truth = pull.truth ^ flips
            return _Pull(truth, pull.met | truth, pull.last, pull.kept)
        seen = view(here[:, 0], here[:, 1], window, width, height)
        number = seen.row * width + seen.column
        flips = view_flips(sailed.seed, step, sailed.rate, seen, width) & under_way
        flips &= jnp.all(number != sailed.stations[:, None], axis=0)
        place = jnp.where(flips, first + number, pull.truth.shape[0])
        now = ~pull.truth.at[place].get(mode="clip")
        truth = pull.truth.at[place].set(now, mode="drop")
        return _Pull(truth, pull.met.at[place].max(now, mode="drop"), pull.last, pull.kept)

    planes = sailed.blocked.reshape(-1)
    zero = jnp.zeros(lanes, jnp.int32)
    begun = _Pull(planes, planes, zero, sailed.stop)
    return lax.fori_loop(0, jnp.max(sailed.steps), on, begun).kept


def _copied(which: Array, source: Array, target: Array) -> Array:
    """Planes of `target` with those of some lanes, bool[lanes], as in `source`."""
    size = source.shape[0] // which.shape[0]
    order = jnp.argsort(~which, stable=True).astype(jnp.int32)

    def copy(i: Array, target: Array) -> Array:
        at = (order[i] * size,)
        return lax.dynamic_update_slice(target, lax.dynamic_slice(source, at, (size,)), at)

    return lax.fori_loop(0, jnp.sum(which, dtype=jnp.int32), copy, target)
