"""Vessels that follow a planned path while cells flip, until it is blocked: all in step.

What `sailing` does for D* Lite, for planners that cannot repair a plan: they are asked for a new
one where what was seen blocks the way ahead, or where a cell came free for a vessel that has none.
"""

from dataclasses import dataclass, replace
from enum import IntEnum
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.cruise.flips import flipped, view
from usvkernels.cruise.sailing import STAY


class Halt(IntEnum):
    """Why a vessel does not go on."""

    NOT_YET = 0
    ARRIVED = 1
    WANTS_PLAN = 2
    DROPPED = 3  # waited for a way to its stop as long as it may
    LATE = 4  # has used up the steps of the leg


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Orders:
    """What the vessels are to do; cells of a map as row * W + column.

    Attributes:
        path: int32[P, lanes], cells from where the vessel is to its stop, the last repeated.
        length: int32[lanes], cells of the path; 0 where there is none.
        proven: bool[lanes], where there is none, whether that is certain.
        stations: int32[d, lanes], cells that never flip.
        seed: uint32[2, lanes], of the flips.
        rate: int32[lanes], probability of a flip times 2^`flips.BITS`.
        left: int32[lanes], steps that the leg may still take.
        max_wait: int32, steps in a row that a vessel waits before its stop is given up.
    """

    path: Array
    length: Array
    proven: Array
    stations: Array
    seed: Array
    rate: Array
    left: Array
    max_wait: Array


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Fleet:
    """The vessels and their maps; planes flat, lanes one after the other."""

    truth: Array  # bool[lanes * H * W]
    known: Array  # bool[lanes * H * W]
    step: Array  # int32[lanes], of the cruise
    waited: Array  # int32[lanes], steps in a row
    drawn: Array  # bool[lanes], whether the flips of this step are
    halt: Array  # int32[lanes], `Halt`
    at: Array  # int32[lanes], place in the path
    made: Array  # int32[lanes], steps made since the orders were given
    moves: Array  # uint8[K, lanes], their codes


def follow(
    orders: Orders,
    fleet: Fleet,
    *,
    shape: tuple[int, int],
    scope: str,
    window: tuple[int, int],
    corner_cutting: bool,
) -> Fleet:
    """Sail until every vessel has halted; K steps each at most, which then wants a plan.

    Args:
        orders: for the vessels.
        fleet: the vessels; those that have halted already stay as they are.
        shape: (H, W), static.
        scope: where cells flip, as `sailing.SCOPES`.
        window: (h, w) of the vessels' view.
        corner_cutting: of the paths.
    """
    height, width = shape
    lane = jnp.arange(fleet.step.shape[0], dtype=jnp.int32)
    first = lane * (height * width)
    place = jnp.arange(orders.path.shape[0], dtype=jnp.int32)[:, None]

    def on(fleet: Fleet) -> Fleet:
        live = fleet.halt == Halt.NOT_YET
        here = orders.path[fleet.at, lane]
        seen = view(here % width, here // width, window, width, height)
        cells = jnp.where(seen.inside, first + seen.row * width + seen.column, first + here)
        draws = live & ~fleet.drawn
        fleet = replace(fleet, truth=changed(fleet, draws, here, cells), drawn=fleet.drawn | live)
        before = fleet.known.at[cells].get(mode="promise_in_bounds")
        now = jnp.where(live, fleet.truth.at[cells].get(mode="promise_in_bounds"), before)
        fleet = replace(fleet, known=fleet.known.at[cells].set(now))
        freed = draws & jnp.any(before & ~now, axis=0)
        return moved(fleet, live, here, freed)

    def changed(fleet: Fleet, draws: Array, here: Array, cells: Array) -> Array:
        if scope == "map":
            number = jnp.arange(height * width, dtype=jnp.int32)
            seed, step = orders.seed[:, :, None], fleet.step[:, None]
            flips = flipped(seed, step, number, orders.rate[:, None])
            flips = (flips & draws[:, None]).reshape(-1)
            fixed = jnp.concatenate([orders.stations, here[None]]) + first
            return fleet.truth ^ flips.at[fixed].set(False)
        number = cells - first
        flips = flipped(orders.seed[:, None], fleet.step, number, orders.rate) & draws
        flips &= (number != here) & jnp.all(number != orders.stations[:, None], axis=0)
        # Cells off the map stand as the vessel's own, which does not flip.
        return fleet.truth.at[cells].set(fleet.truth[cells] ^ flips)

    def moved(fleet: Fleet, live: Array, here: Array, freed: Array) -> Fleet:
        has_path = orders.length > 0
        wants = jnp.where(
            has_path,
            blocked_ahead(fleet),
            freed | (~orders.proven & (fleet.made > 0)),
        )
        drops = live & ~has_path & ~wants & (fleet.waited >= orders.max_wait)
        steps = live & ~wants & ~drops
        at = fleet.at + (steps & has_path)
        there = orders.path[at, lane]
        code = 4 + there % width - here % width + 3 * (there // width - here // width)
        made = fleet.made + steps
        slot = jnp.where(steps, fleet.made, fleet.moves.shape[0])
        halt = jnp.where(live & wants, int(Halt.WANTS_PLAN), fleet.halt)
        halt = jnp.where(drops, int(Halt.DROPPED), halt)
        used_up = (made >= fleet.moves.shape[0]) & steps
        halt = jnp.where(used_up, int(Halt.WANTS_PLAN), halt)
        halt = jnp.where(steps & (made >= orders.left), int(Halt.LATE), halt)
        arrived = steps & has_path & (at == orders.length - 1)
        return replace(
            fleet,
            step=fleet.step + steps,
            waited=jnp.where(steps & has_path, 0, fleet.waited + (steps & ~has_path)),
            drawn=fleet.drawn & ~steps,
            halt=jnp.where(arrived, int(Halt.ARRIVED), halt),
            at=at,
            made=made,
            moves=fleet.moves.at[slot, lane].set(code.astype(jnp.uint8), mode="drop"),
        )

    def blocked_ahead(fleet: Fleet) -> Array:
        """Whether the path from where the vessel is meets a cell known as blocked."""

        def met(cells: Array) -> Array:
            return fleet.known.at[first + cells].get(mode="promise_in_bounds")

        before, after = orders.path[:-1], orders.path[1:]
        hit = met(after)
        if not corner_cutting:
            column, row = before % width, before // width
            hit |= met(row * width + after % width) | met(after // width * width + column)
        return jnp.any(hit & (place[:-1] >= fleet.at), axis=0)

    def unfinished(fleet: Fleet) -> Array:
        return jnp.any(fleet.halt == Halt.NOT_YET)

    # Every turn makes a step or halts, and a lane makes as many as `moves` has room for.
    return lax.while_loop(unfinished, on, fleet)


def fleet_of(
    truth: Array, known: Array, step: Array, waited: Array, drawn: Array, halt: Array, room: int
) -> Fleet:
    """Vessels at the beginning of their paths.

    Args:
        truth, known: bool[lanes, H, W].
        step, waited, drawn, halt: as in `Fleet`.
        room: K, steps that may be made, static.
    """
    zero = jnp.zeros_like(step)
    return Fleet(
        truth=truth.reshape(-1),
        known=known.reshape(-1),
        step=step,
        waited=waited,
        drawn=drawn,
        halt=halt,
        at=zero,
        made=zero,
        moves=jnp.full((room, step.shape[0]), STAY, jnp.uint8),
    )
