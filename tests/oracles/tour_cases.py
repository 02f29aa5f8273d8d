"""Stations, and what is true of tours, in plain Python and NumPy."""

import itertools
from pathlib import Path

import numpy as np

TSPLIB = Path(__file__).parents[3] / "shared" / "data" / "tsplib"


def plain_length(order: list[int], distances: np.ndarray, closed: bool = True) -> float:
    """Leg by leg."""
    legs = sum(float(distances[a, b]) for a, b in itertools.pairwise(order))
    return legs + (float(distances[order[-1], order[0]]) if closed else 0.0)


def straight(points: np.ndarray) -> np.ndarray:
    """Euclidean distances float[d, d]."""
    return np.array([[np.linalg.norm(a - b) for b in points] for a in points])


def shortest(distances: np.ndarray, closed: bool = True) -> float:
    """The optimum, by trying every order."""
    others = itertools.permutations(range(1, len(distances)))
    return min(plain_length([0, *rest], distances, closed) for rest in others)


def neighbours(order: list[int], two_opt: bool, or_opt: bool) -> list[list[int]]:
    """All tours one 2-opt move, or one move of up to three stations, away."""
    count, found = len(order), []
    for start in range(count):
        turned = order[start:] + order[:start]
        if two_opt:
            found += [turned[:k][::-1] + turned[k:] for k in range(2, count)]
        if or_opt:
            for size in range(1, min(3, count - 2) + 1):
                part, rest = turned[:size], turned[size:]
                for place in range(1, len(rest)):
                    found.append(rest[:place] + part + rest[place:])
                    found.append(rest[:place] + part[::-1] + rest[place:])
    return found


def tsplib(name: str) -> np.ndarray:
    """Distances of an instance, rounded as EUC_2D says."""
    lines = (TSPLIB / f"{name}.tsp").read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("NODE_COORD_SECTION")) + 1
    rows = [line.split() for line in lines[first:]]
    points = np.array([[float(x) for x in row[1:]] for row in rows if len(row) == 3])
    return rounded(points)


def rounded(points: np.ndarray) -> np.ndarray:
    """Distances as TSPLIB's EUC_2D says, nearest whole numbers."""
    return np.floor(straight(points) + 0.5)
