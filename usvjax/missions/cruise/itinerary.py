"""What a cruise does, stop by stop, as a table."""

from collections.abc import Mapping

import numpy as np
import polars as pl

from usvjax.missions.cruise import CruiseResult
from usvjax.missions.cruise.methods import CruisePosed, first_map
from usvkernels.status import Status


def itinerary(
    posed: CruisePosed, sailed: CruiseResult, legs: Mapping[str, np.ndarray]
) -> pl.DataFrame:
    """One cruise as a table with a row for each stop, home first and last.

    Args:
        posed: one cruise.
        sailed: how it went.
        legs: float64[1, d, d], m, distances between stations: "straight", and by "water" from
            cell to cell on the first map.

    Returns:
        stop: number in the order of the cruise, 0 for home at the start;
        station: number in the order given, 0 for home;
        x_m, y_m: where it lies;
        status: how the leg to it ended, in the words of `Status`;
        straight_m, water_m: from the stop before;
        sailed_m, time_s: from the start on, along the track pulled straight; null where the
        vessel did not come to the stop.
    """
    order = np.append(sailed.order[0], 0)
    x, y = first_map(posed).points_of(posed.scenes.stations[0][order]).T
    leg_status = sailed.leg_status[0]
    step = np.append(0, np.where(leg_status == int(Status.REACHED), sailed.leg_step[0], -1))
    length, time = _since_start(posed, sailed)
    way_step = sailed.smoothed_step[0, : sailed.smoothed_count[0]]
    # Stops that were reached are way points; a vessel waits at one, if anywhere, after it.
    place = np.searchsorted(way_step, np.maximum(step, 0))
    columns = {
        "stop": np.arange(len(order)),
        "station": order,
        "x_m": x,
        "y_m": y,
        "status": ["start", *(Status(int(status)).name.lower() for status in leg_status)],
        **{
            f"{name}_m": np.append(0.0, between[0][order[:-1], order[1:]])
            for name, between in legs.items()
        },
        "sailed_m": length[place],
        "time_s": time[place],
    }
    come = pl.Series(step >= 0)
    return pl.DataFrame(columns).with_columns(
        pl.when(come).then(pl.col(name)).alias(name) for name in ("sailed_m", "time_s")
    )


def _since_start(posed: CruisePosed, sailed: CruiseResult) -> tuple[np.ndarray, np.ndarray]:
    """Length (m) and time (s) from the start to each way point, float64[Q]."""
    cell_size, speed = posed.source.cell_size, posed.options.params.speed
    count = sailed.smoothed_count[0]
    chords = np.diff(sailed.smoothed[0, :count].astype(np.float64), axis=0)
    length = cell_size * np.append(0.0, np.cumsum(np.hypot(*chords.T)))
    track = sailed.track[0, : sailed.steps[0] + 1]
    waits = np.append(0, np.cumsum((np.diff(track, axis=0) == 0).all(axis=1)))
    time = (length + cell_size * waits[sailed.smoothed_step[0, :count]]) / speed
    return length, time
