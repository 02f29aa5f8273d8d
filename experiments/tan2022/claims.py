"""What Tan et al. 2022 claim, and how each claim is decided."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from experiments.claims import Claim, Finding, Numbers
from experiments.tan2022.arithmetic import WORDS, shares
from experiments.tan2022.joint import ALPHA, LEAST_MAPS
from experiments.tan2022.measures import COUNTED, HYBRID
from experiments.tan2022.published import METHODS, METRICS, TABLE4, TABLE4_MAPS
from usvjax.report.numbers import fixed, listed, p_value

_ERROR = f"{100 * ALPHA:.0f} %"
_TABLE_TEST = (
    "the printed values against tables drawn from our own maps on which both methods succeed, {} "
    "per value, all values together, by the one farthest off in standard deviations; a true table "
    f"is excluded with probability {_ERROR}, and the verdict says so only if every reading "
    f"excludes it; one with fewer than {LEAST_MAPS} such maps has a dash and leaves the claim open."
)
_BETTER_TEST = (
    "yes where the improved method is shown to be better at every radius, no where it is shown to "
    "be worse at one (t-test of the differences map by map, on maps where both succeed, "
    f"{LEAST_MAPS} or more of them); a true claim fails with probability {_ERROR} at most, by Holm "
    "over all comparisons."
)
_RATE_TEST = (
    "yes where the rate is shown to be better at every radius, no where it is shown to be worse at "
    f"one (McNemar on all maps); a true claim fails with probability {_ERROR} at most, by Holm "
    "over all comparisons. That these rates are what is meant is our reading."
)
_GROWTH_TEST = (
    "yes where the mean share by which the path is shortened is shown to grow at both steps from "
    "radius to radius, no where it is shown to fall at one (t-tests, maps paired, where both "
    f"methods succeed on {LEAST_MAPS} maps or more at either radius); a true claim fails with "
    f"probability {_ERROR} at most: two tests, each of which may fail on one side only."
)


def claims(numbers: Numbers) -> list[Claim]:
    """All of them, to be judged by these numbers."""
    return [
        *(
            _weak(f"Table {number}: {words}", f"18 {what}", number, varied)
            for number, words, what, varied in (
                ("2", "one map at three radii", "values", "one"),
                ("3", "one map per radius", "values", "one"),
                ("4", f"averages over {TABLE4_MAPS} maps", "averages", f"{TABLE4_MAPS}"),
            )
        ),
        *(
            _weak(f"Table 4: {words}", _printed_change(metric), metric, f"{TABLE4_MAPS}")
            for metric, words in (
                ("time", "time is reduced by so much"),
                ("path_length", "the path is shortened by so much"),
                ("mean_speed", "mean speed is increased by so much"),
            )
        ),
        _claim(
            "The path is shortened more, the larger the radius",
            listed([-share for share in shares(TABLE4, "path_length")], 1, 100) + " %",
            _grows,
            _GROWTH_TEST,
        ),
        *(
            _claim(
                f'"Superior" in {"navigation " * (metric == "time")}{WORDS[metric]}',
                "at every radius",
                partial(_superior, metric),
                _BETTER_TEST,
            )
            for metric in ("path_length", "time", "mean_speed")
        ),
        *(
            _claim(
                f'"Stronger obstacle avoidance adjustment ability": {words}',
                "no rate is given",
                partial(_rate, name, ending, gain),
                _RATE_TEST,
            )
            for words, name, ending, gain in (
                ("it arrives more often", "success", "REACHED", 1),
                ("it collides less often", "collisions", "COLLIDED", -1),
            )
        ),
    ]


def _claim(
    text: str, published: str, measure: Callable[[Numbers, str], Finding], test: str, **more: Any
) -> Claim:
    readings = {reading.label: reading.label for reading in COUNTED}
    return Claim(text, published, measure, readings, {HYBRID: HYBRID}, test, **more)


def _weak(text: str, published: str, test: str, varied: str) -> Claim:
    """A claim that its test can only exclude."""
    measure = partial(_excluded, test)
    return _claim(text, published, measure, _TABLE_TEST.format(varied), weak=True)


def _printed_change(metric: str) -> str:
    return listed(shares(TABLE4, metric), 1, 100, sign=True) + " %"


def _cases(numbers: Numbers, label: str) -> Sequence[Mapping[str, Any]]:
    cases: Sequence[Mapping[str, Any]] = numbers["paired"][label]["cases"]
    return cases


def _excluded(test: str, numbers: Numbers, label: str) -> Finding:
    """Hold unless the printed values are excluded."""
    found = numbers["paired"][label]["tests"][test]
    if found is None:
        return Finding(None, "too few maps")
    printed, ours = found["printed"], found["ours"]
    if test in METRICS:
        changes = [_mean_change(case, test) for case in _cases(numbers, label)]
        told = f"{listed(changes, 1, 100, sign=True)} %"
    else:
        told = f"farthest {found['worst']}, {fixed(printed, 2)} against {fixed(ours, 2)}"
    return Finding(found["p"] >= ALPHA, f"{told}; p = {p_value(found['p'])}")


def _mean_change(case: Mapping[str, Any], metric: str) -> float | None:
    compared = case["metrics"][metric]
    return None if compared is None else compared["mean_change"]["value"]


def _grows(numbers: Numbers, label: str) -> Finding:
    steps = numbers["paired"][label]["growth"]
    changes = [_mean_change(case, "path_length") for case in _cases(numbers, label)]
    told = listed([None if c is None else -c for c in changes], 1, 100) + " %"
    words = [_shown(step["gain"], step["p"]) if step else "-" for step in steps]
    t = listed([step and step["t"] for step in steps], 1, sign=True)
    return Finding(_holds(words), f"{told}; t = {t}")


def _superior(metric: str, numbers: Numbers, label: str) -> Finding:
    """Hold when the metric is better at each radius."""
    gain = 1 if metric == "mean_speed" else -1
    cases = _cases(numbers, label)
    compared = [case["metrics"][metric] for case in cases]
    words = [
        _shown(gain * of["difference"]["value"], of["p_t_holm"])
        if case["both"] >= LEAST_MAPS
        else "too few maps"
        for case, of in zip(cases, compared, strict=True)
    ]
    shares = [None if c is None else c["change_of_means"] for c in compared]
    return _at_every_radius(words, f"{listed(shares, 1, 100, sign=True)} %")


def _rate(name: str, ending: str, gain: int, numbers: Numbers, label: str) -> Finding:
    """Hold when a rate is better at each radius."""
    cases = _cases(numbers, label)
    words = [
        _shown(gain * case[name]["difference"]["value"], case[name]["p_mcnemar_holm"])
        for case in cases
    ]
    old, new = (
        listed([case["endings"][m][ending]["value"] for case in cases], 1, 100) for m in METHODS
    )
    return _at_every_radius(words, f"{old} to {new} %")


def _shown(gain: float, p: float | None) -> str:
    """What a test shows of one comparison."""
    if p is None or p >= ALPHA:
        return "not shown"
    return "better" if gain > 0 else "worse"


def _at_every_radius(words: Sequence[str], told: str) -> Finding:
    return Finding(_holds(words), f"{told} ({', '.join(words)})")


def _holds(words: Sequence[str]) -> bool | None:
    """What a claim comes to that wants every comparison to be better."""
    return False if "worse" in words else True if set(words) == {"better"} else None
