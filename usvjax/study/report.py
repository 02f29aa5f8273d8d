"""The summary for people: Markdown for a file, tables for a terminal."""

from typing import Any

from usvjax.mission import MOST_CONDITIONS
from usvjax.report import Bullets, Section, Sheet
from usvjax.report import markdown as as_markdown
from usvjax.report.numbers import change, interval, number, p_value, percent

FEW = 3
"""So many conditions of either end."""

# Letters of the failures' names that 80 columns hold; beyond, those that never happened go.
_ROOM_FOR_FAILURES = 24

_AVERAGES = {"mean": "Mean", "median": "Median", "iqm": "Interquartile mean"}


def markdown(summary: dict[str, Any]) -> str:
    """Write a summary as Markdown.

    Args:
        summary: from `usvjax.study.summary.summarise`.

    Returns:
        The text, ending in a newline.
    """
    study = summary["study"]
    level = f"{100 * study['confidence']:g} %"
    sections = [
        Section(
            "How episodes ended",
            [
                f"Share of episodes in %, with its {level} Wilson interval.",
                Sheet("", *_outcomes(summary)),
            ],
        ),
        Section(
            "Averages over each method's own successes",
            [
                "The methods succeed on different episodes, so these must not be subtracted; see "
                "the next table.",
                Sheet("", *_own_averages(summary)),
            ],
        ),
        Section(
            f"Differences to {study['baseline']}, episode by episode",
            [
                "Success over all episodes; everything else over the n episodes where both "
                "succeed.",
                Sheet("", *_differences(summary)),
            ],
        ),
        Section("How to read this", [Bullets(_notes(summary))]),
    ]
    head = f"Study of kind {study['kind']}, seed {study['seed']}, spec {study['hash'][:12]}."
    return as_markdown(Section(study["name"], [head, *sections]))


def terminal(summary: dict[str, Any]) -> list[Sheet | str]:
    """Lay a summary out for a terminal.

    Args:
        summary: from `usvjax.study.summary.summarise`.

    Returns:
        Tables and notes, for `usvjax.report.text_of`. Of more than `MOST_CONDITIONS` conditions
        they show the few whose best method succeeds most often, and least often.
    """
    study = summary["study"]
    level = f"{100 * study['confidence']:g} %"
    shown = _few(summary)
    parts: list[Sheet | str] = [
        Sheet(
            f"How episodes ended (% of episodes, {level} interval)",
            *_short_outcomes(shown),
            words=2,
        ),
    ]
    if len(study["methods"]) > 1:
        title = (
            f"Difference to {study['baseline']} (p by Holm): success over all episodes, all else "
            f"over the n where both succeed"
        )
        parts.append(Sheet(title, *_short_differences(shown), words=2, headed=True))
    if shown is not summary:
        parts.append(_rest_note(summary))
    return parts + [note for note in (_infinite_note(summary), _stopping_note(summary)) if note]


def _few(summary: dict[str, Any]) -> dict[str, Any]:
    """The summary, of many conditions with the ends of their ranking only, numbered by rank."""
    conditions = summary["conditions"]
    count = len(conditions)
    if count <= MOST_CONDITIONS:
        return summary
    success = summary["study"]["success"]

    def best(condition: dict[str, Any]) -> float:
        return max(m["statuses"][success]["value"] or 0.0 for m in condition["methods"])

    ranked = list(enumerate(sorted(conditions, key=best, reverse=True), start=1))
    ends = [
        condition | {"label": f"no. {rank:,} of {count:,}: {condition['label']}"}
        for rank, condition in ranked[:FEW] + ranked[-FEW:]
    ]
    return summary | {"conditions": ends}


def _rest_note(summary: dict[str, Any]) -> str:
    return (
        f"Of {len(summary['conditions']):,} conditions, ranked by the success rate of their best "
        f"method, the first {FEW} and the last {FEW} are shown. All of them are in summary.md, "
        f"summary.json and the Parquet shards."
    )


def _words(name: str) -> str:
    return name.replace("_", " ").capitalize()


def _label(metric: dict[str, Any]) -> str:
    return f"{metric['label']} ({metric['unit']})" if metric["unit"] else str(metric["label"])


