"""The numbers of every table: rates, averages and paired differences with their intervals."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from experiments.chen2023.published import ENDS, TABLE_3, TURNING_RADIUS
from experiments.chen2023.routes import (
    AGILE,
    ASTAR,
    CONTACTS,
    METHODS,
    PROPOSED,
    SPLINE,
    TEMPLATES,
    Measures,
    Method,
    degrees,
    of_pair,
)
from experiments.chen2023.runs import Plan, Results
from usvjax.statistics import (
    RESAMPLES,
    Estimate,
    holm,
    paired_difference,
    paired_rates,
    wilson,
)

LEVEL = 0.95
SEED = 1
RANGE = (0.025, 0.975)  # quantiles over scenes
SPLINES = tuple(method for method in METHODS if method.smoothing == "bspline")


def share(flags: np.ndarray) -> dict[str, Any]:
    """How many are true, with Wilson's interval of the share."""
    return {
        "count": int(flags.sum()),
        "n": len(flags),
        **asdict(wilson(int(flags.sum()), len(flags), LEVEL)),
    }


def mean(values: np.ndarray) -> dict[str, Any]:
    """Mean with its percentile bootstrap interval; none where all values are equal."""
    n = len(values)
    if n == 0:
        return asdict(Estimate(None))
    value = float(values.mean())
    if np.ptp(values) == 0:
        return asdict(Estimate(value))
    drawn = np.random.default_rng(SEED).integers(0, n, (RESAMPLES, n), dtype=np.int32)
    tail = (1.0 - LEVEL) / 2.0
    ends = np.quantile(values[drawn].mean(axis=1), [tail, 1.0 - tail])
    return asdict(Estimate(value, *map(float, ends)))


def spread(values: np.ndarray) -> dict[str, Any]:
    """Mean with its interval, median, and the range that 95 % of the scenes lie in."""
    if not len(values):
        return {"n": 0, "mean": mean(values), "median": None, "range": [None, None]}
    return {
        "n": len(values),
        "mean": mean(values),
        "median": float(np.median(values)),
        "range": [float(q) for q in np.quantile(values, RANGE)],
    }


def scene_mean(values: np.ndarray, counted: np.ndarray) -> dict[str, Any]:
    """Mean over scenes of the mean over a scene's pairs, so that scenes are the sample.

    Args:
        values, counted: [n x pairs]; only what counts does.
    """
    return mean(_within_scenes(values, counted))


def scene_rate(flags: np.ndarray, counted: np.ndarray) -> dict[str, Any]:
    """The same of what is true or not.

    Where it never is, or always, the interval is Wilson's over the scenes: no resample of
    equal values has a spread.
    """
    shares = _within_scenes(flags, counted)
    if len(shares) and np.ptp(shares) == 0 and shares[0] in (0.0, 1.0):
        return asdict(wilson(round(shares.sum()), len(shares), LEVEL))
    return mean(shares)


def _within_scenes(values: np.ndarray, counted: np.ndarray) -> np.ndarray:
    """Mean of each scene that has something to count, float64[n']."""
    kept = counted.reshape(-1, len(ENDS))
    total = np.where(kept, values.reshape(-1, len(ENDS)), 0.0).sum(axis=1)
    some = kept.any(axis=1)
    averaged: np.ndarray = total[some] / kept[some].sum(axis=1)
    return averaged


def sailing(measured: dict[str, Measures], methods: Sequence[Method]) -> list[dict[str, Any]]:
    """How vessels fared on the routes of each method: contacts and distance from the path."""
    rows = []
    for method in methods:
        m = measured[method.name]
        pairs = [of_pair(m, pair) for pair in range(len(ENDS))]
        rows.append(
            {
                "method": method.name,
                "words": method.words,
                "routes": len(m.ok),
                "ok": int(m.ok.sum()),
                "found_scenes": scene_rate(m.found, np.ones_like(m.found)),
                "fitted": [share(p.ok[p.found]) for p in pairs],
                **_contacts(m, pairs),
                "arrived": int(m.arrived[m.ok].sum()),
                "error": scene_mean(m.error, m.ok),
                "error_pairs": [spread(p.error[p.ok].astype(float)) for p in pairs],
                "most_error": float(m.error[m.ok].max(initial=0.0)),
            }
        )
    return rows


