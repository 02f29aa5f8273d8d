"""Batches: rows dealt into blocks of few sizes, run on the devices, and put together again."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import jax
import numpy as np

from usvjax.devices import chosen_devices, share_out
from usvjax.programs import make_room

SIZES = (8, 64, 512)
"""Rows in one call of a device; few sizes, since each is compiled."""

MOST_PADDED = 1.5
"""Times the rows that a batch has, padding included; a small batch is padded to SIZES[0]."""

Work = Callable[[np.ndarray, int, jax.Device], Any]


@dataclass(frozen=True)
class Batch:
    """Rows in blocks, each of which is one call of a device.

    Attributes:
        blocks: int[n_k] each, the rows; every row in one of them.
        size: rows of a call, of which those past a block's last repeat it: so shapes stay those
            that are compiled already.
        devices: those that take part.
    """

    blocks: list[np.ndarray]
    size: int
    devices: list[jax.Device]

    def run(self, work: Work, at_once: bool = False) -> list[Any]:
        """Run the blocks, each device taking the next when it is free.

        Args:
            work: called from one thread per device with the rows int[size], how many of them are
                no padding, and the device; puts its arrays there.
            at_once: where no device has more than one block, begin all of them from the calling
                thread: threads, which start and wait for the interpreter, take 3 ms of a call.
                Only if nothing is left to compile, which would be done one after the other.

        Returns:
            What each block's work returned, in the order of the blocks, arrays on the host.
        """
        if at_once and len(self.blocks) <= len(self.devices):
            make_room()
            pairs = zip(self.blocks, self.devices[: len(self.blocks)], strict=True)
            # All begin before the first is waited for.
            begun = [work(filled(rows, self.size), len(rows), device) for rows, device in pairs]
            return [jax.device_get(found) for found in begun]
        return list(self.each(work))

    def each(self, work: Work) -> Iterator[Any]:
        """As `run`, but a block as soon as it is done.

        What the caller makes of it costs nothing while devices work on the others.
        """

        def on_device(rows: np.ndarray, device: jax.Device) -> Any:
            return jax.device_get(work(filled(rows, self.size), len(rows), device))

        make_room()
        yield from share_out(on_device, self.blocks, self.devices)

    def join(self, parts: Sequence[Any], axis: int = 0) -> np.ndarray:
        """One array of an array per block: without padding, the rows in ascending order.

        Args:
            parts: an array of each block; `size` on `axis`, or no padding there.
            axis: of the rows.
        """
        cut = [
            part[_along(axis, slice(len(rows)))]
            for part, rows in zip(parts, self.blocks, strict=True)
        ]
        joined = np.concatenate(cut, axis=axis)
        return joined if self._place is None else joined.take(self._place, axis=axis)

    def arrays(self, work: Work, axis: int = 0) -> tuple[np.ndarray, ...]:
        """`run` work that returns a tuple of arrays, and `join` them."""
        return tuple(self.join(parts, axis) for parts in zip(*self.run(work), strict=True))

    @cached_property
    def _place(self) -> np.ndarray | None:
        """Of each row among the blocks' results; None where they are in order."""
        rows = np.concatenate(self.blocks)
        return None if np.all(rows[:-1] < rows[1:]) else np.argsort(rows)


def _along(axis: int, rows: slice) -> tuple[Any, ...]:
    return (..., rows) if axis == -1 else (slice(None),) * axis + (rows,)


# --- dealing ----------------------------------------------------------------------------------


def split(rows: np.ndarray, most: int) -> list[np.ndarray]:
    """Rows in even blocks of at most `most`, as few as can be."""
    return np.array_split(rows, -(-len(rows) // most)) if len(rows) else []


def deal(rows: np.ndarray, most: int, devices: int, least: int = 1) -> list[np.ndarray]:
    """Rows in even blocks of at most `most`, as many for each device.

    Args:
        rows: int[n].
        most: rows in a block.
        devices: number of devices.
        least: rows for which another device is worth it.
    """
    return np.array_split(rows, _blocks(len(rows), most, devices, least)) if len(rows) else []


def deal_longest_first(work: np.ndarray, most: int, devices: int) -> list[np.ndarray]:
    """The rows of work[n] in blocks as `deal` makes them, all alike and longest first.

    Work that is long and starts late is what a device ends with, in lanes of which most idle.
    """
    longest_first = np.argsort(-work, kind="stable")
    blocks = _blocks(len(work), most, devices)
    return [longest_first[block::blocks] for block in range(blocks)]


def deal_groups(rows: np.ndarray, size: int, most: int, devices: int) -> list[np.ndarray]:
    """Rows in blocks of whole groups of `size`, at most `most` of them, dealt as `deal` does."""
    groups = np.arange(-(-len(rows) // size))
    return [rows[part[0] * size : (part[-1] + 1) * size] for part in deal(groups, most, devices)]


def _blocks(rows: int, most: int, devices: int, least: int = 1) -> int:
    per_device = -(-rows // (most * devices))
    return min(-(-rows // least), per_device * devices)


def few_sizes(count: int, most: int = SIZES[-1], order: np.ndarray | None = None) -> Batch:
    """Rows 0 .. count - 1 in even blocks, padded to one of SIZES, for work of any kind.

    Args:
        count: rows.
        most: rows in a block.
        order: int[count], the rows, where those that take alike long should be together so that
            none waits for another; by default as they come.
    """
    # The largest size that little padding fills; a device that gets no block does not compile.
    fitting = [n for n in SIZES if n <= most and -(-count // n) * n <= MOST_PADDED * count]
    most = max(fitting, default=min(SIZES[0], most))
    blocks = split(np.arange(count) if order is None else order, most)
    return Batch(blocks, max(most, SIZES[0]), chosen_devices()[: len(blocks)])


def most_rows(each: int, together: int) -> int:
    """The largest of SIZES of which that many, of `each` numbers, have at most `together`."""
    return max((n for n in SIZES if n * each <= together), default=1)


# --- shapes -----------------------------------------------------------------------------------


def bucket(size: int, factor: int = 2) -> int:
    """The next power of `factor`, so that few shapes are compiled."""
    found = 1
    while found < size:
        found *= factor
    return found


def filled(array: np.ndarray, size: int, axis: int = 0) -> np.ndarray:
    """The array with at least `size` along an axis, the last repeated."""
    count = array.shape[axis]
    return array.take(np.minimum(np.arange(max(size, count)), count - 1), axis=axis)


def sized(array: np.ndarray, size: int, axis: int = 0, fill: int = 0) -> np.ndarray:
    """A new array, cut to `size` along an axis or filled up."""
    array = array[_along(axis, slice(size))]
    shape = [*array.shape]
    shape[axis] = size
    made = np.full(shape, fill, array.dtype)
    made[_along(axis, slice(array.shape[axis]))] = array
    return made
