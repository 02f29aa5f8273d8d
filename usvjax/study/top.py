"""Top-level keys of a study file, and what they may be."""

import re
from dataclasses import dataclass

from usvjax.checks import shown
from usvjax.errors import BadInputError
from usvjax.mission import Mission
from usvjax.suggest import did_you_mean

MAX_EPISODES = 2**31 - 1
MAX_SEED = 2**32 - 1
MAX_SHARD = 1_000_000
"""Episodes that are in memory at once, which may take some gigabytes."""
MAX_SHARDS = 1_000_000
"""Shards of a study: a file each, and a place in the queue of what is to be run."""
MAX_CONFIDENCE = 0.999999
"""Beyond, there is no quantile to compute an interval with."""

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")


@dataclass(frozen=True)
class StudyFile:
    """Top-level keys of a study file.

    Attributes:
        name: what the study is called, and its run directory; letters, digits, ".", "_" and "-".
        episodes: per condition and method, 1 or more; with `until`, at most so many.
        kind: the mission, which says what an episode is; one of usvjax's own, of which the first
            is taken when it is left out, or what a plug-in brings.
        plugin: a file of one's own that brings the mission, relative to the study file.
        seed: one seed for the whole study; 0 to 4294967295.
        shard: episodes per shard, the unit of work and of resuming; 1 to 1,000,000.
        methods: what is compared; all that the kind offers when empty.
        baseline: the method that paired differences are taken against; the first when left out.
        until: stop a condition once the interval of every method's success rate is at most this
            wide, a share between 0 and 1 (0.01 is one percentage point); when left out, all
            episodes are run.
        confidence: coverage of every interval; a share between 0 and 0.999999.
    """

    name: str
    episodes: int
    kind: str | None = None
    plugin: str | None = None
    seed: int = 0
    shard: int = 2000
    methods: tuple[str, ...] = ()
    baseline: str | None = None
    until: float | None = None
    confidence: float = 0.95


def check_top(top: StudyFile, mission: Mission, where: str) -> tuple[tuple[str, ...], str]:
    """Check values of top-level keys; return the methods and the baseline.

    Raises:
        BadInputError: naming the key.
    """
    if not _NAME.fullmatch(top.name):
        raise BadInputError(
            f"{where}: 'name' must be at most 100 letters, digits, '.', '_' or '-' (it names a "
            f"folder), "
            f"got {shown(top.name)}"
        )
    _check_range(where, "episodes", top.episodes, 1, MAX_EPISODES)
    _check_range(where, "shard", top.shard, 1, MAX_EPISODES)
    if min(top.shard, top.episodes) > MAX_SHARD:
        raise BadInputError(
            f"{where}: 'shard' must be at most {MAX_SHARD:,}, the episodes that memory can hold "
            f"at once, got {top.shard}"
        )
    _check_range(where, "seed", top.seed, 0, MAX_SEED)
    for key, value in (("until", top.until), ("confidence", top.confidence)):
        if value is not None and not 0.0 < value < 1.0:
            raise BadInputError(f"{where}: {key!r} must lie between 0 and 1, got {value!r}")
    if top.confidence > MAX_CONFIDENCE:
        raise BadInputError(
            f"{where}: 'confidence' must be at most {MAX_CONFIDENCE:g}, got {top.confidence!r}"
        )
    methods = top.methods or tuple(mission.methods)
    for method in methods:
        if method not in mission.methods:
            hint = did_you_mean(method, mission.methods)
            raise BadInputError(f"{where}: unknown method {shown(method)} in 'methods'; {hint}")
    if len(set(methods)) != len(methods):
        raise BadInputError(f"{where}: 'methods' names a method twice: {shown(list(methods))}")
    baseline = methods[0] if top.baseline is None else top.baseline
    if baseline not in methods:
        hint = did_you_mean(baseline, methods)
        raise BadInputError(
            f"{where}: 'baseline' is {shown(baseline)}, not one of 'methods'; {hint}"
        )
    return methods, baseline


def check_shards(top: StudyFile, conditions: int, where: str) -> None:
    """Raise BadInputError where so many conditions make too many shards."""
    least = -(-top.episodes // (MAX_SHARDS // conditions))
    if top.shard < least:
        each = "" if conditions == 1 else f" of each of {conditions:,} conditions"
        raise BadInputError(
            f"{where}: 'shard' must be at least {least:,} for {top.episodes:,} episodes{each}, so "
            f"that the study has at most {MAX_SHARDS:,} files, got {top.shard}"
        )


def _check_range(where: str, key: str, value: int, low: int, high: int) -> None:
    if not low <= value <= high:
        raise BadInputError(f"{where}: {key!r} must lie between {low} and {high}, got {value}")
