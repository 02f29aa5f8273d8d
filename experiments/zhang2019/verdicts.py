"""What holds of Zhang et al. 2019: each claim under each reading, from the numbers."""

from collections.abc import Callable, Mapping
from typing import Any

from experiments.verdicts import UNKNOWN, Finding, Verdict, verdict
from experiments.zhang2019.compare import LEAST_MATCHES
from experiments.zhang2019.published import IMPROVED, TRADITIONAL

READINGS = {
    "printed, batched": ("batched", "printed"),
    "accumulated, batched": ("batched", "accumulated"),
    "printed, textbook": ("textbook", "printed"),
    "accumulated, textbook": ("textbook", "accumulated"),
}
"""Label of a reading to the program and the method."""
MOST_SLOWDOWN = 1.10
"""Ratio of times up to which Table 4 counts as reproduced; printed is 1.07."""

_HALF_UNIT = 0.05
_Evidence = Mapping[str, Any]


def judge(found: Mapping[str, Any]) -> list[Verdict]:
    """Judge every claim under every reading.

    Args:
        found: the tables, as in results.json.
    """
    claims: list[tuple[str, str, Callable[[_Evidence], Finding]]] = [
        (
            "Table 3: cost of the traditional path",
            f"{TRADITIONAL.total}, turning {TRADITIONAL.turning}",
            _traditional,
        ),
        (
            "Table 3: cost of the improved path, on maps like that",
            f"{IMPROVED.total}, turning {IMPROVED.turning}",
            _improved,
        ),
        ("The turning cost is reduced", "15.5 to 10.5", _reduced("turning")),
        ("The total cost of the path is reduced", "59.3 to 54.3", _reduced("total")),
        ("Table 4: time", "116 to 124 ms, ratio 1.07", _time),
    ]
    return [
        verdict(
            claim,
            published,
            {
                label: decide(_evidence(found, program, method))
                for label, (program, method) in READINGS.items()
            },
        )
        for claim, published, decide in claims
    ]


def _evidence(found: Mapping[str, Any], program: str, method: str) -> _Evidence:
    own = found[program]
    return {
        "all": own["traditional"],
        "alike": own["alike"][method],
        "against": {density: rows[method] for density, rows in own["against"].items()},
        "time": own["time"][method],
    }


def _traditional(found: _Evidence) -> Finding:
    """Hold when both costs lie between the 2.5 and 97.5 % quantiles of all maps."""
    spread = found["all"]
    if spread["n"] < LEAST_MATCHES:
        return Finding(None, UNKNOWN)
    holds = _inside(spread["total"], TRADITIONAL.total)
    holds &= _inside(spread["turning"], TRADITIONAL.turning)
    total, turning = (_range(spread[name]) for name in ("total", "turning"))
    return Finding(holds, f"{total}, turning {turning} on {spread['n']:,} maps")


def _improved(found: _Evidence) -> Finding:
    """Hold when both costs lie between the 2.5 and 97.5 % quantiles of the maps alike."""
    own = found["alike"]
    if own["n"] < LEAST_MATCHES:
        return Finding(None, f"{own['n']} maps alike")
    holds = _inside(own["spread"]["total"], IMPROVED.total)
    holds &= _inside(own["spread"]["turning"], IMPROVED.turning)
    total, turning = (_range(own["spread"][name]) for name in ("total", "turning"))
    return Finding(holds, f"{total}, turning {turning} on {own['n']:,} maps")


def _reduced(metric: str) -> Callable[[_Evidence], Finding]:
    """Hold when the mean difference lies below 0 with its interval at every density."""

    def decide(found: _Evidence) -> Finding:
        rows = [row["metrics"][metric]["difference"] for row in found["against"].values()]
        if any(row["high"] is None for row in rows):
            return Finding(None, UNKNOWN)
        numbers = ", ".join(f"{row['value']:+.2f}" for row in rows)
        return Finding(all(row["high"] < 0 for row in rows), numbers)

    return decide


def _time(found: _Evidence) -> Finding:
    """Hold when the method takes no more than a tenth longer."""
    ratio = found["time"]["ratio"]["value"]
    return Finding(ratio <= MOST_SLOWDOWN, f"ratio {ratio:.2f}")


def _inside(spread: Mapping[str, Any], value: float) -> bool:
    return bool(spread["low"] - _HALF_UNIT <= value <= spread["high"] + _HALF_UNIT)


def _range(spread: Mapping[str, Any]) -> str:
    return f"{spread['value']:.1f} [{spread['low']:.1f}, {spread['high']:.1f}]"
