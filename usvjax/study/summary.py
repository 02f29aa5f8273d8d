"""What a study found: rates, averages and paired differences, each with how much it rests on.

The summary is computed from the Parquet shards alone, one condition at a time, so a resumed
run ends with the same bytes as an uninterrupted one.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
import polars as pl

from usvjax.statistics import (
    RESAMPLES,
    Averages,
    averages,
    holm,
    paired_difference,
    paired_rates,
    wilson,
)
from usvjax.study.looks import width
from usvjax.study.runner import Progress
from usvjax.study.shards import Unit
from usvjax.study.spec import Condition, StudySpec, plain
from usvjax.study.store import RunDirectory

FORMAT = 1
"""Version of the layout of summary.json."""

_DIGITS = 10


def summarise(spec: StudySpec, run: RunDirectory, progress: Progress) -> dict[str, Any]:
    """Summarise a finished run.

    Args:
        spec: the study.
        run: its run directory.
        progress: how many episodes each condition took.

    Returns:
        JSON-able: "study" (what was run, levels, looks) and "conditions", each with
        "methods" (counts, rates, averages over each method's own successes) and "pairs"
        (against the baseline, over the episodes where both succeed). Missing figures are None.
        Averages and differences leave out infinite values, such as the clearance of an episode
        that never sensed an obstacle: where there are any, "infinite" says how many, and "n" is
        of the others. "relative" is the mean difference as a share of the baseline's mean, None
        where a ratio has no meaning; the differences of shares have "points" besides, percentage
        points.
    """
    conditions = [_condition(spec, run, condition, progress) for condition in spec.conditions]
    _correct(conditions, len(progress.looks))
    study = {
        "name": spec.name,
        "kind": spec.kind,
        "hash": spec.hash,
        "seed": spec.seed,
        "baseline": spec.baseline,
        "methods": list(spec.methods),
        "success": spec.mission.endings[0].name,
        "confidence": spec.confidence,
        "level": progress.level,
        "looks": list(progress.looks),
        "until": spec.until,
        "resamples": RESAMPLES,
        "metrics": [asdict(m) for m in spec.mission.metrics if m.summarised],
        "counted": [asdict(m) for m in spec.mission.metrics if m.counted],
        "families": _families(conditions),
    }
    rounded: dict[str, Any] = _rounded({"format": FORMAT, "study": study, "conditions": conditions})
    return rounded


def _condition(
    spec: StudySpec, run: RunDirectory, condition: Condition, progress: Progress
) -> dict[str, Any]:
    episodes = progress.episodes[condition.index]
    table = _rows(spec, run, condition.index, episodes)
    columns = {
        method: table.filter(pl.col("method") == method).sort("job") for method in spec.methods
    }
    methods = [_method(spec, condition, m, columns[m], progress) for m in spec.methods]
    pairs = [
        _pair(spec, condition, m, columns[m], columns[spec.baseline], progress)
        for m in spec.methods
        if m != spec.baseline
    ]
    result: dict[str, Any] = {
        "index": condition.index,
        "label": condition.label,
        "varied": plain(condition.varied),
        "episodes": episodes,
        "methods": methods,
        "pairs": pairs,
    }
    if spec.until is not None:
        widest = max(width(wilson(m["successes"], episodes, progress.level)) for m in methods)
        result["widest"] = widest
        result["narrow_enough"] = widest <= spec.until
    return result


def _rows(spec: StudySpec, run: RunDirectory, condition: int, episodes: int) -> pl.DataFrame:
    """Read the first `episodes` of a condition."""
    shards = range(-(-episodes // spec.shard))
    return pl.concat([run.read_shard(Unit(condition, shard)) for shard in shards])


def _method(
    spec: StudySpec, condition: Condition, method: str, table: pl.DataFrame, progress: Progress
) -> dict[str, Any]:
    """Counts, rates and averages of one method."""
    status = table["status"].to_numpy()
    counts = {s.name: int((status == int(s)).sum()) for s in spec.mission.endings}
    rates = {
        name: {"count": count, **asdict(wilson(count, len(status), progress.level))}
        for name, count in counts.items()
    }
    own = table.filter(pl.col("status") == int(spec.mission.endings[0]))
    figures = _averages(spec, [own], progress.level, (condition.index, _rank(spec, method), 0))
    return {
        "method": method,
        "episodes": len(status),
        "successes": counts[spec.mission.endings[0].name],
        "statuses": rates,
        "metrics": figures[0],
        "counted": {
            m.name: float(table[m.name].to_numpy().mean(dtype=np.float64))
            for m in spec.mission.metrics
            if m.counted
        },
    }


def _pair(
    spec: StudySpec,
    condition: Condition,
    method: str,
    table: pl.DataFrame,
    base: pl.DataFrame,
    progress: Progress,
) -> dict[str, Any]:
    """Compare one method with the baseline, episode by episode."""
    code, level = int(spec.mission.endings[0]), progress.level
    won, base_won = table["status"].to_numpy() == code, base["status"].to_numpy() == code
    both = won & base_won
    shared = _finite_pairs(spec, [frame.filter(pl.Series(both)) for frame in (table, base)])
    seed = (condition.index, _rank(spec, method), 1)
    ours, theirs = _averages(spec, shared, level, seed)
    metrics = {}
    for metric in (m for m in spec.mission.metrics if m.summarised):
        name = metric.name
        a, b = (frame[name].to_numpy() for frame in shared)
        infinite = np.isinf(a)
        metrics[name] = {
            **_count(len(a), int(infinite.sum())),
            "method": ours[name],
            "baseline": theirs[name],
            "difference": _difference(a[~infinite], b[~infinite], level, metric.points),
        }
    return {
        "method": method,
        "baseline": spec.baseline,
        "success": asdict(paired_rates(won, base_won, level)),
        "metrics": metrics,
    }


def _finite_pairs(spec: StudySpec, frames: list[pl.DataFrame]) -> list[pl.DataFrame]:
    """Where one of two methods has an infinite value, give it to both: pairs go together."""
    for name in _summarised(spec):
        infinite = np.logical_or.reduce([np.isinf(frame[name].to_numpy()) for frame in frames])
        if infinite.any():
            value = pl.when(pl.Series(infinite)).then(pl.lit(math.inf)).otherwise(pl.col(name))
            frames = [frame.with_columns(value.alias(name)) for frame in frames]
    return frames


def _count(values: int, infinite: int) -> dict[str, int]:
    """How many values count, and how many are left out, where there are any."""
    return {"n": values - infinite, **({"infinite": infinite} if infinite else {})}


def _difference(a: np.ndarray, b: np.ndarray, level: float, points: float | None) -> dict[str, Any]:
    """The mean difference; of a share, in percentage points too, `points` to one of its units."""
    found = paired_difference(a, b, level)
    gap = found.mean.value
    in_points = {"points": None if gap is None else points * gap} if points is not None else {}
    return {
        **asdict(found.mean),
        "relative": found.relative,
        **in_points,
        "p_t": found.p_t,
        "p_wilcoxon": found.p_wilcoxon,
    }


def _averages(
    spec: StudySpec, tables: list[pl.DataFrame], level: float, seed: tuple[int, ...]
) -> list[dict[str, Any]]:
    """Averages of the finite values of every metric of tables of equal height, by name."""
    names = _summarised(spec)
    columns = np.concatenate([t.select(names).to_numpy() for t in tables], axis=1)
    key = (spec.seed, *seed)
    found = [_figures(a) for a in averages(columns, level, key)]
    # The other columns share their resamples, for which they must be of one length.
    infinite = np.isinf(columns)
    for place in np.flatnonzero(infinite.any(axis=0)):
        left = columns[~infinite[:, place], place]
        (own,) = averages(left[:, None], level, key)
        found[place] = _figures(own) | _count(len(columns), len(columns) - len(left))
    per_table = len(names)
    return [
        dict(zip(names, found[i * per_table : (i + 1) * per_table], strict=True))
        for i in range(len(tables))
    ]


def _figures(found: Averages) -> dict[str, Any]:
    return {
        "n": found.n,
        "mean": asdict(found.mean),
        "median": asdict(found.median),
        "iqm": asdict(found.iqm),
    }


def _summarised(spec: StudySpec) -> list[str]:
    return [metric.name for metric in spec.mission.metrics if metric.summarised]


def _rank(spec: StudySpec, method: str) -> int:
    return spec.methods.index(method)


def _tests(conditions: list[dict[str, Any]]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield (family, the dictionary that holds its p-value under that key)."""
    for condition in conditions:
        for pair in condition["pairs"]:
            yield "p_mcnemar", pair["success"]
            for metric in pair["metrics"].values():
                yield "p_t", metric["difference"]
                yield "p_wilcoxon", metric["difference"]


def _correct(conditions: list[dict[str, Any]], looks: int) -> None:
    """Add Holm-corrected p-values; a family is all tests of one kind in the study."""
    for family in ("p_mcnemar", "p_t", "p_wilcoxon"):
        holders = [holder for name, holder in _tests(conditions) if name == family]
        adjusted = holm([holder[family] for holder in holders], looks)
        for holder, p in zip(holders, adjusted, strict=True):
            holder[f"{family}_holm"] = p


def _families(conditions: list[dict[str, Any]]) -> dict[str, int]:
    """Return how many tests each family holds."""
    sizes: dict[str, int] = {}
    for family, holder in _tests(conditions):
        sizes[family] = sizes.get(family, 0) + (holder[family] is not None)
    return sizes


def _rounded(value: Any) -> Any:
    """Keep ten significant digits: more would only show the order of additions."""
    if isinstance(value, Mapping):
        return {k: _rounded(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(v) for v in value]
    if isinstance(value, float):
        return float(f"{value:.{_DIGITS}g}")
    return value
