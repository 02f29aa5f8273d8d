"""Cruises from stop to stop with D* Lite while cells flip, one cell touched per lane and iteration.

A step is: cells flip, the vessel looks about, replans, and makes one move, or waits where it is
cut off. A leg begins with the map as it is known then, and ends at its stop; or without, when the
vessel has waited long enough.
"""

from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.cruise.flips import View, flipped, view, view_flips
from usvkernels.search.dstar_layout import INFINITE, TOP, ReplanStatic
from usvkernels.search.dstar_patch import Outcome
from usvkernels.search.dstar_search import (
    NOWHERE,
    Searches,
    standing,
    worked,
)
from usvkernels.status import Status
from usvkernels.xla.stage import stage

SCOPES = ("window", "map")

STAY = 4
"""Code of a step without a move; that of a move (dx, dy) is 4 + dx + 3 dy."""

_WORD = 32


@dataclass(frozen=True)
class SailingStatic:
    """Choices of method; hashable.

    Attributes:
        search: of the replanning; its `sensing` is the window in which the vessel looks about.
        scope: where cells flip, of `SCOPES`.
    """

    search: ReplanStatic
    scope: str = "window"

    @property
    def window(self) -> tuple[int, int]:
        """(h, w) of the vessel's view."""
        assert self.search.sensing is not None
        return self.search.sensing

    @property
    def words(self) -> int:
        """Of 32 bits, to hold a bit for each cell in view."""
        return -(-self.window[0] * self.window[1] // _WORD)


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Cruises:
    """What the lanes work on; all cells as `Layout.index`.

    Attributes:
        blocked: bool[M, size], maps with their margin.
        map_of: int32[n], map of each cruise.
        stops: int32[d + 1, n], stations in the order of the cruise: home, the others, home.
        seed: uint32[2, n], of the flips.
        rate: int32[n], probability of a flip times 2^`flips.BITS`.
        max_steps: int32, of a leg; also the room for its moves.
        max_wait: int32, steps in a row that a vessel waits before its stop is given up.
        gives_up: bool, whether a stop that is given up ends the cruise.
        max_expansions: int32, in one step.
    """

    blocked: Array
    map_of: Array
    stops: Array
    seed: Array
    rate: Array
    max_steps: Array
    max_wait: Array
    gives_up: Array
    max_expansions: Array


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Vessels(Searches):
    """Cruises under way, one per lane; `live` while a leg is."""

    unseen: Array  # bool[lanes * size], truth differs from what is known; with scope "map"
    changes: Array  # uint32[words, lanes], bits of the cells in view that are not as known
    drawn: Array  # bool[lanes], whether the flips of this step are
    over: Array  # bool[lanes], whether the cruise is, not only the leg
    stops: Array  # int32[d + 1, lanes]
    seed: Array  # uint32[2, lanes]
    rate: Array  # int32[lanes], and so are all below
    job: Array
    leg: Array  # number of the stop it sails to, from 1
    step: Array  # of the cruise
    first: Array  # step at which the leg began
    waited: Array  # steps in a row
    spent: Array  # cells expanded in this leg
    plans: Array  # steps of this leg in which cells were expanded


class Log(NamedTuple):
    """What the lanes have to write down now."""

    move_place: Array  # int32[lanes] into n * d * max_steps, NOWHERE where no step was made
    move: Array  # uint8[lanes], code of the move
    leg_place: Array  # int32[lanes] into n * d, NOWHERE where no leg ended
    leg: Array  # int32[lanes, 4]: `Status` of the leg, step of the cruise, expanded, plans


class _Endings(NamedTuple):
    """How legs end now; bool[lanes]."""

    there: Array
    dropped: Array
    late: Array
    exhausted: Array

    @property
    def any(self) -> Array:
        return self.there | self.dropped | self.late | self.exhausted

    def status(self) -> Array:
        code = jnp.where(self.there, int(Status.REACHED), int(Status.UNREACHABLE))
        code = jnp.where(self.late, int(Status.TIMED_OUT), code)
        return jnp.where(self.exhausted, int(Status.OUT_OF_BUDGET), code)


def advance(static: SailingStatic, cruises: Cruises, vessels: Vessels) -> tuple[Vessels, Log]:
    """Do the next thing in every lane: one change, one expansion, or one move.

    Args:
        static: choices of method.
        cruises: all cruises.
        vessels: those under way.

    Returns:
        The lanes, and what is to be written down.
    """
    void = static.search.layout.void
    there = vessels.live & (vessels.here == vessels.goal)
    vessels = _drawn(static, vessels, vessels.live & ~there & ~vessels.drawn)
    vessels, changing, changed = _next_change(static, vessels)
    now = standing(static.search, vessels)
    ready = vessels.live & ~there & ~changing
    moving, searching = ready & now.settled, ready & ~now.settled
    otherwise = jnp.where(moving, vessels.here, void)
    vessels, outcome = worked(
        static.search, vessels, now, searching=searching, changed=changed, otherwise=otherwise
    )
    goes = moving & (now.value < INFINITE)
    return _moved(static, cruises, vessels, outcome, there, goes, moving & ~goes)


def _drawn(static: SailingStatic, vessels: Vessels, begins: Array) -> Vessels:
    """The lanes with the flips of the step that begins in some of them."""
    if static.scope == "map":
        vessels = _map_drawn(static, vessels, begins)
    else:
        draw = partial(_window_changes, static)
        changes = stage(
            jnp.any(begins), draw, vessels.seed, vessels.step, vessels.rate, vessels.here
        )
        changes = jnp.where(begins, changes, vessels.changes)
        vessels = replace(vessels, changes=changes)
    return replace(vessels, drawn=vessels.drawn | begins)


def _view(static: SailingStatic, here: Array) -> View:
    layout = static.search.layout
    column, row = here % layout.stride, here // layout.stride - TOP
    return view(column, row, static.window, layout.width, layout.height)


def _window_changes(
    static: SailingStatic, seed: Array, step: Array, rate: Array, here: Array
) -> Array:
    """Flips in view as bits, uint32[words, lanes]."""
    seen = _view(static, here)
    return _packed(static, view_flips(seed, step, rate, seen, static.search.layout.width))


def _packed(static: SailingStatic, cells: Array) -> Array:
    """Cells in view, bool[n, lanes], as bits uint32[words, lanes]."""
    bits = jnp.arange(cells.shape[0], dtype=jnp.uint32)[:, None]
    values = jnp.where(cells, jnp.uint32(1) << bits % _WORD, jnp.uint32(0))
    if static.words == 1:  # of the usual window; a third of all time is saved
        return jnp.sum(values, axis=0, dtype=jnp.uint32)[None]
    values = jnp.pad(values, ((0, static.words * _WORD - cells.shape[0]), (0, 0)))
    return jnp.sum(values.reshape(static.words, _WORD, -1), axis=1, dtype=jnp.uint32)


def _first_bit(static: SailingStatic, changes: Array) -> tuple[Array, Array, Array]:
    """Number of the first bit that is set, int32[lanes]; whether one is; and the bits without."""
    if static.words == 1:
        word = changes[0]
        lowest, number = _lowest_bit(word)
        return number, word != 0, (word ^ lowest)[None]
    first = jnp.argmax(changes != 0, axis=0).astype(jnp.int32)
    word = jnp.take_along_axis(changes, first[None], axis=0)[0]
    lowest, number = _lowest_bit(word)
    mine = jnp.arange(static.words, dtype=jnp.int32)[:, None] == first
    return first * _WORD + number, word != 0, jnp.where(mine, word ^ lowest, changes)


def _lowest_bit(word: Array) -> tuple[Array, Array]:
    """The lowest bit that is set, and its number; -1 where none is."""
    lowest = word & (~word + jnp.uint32(1))
    return lowest, _WORD - 1 - lax.clz(lowest).astype(jnp.int32)


def _map_drawn(static: SailingStatic, vessels: Vessels, begins: Array) -> Vessels:
    """Flip cells of whole maps, in the lanes where a step begins; note those in view."""
    layout = static.search.layout
    size = layout.size
    place = jnp.arange(size, dtype=jnp.int32)
    column, row = place % layout.stride, place // layout.stride - TOP
    on_map = (column < layout.width) & (row >= 0) & (row < layout.height)
    number = row * layout.width + column
    seen = _view(static, vessels.here)
    seen_cells = jnp.where(seen.inside, (seen.row + TOP) * layout.stride + seen.column, layout.void)

    def begin(i: Array, carry: tuple[Array, Array]) -> tuple[Array, Array]:
        unseen, noticed = carry
        lane = order[i]
        plane = lax.dynamic_slice(unseen, (lane * size,), (size,))
        step, rate = vessels.step[lane], vessels.rate[lane]
        plane ^= on_map & flipped(vessels.seed[:, lane, None], step, number, rate)
        plane = plane.at[vessels.stops[:, lane]].set(False).at[vessels.here[lane]].set(False)
        cells = seen_cells[:, lane]
        noticed = lax.dynamic_update_slice(noticed, plane[cells][:, None], (jnp.int32(0), lane))
        plane = plane.at[cells].set(False)
        return lax.dynamic_update_slice(unseen, plane, (lane * size,)), noticed

    order = jnp.argsort(~begins, stable=True).astype(jnp.int32)
    carry = (vessels.unseen, jnp.zeros(seen.inside.shape, bool))
    unseen, noticed = lax.fori_loop(0, jnp.sum(begins, dtype=jnp.int32), begin, carry)
    changes = jnp.where(begins, _packed(static, noticed), vessels.changes)
    return replace(vessels, unseen=unseen, changes=changes)


def _next_change(static: SailingStatic, vessels: Vessels) -> tuple[Vessels, Array, Array]:
    """Which lanes have a change to deal with, and the cell that becomes known as changed.

    That cell is void where it is a station, which never changes.
    """
    layout, (height, width) = static.search.layout, static.window
    bit, found, changes = _first_bit(static, vessels.changes)
    bit = jnp.where(found, bit, 0)
    offset = (bit // width - height // 2) * layout.stride + bit % width - width // 2
    cell = vessels.here + offset
    station = jnp.any(vessels.stops == cell, axis=0)
    changed = jnp.where(found & ~station, cell, layout.void)
    return replace(vessels, changes=changes), found, changed


def _moved(
    static: SailingStatic,
    cruises: Cruises,
    vessels: Vessels,
    outcome: Outcome,
    there: Array,
    goes: Array,
    cut_off: Array,
) -> tuple[Vessels, Log]:
    """Move the vessels whose paths are settled, end legs, and say what is to be written down."""
    layout = static.search.layout
    # Expansions aside, an iteration takes a key up to date or a bound, a change or the move.
    changes = static.window[0] * static.window[1]
    most = 2 * cruises.max_expansions + 16 * layout.size + 2 * changes
    exhausted = outcome.overflow | (vessels.expanded > cruises.max_expansions)
    exhausted = vessels.live & (exhausted | (vessels.iterations > most))

    dropped = cut_off & (vessels.waited >= cruises.max_wait)
    steps = (goes | (cut_off & ~dropped)) & ~exhausted
    here = jnp.where(steps & goes, vessels.here + outcome.ahead, vessels.here)
    used = vessels.step + steps - vessels.first
    late = steps & (used >= cruises.max_steps) & (here != vessels.goal)
    endings = _Endings(there, dropped & ~exhausted, late, exhausted)
    ended = endings.any
    spent = vessels.spent + jnp.where(steps | ended, vessels.expanded, 0)
    plans = vessels.plans + ((steps | ended) & (vessels.expanded > 0))
    step = vessels.step + steps
    room = cruises.max_steps * (vessels.stops.shape[0] - 1)
    number = vessels.job * (vessels.stops.shape[0] - 1) + vessels.leg - 1
    ahead = jnp.where(goes, outcome.ahead, 0) + layout.stride + 1
    log = Log(
        move_place=jnp.where(steps, vessels.job * room + vessels.step, NOWHERE),
        move=(ahead % layout.stride + 3 * (ahead // layout.stride)).astype(jnp.uint8),
        leg_place=jnp.where(ended, number, NOWHERE),
        leg=jnp.stack([endings.status(), step, spent, plans], axis=1),
    )
    last = vessels.leg >= vessels.stops.shape[0] - 1
    over = last | ~(there | endings.dropped) | (endings.dropped & cruises.gives_up)
    vessels = replace(
        vessels,
        here=here,
        step=step,
        waited=jnp.where(goes, 0, vessels.waited + steps),
        drawn=vessels.drawn & ~steps,
        spent=spent,
        plans=plans,
        expanded=jnp.where(steps, 0, vessels.expanded),
        iterations=jnp.where(steps, 0, vessels.iterations),
        live=vessels.live & ~ended,
        over=jnp.where(ended, over, vessels.over),
    )
    return vessels, log
