"""What the missions of papers have in common."""

from collections.abc import Iterator
from typing import Any

from usvjax.mission import Replayed


class PaperMission:
    """A mission whose figures are those of its paper's page; see `usvjax.mission.Mission`."""

    def example(self, rows: Any, methods: list[str]) -> tuple[int, str]:
        """The first; see `Mission.example`."""
        return int(rows["job"].min()), "the first, which was not chosen"

    def figures(self, run: Any, replay: Any) -> Iterator[tuple[str, Any]]:
        """None; see `Mission.figures`."""
        return iter(())

    def film(self, replayed: Replayed, row: int) -> Any:
        """Its track; see `Mission.film`."""
        from usvjax.plots.tracks import film_of

        return film_of(replayed, row)
