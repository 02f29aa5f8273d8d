"""The numbers of every table: rates, averages and paired differences with their intervals."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from experiments.chen2023.angles import DIGITS
from experiments.chen2023.angles import ratio as printed_ratio
from experiments.chen2023.published import EXPANSION, TABLE_3
from experiments.chen2023.routes import (
    ARCS,
    ARCS_3,
    ASTAR,
    CONTACTS,
    METHODS,
    PAIRS,
    PROPOSED,
    SPLINES,
    TEMPLATES,
    TURNING_RADIUS,
    Method,
    degrees,
)
from experiments.chen2023.scenes import SEED
from experiments.chen2023.studies import (
    COMPARED,
    EXPANSIONS,
    GRIDS,
    LENGTHS,
    MAIN,
    SWEPT,
    WATERS,
    expansion_of,
)
from experiments.estimates import LEVEL, mean, rank_p, ratio, share, spread
from experiments.runs import Columns, Found, Ran
from usvjax.statistics import averages, holm, paired_difference, paired_rates, wilson
from usvkernels.status import Status

METRICS = {"length": ("decimals",), "turning": tuple(DIGITS)}
"""What Table 3 compares, and the readings of its digits that matter to it."""

Measured = Mapping[str, np.ndarray]
"""Columns of one method, [scenes, pairs]; "found" and "whole" are bool."""

Row = dict[str, Any]


def measure(found: Found) -> Row:
    """Make every table, for results.json."""
    main, expansions = found.studies[MAIN], found.studies[EXPANSIONS]
    measured = _all_of(main, MAIN, METHODS.values())
    others = {expansion_of(e): _all_of(expansions, e, SWEPT) for e in _labels(expansions)}
    numbers = tabulate(
        measured,
        others,
        _by_label(found, GRIDS, COMPARED),
        _by_label(found, WATERS, LENGTHS),
    )
    drawn = main.spec.conditions[0].case.settings["waters"]
    return {"drawn": drawn, **numbers, "timing": found.made["times"]}


def tabulate(
    main: Mapping[str, Measured],
    expansions: Mapping[float, Mapping[str, Measured]],
    grids: Mapping[str, Mapping[str, Measured]],
    waters: Mapping[str, Mapping[str, Measured]],
) -> Row:
    """Tables of what was measured, by the name of a method; all but the timings.

    Args:
        main: with what is printed.
        expansions: by E, besides the printed one.
        grids, waters: by label, where they were run.
    """
    compared = {MAIN: main, **grids}
    sailed = {EXPANSION: main, **expansions}
    return {
        "sailing": {e: sailing(measured) for e, measured in sailed.items()},
        "leaves": {method.name: leaves(main, method) for method in PROPOSED},
        "against_astar": {m.name: against_astar(main, m) for m in (ARCS, ARCS_3)},
        "bends": {m.name: bends(main[m.name], m) for m in (*SPLINES, *PROPOSED)},
        "corners": {
            label: {m.name: corners(own[m.name]) for m in PROPOSED}
            for label, own in compared.items()
        },
        "turning": {m.name: turning(main[m.name]) for m in COMPARED},
        "lengths": {
            label: {name: lengths(m) for name, m in own.items()}
            for label, own in {MAIN: main, **waters}.items()
        },
        "compared": {label: compare(own) for label, own in compared.items()},
    }


def _labels(ran: Ran) -> list[str]:
    return [condition.label for condition in ran.spec.conditions]


def _by_label(found: Found, study: str, methods: Iterable[Method]) -> dict[str, dict[str, Row]]:
    """The conditions of a study, where it was run."""
    if study not in found.studies:
        return {}
    ran, chosen = found.studies[study], list(methods)
    return {label: _all_of(ran, label, chosen) for label in _labels(ran)}


def _all_of(ran: Ran, label: str, methods: Iterable[Method]) -> dict[str, Row]:
    return {m.name: by_scene(ran.columns(label, m.name)) for m in methods}


def by_scene(columns: Columns) -> Row:
    """Columns of jobs as arrays [scenes, pairs]."""
    found = {name: values.reshape(-1, PAIRS) for name, values in columns.items()}
    found["found"] = found["status"] == Status.FOUND
    found["whole"] = found["whole"].astype(bool)
    return found


def scene_mean(values: np.ndarray, counted: np.ndarray) -> Row:
    """Mean over scenes of the mean over what counts of a scene, so that scenes are the sample."""
    return mean(_within_scenes(values, counted))


def scene_rate(flags: np.ndarray, counted: np.ndarray) -> Row:
    """The same of what is true or not, with a bootstrap interval: it stays between 0 and 1.

    Where it never is, or always, the interval is Wilson's over the scenes: equal values have no
    spread.
    """
    shares = _within_scenes(flags, counted)
    if len(shares) and np.ptp(shares) == 0 and shares[0] in (0.0, 1.0):
        return asdict(wilson(round(shares.sum()), len(shares), LEVEL))
    return asdict(averages(shares[:, None], LEVEL, [SEED])[0].mean)


def _within_scenes(values: np.ndarray, counted: np.ndarray) -> np.ndarray:
    """Mean of each scene that has something to count, float64[n']."""
    total = np.where(counted, values, 0.0).sum(axis=1)
    some = counted.any(axis=1)
    averaged: np.ndarray = total[some] / counted[some].sum(axis=1)
    return averaged


def sailing(measured: Mapping[str, Measured]) -> dict[str, Row]:
    """How vessels fared on the routes of each method: contacts and distance from the path."""
    found = {}
    for name, m in measured.items():
        ok = m["whole"]
        found[name] = {
            "routes": int(ok.size),
            "scenes": len(ok),
            "ok": int(ok.sum()),
            "contacts": {kind: _contact(m[kind].astype(bool), ok) for kind in CONTACTS},
            "not_arrived": int((ok & (m["arrived"] == 0)).sum()),
            "error": scene_mean(m["error"], ok),
            "most_error": float(np.where(ok, m["error"], 0.0).max()),
        }
    return found


def _contact(flags: np.ndarray, ok: np.ndarray) -> Row:
    """How many routes in all, how many of a scene, and how many of each pair of ends."""
    return {
        "count": int((flags & ok).sum()),
        "scenes": scene_rate(flags, ok),
        "pairs": [share(f[k]) for f, k in zip(flags.T, ok.T, strict=True)],
    }


def leaves(measured: Mapping[str, Measured], method: Method) -> Row:
    """How far vessels leave the path of A* and a proposed one, ends of Scene 1."""
    ours, plain = measured[method.name], measured[ASTAR.name]
    ok = ours["whole"][:, 0]
    new, old = (m["error"][ok, 0].astype(float) for m in (plain, ours))
    return {"n": int(ok.sum()), "astar": mean(new), "proposed": mean(old), "more": mean(new - old)}


def against_astar(measured: Mapping[str, Measured], method: Method) -> dict[str, list[Row]]:
    """Contacts on a proposed path against those on A*'s, scene by scene, pair by pair."""
    found: dict[str, list[Row]] = {}
    ours, plain = measured[method.name], measured[ASTAR.name]
    for kind in ("left", "entered"):
        entries = []
        for pair in range(PAIRS):
            ok = ours["whole"][:, pair]
            both = [m[kind][ok, pair].astype(bool) for m in (ours, plain)]
            entries.append(asdict(paired_rates(both[0], both[1], LEVEL)))
        for entry, p in zip(entries, holm([e["p_mcnemar"] for e in entries]), strict=True):
            entry["p_holm"] = p
        found[kind] = entries
    return found


def bends(m: Measured, method: Method) -> Row:
    """Largest curvature of a method's paths, in units of 1/R of its own and of 1/15 m."""
    largest = m["bend"][m["whole"]].astype(float)
    tight = largest * TURNING_RADIUS > 1.0
    return {
        "n": len(largest),
        "most": float(largest.max(initial=0.0) * method.radius),
        "median_15": float(np.median(largest) * TURNING_RADIUS) if len(largest) else None,
        "too_tight": int(tight.sum()),
        "too_tight_share": share(tight),
    }


def corners(m: Measured) -> Row:
    """How the corners are sailed, of all routes found, and how many paths have all of theirs."""
    counts = {name: int(m[name][m["found"]].sum()) for name in TEMPLATES}
    whole = m["found"].all(axis=1)
    return {
        "corners": sum(counts.values()),
        "templates": counts,
        "fitted": int(m["whole"].sum()),
        "found": int(m["found"].sum()),
        "fitted_scenes": scene_rate(m["whole"], m["found"]),
        "all_five": share(m["whole"][whole].all(axis=1)),
        "n": int(whole.sum()),
    }


def turning(m: Measured) -> list[Row]:
    """Total turning angle (deg), by pair of ends."""
    angles, whole = degrees(m["turning"].astype(float)).T, m["whole"].T
    return [spread(angle[ok]) for angle, ok in zip(angles, whole, strict=True)]


def lengths(m: Measured) -> list[Row]:
    """Length over the straight line, by pair of ends, and how far out what is printed lies."""
    found = []
    for pair in range(PAIRS):
        ok = m["whole"][:, pair]
        over = (m["path_length"] / m["straight"])[ok, pair].astype(float)
        printed = None if pair == 0 else TABLE_3[pair - 1].proposed.length
        p = printed and rank_p(over, printed / TABLE_3[pair - 1].straight)
        found.append({"n": len(over), "over_straight": spread(over), "rank_p": p})
    return found


def compare(measured: Mapping[str, Measured]) -> dict[str, dict[str, list[Row]]]:
    """Every proposed path against every spline, one row a pair of ends."""
    return {
        ours.name: {
            spline.name: _compared(measured[ours.name], measured[spline.name]) for spline in SPLINES
        }
        for ours in PROPOSED
    }


def _compared(ours: Measured, spline: Measured) -> list[Row]:
    rows = [_pair(ours, spline, pair) for pair in range(PAIRS)]
    for metric in METRICS:
        tested = [row[metric] for row in rows]
        for test in ("p_t", "p_wilcoxon"):
            for entry, p in zip(tested, holm([e[test] for e in tested]), strict=True):
                entry[f"{test}_holm"] = p
    return rows


def _pair(ours: Measured, spline: Measured, pair: int) -> Row:
    ok = ours["whole"][:, pair] & spline["whole"][:, pair]
    units: dict[str, tuple[str, Callable[[np.ndarray], np.ndarray]]] = {
        "length": ("path_length", np.asarray),
        "turning": ("turning", degrees),
    }
    found: Row = {"n": int(ok.sum())}
    for metric, (column, unit) in units.items():
        new, old = (unit(m[column][ok, pair].astype(float)) for m in (ours, spline))
        known = (new > 0) & (old > 0)
        tested = paired_difference(new, old, LEVEL)
        over = new[known] / old[known]
        found[metric] = {
            "difference": asdict(tested.mean),
            "p_t": tested.p_t,
            "p_wilcoxon": tested.p_wilcoxon,
            "ratio": ratio(new[known], old[known]),
            "range": spread(over),
            "less": share(new < old),
            "rank_p": {
                digits: rank_p(over, printed_ratio(TABLE_3[pair - 1], metric, digits))
                for digits in METRICS[metric]
                if pair > 0
            },
        }
    return found
