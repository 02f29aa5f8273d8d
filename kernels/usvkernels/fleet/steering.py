"""What vessels of a fleet decide: what they see, how they meet, and the commands that follow.

For a decision of the dynamic window they are laid side by side, n * lanes at a time.
"""

from dataclasses import replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.dwa.candidates import Command
from usvkernels.dwa.clearance import FAR
from usvkernels.fleet import environment, guidance, orca, rules, wei2023
from usvkernels.fleet.approach import cross, dot
from usvkernels.fleet.blocks import decide_all
from usvkernels.fleet.choice import Asked
from usvkernels.fleet.guidance import Routes
from usvkernels.fleet.models import MODELS
from usvkernels.fleet.params import Settings
from usvkernels.fleet.sight import (
    Obstacles,
    Orders,
    Vessels,
    between,
    less_drift,
    minus,
    nearest_square,
    sums,
)
from usvkernels.fleet.state import Fleet
from usvkernels.fleet.traffic import Circles, Traffic
from usvkernels.trig import angle_between, sincos
from usvkernels.vessel import Complex

COMFORT = 0.8
"""Of the deceleration that a vessel has, what it plans to stop at its goal with: in periods of a
control it cannot follow the curve of all of it."""

TURNING = 0.1
"""Of that speed, and of what it looks along, what a vessel keeps to turn with."""

CLEARANCES = ("guide", "printed")
"""How far clearance scores, and a course is looked along: see `_room` and `_lasting`; or up to the
cap, and as far as to the guidance point, however a vessel lies."""

CLOSING = 0.35
"""Of the way left to its goal, how far ahead on its guide segment a vessel steers for: what it is
off the line shrinks with the way left to the power of 1 / 0.35, and its angle with it."""


def _guided(
    routes: Routes, settings: Settings, fleet: Fleet, goal: Complex
) -> tuple[Complex, Array]:
    """Guidance points, and who is on its guide segment, bool[n, lanes].

    There it steers for a point ahead on the segment's line, elsewhere for that of its route; on its
    way around, for where the segment begins.
    """
    point = guidance.guide(routes, fleet.job, fleet.index)
    gate = routes.gate[fleet.job].T
    bow = guidance.bow(routes, fleet.job)
    led = ((bow[0] != 0.0) | (bow[1] != 0.0)) & (fleet.index >= gate) & ~fleet.returns
    left = dot(bow, minus(goal, fleet.place))
    beyond = jnp.maximum(CLOSING * left, settings.passage.unit_length) - left
    begins = guidance.point(routes, fleet.job, gate)
    guide = [
        jnp.where(fleet.returns, begins[k], jnp.where(led, goal[k] + beyond * bow[k], point[k]))
        for k in range(2)
    ]
    return (guide[0], guide[1]), led


def sight(routes: Routes, settings: Settings, fleet: Fleet) -> Vessels:
    """What the vessels see of each other and of their routes."""
    vessel, passage = settings.vessel, settings.passage
    x, y, psi, v = fleet.reals[:4]
    sin, cos = sincos(psi)
    goal = guidance.point(routes, fleet.job, routes.last[fleet.job].T)
    guide, led = _guided(routes, settings, fleet, goal)
    east, north = guide[0] - x, guide[1] - y
    distance = jnp.sqrt(east * east + north * north)
    known = distance > 0.0
    over = jnp.where(known, distance, 1.0)
    course = jnp.where(known, east / over, cos), jnp.where(known, north / over, sin)
    to_goal = minus(goal, (x, y))
    left = jnp.sqrt(dot(to_goal, to_goal))
    # With the goal abeam it slows down to turn, or it would circle about it.
    abeam = jnp.clip(dot((cos, sin), to_goal) / jnp.maximum(left, 1e-3), TURNING, 1.0)
    wanted = abeam * jnp.sqrt(2.0 * COMFORT * vessel.v_dec * left)
    # The goal is not what it sails to on its way around.
    wanted, left = (jnp.where(fleet.returns, jnp.inf, of) for of in (wanted, left))
    speed = jnp.broadcast_to(jnp.minimum(vessel.v_max, wanted), x.shape)
    velocity, drifts, made_good, fastest = (v * cos, v * sin), None, speed, vessel.v_max
    if MODELS[settings.passage.model].extra:
        sway = fleet.motion[5]
        velocity = v * cos - sway * sin, v * sin + sway * cos
    if settings.environment is not None:
        east, north = environment.drift(settings.environment, (x, y))
        # Whose passage has ended drops anchor.
        adrift = jnp.where(fleet.under_way, 1.0, 0.0)
        drifts = adrift * east, adrift * north
        course, speed, made_good = environment.crab(course, wanted, drifts, vessel.v_max)
        velocity, fastest = (velocity[0] + drifts[0], velocity[1] + drifts[1]), made_good
    arrival = jnp.maximum(left - passage.goal_tolerance, 0.0) / jnp.maximum(fastest, 1e-6)
    return Vessels(
        place=(x, y),
        bow=(cos, sin),
        velocity=velocity,
        drift=drifts,
        course=course,
        guide=guide,
        led=led,
        goal=goal,
        speed=speed,
        made_good=made_good,
        hull=jnp.broadcast_to(passage.hull_radius, x.shape),
        arrival=arrival,
        under_way=fleet.under_way,
        present=fleet.present,
    )


