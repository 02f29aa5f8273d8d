"""The dynamic window of many vessels: of those under way, against what may come near them.

Most vessels of a sea have nothing about them that any of their candidates could come near, and
those that have arrived decide nothing. So vessels are decided on a block after the other, those
with equally many circles to look at together, and each against these alone.
"""

from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.dwa.candidates import Command
from usvkernels.dwa.clearance import FAR
from usvkernels.fleet.choice import Asked, decide
from usvkernels.fleet.traffic import Circles, Traffic, bulge
from usvkernels.xla.single import single

BLOCK = 64
"""Vessels that are decided on at a time."""

MARGIN = 1.0
"""m by which rounding may err about what comes near."""


def decide_all(active: Array, asked: Asked, traffic: Traffic) -> Command:
    """Speeds (m/s) and yaw rates (rad/s), float[vessels], of vessels that are active.

    Of the others they are zero, or what they would be; the same as `decide` in any case.

    Args:
        active: bool[vessels], whose command is wanted.
        asked, traffic: as of `decide`.
    """
    return lax.platform_dependent(active, asked, traffic, cpu=_in_blocks, default=_at_once)


def _at_once(active: Array, asked: Asked, traffic: Traffic) -> Command:
    """All vessels in one go, for devices that gain nothing by blocks."""
    del active
    return decide(asked, traffic)


def _in_blocks(active: Array, asked: Asked, traffic: Traffic) -> Command:
    vessels = len(active)
    near = _near(asked, traffic)
    work = sum(jnp.sum(kind, axis=0, dtype=jnp.int32) for kind in near)
    order = jnp.argsort(jnp.where(active, work, jnp.iinfo(jnp.int32).max))
    width = min(BLOCK, vessels)
    blocks = -(-jnp.sum(active, dtype=jnp.int32) // width)
    # The last block takes vessels of the one before again where it would reach past the end.
    last = vessels - width

    def some(block: Array, command: Array) -> Array:
        who = lax.dynamic_slice_in_dim(order, jnp.minimum(block * width, last), width)
        of = partial(_of, who=who)
        weighing, others = (
            _nearest(of(kind.rows), of(mask)) for kind, mask in zip(traffic[:2], near, strict=True)
        )
        part = Traffic(weighing, others, of(traffic.course))
        found = decide(jax.tree.map(of, asked), part)
        return command.at[:, who].set(jnp.stack(found))

    nothing = jnp.zeros((2, vessels), asked.motion.dtype)
    command = lax.fori_loop(0, blocks, some, nothing)
    return command[0], command[1]


def _of(leaf: Array, who: Array) -> Array:
    return leaf[..., who] if jnp.ndim(leaf) else leaf


def _near(asked: Asked, traffic: Traffic) -> tuple[Array, Array]:
    """Whether circles can matter to any candidate, bool[K, vessels], of both kinds."""
    vessel, speed = asked.vessel, asked.motion[3]
    gained = speed + jnp.maximum(vessel.v_acc, vessel.v_dec) * vessel.dt
    fastest = jnp.minimum(gained, jnp.maximum(vessel.v_max, speed)) + asked.sampling.v_step
    turning = vessel.dt * asked.sampling.horizon
    off = fastest * turning * bulge(vessel.w_max * turning) + MARGIN
    # Where nothing is clear, the room to a collision decides: of the circle that is too close it is
    # less than this.
    off += jnp.maximum(*(_most_room(kind) for kind in traffic[:2]))
    stopping = jnp.minimum(traffic.course, fastest / vessel.v_dec)
    cap = asked.objective.clearance_cap
    return (
        _comes_near(traffic.weighing, fastest, turning + traffic.course, off + cap),
        _comes_near(traffic.others, fastest, turning + stopping, off),
    )


def _most_room(circles: Circles) -> Array:
    """Most that any circle keeps beyond its touch, float[vessels] (m)."""
    *_, reach, touch = circles.rows
    return jnp.max(reach - touch, axis=0, initial=0.0)


def _comes_near(circles: Circles, fastest: Array, lasts: Array, off: Array) -> Array:
    """Whether circles may come as near as that to what sails so long, bool[K, vessels]."""
    east, north, *velocity, reach, _ = circles.rows
    closing = fastest + jnp.hypot(*velocity)
    return jnp.hypot(east, north) - reach - off <= closing * lasts


def _nearest(rows: Array, near: Array) -> Circles:
    """Those of a block's circles [6, K, vessels] that come near, each vessel's the first."""
    if not rows.shape[1]:
        return Circles(rows, 0)
    most = jnp.max(jnp.sum(near, axis=0, dtype=jnp.int32))
    return Circles(single(_gathered, rows, near, most), most)


def _gathered(rows: Array, near: Array, most: Array) -> Array:
    count = near.shape[0]
    padding = jnp.array([FAR, FAR, 0.0, 0.0, 0.0, 0.0], rows.dtype)[:, None]

    def take(slot: Array, carry: tuple[Array, Array]) -> tuple[Array, Array]:
        left, gathered = carry

        def first(i: Array, found: tuple[Array, Array]) -> tuple[Array, Array]:
            k = count - 1 - i
            here = left[k] != 0
            return jnp.where(here, k, found[0]), jnp.where(here, rows[:, k], found[1])

        none = jnp.full(near.shape[1], count, jnp.int32)
        pad = jnp.broadcast_to(padding, (len(rows), near.shape[1]))
        taken, circle = lax.fori_loop(0, count, first, (none, pad))
        left = jnp.where(jnp.arange(count)[:, None] == taken, 0, left)
        return left, gathered.at[:, slot].set(circle)

    left = near.astype(jnp.int32)
    return lax.fori_loop(0, most, take, (left, jnp.zeros_like(rows)))[1]
