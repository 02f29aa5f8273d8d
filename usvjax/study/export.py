"""Recorded episodes as tables."""

from pathlib import Path

import numpy as np
import polars as pl

from usvjax.mission import Replayed
from usvjax.plots.style import write_atomically

_WORDS = {"s": "time_s", "m": "distance_m"}


def tracks_table(replayed: Replayed) -> pl.DataFrame:
    """Where the vessels of some episodes were.

    Returns:
        job; time_s, or distance_m of routes, which nobody sails yet; vessel, from 0; x_m, y_m.
        A row for each vessel at each time, those where it was not there left out.
    """
    parts = []
    for job, track in zip(replayed.jobs, replayed.recording.tracks, strict=True):
        times, vessels = track.places.shape[:2]
        columns = {
            "job": np.full(times * vessels, job),
            _WORDS[track.unit]: np.repeat(track.along, vessels),
            "vessel": np.tile(np.arange(vessels), times),
            "x_m": track.places[..., 0].ravel(),
            "y_m": track.places[..., 1].ravel(),
        }
        parts.append(pl.DataFrame(columns))
    table = pl.concat(parts)
    return table.filter(pl.col("x_m").is_finite() & pl.col("y_m").is_finite())


def write_tracks(replayed: Replayed, path: Path) -> Path:
    """Write `tracks_table` as CSV, whole or not at all.

    Raises:
        BadInputError: the place cannot be written.
    """
    text = tracks_table(replayed).write_csv()
    return write_atomically(path, lambda file: file.write_text(text, encoding="utf-8"))