def meet(
    settings: Settings, fleet: Fleet, vessels: Vessels, obstacles: Obstacles
) -> tuple[Orders, Array, Array, Array]:
    """Orders, who keeps its guidance point, roles and alterations by the encounter strategy."""
    how, held = settings.encounters, jnp.zeros_like(fleet.present)
    if how.strategy == "rules":
        reach = vessels.hull + settings.passage.obstacle_radius
        idle = (fleet.steps - fleet.anchor_step).astype(reach.dtype) * settings.vessel.dt
        orders, roles, altered = rules.meet(
            how, vessels, obstacles, reach, fleet.roles, fleet.altered, idle
        )
        return orders, held, roles, altered
    if how.strategy == "wei2023":
        v_dec = jnp.broadcast_to(settings.vessel.v_dec, vessels.speed.shape)
        orders, held = wei2023.meet(how, vessels, v_dec)
        return orders, held, fleet.roles, fleet.altered
    nobody = jnp.zeros_like(fleet.roles, dtype=bool)
    orders = Orders(vessels.course, vessels.speed, nobody, held, sums(vessels.hull))
    return orders, held, fleet.roles, fleet.altered


def command(
    settings: Settings,
    fleet: Fleet,
    vessels: Vessels,
    orders: Orders,
    obstacles: Obstacles,
    beside: Obstacles,
) -> Command:
    """Speed (m/s) and yaw rate (rad/s) of each vessel, [n, lanes].

    Args:
        settings, fleet, vessels, orders: what there is.
        obstacles: what vessels sense.
        beside: what lies about their guidance points.
    """
    if settings.encounters.strategy == "orca":
        chosen = _reciprocal(settings, fleet, vessels, obstacles)
    else:
        chosen = _by_window(settings, fleet, vessels, orders, obstacles, beside)
    v, w = fleet.reals[3], jnp.zeros_like(fleet.reals[4])
    slowing = jnp.maximum(v - settings.vessel.v_dec * settings.vessel.dt, 0.0)
    under_way = vessels.under_way
    return jnp.where(under_way, chosen[0], slowing), jnp.where(under_way, chosen[1], w)


def _reciprocal(
    settings: Settings, fleet: Fleet, vessels: Vessels, obstacles: Obstacles
) -> Command:
    """Towards the velocity of `orca`: turning as fast as its angle asks, at its share ahead."""
    vessel = settings.vessel
    v, w = fleet.reals[3:5]
    reach = vessels.hull + settings.passage.obstacle_radius
    wanted = orca.meet(settings.encounters, vessels, obstacles, reach, vessel.dt)
    ahead, across = dot(vessels.bow, wanted), cross(vessels.bow, wanted)
    angle = jnp.where(across < 0.0, -1.0, 1.0) * angle_between(across, ahead)
    turn = angle / (settings.sampling.horizon * vessel.dt)
    least, most = w - vessel.w_dec * vessel.dt, w + vessel.w_acc * vessel.dt
    turn = jnp.clip(turn, jnp.maximum(least, vessel.w_min), jnp.minimum(most, vessel.w_max))
    slowest, fastest = v - vessel.v_dec * vessel.dt, v + vessel.v_acc * vessel.dt
    speed = jnp.clip(ahead, jnp.maximum(slowest, 0.0), jnp.minimum(fastest, vessel.v_max))
    return speed, turn


