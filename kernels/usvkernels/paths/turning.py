"""Corners of a path turned into arcs that a vessel can sail (Chen et al. 2023, Algorithm 1).

A path of straight segments becomes segments and arcs of radius R or more that meet tangentially.
At a corner T with deflection a, course d1 before and d2 after it, the templates are, to be
tried in this order:

1. INSIDE: one arc inside the corner, tangent to both segments at a distance t from T; its
   radius is t / tan(a / 2). First with t = R_s, and where this does not fit with the least
   possible t = R tan(a / 2). Where R_s is the smaller of the two, t is the least possible.
2. LATE: straight on to T, then an arc of R through a + b, across the outgoing line, and one
   back through b that ends on it, cos b = (1 + cos a) / 2. At a right angle b is 60 deg: the
   chords inclined by 45 and 30 deg of Eqs. 8 and 9. It ends R sin a + 2 R sin b past T.
3. EARLY: the same mirrored in time: out through b before T, back through a + b, at T on course.

Two corners share the segment between them. Which template each corner gets is settled for the
path as a whole: fewest corners without, then lowest numbers, by dynamic programming.
"""

from dataclasses import dataclass
from enum import IntEnum
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.paths.arcs import Primitives, arc_point, near_blocked
from usvkernels.paths.charts import Charts
from usvkernels.trig import wrap_angle

STRAIGHT = 1e-6
"""Deflection (rad) below which there is no corner."""

ROUNDING = 2e-6
"""Arcs are drawn wider by this share, so that rounding cannot lift a curvature over 1 / R."""

SAMPLE = 0.5
"""Greatest distance (cells) between two points of an arc that are tested for collision."""

_SLACK = 1e-3  # cells, for what rounding does to the place of such a point
_UNFITTED_COST = 1000


class Turn(IntEnum):
    """How a corner is sailed."""

    UNFITTED = -1  # no template fits; the corner stays
    NONE = 0  # no corner
    INSIDE = 1
    LATE = 2
    EARLY = 3


