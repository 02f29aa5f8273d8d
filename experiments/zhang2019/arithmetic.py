"""Zhang et al. 2019: the printed numbers against each other, and what they say of the map."""

from collections.abc import Callable
from dataclasses import dataclass

from experiments.claims import Check
from experiments.zhang2019.published import GAMMA, IMPROVED, LOWER, TIMES, TRADITIONAL

HALF_UNIT = 0.5
"""Table 4 is in whole ms, and the text's share in whole per cent."""


@dataclass(frozen=True)
class Steps:
    """One way to make up the published length.

    Attributes:
        straight, diagonal: steps.
        side: cells of a square map that a path from corner to corner with these steps and
            without detours crosses, None where there is no such map.
    """

    straight: int
    diagonal: int

    @property
    def side(self) -> int | None:
        """Each diagonal step goes one column and one row on, a straight one either."""
        squares = self.straight + 2 * self.diagonal
        return None if squares % 2 else squares // 2 + 1


def steps_of(length: float) -> list[Steps]:
    """All numbers of steps that add up to a length with a diagonal cost of 1.4."""
    tenths = round(10 * length)
    return [
        Steps((tenths - 14 * diagonal) // 10, diagonal)
        for diagonal in range(tenths // 14 + 1)
        if (tenths - 14 * diagonal) % 10 == 0
    ]


def ratio_range() -> tuple[float, float]:
    """The least and the largest ratio of times that round to those of Table 4."""
    old, new = TIMES["traditional"], TIMES["improved"]
    return (new - HALF_UNIT) / (old + HALF_UNIT), (new + HALF_UNIT) / (old - HALF_UNIT)


def checks() -> list[Check]:
    """Compare the paper's numbers with each other."""
    rows = {"traditional": TRADITIONAL, "improved": IMPROVED}
    turns = [_turns(name, row.turning / GAMMA, row.turning) for name, row in rows.items()]
    return [*turns, *lower()]


def lower() -> list[Check]:
    """The text's share of Table 4 in both ways to read it."""
    return [
        _lower("longer per query", lambda ratio: ratio - 1.0),
        _lower("fewer queries a second", lambda ratio: 1.0 - 1.0 / ratio),
    ]


def _turns(name: str, turns: float, cost: float) -> Check:
    return Check(
        f"Table 3, turning cost, {name}",
        f"{cost} at {GAMMA} per 45 deg",
        f"{turns:g} turns by 45 deg",
        "agrees" if turns.is_integer() else "contradicts",
    )


def _lower(words: str, share: Callable[[float], float]) -> Check:
    """The text's share, read in one way, against the times of Table 4 and their rounding."""
    value, low, high = (
        100.0 * share(ratio) for ratio in (TIMES["improved"] / TIMES["traditional"], *ratio_range())
    )
    can = low < LOWER + HALF_UNIT and high >= LOWER - HALF_UNIT
    return Check(
        f'Table 4, performance "only {LOWER:g} % lower", read as: {words}',
        f"{LOWER:g} %",
        f"{value:.2f} %, and {low:.1f} to {high:.1f} % as the times are rounded to whole ms",
        "agrees" if round(value) == LOWER else "can agree" if can else "contradicts",
    )
