"""Claims of a paper, and what becomes of them under every way to read it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from usvjax.report import Section, Sheet
from usvjax.report.numbers import NONE

REPRODUCES = "reproduces"
NOT_EXCLUDED = "not excluded"
DEPENDS = "depends on the reading"
FAILS = "does not reproduce"
OPEN = "undecided"
WORDS = (REPRODUCES, NOT_EXCLUDED, DEPENDS, FAILS, OPEN)
"""What a claim may come to, in the order of summaries."""

Numbers = Mapping[str, Any]
"""What was measured, as in results.json."""


@dataclass(frozen=True)
class Finding:
    """One claim under one reading.

    Attributes:
        holds: None where the sample does not tell.
        numbers: what was found, in a few words.
    """

    holds: bool | None
    numbers: str


@dataclass(frozen=True)
class Claim:
    """One table, figure or sentence of a paper that can be put to the test.

    Attributes:
        text: what the paper says.
        published: its numbers.
        measure: from the numbers found and what a reading stands for to a finding.
        readings: ways to read the paper, by label, and what each gives to `measure`. All of them
            count: a claim reproduces where it is shown to hold under all, and fails where it is
            shown not to hold under any. Of many, those with the same words before a colon are
            counted together on the page.
        beside: readings that stand beside these and do not count, such as what was chosen after
            the fact to come near to this very claim.
        test: how it is decided, and with what probability a true claim would fail; one sentence.
        weak: whether the test can only exclude the claim; where it does not, that is all it says.
    """

    text: str
    published: str
    measure: Callable[[Numbers, Any], Finding]
    readings: Mapping[str, Any]
    beside: Mapping[str, Any] = field(default_factory=dict)
    test: str = ""
    weak: bool = False


@dataclass(frozen=True)
class Verdict:
    """What became of a claim.

    Attributes:
        claim, published, test: of the claim.
        verdict: one of `WORDS`.
        found: label of a reading to what was found.
        beside: the same of the readings that do not count.
    """

    claim: str
    published: str
    test: str
    verdict: str
    found: dict[str, Finding]
    beside: dict[str, Finding]


def judge(claims: Sequence[Claim], numbers: Numbers) -> list[Verdict]:
    """Put claims to the test."""
    return [_judged(claim, numbers) for claim in claims]


def _judged(claim: Claim, numbers: Numbers) -> Verdict:
    found, beside = (
        {label: claim.measure(numbers, given) for label, given in readings.items()}
        for readings in (claim.readings, claim.beside)
    )
    word = weigh(list(found.values()))
    if word == REPRODUCES and claim.weak:
        word = NOT_EXCLUDED
    return Verdict(claim.text, claim.published, claim.test, word, found, beside)


def weigh(findings: Sequence[Finding]) -> str:
    """What the findings under all readings that count come to; one that is open leaves it open."""
    known = {finding.holds for finding in findings}
    if {True, False} <= known:
        return DEPENDS
    if None in known or not known:
        return OPEN
    return REPRODUCES if True in known else FAILS


def below(figure: Mapping[str, Any], bound: float = 0.0) -> bool | None:
    """Whether a figure lies below a bound with its whole interval.

    Returns:
        False where it lies above with all of it; None where the interval holds the bound, or
        there is none.
    """
    low, high = figure["low"], figure["high"]
    if low is None or high is None:
        return None
    return True if high < bound else False if low > bound else None


def above(figure: Mapping[str, Any], bound: float = 0.0) -> bool | None:
    """Whether a figure lies above a bound with its whole interval; see `below`."""
    found = below(figure, bound)
    return None if found is None else not found


def not_excluded(p: float, least: float, level: float) -> bool | None:
    """Whether a p leaves a claim standing that a test can only exclude.

    Args:
        p: of the test.
        least: the smallest that p could have been; that of ranks hangs on how many there are.
        level: up to which p excludes.

    Returns:
        None where no p could have excluded it.
    """
    if p <= level:
        return False
    return None if least > level else True


def every(findings: Sequence[bool | None]) -> bool | None:
    """Whether all of several hold; one that is open leaves that open, unless another does not."""
    return False if False in findings else None if None in findings else True


def summary(verdicts: Sequence[Verdict]) -> list[str]:
    """The claims by what became of them, a line each."""
    lines = []
    for word in WORDS:
        claims = [one.claim for one in verdicts if one.verdict == word]
        if claims:
            lines.append(f"**{word[0].upper()}{word[1:]}**: {'; '.join(claims)}.")
    return lines


def sheet(verdicts: Sequence[Verdict]) -> Sheet:
    """Verdicts as a table: a column per reading, or kind of it; brackets mean it does not count."""
    counted = dict.fromkeys(label for one in verdicts for label in _cells(one.found))
    beside = dict.fromkeys(label for one in verdicts for label in _cells(one.beside))
    rows = [
        [
            one.claim,
            one.published,
            f"**{one.verdict}**",
            *(_cells(one.found).get(label, NONE) for label in counted),
            *(_cells(one.beside).get(label, NONE) for label in beside),
        ]
        for one in verdicts
    ]
    header = ["The paper", "Published", "Verdict", *counted, *(f"({label})" for label in beside)]
    return Sheet("", header, rows, words=len(header))


def tests(verdicts: Sequence[Verdict]) -> list[str]:
    """How claims were decided, those decided alike together."""
    by_test: dict[str, list[str]] = {}
    for one in verdicts:
        if one.test:
            by_test.setdefault(one.test, []).append(one.claim)
    return [f"{'; '.join(claims)}: {test}" for test, claims in by_test.items()]


def section(verdicts: Sequence[Verdict]) -> Section:
    """Verdicts for a terminal: below each claim what was found under every reading."""
    rows = []
    for one in verdicts:
        head = f"{one.claim} (published: {one.published}): {one.verdict.upper()}"
        rows += [[head, label, cell] for label, cell in _cells(one.found).items()]
        rows += [[head, f"({label})", cell] for label, cell in _cells(one.beside).items()]
    return Section(
        "What reproduces", [Sheet("", ["", "Reading", "Found"], rows, words=3, headed=True)]
    )


def _cells(found: Mapping[str, Finding]) -> dict[str, str]:
    """Findings by their reading; those that share the words before a colon are counted together."""
    together: dict[str, dict[str, Finding]] = {}
    for label, finding in found.items():
        together.setdefault(label.partition(": ")[0], {})[label] = finding
    cells = {}
    for head, group in together.items():
        if len(group) > 1:
            cells[head] = _count(list(group.values()))
        else:
            cells |= {label: f"{_WORD[one.holds]}: {one.numbers}" for label, one in group.items()}
    return cells


_WORD = {True: "yes", False: "no", None: NONE}


def _count(findings: Sequence[Finding]) -> str:
    counts = {word: sum(one.holds is holds for one in findings) for holds, word in _WORD.items()}
    words = [f"{word} {count}" for word, count in counts.items() if count]
    return f"of {len(findings)}: {', '.join(words)}"


@dataclass(frozen=True)
class Check:
    """One of a paper's numbers against its other numbers.

    Attributes:
        where: which number.
        printed: as printed, with its unit.
        recomputed: from the other numbers.
        verdict: "agrees", "can agree" (such as an average of ratios, which need not be the ratio
            of averages), or "contradicts".
    """

    where: str
    printed: str
    recomputed: str
    verdict: str


def arithmetic(checks: Sequence[Check]) -> Section:
    """The checks that do not agree, and how many do."""
    agreeing, possible, against = (
        sum(check.verdict == word for check in checks)
        for word in ("agrees", "can agree", "contradicts")
    )
    rows = [
        [check.where, check.printed, check.recomputed, check.verdict]
        for check in checks
        if check.verdict != "agrees"
    ]
    return Section(
        "The paper's own arithmetic",
        [
            f"Of {len(checks)} checks of the paper's numbers against each other {agreeing} agree, "
            f"{possible} can agree and {against} contradict. Those that agree are left out here.",
            Sheet("", ["Where", "Printed", "From the other numbers", "Verdict"], rows, words=4),
        ],
    )
