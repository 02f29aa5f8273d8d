"""The tables of Zhang et al. 2019, and how the paper was read."""

from collections.abc import Mapping
from typing import Any

from experiments.claims import Numbers
from experiments.zhang2019.arithmetic import lower
from experiments.zhang2019.compare import SAVED
from experiments.zhang2019.published import IMPROVED, TIMES, TRADITIONAL
from experiments.zhang2019.runs import FITTED, SIDES
from usvjax.report import Bullets, Section, Sheet
from usvjax.report.numbers import NONE, change, fixed, interval, listed, p_value, percent

METRICS = ("total", "turning", "bends", "length", "expanded")
HEADS = ["Total", "Turning", "Turns", "Length", "Expanded"]
RULES = ("printed", "accumulated")
BASES = ("batched", "textbook")


def sections(numbers: Numbers) -> list[Section]:
    """All tables; see `experiments.paper.Part`."""
    return [
        Section("Table 3 on one map (Figs. 9 and 10)", _shown(numbers)),
        Section("The size of the paper's map", _sizes(numbers)),
        Section("Maps like the paper's", _alike(numbers)),
        Section("All maps: paired differences to the traditional search", _against(numbers)),
        Section(f"Closely, at {FITTED.side} x {FITTED.side} cells", _closely(numbers)),
        Section("What ties explain", _ties(numbers)),
        Section("Time (Table 4)", _time(numbers)),
    ]


def summary(numbers: Numbers) -> list[str]:
    """The findings beside the verdicts."""
    lines = []
    alike = _alike_of(numbers, "batched", FITTED.label)
    if alike["n"]:
        savings = ", ".join(
            f"{fixed(alike[rule]['saved'], 2)} ({words}; {_share(alike[rule])} save "
            f"{SAVED:.1f} or more)"
            for rule, words in (
                ("printed", "Eq. 7 as printed"),
                ("accumulated", "e(n) accumulated in g(n)"),
                ("exact", "the exact optimum"),
            )
        )
        lines.append(
            f"**The saving of Table 3** is {SAVED:.1f} at equal length. On the "
            f"{alike['n']:,} maps of {FITTED.label} that are like the paper's the mean saving is "
            f"{savings}."
        )
    own = numbers["closely"][FITTED.label]
    rows = own["batched"]
    worse, equal = (
        " and ".join(f"{interval(rows[rule][name], 100, digits=1)} % {rule}" for rule in RULES)
        for name in ("worse", "equal")
    )
    lines.append(
        f"**Map by map**, at {FITTED.label}, the improved path costs more in total "
        f"than the traditional one on {worse}; it costs the same on {equal}."
    )
    excess = ", ".join(
        f"{percent(own['excess'][rule], 1)} % ({rule})" for rule in ("traditional", *RULES)
    )
    lines.append(
        f"**Over the exact optimum** (true diagonals) the totals lie on average by {excess} at "
        f"{FITTED.label}."
    )
    return lines


def readings(numbers: Numbers) -> list[str]:
    """How the paper was read; see `experiments.paper.Part`."""
    maps = numbers["maps"]
    return [
        "Map: drawn in Figs. 9 and 10, published nowhere. Ours are square, each cell blocked with "
        "the density as probability, from the upper left corner (as printed) to the lower right "
        f"one. Readings: {listed(SIDES, 0)} cells a side, densities 0.1, 0.2 and 0.3. "
        f"{FITTED.label} was chosen after the fact, so that the traditional path costs about as "
        "much as the paper's; where a verdict has it, it stands beside and does not count.",
        "Corners: whether a diagonal step may pass a blocked cell beside it is not printed. "
        "Readings: it may not, and it may (*corners cut*).",
        "Costs: 1 and 1.4 per step, 0.5 per 45 deg, counted along the path. The batched search "
        "itself takes the square root of 2 for a diagonal step, the textbook's program 1.4.",
        "Traditional: Manhattan distance (Eq. 5) although diagonal steps are allowed. It "
        "overestimates, so paths need not be shortest.",
        "Improved, *printed*: e(n) enters F(n) given the cell's parent, and the way to what "
        "follows is g(n) without it (Eq. 7). *Accumulated*: it counts in g(n) from there on.",
        "Ties: the paper takes the cell that entered the open list first and, in its figures, "
        'the "lower" one. The *batched* search takes of equal f that with the least h (on these '
        "maps to within half a cell), then the first row by row; traditional and accumulated, it "
        "opens closed cells again when a shorter way to them is found (not as printed). The "
        "*textbook*'s program takes equal values in order of entry and leaves closed cells "
        "closed; readings: neighbours from the lowest row up, from the uppermost down (*upper "
        "first*), and of equals the one that entered last (*last in*).",
        f"Maps: {maps['batched']:,} of each size for the batched search, the first "
        f"{maps['textbook']:,} of them for the textbook's program; maps without a path are left "
        "out (all rules find one or none does).",
        "Maps like the paper's: the traditional path is within 1 square of Table 3 in length "
        "(43.8) and in turning cost (15.5); as a further reading, within 2.",
    ]


