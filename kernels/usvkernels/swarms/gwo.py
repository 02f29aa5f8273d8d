"""The grey wolf optimiser: a pack drawn to its three best, ever more closely.

Source: Mirjalili, Mirjalili and Lewis 2014, Advances in Engineering Software 69; Yu et al. 2022,
Eqs. 1 to 6 and 14.
"""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax
from jax.typing import DTypeLike

from usvkernels import draws
from usvkernels.swarms.laws import GwoParams, convergence
from usvkernels.swarms.pack import (
    Box,
    Found,
    Objective,
    evaluate,
    lowest,
    numbers,
    pick,
    scattered,
)

LEADERS = 3
"""Alpha, beta and delta; the least number of wolves too."""


@dataclass(frozen=True)
class GwoStatic:
    """Choices of method.

    Attributes:
        law: of a(t), one of `laws.LAWS`.
        leaders: "kept": the three best positions ever evaluated. In the authors' own program a new
            alpha displaces the old one; here that one becomes beta, as the text has it. "pack": the
            three best of the current pack.
        greedy: a wolf stays where it is unless the new position is better.
    """

    law: str = "linear"
    leaders: str = "kept"
    greedy: bool = False


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Wolves:
    """A pack under way.

    Attributes:
        x: float[n, dim, R], positions to evaluate next.
        home: float[n, dim, R] with `greedy`, best position of each wolf; else [0, dim, R].
        home_value: float[n, R] with `greedy`, there; else [0, R].
        kept: float[3, dim, R], the three best positions so far, best first.
        kept_value: float[3, R], there.
        nans: int32[R].
    """

    x: Array
    home: Array
    home_value: Array
    kept: Array
    kept_value: Array
    nans: Array


def run(
    fn: Objective,
    box: Box,
    seed: Array,
    params: GwoParams,
    static: GwoStatic,
    *,
    population: int,
    iterations: int,
) -> Found:
    """Minimise fn in R runs; population * iterations evaluations each.

    Args:
        fn: the function.
        box: its bounds; positions are clipped to them.
        seed: uint32[2, R].
        params: leaves float or float[R].
        static: choices of method.
        population: wolves, 3 or more.
        iterations: T.

    Returns:
        What was found.
    """
    dtype = box.low.dtype
    a = convergence(static.law, iterations, params, dtype)

    def step(wolves: Wolves, now: tuple[Array, Array]) -> tuple[Wolves, Array]:
        wolves = advance(fn, box, seed, static, wolves, *now)
        return wolves, wolves.kept_value[0]

    wolves = first_pack(scattered(seed, box, population), static)
    wolves, history = lax.scan(step, wolves, (jnp.arange(iterations), a))
    return Found(wolves.kept_value[0], wolves.kept[0], history, wolves.nans)


def first_pack(x: Array, static: GwoStatic) -> Wolves:
    """Wolves at x float[n, dim, R], none of them evaluated yet."""
    homes = x.shape[0] if static.greedy else 0
    return Wolves(
        x=x,
        home=x[:homes],
        home_value=jnp.full((homes, x.shape[2]), jnp.inf, x.dtype),
        kept=x[:LEADERS],
        kept_value=jnp.full((LEADERS, x.shape[2]), jnp.inf, x.dtype),
        nans=jnp.zeros(x.shape[2], jnp.int32),
    )


def advance(
    fn: Objective, box: Box, seed: Array, static: GwoStatic, wolves: Wolves, time: Array, a: Array
) -> Wolves:
    """Iteration `time`: evaluate the pack and move it by the factor `a` of shape [1] or [R]."""
    wolves, leaders, x = observe(fn, wolves, static)
    steps = coefficients(seed, time + 1, x.shape[:2], x.dtype)
    return replace(wolves, x=jnp.clip(surround(x, leaders, a, steps), box.low, box.high))


def observe(fn: Objective, wolves: Wolves, static: GwoStatic) -> tuple[Wolves, Array, Array]:
    """Evaluate the pack; returns it, its leaders float[3, dim, R], and where its wolves are."""
    value, nans = evaluate(fn, wolves.x)
    # The best of the pack first, and then of those six: the whole pack need not be copied.
    values, index = lowest(value, LEADERS)
    values = jnp.concatenate([wolves.kept_value, values])
    kept_value, of_six = lowest(values, LEADERS)
    kept = pick(jnp.concatenate([wolves.kept, pick(wolves.x, index)]), of_six)
    x, home_value = wolves.x, wolves.home_value
    if static.greedy:
        better = value < home_value
        x = jnp.where(better[:, None], wolves.x, wolves.home)
        home_value = jnp.where(better, value, home_value)
        value = home_value
    leaders = kept if static.leaders == "kept" else pick(x, lowest(value, LEADERS)[1])
    wolves = Wolves(
        x=x,
        home=x if static.greedy else wolves.home,
        home_value=home_value,
        kept=kept,
        kept_value=kept_value,
        nans=wolves.nans + nans,
    )
    return wolves, leaders, x


def coefficients(
    seed: Array, time: Array | int, shape: tuple[int, ...], dtype: DTypeLike
) -> list[tuple[Array, Array]]:
    """For each leader 2 r1 - 1 and 2 r2 of Eq. 1, float[n, dim, R] each."""
    first = numbers(seed, time, shape, 0)
    second = numbers(seed, time, shape, 1)
    drawn = [draws.signed(word, dtype) for word in (*first, *second[:2])]
    return [(drawn[2 * k], drawn[2 * k + 1] + 1) for k in range(LEADERS)]


def surround(x: Array, leaders: Array, a: Array, steps: list[tuple[Array, Array]]) -> Array:
    """Eqs. 3 to 6: the mean of what each leader draws a wolf to, with A = a (2 r1 - 1)."""
    drawn = [
        leader - a * towards * jnp.abs(c * leader - x)
        for leader, (towards, c) in zip(leaders, steps, strict=True)
    ]
    return sum(drawn[1:], drawn[0]) / LEADERS
