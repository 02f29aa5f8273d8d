"""The episode of a run that a command has back: the arguments that choose it, and the choice."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

if TYPE_CHECKING:
    from usvjax.mission import Replayed
    from usvjax.study.replay import Replay

RunPath = Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RUN")]
Job = Annotated[int | None, tyro.conf.arg(metavar="N")]
Method = Annotated[str | None, tyro.conf.arg(metavar="NAME")]
OutFile = Annotated[Path | None, tyro.conf.arg(metavar="FILE")]


@dataclass(frozen=True)
class Chosen:
    """One episode of a run.

    Attributes:
        replay: has episodes of the run back.
        condition: number of its condition.
        method: of the run.
        job: number of the episode.
    """

    replay: "Replay"
    condition: int
    method: str
    job: int

    @property
    def name(self) -> str:
        """What sets it apart in the name of a file."""
        return f"c{self.condition}-{self.method}-j{self.job}"

    def place(self, name: str) -> Path:
        """Where a file about it goes, unless another place is given."""
        from usvjax.study.folder import check_no_link

        folder = self.replay.run.path / "figures"
        check_no_link(folder)
        return folder / name

    def again(self) -> "Replayed":
        """Simulate the episode again; see `usvjax.study.replay.Replay`."""
        return self.replay(self.condition, self.method, [self.job])


def choose(run: Path, condition: int, method: str | None, job: int | None, folder: Path) -> Chosen:
    """The episode asked for; by default the one that `usvjax plot` shows, by the last method."""
    from usvjax.study import load_run
    from usvjax.study.replay import Replay

    replay = Replay(load_run(run), folder)
    method = replay.run.methods[-1] if method is None else method
    number = replay.example(condition)[0] if job is None else job
    return Chosen(replay, condition, method, number)