def _contacts(m: Measures, pairs: Sequence[Measures]) -> dict[str, Any]:
    """Of every kind: on each pair of ends, over scenes, and how many in all."""
    found: dict[str, Any] = {}
    for kind in CONTACTS:
        flags = m.in_contact(kind)
        found[kind] = [share(p.in_contact(kind)[p.ok]) for p in pairs]
        found[f"{kind}_scenes"] = scene_rate(flags, m.ok)
        found[f"{kind}_count"] = int(flags[m.ok].sum())
    return found


def paired_contacts(measured: dict[str, Measures]) -> dict[str, list[dict[str, Any]]]:
    """Contacts on the proposed path against those on A*'s, scene by scene, pair by pair."""
    found: dict[str, list[dict[str, Any]]] = {}
    for kind in ("left", "entered"):
        entries = []
        for pair in range(len(ENDS)):
            ours, plain = (of_pair(measured[m.name], pair) for m in (PROPOSED, ASTAR))
            both = [m.in_contact(kind)[ours.ok] for m in (ours, plain)]
            entries.append(asdict(paired_rates(both[0], both[1], LEVEL)))
        for entry, p in zip(entries, holm([e["p_mcnemar"] for e in entries]), strict=True):
            entry["p_holm"] = p
        found[kind] = entries
    return found


def bends(measured: dict[str, Measures], methods: Sequence[Method]) -> list[dict[str, Any]]:
    """Largest curvature of the paths, in units of 1/R of the method and of 1/15 m."""
    rows = []
    for method in methods:
        m = measured[method.name]
        largest = m.bend[m.ok].astype(float)
        if method.smoothing == "none" or method is AGILE or not len(largest):
            continue
        rows.append(
            {
                "method": method.name,
                "words": method.words,
                "radius": method.radius,
                "most": float(largest.max() * method.radius),
                "median_15": float(np.median(largest) * TURNING_RADIUS),
                "too_tight_15": share(largest * TURNING_RADIUS > 1.0),
            }
        )
    return rows


def corners(measured: dict[str, Measures], methods: Sequence[Method]) -> list[dict[str, Any]]:
    """How the corners are sailed, of all routes found; a path once, whatever vessels sail it."""
    rows = []
    for method in methods:
        if method.smoothing != "arcs" or method is AGILE:
            continue
        m = measured[method.name]
        counts = m.corners[m.found].sum(axis=0)
        rows.append(
            {
                "method": method.name,
                "words": method.words,
                "corners": int(counts.sum()),
                "templates": {
                    t.name: int(count) for t, count in zip(TEMPLATES, counts, strict=True)
                },
                "fitted": int(m.ok.sum()),
                "found": int(m.found.sum()),
                "fitted_scenes": scene_rate(m.ok, m.found),
            }
        )
    return rows


def compare(measured: dict[str, Measures]) -> list[dict[str, Any]]:
    """Length and turning of the splines against the proposed paths, one row a pair of ends."""
    rows = [_pair(measured, pair) for pair in range(len(ENDS))]
    for spline in SPLINES:
        for metric in ("length", "turning"):
            tested = [row["splines"][spline.name][metric] for row in rows]
            for test in ("p_t", "p_wilcoxon"):
                for entry, p in zip(tested, holm([e[test] for e in tested]), strict=True):
                    entry[f"{test}_holm"] = p
    return rows


