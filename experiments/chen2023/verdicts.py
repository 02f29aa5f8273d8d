"""What holds of Chen et al. 2023 on path planning: each figure and table, from the numbers."""

from collections.abc import Callable, Sequence
from typing import Any

from experiments.chen2023.published import EXPANSION, TABLE_3
from experiments.chen2023.routes import (
    ASTAR,
    CONTACTS,
    CORNER_SPLINE,
    DIRECT,
    KEY_SPLINE,
    PRINTED,
    PROPOSED,
    SPLINE,
)
from experiments.verdicts import Finding, Verdict, verdict

FEWEST = 20
"""Scenes that a finding rests on at least."""
TYPICAL = 0.5
"""Share of routes on which what a figure shows must happen, for the figure to be typical."""
ALPHA = 0.05

EXPANDED, BARE = ("left", "entered"), ("touched", "hit")
"""Contacts that tell paths apart where islands are expanded, and where they are not."""

SPLINE_READINGS = {
    "spline of A*'s cells": SPLINE,
    "of its corners": CORNER_SPLINE,
    "of the shortened path": KEY_SPLINE,
}
Row = dict[str, Any]


def judge(found: Row) -> list[Verdict]:
    """Judge every figure and table.

    Args:
        found: all results, as in results.json.
    """
    return [
        verdict(
            "Fig. 15: the vessel leaves the path of A*",
            "one scene",
            {f"E = {EXPANSION:g}": _leaves(found)},
        ),
        verdict(
            "Fig. 15: there it collides with an obstacle",
            "one scene",
            _collisions(found),
        ),
        verdict(
            "Fig. 16: on the proposed path it does not, and arrives",
            "one scene",
            _safety(found),
        ),
        verdict(
            "Algorithm 1 smooths the path of A*",
            "every path shown",
            {
                "after shortening, R = 15 m": _fitted(found, PROPOSED.name),
                "after shortening, R = 3 m": _fitted(found, PRINTED.name),
                "A* itself, R = 15 m": _fitted(found, DIRECT.name),
            },
        ),
        verdict(
            "The proposed path bends no more than the vessel can turn",
            "curvature at most r/u",
            {
                "R = u/r = 15 m": _bend(found, PROPOSED.name),
                "R = 3 m (Table 1)": _bend(found, PRINTED.name),
            },
        ),
        _over_splines(
            "Tables 2 and 3: the proposed path is shorter than the B-spline",
            "in all 4 rows",
            found,
            _less("length"),
        ),
        _over_splines(
            "Tables 2 and 3: by as much as printed",
            "ratios " + _list([r.proposed.length / r.bspline.length for r in TABLE_3], 3),
            found,
            _as_printed("length", "length", 3),
        ),
        _over_splines(
            "Table 3: the proposed path turns less than the B-spline",
            "in all 4 rows (digits as decimals)",
            found,
            _less("turning"),
        ),
        _over_splines(
            "Table 3: by as much as printed",
            "ratios " + _list([r.proposed.degrees / r.bspline.degrees for r in TABLE_3], 2),
            found,
            _as_printed("turning", "turning_deg", 2),
        ),
        verdict(
            "Table 3: length of the proposed path over the straight line",
            _list([row.proposed.length / row.straight for row in TABLE_3], 3),
            _detours(found),
        ),
        verdict(
            "Tables 2 and 3: planning takes less time than with a B-spline",
            "ratios " + _list([r.proposed.time / r.bspline.time for r in TABLE_3], 2),
            _times(found),
        ),
    ]


def _list(values: Sequence[float | None], digits: int) -> str:
    return ", ".join("-" if v is None else f"{v:.{digits}f}" for v in values)


def _method(rows: Sequence[Row], name: str) -> Row:
    return next(row for row in rows if row["method"] == name)


def _leaves(found: Row) -> Finding:
    """Hold when the typical scene takes the vessel farther off than the proposed path ever does."""
    plain, ours = (_method(found["sailing"], m.name)["error_pairs"][0] for m in (ASTAR, PROPOSED))
    if ours["n"] < FEWEST:
        return Finding(None, "too few scenes")
    numbers = (
        f"at most {plain['median']:.1f} m off in the median scene; "
        f"{ours['median']:.1f} m on the proposed path"
    )
    return Finding(plain["median"] > ours["range"][1], numbers)


def _collisions(found: Row) -> dict[str, Finding]:
    """Hold when it happens on most routes, of any pair of ends."""
    main = _method(found["sailing"], ASTAR.name)
    findings = {
        f"E = {EXPANSION:g}: {words}": _typical(main, kind) for kind, words in CONTACTS.items()
    }
    for row in found["expansions"]:
        if row["method"] == ASTAR.name and row["expansion"] == 0.0:
            findings |= {f"E = 0: {CONTACTS[kind]}": _typical(row, kind) for kind in BARE}
    return findings


def _typical(row: Row, contact: str) -> Finding:
    if row["ok"] < FEWEST:
        return Finding(None, "too few scenes")
    rate = row[f"{contact}_scenes"]["value"]
    return Finding(rate >= TYPICAL, f"on {100 * rate:.1f} % of {row['ok']:,} routes")


