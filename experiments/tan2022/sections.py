"""The tables of the page on Tan et al. 2022: the paper's beside ours, and what is varied."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from experiments.claims import Numbers
from experiments.tan2022.arithmetic import WORDS, shares
from experiments.tan2022.measures import COUNTED, HYBRID
from experiments.tan2022.published import (
    METHODS,
    METRICS,
    RADII,
    TABLE2,
    TABLE3,
    TABLE4,
    PublishedTable,
)
from experiments.tan2022.ranking import LEAST_COMMON
from experiments.tan2022.readings import ALONG_DEMO, ALONG_PRESET, MAIN
from experiments.tan2022.why import why
from usvjax.report import Bullets, Section, Sheet
from usvjax.report.numbers import change, ends, fixed, interval, listed, p_value

ENDINGS = ("REACHED", "COLLIDED", "STUCK", "TIMED_OUT")
_ENDED = ("Reached", "Collided", "Stuck", "Timed out")
_UNITS = {"time": "s", "path_length": "m", "mean_speed": "m/s"}
_IN_FULL = (*(reading.label for reading in (*MAIN, ALONG_PRESET, ALONG_DEMO)), HYBRID)
"""Comparisons whose every number is on the page; those of the others are in results.json."""


def sections(numbers: Numbers) -> list[Section]:
    """Everything between the verdicts and the figures."""
    return [
        Section("Improved against traditional", [_OVERVIEW, _overview(numbers)]),
        Section("Why", [Bullets(why(numbers))]),
        *(_published(printed, numbers) for printed in (TABLE2, TABLE3, TABLE4)),
        Section(
            "Both methods on paired maps",
            [_PAIRED, *(_paired(label, numbers["paired"][label]) for label in _IN_FULL)],
        ),
        Section("What the paper does not print", [_VARIED, _sensitivities(numbers)]),
        Section("Which reading comes nearest", _ranking(numbers)),
        Section("What Eq. 4 asks of dist", [_BOUNDS, _bounds(numbers)]),
    ]


_AT = f"r = {', '.join(f'{r:g}' for r in RADII)} m"
_OVERVIEW = (
    f"At {_AT}. Changes are means over the maps where both methods "
    "succeed of the change per map (in brackets: change of the means)."
)


def _overview(numbers: Numbers) -> Sheet:
    header = ["", "Maps", *(f"{_capital(metric)} (%)" for metric in METRICS)]
    header += ["Success (%)", "Collisions (%)"]
    printed = [listed(shares(TABLE4, metric), 1, 100, sign=True) for metric in METRICS]
    rows = [["*published (Table 4)*", "20", *printed, "not given", "not given"]]
    for label in (*(reading.label for reading in COUNTED), HYBRID):
        cases = numbers["paired"][label]["cases"]
        rates = [
            " to ".join(
                listed([case["endings"][method][ending]["value"] for case in cases], 1, 100)
                for method in METHODS
            )
            for ending in ("REACHED", "COLLIDED")
        ]
        changes = [_changes(cases, metric) for metric in METRICS]
        rows.append([label, f"{cases[0]['maps']:,}", *changes, *rates])
    return Sheet("", header, rows)


def _capital(metric: str) -> str:
    return WORDS[metric].capitalize()


def _changes(cases: Sequence[Mapping[str, Any]], metric: str) -> str:
    """Mean change per map, and the change of the means in brackets."""
    compared = [case["metrics"][metric] for case in cases]
    per_map = [None if c is None else c["mean_change"]["value"] for c in compared]
    of_means = [None if c is None else c["change_of_means"] for c in compared]
    return f"{listed(per_map, 1, 100, sign=True)} ({listed(of_means, 1, 100, sign=True)})"


def _published(printed: PublishedTable, numbers: Numbers) -> Section:
    ours = {label: tables[str(printed.number)] for label, tables in numbers["tables"].items()}
    return Section(
        f"Table {printed.number}", [_beside(printed, ours), Bullets(list(_chosen(ours)))]
    )


def _beside(printed: PublishedTable, ours: Mapping[str, Sequence[Mapping[str, Any]]]) -> Sheet:
    """Lay one table out as the paper does: radius by radius, published then ours."""
    header = ["", "Method"]
    for radius in RADII:
        header += [f"r = {radius:g} m: published", *ours]
    rows = []
    for metric in METRICS:
        for method in METHODS:
            row = [f"{_capital(metric)} ({_UNITS[metric]})", method]
            for place, radius in enumerate(RADII):
                row.append(f"**{printed.values[method, metric][place]:.2f}**")
                row += [_cell(rows_of, radius, method, metric) for rows_of in ours.values()]
            rows.append(row)
        rows.append(_change_row(printed, metric, ours))
    return Sheet("", header, rows, words=2)


def _cell(rows: Sequence[Mapping[str, Any]], radius: float, method: str, metric: str) -> str:
    values = [row["values"] for row in rows if row["radius"] == radius and row["values"]]
    return fixed(values[0][method][metric] if values else None, 2)


def _change_row(
    printed: PublishedTable, metric: str, ours: Mapping[str, Sequence[Mapping[str, Any]]]
) -> list[str]:
    """Change of one metric; where the paper prints none, that of its values in brackets."""
    row = [f"{_capital(metric)}, change", ""]
    for place, radius in enumerate(RADII):
        if metric in printed.change:
            row.append(f"**{change(shares(printed, metric)[place])}**")
        else:
            old, new = (printed.values[method, metric][place] for method in METHODS)
            row.append(f"({change(new / old - 1)})")
        row += [_own_change(rows, radius, metric) for rows in ours.values()]
    return row


def _own_change(rows: Sequence[Mapping[str, Any]], radius: float, metric: str) -> str:
    """Our change: averaged over maps for Table 4, as the paper seems to, else of one map."""
    entries = [row for row in rows if row["radius"] == radius and row["values"]]
    if not entries:
        return change(None)
    if "change" in entries[0]:
        return change(entries[0]["change"][metric])
    old, new = (entries[0]["values"][method][metric] for method in METHODS)
    return change(new / old - 1)


def _chosen(ours: Mapping[str, Sequence[Mapping[str, Any]]]) -> Iterator[str]:
    """Say which maps these are, and how many were passed over for them."""
    for label, rows in ours.items():
        chosen = [
            f"r = {row['radius']:g} m: "
            + (f"map {row['map']}" if "map" in row else f"{row['maps']} maps")
            + f", {row['passed_over']:,} passed over"
            for row in rows
        ]
        yield f"{label}: " + ("; ".join(chosen) if chosen else "no such map was found") + "."


_PAIRED = (
    "Endings in % with 95 % Wilson intervals. Success map by map, with the Agresti-Min interval of "
    "its difference, improved minus traditional. Time, length and mean speed on the n maps where "
    "both succeed: these are the easier maps, so the averages say nothing about the others. The "
    "last share is that of maps which change at least as much as Table 4 says they do on average. "
    "p-values are Holm-corrected over all comparisons, also those that are in results.json only "
    "(t-test, Wilcoxon; McNemar for success)."
)


def _paired(label: str, row: Mapping[str, Any]) -> Section:
    cases = row["cases"]
    # A hybrid's episodes are those of the two readings that it is made of.
    own = [] if label == HYBRID else [_endings(cases)]
    title = f"{label[0].upper()}{label[1:]}, {cases[0]['maps']:,} maps per radius"
    return Section(title, [*own, _success(cases), _values(cases)])


def _endings(cases: Sequence[Mapping[str, Any]]) -> Sheet:
    return Sheet(
        "",
        ["r (m)", "Rate", "Method", *_ENDED],
        [
            [f"{case['radius']:g}", f"{case['rate']:g}", method]
            + [interval(case["endings"][method][ending], 100, digits=1) for ending in ENDINGS]
            for case in cases
            for method in METHODS
        ],
    )


def _success(cases: Sequence[Mapping[str, Any]]) -> Sheet:
    header = ["r (m)", "Both succeed", "Only improved", "Only traditional", "Neither"]
    counts = ("both", "method_only", "baseline_only", "neither")
    return Sheet(
        "",
        [*header, "Difference (points)", "p (McNemar)"],
        [
            [
                f"{case['radius']:g}",
                *(f"{case['success'][name]:,}" for name in counts),
                interval(case["success"]["difference"], 100, True, 1),
                p_value(case["success"]["p_mcnemar_holm"]),
            ]
            for case in cases
        ],
    )


def _values(cases: Sequence[Mapping[str, Any]]) -> Sheet:
    header = ["r (m)", "n", "", "Traditional", "Improved", "Difference, t interval", "Bootstrap"]
    header += ["Change of the means", "Mean change per map (%)", "As published (%)", "p (t)"]
    rows = [
        [
            f"{case['radius']:g}",
            f"{case['both']:,}",
            f"{_capital(metric)} ({_UNITS[metric]})",
            interval(compared["traditional"]),
            interval(compared["improved"]),
            interval(compared["difference"], 1, True, 2),
            ends(compared["difference_bootstrap"]),
            change(compared["change_of_means"]),
            interval(compared["mean_change"], 100, True, 1),
            fixed(case["as_much_as_published"][metric], 1, 100),
            p_value(compared["p_t_holm"]),
            p_value(compared["p_wilcoxon_holm"]),
        ]
        for case in cases
        for metric, compared in case["metrics"].items()
        if compared is not None
    ]
    return Sheet("", [*header, "p (Wilcoxon)"], rows, words=3)


_VARIED = (
    "One choice at a time. Endings: % reached / collided / stuck / timed out. Time, length and "
    "speed: means of traditional / improved on the n maps where both succeed; the time ratio is "
    "that of these means, improved over traditional, with its bootstrap interval. Success decides "
    "which maps are compared, so a rule that gives up more vessels also compares easier maps. The "
    "figure of the cap shows the rows of the cap."
)


def _sensitivities(numbers: Numbers) -> Sheet:
    header = ["Varied", "Reading", "r (m)", "Maps", "Traditional", "Improved", "n"]
    header += ["Time (s)", "Length (m)", "Speed (m/s)", "Time ratio"]
    rows = []
    group = ""
    for row in numbers["sensitivities"]:
        rows.append(["" if row["group"] == group else row["group"], *_sensitivity(row)])
        group = row["group"]
    return Sheet("", header, rows, words=2)


def _sensitivity(row: Mapping[str, Any]) -> list[str]:
    line = [row["reading"], f"{row['radius']:g}", f"{row['maps']:,}"]
    for method in METHODS:
        rates = (row["endings"][method][ending]["value"] for ending in ENDINGS)
        line.append(" / ".join(fixed(rate, 0, 100) for rate in rates))
    line.append(str(row["both"]))
    for metric, digits in zip(METRICS, (1, 1, 2), strict=True):
        means = [row["means"] and row["means"][method][metric] for method in METHODS]
        line.append(" / ".join(fixed(mean, digits) for mean in means))
    return [*line, interval(row["time_ratio"])]


def _ranking(numbers: Numbers) -> list[str | Section]:
    ranked = numbers["ranking"]
    header = ["Traditional", "Improved", "Factor", "Maps where both succeed"]
    header += [f"{_capital(metric)} ({_UNITS[metric]})" for metric in METRICS]
    found: list[str | Section] = [
        "After the fact, and without tuning: combinations of the cap (2r, 1 m, 2 m, 5 m, none), "
        "the start (towards the goal, 90 deg), sailing astern (allowed, not) and Eq. 4 (applied, "
        f"not), {ranked['readings']} readings on {ranked['maps']:,} maps per radius, and every "
        "pair of them from the same start with the traditional method under one and the improved "
        f"under the other. Of these, {ranked['ranked']:,} have at least {LEAST_COMMON} common "
        "successes at each radius and are ranked, by the root mean square of ln(ours / published) "
        "over the 18 averages of Table 4. The factor is its exponential: at 1.3 an average is "
        f"typically 30 % off. Values are traditional / improved at {_AT}. With this many pairs "
        "the first place is partly luck."
    ]
    for title, key in (("One reading for both methods", "single"), ("Hybrids", "hybrid")):
        rows = [_rank(line) for line in ranked[key]] or [["none", *["-"] * 6]]
        found.append(Section(title, [Sheet("", header, [_published_rank(), *rows], words=2)]))
    return found


def _published_rank() -> list[str]:
    cells = [
        ", ".join(
            f"{old:g} / {new:g}"
            for old, new in zip(*(TABLE4.values[m, metric] for m in METHODS), strict=True)
        )
        for metric in METRICS
    ]
    return ["*published*", "", "", "", *cells]


def _rank(line: Mapping[str, Any]) -> list[str]:
    cells = [
        ", ".join(
            f"{fixed(old[i], digits)} / {fixed(new[i], digits)}" for old, new in line["values"]
        )
        for i, digits in enumerate((1, 1, 2))
    ]
    improved = "the same" if line["traditional"] == line["improved"] else line["improved"]
    counts = ", ".join(map(str, line["common"]))
    return [line["traditional"], improved, fixed(line["typical_factor"], 2), counts, *cells]


_BOUNDS = (
    "Eq. 4 admits v only up to sqrt(2 dist v_b), so a mean speed bounds the cap on dist from below:"
)


def _bounds(numbers: Numbers) -> Sheet:
    header = ["Improved method", "Mean speed (m/s)", "dist that Eq. 4 asks for (m)", "2r (m)"]
    header += ["Most that a cap of 2r admits (m/s)", "Excludes that cap"]
    return Sheet(
        "",
        header,
        [
            [
                f"Table {bound['table']}, r = {bound['radius']:g} m",
                fixed(bound["speed"], 2),
                fixed(bound["dist"], 2),
                fixed(bound["demo_cap"], 1),
                fixed(bound["top_speed"], 2),
                "yes" if bound["excludes_demo_cap"] else "no",
            ]
            for bound in numbers["cap_bounds"]
        ],
    )