def _shown(numbers: Numbers) -> list[Any]:
    shown = numbers["shown"]
    published = {"traditional": TRADITIONAL, "printed": IMPROVED, "accumulated": IMPROVED}
    rows = [
        [
            rule,
            f"**{row.total}, {row.turning}**" if (row := published.get(rule)) else NONE,
            *(fixed(own[name]) for name in ("total", "turning", "length")),
            str(own["bends"]),
            str(own["expanded"]),
        ]
        for rule, own in shown["paths"].items()
    ]
    header = ["Path", "Published total, turning", "Total", "Turning", "Length", "Turns", "Expanded"]
    return [
        f"Map {shown['map']} of {FITTED.label}: of {numbers['maps']['batched']:,} the one whose "
        "traditional path comes nearest to Table 3 in length and turning cost, the first of "
        "equals. Chosen after the fact, and by the traditional path alone.",
        Sheet("", header, rows, words=2),
    ]


def _sizes(numbers: Numbers) -> list[Any]:
    fits = "; ".join(
        f"{row['straight']} straight and {row['diagonal']} diagonal"
        + (f" (side {row['side']})" if row["side"] else "")
        for row in numbers["steps"]
    )
    rows = [
        [
            label,
            interval(own["reached"], 100, digits=1),
            *(interval(own[name], digits=1) for name in ("length", "turning")),
            *(
                p_value(numbers["programs"][program][label]["traditional"]["p"])
                for program in numbers["programs"]
            ),
        ]
        for label in numbers["sizes"]
        for own in (numbers["programs"]["batched"][label]["traditional"],)
    ]
    header = ["Size", "With a path (%)", "Length", "Turning"]
    return [
        f"Both published paths are {TRADITIONAL.length:.1f} long. With 1.4 per diagonal step that "
        f"is, in steps: {fits}. In brackets: side of the square map that such a path crosses from "
        "corner to corner without detours. The traditional paths of the batched search, mean with "
        f"2.5 and 97.5 % quantiles of the maps (published: {TRADITIONAL.length:.1f} and "
        f"{TRADITIONAL.turning}), and for each program p, the probability of a path as far out as "
        "Table 3's; at 0.05 or less the size is excluded.",
        Sheet("", [*header, *(f"p, {program}" for program in numbers["programs"])], rows),
    ]


def _alike_of(numbers: Numbers, program: str, label: str) -> Mapping[str, Any]:
    found: Mapping[str, Any] = numbers["programs"][program][label]["alike"]["1"]
    return found


def _share(row: Mapping[str, Any]) -> str:
    return f"{percent(row['as_published']['value'], 0)} %"


def _alike(numbers: Numbers) -> list[Any]:
    columns = [("batched", rule) for rule in (*RULES, "exact")]
    columns += [("textbook", rule) for rule in RULES]
    rows = []
    for label in numbers["sizes"]:
        found = {program: _alike_of(numbers, program, label) for program in BASES}
        if not any(own["n"] for own in found.values()):
            continue
        rows.append(
            [
                label,
                *(f"{own['n']:,}" for own in found.values()),
                *(_saved(found[program][rule]) for program, rule in columns),
            ]
        )
    header = ["Size", *(f"Maps, {program}" for program in BASES)]
    header += [f"{rule}, {program}" for program, rule in columns]
    return [
        "Maps whose traditional path is within 1 square of Table 3 in length (43.8) and turning "
        f"cost (15.5). Mean saving of the total in squares, and share of maps that save "
        f"{SAVED:.1f} or more, as the paper's does, with its Wilson interval (%). Sizes that are "
        "left out have no such map.",
        Sheet("", header, rows),
        _exactly(numbers),
    ]


def _saved(row: Mapping[str, Any]) -> str:
    if row["saved"] is None:
        return NONE
    return f"{fixed(row['saved'], 2)}; {interval(row['as_published'], 100, digits=1)}"


def _exactly(numbers: Numbers) -> str:
    """All sizes with whole corners together; maps of the textbook's program are among them."""
    found = [
        numbers["programs"]["batched"][label]["exactly"]
        for label, size in numbers["sizes"].items()
        if not size["corner_cutting"]
    ]
    total = {name: sum(one[name] for one in found) for name in ("maps", *RULES)}
    return (
        f"The traditional path costs exactly {TRADITIONAL.total} with {TRADITIONAL.turning} of "
        f"turning on {total['maps']} maps of all sizes (batched, corners not cut); the improved "
        f"one then exactly {IMPROVED.total} with {IMPROVED.turning} on {total['printed']} as "
        f"printed and on {total['accumulated']} accumulated."
    )


