"""Random corners among random obstacles: is every smoothed path sailable, and how fast."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from benchmarks.markdown import table, verdict
from benchmarks.timing import in_turns, spread
from usvjax.paths.turns import SmoothTurns, smooth_turns
from usvkernels.paths.turning import Turn

TITLE = "corners smoothed to the turning radius"
RADIUS = 15.0  # m: Chen 2023's vessel at 15 m/s and 1 rad/s
CELL = 3.0  # m
SIZE = 80  # cells
OBSTACLES = 6  # blocked discs a map
BOUNDS = {"gap": 1e-3, "tangent": 1e-5, "end": 1e-9}  # m, rad, m


@dataclass(frozen=True)
class CornerScenes:
    """Corners: two clear segments each, on a map of its own.

    Attributes:
        paths: float64[n, 3, 2], m.
        blocked: bool[n, SIZE, SIZE].
    """

    paths: np.ndarray
    blocked: np.ndarray


def random_corners(count: int, seed: int = 0) -> CornerScenes:
    """Corners of every deflection on maps of discs, off both segments by 0.3 m or more."""
    rng = np.random.default_rng(seed)
    middle = SIZE * CELL / 2
    y, x = (np.mgrid[:SIZE, :SIZE] + 0.5) * CELL
    paths, maps = [], []
    while len(paths) < count:
        course = rng.uniform(-np.pi, np.pi)
        turn = rng.uniform(-np.pi, np.pi)
        before, after = rng.uniform(20, 100, 2)
        corner = middle + rng.uniform(-10, 10, 2)
        first = corner - before * np.array([np.cos(course), np.sin(course)])
        last = corner + after * np.array([np.cos(course + turn), np.sin(course + turn)])
        blocked = np.zeros((SIZE, SIZE), bool)
        for _ in range(OBSTACLES):
            angle, away = rng.uniform(-np.pi, np.pi), rng.uniform(3, 60)
            centre = corner + away * np.array([np.cos(angle), np.sin(angle)])
            blocked |= np.hypot(x - centre[0], y - centre[1]) <= rng.uniform(2, 15)
        path = np.stack([first, corner, last])
        clear = 0.75 * CELL  # a disc of this radius covers a cell's corners
        gap = np.minimum(_distance(x, y, first, corner), _distance(x, y, corner, last))
        paths.append(path)
        maps.append(blocked & (gap > clear))
    return CornerScenes(np.stack(paths), np.stack(maps))


def _distance(x: np.ndarray, y: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    step = end - start
    share = ((x - start[0]) * step[0] + (y - start[1]) * step[1]) / (step @ step)
    share = np.clip(share, 0, 1)
    return np.hypot(x - start[0] - share * step[0], y - start[1] - share * step[1])


def smooth(scenes: CornerScenes, spacing: float = 0.5) -> SmoothTurns:
    """Smooth all corners in one call."""
    return smooth_turns(
        scenes.paths,
        None,
        scenes.blocked,
        turning_radius=RADIUS,
        cell_size=CELL,
        spacing=spacing,
    )


def check(scenes: CornerScenes, found: SmoothTurns) -> dict[str, float]:
    """How far the smoothed paths are from what they must be.

    Returns:
        "curvature": largest curvature times R; "gap": largest distance (m) and "tangent": largest
        angle (rad) between the end of a piece and the start of the next; "end": how far the ends
        moved (m); "hits": samples on a blocked cell.
    """
    pieces, rows = found.pieces, np.flatnonzero(found.fitted)
    joints = pieces.valid[:, 1:] & found.fitted[:, None]
    gap = np.linalg.norm(pieces.end[:, :-1] - pieces.start[:, 1:], axis=2)[joints]
    turned = (pieces.heading + pieces.sweep)[:, :-1] - pieces.heading[:, 1:]
    tangent = np.abs((turned + np.pi) % (2 * np.pi) - np.pi)[joints]
    last = found.counts - 1
    ends = np.stack([found.points[:, 0], found.points[np.arange(len(last)), last]], axis=1)
    moved = np.linalg.norm(ends - scenes.paths[:, [0, -1]], axis=2)
    cells = np.floor(found.points / CELL).astype(int)
    hit = scenes.blocked[np.arange(len(cells))[:, None], cells[..., 1], cells[..., 0]]
    return {
        "curvature": float(found.curvature_bound[rows].max(initial=0.0)) * RADIUS,
        "gap": float(gap.max(initial=0.0)),
        "tangent": float(tangent.max(initial=0.0)),
        "end": float(moved.max()),
        "hits": int(hit.sum()),
    }


def measure(quick: bool) -> dict[str, Any]:
    """Smooth random corners, check every one, and time it."""
    scenes = random_corners(100 if quick else 5000)
    found = smooth(scenes)
    calls = {"samples every 0.5 m": 0.5, "samples every 3 m": RADIUS / 5}
    timed = in_turns({name: partial(smooth, scenes, step) for name, step in calls.items()})
    cases = {turn.name: int((found.turns == turn).sum()) for turn in Turn}
    return {
        "corners": len(scenes.paths),
        "cases": cases,
        "worst": check(scenes, found),
        "timed": timed,
    }


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    worst, cases, count = found["worst"], found["cases"], found["corners"]
    turns = ", ".join(f"{name} {cases[name]:,}" for name in ("INSIDE", "LATE", "EARLY", "UNFITTED"))
    rows = [
        (
            name,
            f"{times['median'] * 1e3:.0f}",
            f"{count / times['median']:,.0f}",
            spread(times["seconds"]),
        )
        for name, times in found["timed"].items()
    ]
    verdicts = [
        verdict(
            f"curvature at most 1 / R (largest: {worst['curvature']:.7f} / R)",
            worst["curvature"] <= 1,
        ),
        verdict(
            f"tangents continuous to 1e-5 rad (largest: {worst['tangent']:.1e})",
            worst["tangent"] <= BOUNDS["tangent"],
        ),
        verdict(
            f"pieces joined to 1 mm (largest gap: {worst['gap']:.1e} m)",
            worst["gap"] <= BOUNDS["gap"],
        ),
        verdict(f"ends kept (moved by {worst['end']:.1e} m)", worst["end"] <= BOUNDS["end"]),
        verdict(f"no sample on a blocked cell ({worst['hits']} are)", worst["hits"] == 0),
    ]
    return (
        f"{count:,} corners of every deflection, R = {RADIUS:g} m, each on a map of {SIZE} x "
        f"{SIZE} cells of {CELL:g} m with {OBSTACLES} discs. How they are sailed: {turns}.\n\n"
        + "\n".join(verdicts)
        + "\n\n"
        + table(("", "ms", "paths/s", "timings"), rows)
    )
