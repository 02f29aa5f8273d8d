"""Each rule against the traditional one on the same maps, and on maps like the paper's."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from experiments.estimates import mean, rank_p, ratio, share, spread
from experiments.runs import Found, Ran
from experiments.zhang2019.arithmetic import steps_of
from experiments.zhang2019.mission import BATCHED, ORDERS, TEXTBOOK, named
from experiments.zhang2019.paths import EXACT_DIAGONAL, Paths, paths_of
from experiments.zhang2019.published import IMPROVED, TRADITIONAL
from experiments.zhang2019.runs import FITTED, SIZES, settings

WINDOWS = (1.0, 2.0)
"""Squares by which length and turning cost of the traditional path may differ from the paper's
on a map that counts as one like it."""
SAVED = TRADITIONAL.total - IMPROVED.total
"""Squares, by Table 3."""
_ALIKE = 1e-6

CLOSELY = [label for label, (side, _, cut) in SIZES.items() if side == FITTED.side and not cut]
"""Sizes of the map of which the tables show everything."""

PROGRAMS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "batched": ("batched", tuple(rule for rule in BATCHED if rule != "traditional")),
    **{order: ("textbook", ("printed", "accumulated")) for order in ORDERS},
}
"""Name of a program to its study and the rules beside the traditional one."""


def paths(ran: Ran, label: str, rule: str, program: str) -> Paths:
    """The paths of one rule on the maps of one size."""
    return paths_of(ran.columns(label, named(rule, program)))


def measure(found: Found) -> dict[str, Any]:
    """All tables; see `experiments.paper.Part`."""
    table: dict[str, Any] = {
        "maps": settings(found),
        "sizes": {label: size._asdict() for label, size in SIZES.items()},
        "programs": {program: _program(found, program) for program in PROGRAMS},
        "closely": {label: _closely(found, label) for label in CLOSELY},
        "shown": _shown(found),
        "time": _times(found.made["timed"]),
        "steps": [{**asdict(row), "side": row.side} for row in steps_of(TRADITIONAL.length)],
    }
    return table


def _program(found: Found, program: str) -> dict[str, Any]:
    study, rules = PROGRAMS[program]
    ran = found.studies[study]
    table = {}
    for label in SIZES:
        old = paths(ran, label, "traditional", program)
        new = {rule: paths(ran, label, rule, program) for rule in rules}
        table[label] = {
            "traditional": traditional(old),
            "alike": {
                f"{window:g}": {
                    "n": int(alike(old, window).sum()),
                    **{rule: saved(own, old, window) for rule, own in new.items()},
                }
                for window in WINDOWS
            },
            "exactly": exactly(new, old),
            "against": {rule: against(own, old) for rule, own in new.items()},
        }
    return table


def traditional(old: Paths) -> dict[str, Any]:
    """What the traditional paths cost on all maps, and how far out Table 3's lies among them.

    Returns:
        Share of maps with a path; mean, 2.5 and 97.5 % quantiles; and p, the probability that
        a map of these has a path as far out in length or in turning cost (by ranks, Bonferroni
        for the two).
    """
    some = old.some(old.found)
    length, turning = some.length(), some.turning
    ranks = (
        rank_p(length, TRADITIONAL.length, _ALIKE),
        rank_p(turning, TRADITIONAL.turning, _ALIKE),
    )
    return {
        "n": len(length),
        "reached": share(old.found),
        "length": spread(length),
        "turning": spread(turning),
        "total": spread(some.total()),
        "p": min(1.0, 2.0 * min(ranks)),
    }


def alike(old: Paths, window: float) -> np.ndarray:
    """Which maps are like the paper's: the traditional path costs about what Table 3 says."""
    close: np.ndarray = (
        old.found
        & (np.abs(old.length() - TRADITIONAL.length) <= window + _ALIKE)
        & (np.abs(old.turning - TRADITIONAL.turning) <= window + _ALIKE)
    )
    return close


def saved(new: Paths, old: Paths, window: float) -> dict[str, Any]:
    """What a rule saves on the maps that are like the paper's.

    Returns:
        Mean saving of the total; share of maps with at least the published one; and p, the
        probability of such a saving on a map like these, the paper's counted as one more.
    """
    chosen = alike(old, window)
    saving = old.some(chosen).total() - new.some(chosen).total()
    as_published = saving >= SAVED - _ALIKE
    return {
        "saved": float(saving.mean()) if len(saving) else None,
        "as_published": share(as_published),
        "p": float((1 + as_published.sum()) / (1 + len(as_published))),
    }