def _pair(measured: dict[str, Measures], pair: int) -> dict[str, Any]:
    ours, plain = (of_pair(measured[m.name], pair) for m in (PROPOSED, ASTAR))
    ok = ours.ok
    return {
        "pair": pair,
        "start": ENDS[pair][0],
        "end": ENDS[pair][1],
        "found": share(ours.found),
        "n": int(ok.sum()),
        "proposed": _values(ours, ok),
        "astar": _values(plain, ok),
        "splines": {s.name: _against(of_pair(measured[s.name], pair), ours, ok) for s in SPLINES},
        "published": _published(pair),
    }


def _values(m: Measures, ok: np.ndarray) -> dict[str, Any]:
    return {
        "over_straight": spread((m.length / m.straight)[ok].astype(float)),
        "turning_deg": spread(degrees(m.turning[ok].astype(float))),
    }


def _against(spline: Measures, ours: Measures, ok: np.ndarray) -> dict[str, Any]:
    """A spline's values, and how the proposed paths differ from them."""
    entry = {"values": _values(spline, ok)}
    for metric, a, b in (
        ("length", ours.length, spline.length),
        ("turning", degrees(ours.turning), degrees(spline.turning)),
    ):
        new, old = a[ok].astype(float), b[ok].astype(float)
        tested = paired_difference(new, old, LEVEL)
        known = old > 0
        entry[metric] = {
            "difference": asdict(tested.mean),
            "p_t": tested.p_t,
            "p_wilcoxon": tested.p_wilcoxon,
            "ratio": spread(new[known] / old[known]),
            "less": share(new < old),
        }
    return entry


def _published(pair: int) -> dict[str, Any] | None:
    """Of Table 3, where it has the pair."""
    if pair == 0:
        return None
    row = TABLE_3[pair - 1]
    values: dict[str, Any] = {
        name: {
            "time": row.of(name).time,
            "length": row.of(name).length,
            "over_straight": row.of(name).length / row.straight,
            "turning_deg": row.of(name).degrees,
            "turning_by_minutes_deg": row.of(name).degrees_by_minutes,
        }
        for name in ("bspline", "proposed")
    }
    ratios = ("time", "length", "turning_deg", "turning_by_minutes_deg")
    values["ratio"] = {key: values["proposed"][key] / values["bspline"][key] for key in ratios}
    return values


def over_expansions(plans: Sequence[Plan], results: Results) -> list[dict[str, Any]]:
    """Contacts with islands against the expansion coefficient that routes were searched with."""
    rows = []
    for plan in plans:
        for row in sailing(results[plan], plan.methods):
            kept = ["method", "words", "routes", "ok", "arrived", "error", "most_error"]
            kept += [f"{kind}_{what}" for kind in CONTACTS for what in ("scenes", "count")]
            rows.append(
                {"expansion": plan.expansion, "scenes": plan.scenes}
                | {key: row[key] for key in kept}
            )
    return rows


def over_waters(plans: Sequence[Plan], results: Results) -> list[dict[str, Any]]:
    """Lengths against how the scenes are drawn."""
    rows = []
    for plan in plans:
        measured = results[plan]
        ours = measured[PROPOSED.name]
        pairs = []
        for pair in range(len(ENDS)):
            m = of_pair(ours, pair)
            values = (m.length / m.straight)[m.ok].astype(float)
            reached = None if pair == 0 else share(values >= _over_straight(pair))
            pairs.append({"over_straight": spread(values), "as_long_as_published": reached})
        both = ours.ok
        spline = measured[SPLINE.name]
        ratio = np.where(both, ours.length / np.where(both, spline.length, 1.0), 0.0)
        rows.append(
            {
                "waters": plan.waters.words,
                "scenes": plan.scenes,
                "found": scene_rate(ours.found, np.ones_like(ours.found)),
                "fitted": scene_rate(ours.ok, ours.found),
                "ratio": scene_mean(ratio, both),
                "pairs": pairs,
            }
        )
    return rows


def _over_straight(pair: int) -> float:
    row = TABLE_3[pair - 1]
    return row.proposed.length / row.straight
