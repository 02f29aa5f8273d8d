"""The grey areas of Figs. 9, 10, 14 and 15: cells that the vessel saw or that were expanded."""

from typing import Any

import numpy as np

from experiments import estimates
from experiments.runs import Found, Ran
from experiments.yu2022.cruises.published import PROPOSED, RUNS
from experiments.yu2022.cruises.runs import ENCODINGS, ENVIRONMENTS, SWARMS, USUAL, label_of
from usvkernels.status import Status

REACH = 2
"""Cells that the vessel sees to each side (section 5.1: 5 x 5)."""


def seen_cells(track: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Cells within the vessel's window, anywhere along a track of cells int[P, 2]; bool[H, W]."""
    seen = np.zeros(shape, bool)
    for x, y in track:
        rows = slice(max(0, y - REACH), y + REACH + 1)
        seen[rows, max(0, x - REACH) : x + REACH + 1] = True
    return seen


def detection(found: Found, environment: str) -> dict[str, Any]:
    """Cells seen and cells expanded in Case 1 by Algorithm 4 and the proposed one, by encoding.

    Only the first runs are sailed again, as the tracks of a study are not kept.
    """
    ran = found.studies["cases"]
    areas: dict[str, Any] = {}
    for encoding, names in ENCODINGS.items():
        own = {n: _areas(ran, environment, m) for n, m in names.items() if n not in SWARMS}
        both = np.all([rows.pop("complete") for rows in own.values()], axis=0)
        areas[encoding] = {
            kind: {
                **{name: estimates.mean(rows[kind][both]) for name, rows in own.items()},
                "less": estimates.difference((own["gwo"][kind] - own[PROPOSED][kind])[both]),
                "n": int(both.sum()),
            }
            for kind in ("seen", "expanded")
        }
    return areas


def _areas(ran: Ran, environment: str, method: str) -> dict[str, np.ndarray]:
    label = label_of(environment, 1, USUAL)
    jobs = list(range(min(RUNS, ran.spec.episodes)))
    side = ENVIRONMENTS[environment].side
    (sailed,) = ran.replay(label, method, jobs).recording.detail
    tracks = (track[: steps + 1] for track, steps in zip(sailed.track, sailed.steps, strict=True))
    return {
        "seen": np.array([seen_cells(track, (side, side)).sum() for track in tracks], float),
        "expanded": sailed.expanded.astype(float),
        "complete": sailed.status == int(Status.REACHED),
    }
