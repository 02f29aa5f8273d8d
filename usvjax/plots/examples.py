"""Which episode a figure shows: chosen by a rule, not by eye."""

import numpy as np
import polars as pl

from usvjax.plots.distributions import both_reached
from usvkernels.status import Status


def middle_job(rows: pl.DataFrame, column: str) -> int:
    """Return the job at the lower median of a column, the lowest number among equals."""
    return int(rows.sort(column, "job")["job"][(len(rows) - 1) // 2])


def median_job(
    rows: pl.DataFrame, method: str, column: str, success: Status, what: str
) -> tuple[int, str]:
    """Choose the job of median length, or the like, among those in which every method succeeded.

    Args:
        rows: of one condition.
        method: whose length it is.
        column: a metric.
        success: the status that counts as success.
        what: words for such a job, should there be none: "query that every method solved".

    Returns:
        The job, and why it was chosen; the first job where there is none such.
    """
    kept = both_reached(rows, success).filter(pl.col("method") == method)
    if kept.is_empty():
        return int(rows["job"].min()), f"no {what}"  # type: ignore[arg-type]
    return middle_job(kept, column), "median length"


def spread_jobs(rows: pl.DataFrame, most: int) -> list[int]:
    """At most so many jobs, evenly over the rows of one method: no ending is preferred."""
    jobs = rows.sort("job")["job"].to_numpy()
    places = np.unique(np.linspace(0, len(jobs) - 1, min(most, len(jobs))).astype(int))
    chosen: list[int] = jobs[places].tolist()
    return chosen
