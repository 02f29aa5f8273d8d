"""Grey wolves in plain NumPy and float64, and the generator's words in whole Python numbers."""

from collections.abc import Callable

import numpy as np

Objective = Callable[[np.ndarray], np.ndarray]  # float[..., dim] -> float[...]
Step = Callable[[int, tuple[int, ...]], tuple[np.ndarray, np.ndarray]]
"""Draws (r1, r2) in [0, 1] of an iteration, float[leader, wolf, dim] each."""

FUNCTIONS: dict[str, Objective] = {
    "f1": lambda x: (x**2).sum(-1),
    "f2": lambda x: np.abs(x).max(-1),
    "f3": lambda x: (x**2 - 10 * np.cos(2 * np.pi * x) + 10).sum(-1),
    "f4": lambda x: np.abs(x * np.sin(x) + 0.1 * x).sum(-1),
}


def words(first: int, second: int, time: int, index: int) -> list[int]:
    """pcg4d of one counter, with a last shift."""
    state = [(1664525 * v + 1013904223) % 2**32 for v in (first, second, time, index)]
    for _ in range(2):
        for into, a, b in ((0, 1, 3), (1, 2, 0), (2, 0, 1), (3, 1, 2)):
            state[into] = (state[into] + state[a] * state[b]) % 2**32
        state = [v ^ (v >> 16) for v in state]
    return state


def hunt(
    fn: Objective,
    x: np.ndarray,
    bounds: tuple[float, float],
    factors: np.ndarray,
    step: Step,
    leaders: str = "kept",
    greedy: bool = False,
) -> tuple[list[np.ndarray], np.ndarray]:
    """One run, wolf by wolf.

    Args:
      fn: objective.
      x: float[wolves, dim], where the pack begins.
      bounds: (low, high).
      factors: a(t) for each iteration.
      step: draws.
      leaders: "kept" or "pack".
      greedy: keep each wolf's best position.

    Returns:
      The pack after every iteration, and the least value up to each.
    """
    best_three: list[tuple[float, np.ndarray]] = []
    home: list[tuple[float, np.ndarray]] = [(np.inf, place) for place in x]
    packs, history = [], []
    for t, a in enumerate(factors):
        pack = [(float(fn(place)), place) for place in x]
        best_three = sorted([*best_three, *pack], key=lambda one: one[0])[:3]
        if greedy:
            home = [new if new[0] < old[0] else old for new, old in zip(pack, home, strict=True)]
            pack = home
        ranked = sorted(pack, key=lambda one: one[0])[:3] if leaders == "pack" else best_three
        r1, r2 = step(t, x.shape)
        moved = np.zeros_like(x)
        for wolf, (_, place) in enumerate(pack):
            for k, (_, leader) in enumerate(ranked):
                distance = np.abs(2 * r2[k, wolf] * leader - place)
                moved[wolf] += leader - (2 * a * r1[k, wolf] - a) * distance
        x = np.clip(moved / 3, *bounds)
        packs.append(x)
        history.append(best_three[0][0])
    return packs, np.array(history)


def hunts(
    fn: Objective,
    rng: np.random.Generator,
    bounds: tuple[float, float],
    *,
    runs: int,
    wolves: int,
    dim: int,
    iterations: int,
) -> np.ndarray:
    """Least values float[runs] of textbook runs side by side, leaders kept, a from 2 to 0."""
    x = rng.uniform(*bounds, (runs, wolves, dim))
    kept = np.full((runs, 3), np.inf), np.zeros((runs, 3, dim))
    for t in range(iterations):
        values = np.concatenate([kept[0], fn(x)], axis=1)
        places = np.concatenate([kept[1], x], axis=1)
        order = np.argsort(values, axis=1, kind="stable")[:, :3]
        kept = (
            np.take_along_axis(values, order, 1),
            np.take_along_axis(places, order[:, :, None], 1),
        )
        a = 2 - 2 * t / iterations
        moved = np.zeros_like(x)
        for k in range(3):
            leader = kept[1][:, k, None]
            r1, r2 = rng.random((2, *x.shape))
            moved += leader - (2 * a * r1 - a) * np.abs(2 * r2 * leader - x)
        x = np.clip(moved / 3, *bounds)
    return kept[0][:, 0]
