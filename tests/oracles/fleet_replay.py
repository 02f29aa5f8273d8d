"""A recorded fleet judged again, step by step, in NumPy and double precision."""

import numpy as np

ENDINGS = {"RUNNING": 0, "REACHED": 1, "COLLIDED": 2, "STUCK": 3, "TIMED_OUT": 4}


def step_errors(track: np.ndarray, dt: float) -> tuple[float, float]:
    """Largest error of place (m) and heading (rad) against the unicycle's Euler step.

    Args:
        track: float[T, n, 5], as recorded.
        dt: s.
    """
    x, y, psi, v, w = np.moveaxis(track.astype(np.float64), -1, 0)
    place = np.maximum(
        np.abs(x[:-1] + v[1:] * dt * np.cos(psi[:-1]) - x[1:]),
        np.abs(y[:-1] + v[1:] * dt * np.sin(psi[:-1]) - y[1:]),
    )
    turned = psi[:-1] + w[1:] * dt - psi[1:]
    return float(place.max()), float(np.abs((turned + np.pi) % (2 * np.pi) - np.pi).max())


def excess(track: np.ndarray, v_max: np.ndarray, limits: dict[str, float], dt: float) -> float:
    """By how much the worst command breaks a limit, as a share of the limit."""
    v, w = track[..., 3].astype(np.float64), track[..., 4].astype(np.float64)
    running = np.abs(np.diff(track[..., :3], axis=0)).sum(axis=-1) > 0
    over = [
        np.max(v / v_max) - 1,
        np.max(-v),
        np.max(np.abs(w)) / limits["w_max"] - 1,
        np.max(np.diff(v, axis=0)) / (limits["v_acc"] * dt) - 1,
        np.max(-np.diff(v, axis=0)) / (limits["v_dec"] * dt) - 1,
        # Who has arrived stops turning at once.
        np.max(np.abs(np.diff(w, axis=0)) * (running & (w[1:] != 0))) / (limits["w_acc"] * dt) - 1,
    ]
    return float(max(over))


def separations(track: np.ndarray, hull: np.ndarray) -> np.ndarray:
    """Least distance between hulls in each step and pair, float64[T - 1, n, n]; inf of oneself."""
    place = track[..., :2].astype(np.float64)
    apart = place[:, None] - place[:, :, None]
    start, way = apart[:-1], np.diff(apart, axis=0)
    square = np.maximum(np.sum(way * way, axis=-1), 1e-300)
    share = np.clip(-np.sum(start * way, axis=-1) / square, 0, 1)
    least = np.linalg.norm(start + share[..., None] * way, axis=-1)
    least -= hull[:, None] + hull
    least[:, np.arange(len(hull)), np.arange(len(hull))] = np.inf
    return least


def clearances(track: np.ndarray, circles: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Least distance from each hull to a circle in each step, float64[T - 1, n]."""
    place = track[..., :2].astype(np.float64)
    start, way = place[:-1, :, None] - circles, np.diff(place, axis=0)[:, :, None]
    square = np.maximum(np.sum(way * way, axis=-1), 1e-300)
    share = np.clip(-np.sum(start * way, axis=-1) / square, 0, 1)
    return np.linalg.norm(start + share[..., None] * way, axis=-1).min(axis=-1) - reach