def _endings(summary: dict[str, Any]) -> list[str]:
    """Names of the statuses, success first."""
    names = list(summary["conditions"][0]["methods"][0]["statuses"])
    return sorted(names, key=lambda name: name != summary["study"]["success"])


def _outcomes(summary: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    endings = _endings(summary)
    rows = [
        [
            condition["label"],
            method["method"],
            str(method["episodes"]),
            *(
                f"{interval(method['statuses'][e], 100.0)} ({method['statuses'][e]['count']})"
                for e in endings
            ),
            *map(number, method["counted"].values()),
        ]
        for condition in summary["conditions"]
        for method in condition["methods"]
    ]
    means = [f"{_label(metric)}, mean" for metric in summary["study"]["counted"]]
    return ["Condition", "Method", "Episodes", *map(_words, endings), *means], rows


def _short_outcomes(summary: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    success, *failures = _endings(summary)
    methods = [method for condition in summary["conditions"] for method in condition["methods"]]
    if sum(map(len, failures)) > _ROOM_FOR_FAILURES:
        failures = [e for e in failures if any(m["statuses"][e]["count"] for m in methods)]
    counted = [
        metric
        for metric in summary["study"]["counted"]
        if any(m["counted"][metric["name"]] for m in methods)
    ]
    rows = []
    for condition in summary["conditions"]:
        for place, method in enumerate(condition["methods"]):
            rates = method["statuses"]
            rows.append(
                [
                    condition["label"] if place == 0 else "",
                    method["method"],
                    f"{method['episodes']:,}",
                    interval(rates[success], 100.0),
                    *(percent(rates[name]["value"]) for name in failures),
                    *(number(method["counted"][metric["name"]]) for metric in counted),
                ]
            )
    means = [f"{_label(metric)}, mean" for metric in counted]
    return ["Condition", "Method", "Episodes", *map(_words, (success, *failures)), *means], rows


def _own_averages(summary: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    rows = [
        [
            condition["label"],
            method["method"],
            _label(metric),
            _of_all(method["metrics"][metric["name"]]),
            *(interval(method["metrics"][metric["name"]][key]) for key in _AVERAGES),
        ]
        for condition in summary["conditions"]
        for method in condition["methods"]
        for metric in summary["study"]["metrics"]
    ]
    return ["Condition", "Method", "Figure", "n", *_AVERAGES.values()], rows


def _differences(summary: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    header = ["Condition", "Method", "Figure", "n", "Baseline mean", "Method mean"]
    header += ["Mean difference", "Change", "p (t)", "p (Wilcoxon)", "p (McNemar)"]
    rows = []
    for condition in summary["conditions"]:
        for pair in condition["pairs"]:
            start = [condition["label"], pair["method"]]
            success = pair["success"]
            rates = _success_rates(success)
            rows.append(
                [
                    *start,
                    "Success (%)",
                    str(success["n"]),
                    *map(percent, rates),
                    interval(success["difference"], 100.0, sign=True),
                    "-",
                    "-",
                    "-",
                    p_value(success["p_mcnemar_holm"]),
                ]
            )
            for metric in summary["study"]["metrics"]:
                found = pair["metrics"][metric["name"]]
                gap = found["difference"]
                rows.append(
                    [
                        *start,
                        _label(metric),
                        _of_all(found),
                        interval(found["baseline"]["mean"]),
                        interval(found["method"]["mean"]),
                        interval(gap, sign=True),
                        _change(gap),
                        p_value(gap["p_t_holm"]),
                        p_value(gap["p_wilcoxon_holm"]),
                        "-",
                    ]
                )
    return header, rows


def _short_differences(summary: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    rows = []
    for condition in summary["conditions"]:
        for pair in condition["pairs"]:
            success = pair["success"]
            head = f"{condition['label']}: {pair['method']}, "
            head += f"n = {success['both']:,} of {success['n']:,}"
            rows.append(
                [
                    head,
                    "Success (%)",
                    *map(percent, _success_rates(success)),
                    interval(success["difference"], 100.0, sign=True),
                    "",
                    p_value(success["p_mcnemar_holm"]),
                ]
            )
            for metric in summary["study"]["metrics"]:
                found = pair["metrics"][metric["name"]]
                gap = found["difference"]
                own = f", n = {_of_all(found)}" if _infinite(found) else ""
                rows.append(
                    [
                        "",
                        f"{_label(metric)}{own}",
                        number(found["baseline"]["mean"]["value"]),
                        number(found["method"]["mean"]["value"]),
                        interval(gap, sign=True),
                        _change(gap),
                        p_value(gap["p_t_holm"]),
                    ]
                )
    return ["Condition", "Figure", "Baseline", "Method", "Difference", "Change", "p"], rows


def _success_rates(success: dict[str, Any]) -> tuple[float | None, float | None]:
    """Success rates of baseline and method from the paired counts."""
    n = success["n"]
    if not n:
        return None, None
    both = success["both"]
    return (both + success["baseline_only"]) / n, (both + success["method_only"]) / n


def _change(gap: dict[str, Any]) -> str:
    """A share changes by points: from 0.8 to 99.8 % is no "+12375 %"."""
    if "points" in gap:
        return "-" if gap["points"] is None else f"{gap['points']:+.1f} pp"
    return change(gap["relative"])


def _infinite(found: dict[str, Any]) -> int:
    """How many values a figure leaves out; summaries only have the key where there are some."""
    return int(found.get("infinite", 0))


def _of_all(found: dict[str, Any]) -> str:
    """How many values a figure is of, out of how many if it leaves some out."""
    left_out = _infinite(found)
    return f"{found['n']} of {found['n'] + left_out}" if left_out else str(found["n"])


def _infinite_note(summary: dict[str, Any]) -> str:
    """Say which metrics leave out episodes; "" where none does."""
    conditions = summary["conditions"]
    compared = [one for c in conditions for one in (*c["methods"], *c["pairs"])]
    metrics = [
        metric["label"]
        for metric in summary["study"]["metrics"]
        if any(_infinite(one["metrics"][metric["name"]]) for one in compared)
    ]
    if not metrics:
        return ""
    return (
        f"{' and '.join(metrics)}: episodes with an infinite value, such as the clearance of one "
        f"that never sensed an obstacle, are left out, and n is of the others."
    )


def _stopping_note(summary: dict[str, Any]) -> str:
    study = summary["study"]
    if study["until"] is None:
        return ""
    wide = [c["label"] for c in summary["conditions"] if not c["narrow_enough"]]
    text = f"Success rates are known to within {study['until']:g} (interval width)"
    if not wide:
        return f"{text} everywhere."
    named = "; ".join(wide[:MOST_CONDITIONS])
    rest = len(wide) - MOST_CONDITIONS
    more = f"; and {rest:,} more (see narrow_enough in summary.json)" if rest > 0 else ""
    return f"{text} except, after {study['looks'][-1]:,} episodes, for: {named}{more}."


def _notes(summary: dict[str, Any]) -> list[str]:
    study, families = summary["study"], summary["study"]["families"]
    looks = len(study["looks"])
    infinite = _infinite_note(summary)
    undetermined = "no episode ever" if infinite else "one never"
    notes = [
        "Methods meet the same episodes: what was drawn for a job is the same for all of them.",
        f"Intervals: shares Wilson; averages percentile bootstrap ({study['resamples']} "
        "resamples); mean differences Student's t; difference of success rates Agresti-Min. "
        '"-": the episodes do not determine this figure, such as a mean clearance where '
        f"{undetermined} sensed an obstacle.",
        *([infinite] if infinite else []),
        "p-values: paired t-test, Wilcoxon's signed-rank test and McNemar's exact test, each "
        "Holm-corrected over all tests of its kind in this study ("
        + ", ".join(
            f"{families.get(k, 0)} {name}"
            for k, name in (("p_t", "t"), ("p_wilcoxon", "Wilcoxon"), ("p_mcnemar", "McNemar"))
        )
        + ").",
    ]
    if looks > 1:
        notes.append(
            f"Episodes were looked at after {', '.join(map(str, study['looks']))}. So that "
            f"stopping early does not spoil {100 * study['confidence']:g} % coverage, each "
            f"interval is computed at {100 * study['level']:.4g} % and each p-value multiplied "
            f"by {looks}. {_stopping_note(summary)}"
        )
    return notes