def exactly(new: Mapping[str, Paths], old: Paths) -> dict[str, int]:
    """Count maps whose traditional path costs exactly what Table 3 says.

    Returns:
        Their number, and by rule on how many of them its path then does, too.
    """
    same = alike(old, 0.0)
    hits = {
        rule: same
        & np.isclose(own.total(), IMPROVED.total)
        & np.isclose(own.turning, IMPROVED.turning)
        for rule, own in new.items()
    }
    return {"maps": int(same.sum()), **{rule: int(hit.sum()) for rule, hit in hits.items()}}


def nearest(old: Paths) -> int:
    """Choose the map whose traditional path comes nearest to Table 3, the first of equals."""
    apart = np.abs(old.length() - TRADITIONAL.length) + np.abs(old.turning - TRADITIONAL.turning)
    return int(np.where(old.found, np.round(apart, 6), np.inf).argmin())


def against(new: Paths, old: Paths) -> dict[str, Any]:
    """Mean differences to the traditional rule with t intervals, map by map where there is a path.

    Returns:
        Number of maps, and the changes of total and turning cost and of the number of turns.
    """
    both = new.found & old.found
    new, old = new.some(both), old.some(both)
    return {
        "n": int(both.sum()),
        "total": mean(new.total() - old.total()),
        "turning": mean(new.turning - old.turning),
        "bends": mean(new.bends - old.bends),
    }


def closely(new: Paths, old: Paths) -> dict[str, Any]:
    """The same in full.

    Returns:
        `against`; means of both; changes of length and of the cells expanded; and the shares of
        maps on which the total cost is equal and higher.
    """
    rows = against(new, old)
    both = new.found & old.found
    new, old = new.some(both), old.some(both)
    change = new.total() - old.total()
    means = {
        "total": (new.total(), old.total()),
        "turning": (new.turning, old.turning),
        "bends": (new.bends, old.bends),
        "length": (new.length(), old.length()),
        "expanded": (new.expanded, old.expanded),
    }
    return {
        **rows,
        "length": mean(new.length() - old.length()),
        "expanded": mean(new.expanded - old.expanded),
        "means": {
            name: [float(one.mean()) if len(one) else None for one in pair]
            for name, pair in means.items()
        },
        "equal": share(np.abs(change) <= _ALIKE),
        "worse": share(change > _ALIKE),
    }


def _closely(found: Found, label: str) -> dict[str, Any]:
    """Every rule of both programs against the program's traditional one on maps of one size."""
    batch, book = found.studies["batched"], found.studies["textbook"]
    own = {rule: paths(batch, label, rule, "batched") for rule in BATCHED}
    books = {name: paths_of(book.columns(label, name)) for name in TEXTBOOK}
    plain = books.pop(named("traditional", "textbook"))
    return {
        "batched": {
            rule: closely(one, own["traditional"])
            for rule, one in own.items()
            if rule != "traditional"
        },
        "textbook": {name: closely(one, plain) for name, one in books.items()},
        "excess": {rule: excess(one, own["exact"]) for rule, one in own.items()},
    }


def excess(own: Paths, exact: Paths) -> float | None:
    """By how much totals, with true diagonals, exceed the least there is; mean, relative to it."""
    both = own.found & exact.found
    if not both.any():
        return None
    best = exact.some(both).total(EXACT_DIAGONAL)
    return float((own.some(both).total(EXACT_DIAGONAL) / best).mean() - 1.0)


def _shown(found: Found) -> dict[str, Any]:
    """The paths on the map that is drawn."""
    ran, label = found.studies["batched"], FITTED.label
    job = nearest(paths(ran, label, "traditional", "batched"))
    table = {}
    for rule in BATCHED:
        own = paths(ran, label, rule, "batched").some(np.array([job]))
        table[rule] = {
            "total": float(own.total()[0]),
            "turning": float(own.turning[0]),
            "length": float(own.length()[0]),
            "bends": int(own.bends[0]),
            "expanded": int(own.expanded[0]),
        }
    return {"map": job, "paths": table}


def _times(taken: Mapping[str, Any]) -> dict[str, Any]:
    """Times by size, program and rule.

    Returns:
        Number of runs, s per query of the fastest, and the ratio to the traditional rule: the
        geometric mean over runs that took turns.
    """
    return {
        label: {
            program: {
                rule: {
                    "n": len(seconds),
                    "seconds": min(seconds),
                    "ratio": ratio(np.array(seconds), np.array(rules["traditional"])),
                }
                for rule, seconds in rules.items()
            }
            for program, rules in programs.items()
        }
        for label, programs in taken.items()
    }