def _safety(found: Row) -> dict[str, Finding]:
    """Hold when no vessel is in contact, whatever its ends, and all arrive."""
    main = found["sailing"]
    bare = [row for row in found["expansions"] if row["expansion"] == 0.0]
    findings: dict[str, Finding] = {}
    for method, radius in ((PROPOSED, "R = u/r = 15 m"), (PRINTED, "R = 3 m (Table 1)")):
        row = _method(main, method.name)
        findings |= {f"{radius}, E = {EXPANSION:g}: {CONTACTS[k]}": _safe(row, k) for k in EXPANDED}
        if bare:
            row = _method(bare, method.name)
            findings |= {f"{radius}, E = 0: {CONTACTS[k]}": _safe(row, k) for k in BARE}
    return findings


def _safe(row: Row, contact: str) -> Finding:
    if row["ok"] < FEWEST:
        return Finding(None, "too few scenes")
    touched = row[f"{contact}_count"]
    numbers = f"{touched:,} of {row['ok']:,} in contact"
    missing = row["ok"] - row["arrived"]
    if missing:
        numbers += f", {missing:,} not arrived"
    return Finding(touched == 0 and missing == 0, numbers)


def _fitted(found: Row, name: str) -> Finding:
    """Hold when every path is smoothed."""
    row = _method(found["corners"], name)
    if row["found"] < FEWEST:
        return Finding(None, "too few scenes")
    return Finding(
        row["fitted"] == row["found"],
        f"{row['fitted']:,} of {row['found']:,} paths, "
        f"{row['corners'] - row['templates']['UNFITTED']:,} of {row['corners']:,} corners",
    )


def _bend(found: Row, name: str) -> Finding:
    """Hold when no path bends more than the vessel of Table 1 can turn."""
    rows = [row for row in found["bends"] if row["method"] == name]
    if not rows or rows[0]["too_tight_15"]["n"] < FEWEST:
        return Finding(None, "too few scenes")
    row = rows[0]
    numbers = f"at most {row['most']:.3f} / R; {_share(row['too_tight_15'])} over r/u"
    return Finding(row["too_tight_15"]["count"] == 0, numbers)


def _share(rate: Row) -> str:
    return f"{100 * rate['value']:.1f} % of {rate['n']:,}"


def _over_splines(
    claim: str, published: str, found: Row, decide: Callable[[Sequence[Row]], Finding]
) -> Verdict:
    """Judge the four rows of Table 3 under every reading of the B-spline."""
    rows = [row for row in found["compared"] if row["published"] is not None]
    findings = {}
    for label, method in SPLINE_READINGS.items():
        entries = [
            {**row["splines"][method.name], "n": row["n"], "published": row["published"]}
            for row in rows
        ]
        few = any(entry["n"] < FEWEST for entry in entries)
        findings[label] = Finding(None, "too few scenes") if few else decide(entries)
    return verdict(claim, published, findings)


def _less(metric: str) -> Callable[[Sequence[Row]], Finding]:
    """Hold when the mean difference is below 0 in every row, Holm-corrected t-test at 5 %."""

    def decide(entries: Sequence[Row]) -> Finding:
        tested = [entry[metric] for entry in entries]
        holds = all(t["difference"]["value"] < 0 and (t["p_t_holm"] or 0.0) < ALPHA for t in tested)
        shares = _list([100 * t["less"]["value"] for t in tested], 0)
        return Finding(holds, f"in {shares} % of scenes")

    return decide


def _as_printed(metric: str, key: str, digits: int) -> Callable[[Sequence[Row]], Finding]:
    """Hold when the printed ratios lie where those of 95 % of the scenes do."""

    def decide(entries: Sequence[Row]) -> Finding:
        ratios = [entry[metric]["ratio"] for entry in entries]
        wanted = [entry["published"]["ratio"][key] for entry in entries]
        means = _list([ratio["mean"]["value"] for ratio in ratios], digits)
        return _inside([ratio["range"] for ratio in ratios], wanted, f"means {means}")

    return decide


def _inside(
    ranges: Sequence[Sequence[float | None]], wanted: Sequence[float], numbers: str
) -> Finding:
    hits = [
        low is not None and high is not None and low <= value <= high
        for (low, high), value in zip(ranges, wanted, strict=True)
    ]
    return Finding(
        all(hits), f"{numbers}; {sum(hits)} of {len(hits)} printed within 95 % of scenes"
    )


def _detours(found: Row) -> dict[str, Finding]:
    """Hold when the printed lengths lie where those of 95 % of the scenes do."""
    main = [row["proposed"]["over_straight"] for row in found["compared"] if row["published"]]
    drawn = {found["settings"]["main"]["words"]: main}
    for row in found["waters"]:
        drawn[row["waters"]] = [pair["over_straight"] for pair in row["pairs"][1:]]
    wanted = [row.proposed.length / row.straight for row in TABLE_3]
    findings = {}
    for words, spreads in drawn.items():
        if min(spread["n"] for spread in spreads) < FEWEST:
            findings[words] = Finding(None, "too few scenes")
            continue
        means = _list([spread["mean"]["value"] for spread in spreads], 3)
        findings[words] = _inside([s["range"] for s in spreads], wanted, f"means {means}")
    return findings


def _times(found: Row) -> dict[str, Finding]:
    """Hold when the proposed algorithm takes less time for each path."""
    single = found["timing"]["single"][1:]
    ratios = [entry["a_proposed"] / entry["a_bspline"] for entry in single]
    batch = found["timing"]["batch"]
    ratio = batch["a_proposed"] / batch["a_bspline"]
    return {
        "one path a call": Finding(max(ratios) < 1, f"ratios {_list(ratios, 2)}"),
        "many at once": Finding(ratio < 1, f"ratio {ratio:.2f}"),
    }