CASES = (Turn.INSIDE, Turn.INSIDE, Turn.LATE, Turn.EARLY)
"""What the columns of `Templates` are."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Corners:
    """Interior points of paths; C = P - 2. Lengths in the unit of the points."""

    point: Array  # float[B, C, 2]
    course: Array  # float[B, C + 1, 2], unit vectors of the segments; 0 where none is
    segment: Array  # float[B, C + 1], their lengths
    deflection: Array  # float[B, C], signed, rad; positive to port
    half_tangent: Array  # float[B, C], tan(|deflection| / 2)
    turns: Array  # bool[B, C], False at padding and where the path goes straight on


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Templates:
    """Candidates for every corner; K = len(CASES). Arcs of no length are absent."""

    before: Array  # float[B, C, K], how much of the segment before the corner is needed
    after: Array  # float[B, C, K], of that after it; inf where the template is impossible
    start: Array  # float[B, C, K, 2]
    heading: Array  # float[B, C, K], at the start, rad
    length: Array  # float[B, C, K, 2], of the first and of the second arc
    curvature: Array  # float[B, C, K, 2], signed; positive to port


def find_corners(points: Array, counts: Array) -> Corners:
    """Corners of paths.

    Args:
        points: float[B, P, 2], P >= 3; no point equals the one before it.
        counts: int32[B], points of each path, at most P.
    """
    slot = jnp.arange(points.shape[1], dtype=jnp.int32)
    step = jnp.where((slot[1:] < counts[:, None])[..., None], points[:, 1:] - points[:, :-1], 0.0)
    segment = jnp.sqrt(jnp.sum(step * step, axis=-1))
    course = step / jnp.where(segment > 0.0, segment, 1.0)[..., None]
    before, after = course[:, :-1], course[:, 1:]
    along = jnp.sum(before * after, axis=-1)
    across = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
    deflection = jnp.arctan2(across, along)
    # Two forms of the tangent of half the angle, each exact where the other loses its digits.
    half_tangent = jnp.where(
        along > 0.0,
        jnp.abs(across) / jnp.where(along > 0.0, 1.0 + along, 1.0),
        (1.0 - along) / jnp.where(across == 0.0, 1e-30, jnp.abs(across)),
    )
    exists = slot[1:-1] < counts[:, None] - 1
    return Corners(
        point=points[:, 1:-1],
        course=course,
        segment=segment,
        deflection=deflection,
        half_tangent=half_tangent,
        turns=exists & (jnp.abs(deflection) > STRAIGHT),
    )


def make_templates(corners: Corners, radius: Array, reach: Array) -> Templates:
    """The candidates of every corner.

    Args:
        corners: of `find_corners`.
        radius: float[B], least turning radius R.
        reach: float[B], R_s, where the wider inside arc leaves and meets the segments.
    """
    radius = (radius * (1.0 + ROUNDING))[:, None]
    angle, side = jnp.abs(corners.deflection), jnp.sign(corners.deflection)
    least = radius * corners.half_tangent
    wide = jnp.maximum(reach[:, None], least)
    half = jnp.sin(0.5 * angle)
    less = half * half  # 1 - cos b = (1 - cos a) / 2, without the cancellation
    sin_back = jnp.sqrt(less * (2.0 - less))
    back = jnp.arctan2(sin_back, 1.0 - less)
    past = radius * (jnp.sin(angle) + 2.0 * sin_back)
    none, over, under = jnp.zeros_like(least), radius * (angle + back), radius * back
    sharp = side / radius

    def inside(tangent: Array) -> tuple[Array, Array]:
        curvature = jnp.minimum(corners.half_tangent / tangent, 1.0 / radius)
        length = angle / jnp.where(corners.turns, curvature, 1.0)
        return jnp.stack([length, none], -1), jnp.stack([side * curvature, none], -1)

    arcs = (
        inside(wide),
        inside(jnp.where(least > 0.0, least, 1.0)),
        (jnp.stack([over, under], -1), jnp.stack([sharp, -sharp], -1)),
        (jnp.stack([under, over], -1), jnp.stack([-sharp, sharp], -1)),
    )
    before = jnp.stack([wide, least, none, past], -1)
    ahead = corners.course[:, :-1]
    heading = jnp.arctan2(ahead[..., 1], ahead[..., 0])
    return Templates(
        before=before,
        after=jnp.stack([wide, least, past, none], -1),
        start=corners.point[:, :, None] - before[..., None] * ahead[:, :, None],
        heading=jnp.broadcast_to(heading[..., None], before.shape),
        length=jnp.stack([length for length, _ in arcs], axis=2),
        curvature=jnp.stack([curvature for _, curvature in arcs], axis=2),
    )


def free_of_obstacles(
    templates: Templates,
    wanted: Array,
    charts: Charts,
    cell_size: Array | float,
    margin: Array | float,
    samples: Array | int,
) -> Array:
    """Whether the arcs of the candidates keep off every blocked cell; never wrong when True.

    An arc is tested at `samples` points. None of its points is farther than half their
    spacing from one of them, so it keeps `margin` when these keep `margin` and that much more.

    Args:
        templates: candidates, in the frame of the map's corner (m).
        wanted: bool[B, C, K]; the others need no answer.
        charts: each path's map.
        cell_size: m.
        margin: m, distance that arcs keep to blocked cells, less than a quarter of a cell.
        samples: points, at least the longest candidate over SAMPLE cells.

    Returns:
        bool[B, C, K].
    """
    first, total = templates.length[..., 0], jnp.sum(templates.length, axis=-1)
    total = jnp.where(wanted, total, 0.0)
    start = (templates.start[..., 0], templates.start[..., 1])
    turned = templates.heading + templates.curvature[..., 0] * first
    middle = arc_point(start, templates.heading, templates.curvature[..., 0], first)
    reach = (margin + total / (2 * samples)) / cell_size + _SLACK

    def test(i: Array, near: Array) -> Array:
        distance = total * ((i + 0.5) / samples)
        late = distance > first
        x, y = arc_point(
            (jnp.where(late, middle[0], start[0]), jnp.where(late, middle[1], start[1])),
            jnp.where(late, turned, templates.heading),
            jnp.where(late, templates.curvature[..., 1], templates.curvature[..., 0]),
            jnp.where(late, distance - first, distance),
        )
        return near | near_blocked(charts, x / cell_size, y / cell_size, reach)

    return wanted & ~jax.lax.fori_loop(0, samples, test, jnp.zeros(wanted.shape, bool))


def fits_alone(corners: Corners, templates: Templates) -> Array:
    """Whether a candidate fits its two segments, no other corner considered; bool[B, C, K]."""
    segment = corners.segment[..., None]
    fits = (templates.before <= segment[:, :-1]) & (templates.after <= segment[:, 1:])
    return fits & corners.turns[..., None]


def allocate(corners: Corners, templates: Templates, usable: Array) -> Array:
    """Choose a candidate for every corner so that neighbours fit the segment they share.

    Args:
        corners: of `find_corners`.
        templates: their candidates.
        usable: bool[B, C, K], candidates that fit alone and are free of obstacles.

    Returns:
        int32[B, C], the column of the candidate, K where the corner stays as it is.
    """
    count = usable.shape[-1]
    rows = usable.shape[0]
    idle = jnp.zeros((*usable.shape[:2], 1), templates.before.dtype)
    before = jnp.concatenate([templates.before, idle], axis=-1)
    after = jnp.concatenate([templates.after, idle], axis=-1)
    price = jnp.where(usable, jnp.arange(count, dtype=jnp.int32), 2 * _UNFITTED_COST)
    staying = jnp.where(corners.turns, _UNFITTED_COST, 0).astype(jnp.int32)
    price = jnp.concatenate([price, staying[..., None]], axis=-1)
    never = jnp.int32(2**29)

    def extend(carry: tuple[Array, Array], corner: tuple[Array, ...]) -> tuple[tuple, Array]:
        best, used = carry  # [B, K + 1] of the corner before
        price, before, after, segment = corner
        room = used[:, :, None] + before[:, None, :] <= segment[:, None, None]
        paths = jnp.where(room, best[:, :, None], never)
        source = jnp.argmin(paths, axis=1).astype(jnp.int32)
        return (jnp.min(paths, axis=1) + price, after), source

    by_corner = (price, before, after, corners.segment[:, :-1])
    first = (
        jnp.zeros((rows, count + 1), jnp.int32),
        jnp.zeros((rows, count + 1), templates.before.dtype),
    )
    (best, _), source = jax.lax.scan(
        extend, first, jax.tree.map(lambda a: a.swapaxes(0, 1), by_corner)
    )

    def follow(chosen: Array, source: Array) -> tuple[Array, Array]:
        earlier = jnp.take_along_axis(source, chosen[:, None], axis=1)[:, 0]
        return earlier, chosen

    last = jnp.argmin(best, axis=-1).astype(jnp.int32)
    _, chosen = jax.lax.scan(follow, last, source, reverse=True)
    return chosen.swapaxes(0, 1)


def cases_of(corners: Corners, chosen: Array) -> Array:
    """int32[B, C] of `Turn`, for what `allocate` chose."""
    case = jnp.array([*CASES, Turn.UNFITTED], jnp.int32)[chosen]
    return jnp.where(corners.turns, case, Turn.NONE)


def assemble(first: Array, corners: Corners, templates: Templates, chosen: Array) -> Primitives:
    """The smoothed paths.

    Args:
        first: float[B, 2], where the paths begin.
        corners: of `find_corners`.
        templates: their candidates.
        chosen: int32[B, C] of `allocate`.
    """
    turned = chosen < templates.before.shape[-1]

    def pick(values: Array, staying: Array | float) -> Array:
        place = jnp.where(turned, chosen, 0).reshape(chosen.shape + (1,) * (values.ndim - 2))
        picked = jnp.take_along_axis(values, place, axis=2)[:, :, 0]
        return jnp.where(turned.reshape(turned.shape + (1,) * (picked.ndim - 2)), picked, staying)

    before, after = pick(templates.before, 0.0), pick(templates.after, 0.0)
    place = pick(templates.start, corners.point)
    length, curvature = pick(templates.length, 0.0), pick(templates.curvature, 0.0)
    heading = jnp.arctan2(corners.course[..., 1], corners.course[..., 0])
    h0 = heading[:, :-1]
    h1 = wrap_angle(h0 + curvature[..., 0] * length[..., 0])
    start = (place[..., 0], place[..., 1])
    middle = arc_point(start, h0, curvature[..., 0], length[..., 0])
    leave = corners.point + after[..., None] * corners.course[:, 1:]
    zero = jnp.zeros((chosen.shape[0], 1), before.dtype)
    straight = corners.segment - jnp.concatenate([zero, after], 1)
    straight = jnp.maximum(straight - jnp.concatenate([before, zero], 1), 0.0)
    begin = jnp.concatenate([first[:, None], leave], axis=1)

    def interleave(segment: Array, arc: Array, second: Array) -> Array:
        body = jnp.stack([segment[:, :-1], arc, second], axis=2)
        return jnp.concatenate(
            [body.reshape(body.shape[0], -1, *body.shape[3:]), segment[:, -1:]], 1
        )

    return Primitives(
        start=interleave(begin, place, jnp.stack(middle, -1)),
        heading=interleave(heading, h0, h1),
        length=interleave(straight, length[..., 0], length[..., 1]),
        curvature=interleave(jnp.zeros_like(straight), curvature[..., 0], curvature[..., 1]),
    )


def smooth(
    charts: Charts,
    points: Array,
    counts: Array,
    radius: Array,
    reach: Array,
    cell_size: Array | float,
    margin: Array | float,
    samples: Array | int,
) -> tuple[Corners, Array, Primitives]:
    """Smooth paths: Algorithm 1 of Chen et al. 2023 from corners to segments and arcs.

    Args:
        charts: each path's map, inflated.
        points: float[B, P, 2], P >= 3, in the frame of the map's corner (m); no point of a path
            equals the one before it, and its segments are clear.
        counts: int32[B], points of each path.
        radius, reach: float[B], R and R_s (m).
        cell_size, margin, samples: as `free_of_obstacles`.

    Returns:
        The corners, how each is sailed (int32[B, C] of `Turn`), and the segments and arcs.
    """
    corners = find_corners(points, counts)
    templates = make_templates(corners, radius, reach)
    fits = fits_alone(corners, templates)
    free = free_of_obstacles(templates, fits, charts, cell_size, margin, samples)
    chosen = allocate(corners, templates, free)
    return corners, cases_of(corners, chosen), assemble(points[:, 0], corners, templates, chosen)
