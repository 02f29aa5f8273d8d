"""Stopping when the interval is narrow enough, without spoiling its coverage.

An interval that is computed again and again until it happens to be narrow covers the truth
less often than it claims. Here the numbers of episodes at which a study looks are fixed
before it starts (one shard, then doubling), and every interval is computed at the level
1 - alpha / looks. By Bonferroni's inequality all looks together then cover with at least
1 - alpha, so the one at which the study stops does too, whatever the rule of stopping.
"""

from collections.abc import Sequence

from usvjax.statistics import Estimate, wilson


def look_schedule(episodes: int, shard: int, until: float | None) -> tuple[int, ...]:
    """Return the numbers of episodes after which a study looks at its intervals.

    Args:
        episodes: the most episodes of a condition.
        shard: episodes per shard.
        until: the wanted width; None means one look, at the end.

    Returns:
        Increasing numbers of episodes, the last one `episodes`.
    """
    looks = []
    if until is not None:
        at = shard
        while at < episodes:
            looks.append(at)
            at *= 2
    return (*looks, episodes)


def look_level(confidence: float, looks: int) -> float:
    """Return the level of each single interval, so that all looks together cover `confidence`.

    Args:
        confidence: wanted coverage of the interval that is reported at the end.
        looks: how many looks the schedule has.
    """
    return 1.0 - (1.0 - confidence) / looks


def narrow_enough(successes: Sequence[int], n: int, level: float, until: float) -> bool:
    """Whether the Wilson interval of every method's success rate is at most `until` wide.

    Args:
        successes: per method, of `n` episodes each.
        n: episodes so far.
        level: of the interval, see `look_level`.
        until: the wanted width, as a share.
    """
    return all(width(wilson(k, n, level)) <= until for k in successes)


def width(estimate: Estimate) -> float:
    """Width of an interval; infinite where there is none."""
    if estimate.low is None or estimate.high is None:
        return float("inf")
    return estimate.high - estimate.low