def _by_window(
    settings: Settings,
    fleet: Fleet,
    vessels: Vessels,
    orders: Orders,
    obstacles: Obstacles,
    beside: Obstacles,
) -> Command:
    """What the dynamic window chooses under the orders."""
    vessel, sampling, objective = settings.vessel, settings.sampling, settings.objective
    x, y, _, v = fleet.reals[:4]
    n, lanes = x.shape
    flat = partial(_side_by_side, n=n, lanes=lanes)
    # The window's lowest speed stays in it: a vessel slows down no faster than it can.
    cap = jnp.maximum(jnp.minimum(orders.cap, vessel.v_max), v - vessel.v_dec * vessel.dt)
    able = jax.tree.map(flat, replace(vessel, v_max=cap))
    to_guide = minus(vessels.guide, vessels.place)
    ahead = jnp.sqrt(dot(to_guide, to_guide))
    goal = x + orders.course[0] * ahead, y + orders.course[1] * ahead
    asked_for = replace(
        objective,
        # What a guide segment keeps from obstacles is enough: who shied would arrive askew.
        clearance_weight=jnp.where(vessels.led, 0.0, objective.clearance_weight),
    )
    if settings.passage.clearance == "guide":
        room = jnp.minimum(_room(settings, vessels, beside), objective.clearance_cap)
        asked_for = replace(asked_for, clearance_cap=room)
    asked = Asked(able, sampling, asked_for, fleet.reals[:5], jnp.stack(goal))
    course = _lasting(settings, fleet, vessels, orders, ahead)
    command = decide_all(
        flat(vessels.under_way),
        jax.tree.map(flat, asked),
        jax.tree.map(flat, _traffic(settings, vessels, orders, obstacles, course)),
    )
    return command[0].reshape(n, lanes), command[1].reshape(n, lanes)


def _lasting(
    settings: Settings, fleet: Fleet, vessels: Vessels, orders: Orders, ahead: Array
) -> Array:
    """How long a course is looked along after the turn, [n, lanes] (s).

    With the turn as far as to the guidance point, and less as that is off the bow: who turns
    towards it does not sail what its candidates look along. At least until the vessel has stopped.
    """
    vessel, turning = settings.vessel, settings.vessel.dt * settings.sampling.horizon
    if settings.passage.clearance == "printed":
        return ahead / jnp.maximum(vessels.made_good, 1e-3)
    facing = jnp.clip(dot(vessels.bow, orders.course), TURNING, 1.0)
    whole = facing * ahead / jnp.maximum(vessels.made_good, 1e-3)
    stopping = (fleet.reals[3] + vessel.v_acc * vessel.dt) / vessel.v_dec
    return jnp.maximum(whole - turning, stopping)


def _room(settings: Settings, vessels: Vessels, beside: Obstacles) -> Array:
    """What guidance points are clear of obstacles at rest by, [n, lanes], 0 or more (m).

    No candidate needs to be clearer than the place it is steered for: who shied from what lies
    beside its route would circle about it.
    """
    centre, velocity = beside
    if velocity is not None:
        centre = jnp.where(jnp.any(velocity != 0.0, axis=0), FAR, centre)
    still = jnp.zeros_like(vessels.hull)
    square = nearest_square(Obstacles(centre, None), vessels.guide, (still, still), 0.0)
    reach = vessels.hull + settings.passage.obstacle_radius
    return jnp.maximum(jnp.sqrt(square) - reach, 0.0)


def _side_by_side(leaf: Array, n: int, lanes: int) -> Array:
    """[..., n, lanes] as [..., n * lanes]; scalars as they are."""
    if jnp.ndim(leaf) < 2:
        return leaf
    return leaf.reshape(*leaf.shape[:-2], n * lanes)


def _traffic(
    settings: Settings, vessels: Vessels, orders: Orders, obstacles: Obstacles, course: Array
) -> Traffic:
    """Obstacles and the vessels that are to be seen, leaves [.., n, lanes]."""
    x, y = vessels.place
    centres = obstacles.centre - jnp.stack([x, y])[:, None]
    theirs = jnp.zeros_like(centres)
    if obstacles.velocity is not None:
        theirs += obstacles.velocity
    reach = vessels.hull + settings.passage.obstacle_radius
    circles = _circles(vessels, centres, theirs, reach, reach)
    if settings.encounters.strategy == "none":
        return Traffic(circles, Circles(circles.rows[:, :0], 0), course)
    places = jnp.stack(between((x, y))).swapaxes(1, 2)  # [2, j, i, lanes]
    places = jnp.where(orders.sees.swapaxes(0, 1), places, FAR)
    moves = jnp.where(orders.still, 0.0, jnp.stack(vessels.velocity))
    apart = orders.apart.swapaxes(0, 1)
    others = _circles(vessels, places, moves[:, :, None], apart, sums(vessels.hull))
    if settings.encounters.strategy == "wei2023":
        rows = jnp.concatenate([circles.rows, others.rows], axis=1)
        return Traffic(Circles(rows, rows.shape[1]), Circles(rows[:, :0], 0), course)
    return Traffic(circles, others, course)


def _circles(
    vessels: Vessels, place: Array, velocity: Array, reach: Array, touch: Array
) -> Circles:
    """Circles of places [2, K, n, lanes], and of the others what can be broadcast to them."""
    velocity = jnp.broadcast_to(velocity, place.shape)
    velocity = jnp.stack(less_drift(vessels, (velocity[0], velocity[1])))
    sizes = [jnp.broadcast_to(size, place.shape[1:])[None] for size in (reach, touch)]
    return Circles(jnp.concatenate([place, velocity, *sizes]), place.shape[1])
