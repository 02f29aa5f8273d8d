"""Random situations of the dynamic window, shared by the oracle and property tests."""

from contextlib import AbstractContextManager
from dataclasses import dataclass, fields
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from benchmarks.peers import Settings, dwa_numpy
from usvjax.ambient import precision
from usvjax.missions.dwa.params import DwaParams, DwaStatic, split
from usvkernels.dwa import candidates as dwa
from usvkernels.dwa.window import Motion

Floats = npt.NDArray[np.float64]

FAMILIES = ("open", "dense", "near", "reverse", "limits", "far", "trapped", "rest", "grid")


def enable_x64() -> AbstractContextManager[None]:
    """Let JAX compute in float64 inside a `with` block; compiled float32 code is kept apart."""
    return precision(double=True)


@dataclass(frozen=True)
class Situations:
    """S situations with K obstacle rows, in float64 but exactly representable in float32."""

    states: Floats  # [S, 5] (x, y, psi, v, w)
    obstacles: Floats  # [S, K, 2], m
    valid: npt.NDArray[np.bool_]  # [S, K]
    goals: Floats  # [S, 2], m
    family: npt.NDArray[np.int64]  # [S] index into FAMILIES

    def __len__(self) -> int:
        return len(self.states)

    def rows(self, index: slice | npt.NDArray) -> "Situations":
        """Pick situations."""
        return Situations(
            self.states[index],
            self.obstacles[index],
            self.valid[index],
            self.goals[index],
            self.family[index],
        )


def situations(rng: np.random.Generator, n: int, k: int, s: Settings) -> Situations:
    """Draw n situations, all families in turn, in a water of 10 m x 10 m.

    Dense and sparse obstacles, obstacles a hand's breadth away, motion astern, speeds at the
    limits, goals kilometres away, no way out at all, vessels at rest, everything on integers.
    """
    family = np.arange(n) % len(FAMILIES)
    states = np.stack(
        [
            rng.uniform(0.0, 10.0, n),
            rng.uniform(0.0, 10.0, n),
            rng.uniform(-np.pi, np.pi, n),
            rng.uniform(s.v_min, s.v_max, n),
            rng.uniform(s.w_min, s.w_max, n),
        ],
        axis=1,
    )
    obstacles = rng.uniform(-2.0, 12.0, (n, k, 2))
    valid = rng.random((n, k)) < rng.uniform(0.0, 1.0, (n, 1))
    goals = rng.uniform(0.0, 10.0, (n, 2))

    def of(name: str) -> npt.NDArray[np.bool_]:
        return family == FAMILIES.index(name)

    valid[of("open")] &= rng.random((of("open").sum(), k)) < 0.15
    valid[of("dense")] = True
    angle = rng.uniform(-np.pi, np.pi, (n, k))
    around = np.stack((np.cos(angle), np.sin(angle)), axis=2)
    close = states[:, None, :2] + around * (s.radius + rng.uniform(0.0, 2.0, (n, k, 1)) ** 2)
    obstacles[of("near")] = close[of("near")]
    states[of("reverse"), 3] = rng.uniform(s.v_min, 0.0, of("reverse").sum())
    edges = rng.integers(0, 2, (2, n))
    at = of("limits")
    states[at, 3] = np.where(edges[0, at], s.v_min, s.v_max)
    states[at, 4] = np.where(edges[1, at], s.w_min, s.w_max)
    goals[of("far")] = rng.uniform(-5e3, 5e3, (of("far").sum(), 2))
    inside = states[:, None, :2] + around * s.radius * np.sqrt(rng.random((n, k, 1)))
    obstacles[of("trapped")] = inside[of("trapped")]
    valid[of("trapped")] = True
    states[of("rest"), 3:] = 0.0
    at = of("grid")
    states[at, :2], obstacles[at], goals[at] = (
        np.round(a[at]) for a in (states[:, :2], obstacles, goals)
    )
    states[at, 3] = np.round(states[at, 3] / s.v_step) * s.v_step
    states[at, 4] = np.round(states[at, 4] / s.w_step) * s.w_step
    exact = (a.astype(np.float32).astype(np.float64) for a in (states, obstacles, goals))
    states, obstacles, goals = exact
    return Situations(states, obstacles, valid, goals, family)


@partial(jax.jit, static_argnums=1)
def weigh(
    params: DwaParams,
    static: DwaStatic,
    motion: Motion,
    obstacles: jax.Array,
    goal: jax.Array,
) -> tuple[dwa.Candidates, tuple[jax.Array, ...], tuple[jax.Array, jax.Array]]:
    vessel, sampling, objective, rules = split(params, static)
    sight = motion, obstacles, rules.radius, goal
    found = dwa.candidates(vessel, sampling, objective, *sight)
    return found, dwa.choose(found), dwa.decide(vessel, sampling, objective, *sight)


def parameters(s: Settings) -> tuple[DwaParams, DwaStatic]:
    """Say to the kernel what the settings say to the peers."""
    numbers, choices = (
        {f.name: getattr(s, f.name) for f in fields(kind) if hasattr(s, f.name)}
        for kind in (DwaParams, DwaStatic)
    )
    return DwaParams(**numbers), DwaStatic(**choices)


def kernel(s: Settings, case: Situations, params: DwaParams | None = None) -> dwa_numpy.Decision:
    """Lay out what the kernel finds as the oracle does, in the arithmetic that JAX is set to.

    `params`, where given, replaces the numbers of `s`; its leaves may hold one value per situation.
    The margins are the oracle's business and stay empty.
    """
    real = jnp.asarray(0.0).dtype
    numbers, static = parameters(s)
    motion = Motion(jnp.asarray(case.states.T, real))
    centres = np.where(case.valid[:, :, None], case.obstacles, dwa.FAR).transpose(2, 1, 0)
    goal = jnp.asarray(case.goals.T, real)
    result = weigh(params or numbers, static, motion, jnp.asarray(centres, real), goal)
    found, (row, column, some), command = jax.tree.map(np.asarray, result)

    def flat(a: npt.NDArray) -> npt.NDArray:
        return np.broadcast_to(a, found.score.shape).reshape(s.n_v * s.n_w, len(case)).T

    return dwa_numpy.Decision(
        chosen=np.where(some, row * static.n_w + column, -1),
        command=np.stack(command, axis=1),
        v=flat(found.v[:, None]),
        w=flat(found.w[None]),
        end=np.stack([flat(found.end_x), flat(found.end_y)], axis=2),
        clearance=flat(found.clearance),
        admissible=flat(found.admissible),
        heading=np.pi - flat(found.heading_error),
        score=flat(found.score),
        margin=np.zeros(0),
        rate_margin=np.zeros(0),
    )