def _against(numbers: Numbers) -> list[Any]:
    columns = [(program, rule) for program in BASES for rule in RULES]
    rows = [
        [
            label,
            *(
                "; ".join(fixed(own[name]["value"], 2, sign=True) for name in METRICS[:3])
                for program, rule in columns
                for own in (numbers["programs"][program][label]["against"][rule],)
            ),
        ]
        for label in numbers["sizes"]
    ]
    header = ["Size", *(f"{rule}, {program}" for program, rule in columns)]
    return [
        "Mean changes of the total cost (squares), of the turning cost (squares) and of the "
        "number of turns; their intervals, and other orders of equals, are in `results.json`.",
        Sheet("", header, rows),
    ]


def _closely(numbers: Numbers) -> list[Any]:
    rows = [
        [
            label,
            f"{row['n']:,}",
            rule,
            *(_change(row, name) for name in METRICS),
            *(interval(row[name], 100, digits=1) for name in ("equal", "worse")),
            percent(own["excess"][rule]),
        ]
        for label, own in numbers["closely"].items()
        for rule, row in own["batched"].items()
    ]
    header = ["Size", "n", "Rule", *HEADS, "Equal total (%)", "Higher (%)", "Excess (%)"]
    plain = listed((own["excess"]["traditional"] for own in numbers["closely"].values()), 1, 100)
    return [
        "Batched. Rule minus traditional on the n maps with a path, in squares, with 95 % t "
        "intervals of the paired mean; shares of maps with Wilson intervals. Excess: by how much "
        "the total (true diagonals) exceeds the exact optimum on average; that of the traditional "
        f"path is {plain} %.",
        Sheet("", header, rows),
    ]


def _change(row: Mapping[str, Any], name: str) -> str:
    new, old = row["means"][name]
    return f"{fixed(old)} to {fixed(new)}: {interval(row[name], sign=True, digits=2)}"


def _ties(numbers: Numbers) -> list[Any]:
    rows = [
        [label, f"{row['n']:,}", rule, *(_change(row, name) for name in METRICS),
         interval(row["worse"], 100, digits=1)]
        for label, own in numbers["closely"].items()
        for rule, row in own["textbook"].items()
    ]  # fmt: skip
    return [
        "The textbook's program on the first of the same maps; differences to its own traditional "
        "search (order of entry, lower neighbours first). *Ties only*: a turning cost of 0.001, "
        "which decides between equal f and nothing else; this is the explanation that the paper "
        "gives for its gain.",
        Bullets([_tie_shares(label, own["textbook"]) for label, own in numbers["closely"].items()]),
        Sheet("", ["Size", "n", "Rule", *HEADS, "Higher total (%)"], rows),
    ]


def _tie_shares(label: str, rows: Mapping[str, Any]) -> str:
    gain = {
        rule: fixed(rows[f"{rule} (textbook)"]["turning"]["value"], 2, sign=True)
        for rule in ("printed", "ties only", "accumulated")
    }
    orders = (f"traditional (textbook, {order})" for order in ("upper first", "last in"))
    moved = listed((rows[name]["turning"]["value"] for name in orders), 2, sign=True)
    return (
        f"{label}: turning cost {gain['printed']} as printed, of which ties alone make "
        f"{gain['ties only']}; {gain['accumulated']} accumulated. Upper neighbours first, and last "
        f"in first out, move the traditional search by {moved}."
    )


def _time(numbers: Numbers) -> list[Any]:
    rows = [
        [label, program, rule, f"{1e6 * row['seconds']:,.1f}", interval(row["ratio"], digits=2)]
        for label, programs in numbers["time"].items()
        for program, rules in programs.items()
        for rule, row in rules.items()
    ]
    ratio = TIMES["improved"] / TIMES["traditional"]
    return [
        f"Published: {TIMES['traditional']:g} and {TIMES['improved']:g} ms (VS2017, i5-6300HQ), "
        f"{change(ratio - 1.0)}. Processor time per query: the fastest run. Ratio to the "
        "traditional rule: geometric mean over runs that take turns, with its 95 % t interval. "
        "Batched: on one device, all maps at once; textbook: Python, map by map.",
        Sheet("", ["Size", "Program", "Rule", "us per query", "Ratio"], rows, words=3),
        Bullets([f"{one.where}: {one.recomputed}: {one.verdict}." for one in lower()]),
    ]
