"""What Yu et al. 2022 say of their heuristic, under each reading of Eq. 17 and of the old one."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from experiments.claims import Claim, Finding, Numbers, above, below
from experiments.yu2022.heuristic.mission import TRADITIONAL, UNIT
from experiments.yu2022.heuristic.published import EXPANDED, FEWER, SAME_PATH
from usvjax.report.numbers import listed

LEAST_MAPS = 20
TOO_FEW = "too few maps"
RULE = 0.95
"""Share of maps on which what is a rule holds."""
CHANCE = 0.05
"""Share of maps below which what is said of one map is taken as excluded."""


class Given(NamedTuple):
    """What a reading stands for.

    Attributes:
        new: heuristic that Eq. 17 may mean.
        old: what it is compared with.
    """

    new: str
    old: str = TRADITIONAL


READINGS = {
    "Eq. 17 as printed": Given("weighted"),
    "octile with the weight of Eq. 17": Given("weighted_octile"),
}
BY_UNIT = {
    f"{label}; traditional diagonal steps of cost 1": Given(given.new, UNIT)
    for label, given in READINGS.items()
}
BESIDE = {"octile": Given("octile")}

Rows = Sequence[Mapping[str, Any]]


def claims(numbers: Numbers) -> list[Claim]:
    """Every claim about the heuristic."""
    both = READINGS | BY_UNIT
    first, then = EXPANDED.values()
    return [
        Claim(
            "Figs. 3 and 4: nodes expanded from E3 until row D is done",
            f"{first} and {then}",
            _layer,
            READINGS,
            BESIDE,
            "computed from the equations on a grid without obstacles, without error",
        ),
        Claim(
            "Fig. 5: fewer expanded nodes",
            f'"{FEWER}"',
            _on("plans", _fewer),
            both,
            BESIDE,
            "the geometric mean over maps of the ratio of expansions lies below 1 with its whole "
            "95 % t interval on every kind of map: yes; above 1 on every kind: no; two equal "
            "heuristics would come to either in 2.5 % of samples at most",
        ),
        Claim(
            "Fig. 5: on its map both paths are the same",
            f'"{SAME_PATH}"',
            _on("plans", _may_be_same),
            both,
            BESIDE,
            "of equally short paths a rule that is not printed chooses: the new path may be the "
            "old one where it is as short by the old one's costs, and the claim is excluded where "
            f"that is so on fewer than {100 * CHANCE:g} % of maps of every kind, with the 95 % "
            "Wilson interval: a map like these would show it in no more papers than that",
            weak=True,
        ),
        Claim(
            "Fig. 5 as a rule: the new path is as short",
            "no number is given",
            _on("plans", _as_short),
            both,
            BESIDE,
            f"so on more than {100 * RULE:g} % of maps with the whole 95 % Wilson interval on "
            "every kind of them: yes; on fewer on every kind: no; a share just at this threshold, "
            "which is ours, comes to either in about 2.5 % of samples at most",
        ),
        Claim(
            "Fewer expanded nodes while the map changes",
            "no number is given",
            _on("episodes", _fewer),
            READINGS,
            BESIDE,
            "as for fewer expanded nodes in Fig. 5",
        ),
    ]


def _layer(numbers: Numbers, given: Given) -> Finding:
    """Besides the goal, as many nodes of row D as are tied for the least key."""
    words = {1: "two", 2: "three", 3: "four"}
    found = [
        tuple(words[rows[name][0]] for name in (TRADITIONAL, given.new))
        for rows in numbers["layers"].values()
    ]
    return Finding(
        _unanimous(pair == tuple(EXPANDED.values()) for pair in found),
        "; ".join(map(" and ".join, dict.fromkeys(found))),
    )


def _unanimous(answers: Iterable[bool | None]) -> bool | None:
    """What all answers are; None where they differ: which map the paper's is like is not known."""
    known = set(answers)
    return known.pop() if len(known) == 1 else None


def _on(kind: str, decide: Callable[[Rows], Finding]) -> Callable[[Numbers, Given], Finding]:
    """Decide on all tables of a kind."""

    def measure(numbers: Numbers, given: Given) -> Finding:
        tables = numbers[kind].values()
        if any(table["n"] < LEAST_MAPS for table in tables):
            return Finding(None, TOO_FEW)
        rows = [table["heuristics"][given.new] for table in tables]
        return decide([row["against"][given.old] if "against" in row else row for row in rows])

    return measure


def _fewer(rows: Rows) -> Finding:
    numbers = listed([row["times"]["value"] for row in rows], 2)
    return Finding(_unanimous(below(row["times"], 1.0) for row in rows), f"{numbers} times")


def _may_be_same(rows: Rows) -> Finding:
    short = [row["as_short"] for row in rows]
    cells = listed([row["same_cells"]["value"] for row in rows], 1, 100)
    return Finding(
        not all(below(share, CHANCE) for share in short),
        f"as short on {_values(short)} % of maps, the same cells by our ties on {cells} %",
    )


def _as_short(rows: Rows) -> Finding:
    short = [row["as_short"] for row in rows]
    holds = _unanimous(above(share, RULE) for share in short)
    return Finding(holds, f"on {_values(short)} % of maps")


def _values(shares: Sequence[Mapping[str, Any]]) -> str:
    return listed([share["value"] for share in shares], 1, 100)
