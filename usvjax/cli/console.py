"""Where commands print: under any encoding and at any width, and nothing of a user's as markup."""

import codecs
import io
import os
import sys
import time
from collections.abc import Iterable
from types import TracebackType

from rich.cells import cell_len
from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TaskID, TextColumn
from rich.progress import TimeElapsedColumn as Elapsed
from rich.progress import TimeRemainingColumn as Remaining
from rich.text import Text

from usvjax.errors import printable
from usvjax.report.sheets import Sheet, text_of

_BAR, _AROUND = 16, 50
"""Columns of a bar, and of the speed and the times around it."""
_EVERY = 30.0  # s, between lines of progress where there is no terminal
_PLAIN = {"\u2500": "-", "\u2501": "-", "\u2588": "#", "\u2584": ".", "\u2580": "'"}
_PLAIN |= {"\u2026": "...", "\u2018": "'", "\u2019": "'", "\u2022": "*", "\u00a0": " "}
_HANDLER = "usvjax.plain"


def _plain(error: UnicodeError) -> tuple[str, int]:
    """What stands for characters that an encoding lacks: a plain one alike, or "?"."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    missing = error.object[error.start : error.end]
    return "".join(_PLAIN.get(c, "?") for c in missing), error.end


codecs.register_error(_HANDLER, _plain)


def use_any_encoding() -> None:
    """Let stdout and stderr print any text whatever their encoding, at worst a "?" for a letter."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=_HANDLER)


def console(stderr: bool = False) -> Console:
    """The console of every command: it reads no markup, cuts nothing and wraps nothing."""
    return Console(stderr=stderr, highlight=False, markup=False, emoji=False, soft_wrap=True)


def room() -> int | None:
    """Columns that a line on stdout may take; None in a pipe or a file, where nobody counts."""
    out = console()
    if out.is_terminal or os.environ.get("COLUMNS", "").isdigit():
        return max(out.width, 1)
    return None


def show(*parts: Sheet | str) -> None:
    """Print tables, and paragraphs folded at spaces, on stdout."""
    console().print(Text(text_of(parts, room())), end="")


def show_line(text: str | Text) -> None:
    """Print one line on stdout, such as a path, which must stay whole to be copied."""
    console().print(Text(printable(text)) if isinstance(text, str) else text)


def complain(text: str) -> None:
    """Print one line on stderr."""
    print(printable(" ".join(text.split())), file=sys.stderr)


class Meter:
    """Progress on stderr: a bar on a terminal, elsewhere a line now and then."""

    def __init__(self, name: str, what: str, quiet: bool = False) -> None:
        """Nothing is shown before `begin`.

        Args:
            name: what is going on.
            what: is counted, such as "episodes".
            quiet: whether nothing is shown at all.
        """
        self._console = console(stderr=True)
        self._name, self._what, self._quiet = printable(name), what, quiet
        self._done, self._total = 0.0, 0.0
        self._said = self._began = time.monotonic()
        self._bar: Progress | None = None
        self._task = TaskID(0)

    def begin(self, done: int, total: int) -> None:
        """Show it."""
        self._done, self._total = done, total
        self._said = self._began = time.monotonic()
        if self._console.is_terminal and not self._quiet:
            self._bar = Progress(*self._columns(), console=self._console)
            self._task = self._bar.add_task(self._name, total=total, completed=done)
            self._bar.start()

    def advance(self, count: int) -> None:
        """Count on."""
        self._done += count
        if self._bar is not None:
            self._bar.advance(self._task, count)
        elif time.monotonic() - self._said > _EVERY:
            self._say_how_far()

    def say(self, text: str) -> None:
        """Print a line."""
        if not self._quiet:
            (self._bar.console if self._bar else self._console).print(Text(printable(text)))

    def end(self, whole: bool) -> None:
        """Leave the last state standing; if `whole`, nothing more would have come."""
        if self._bar is not None:
            if whole:
                self._bar.update(self._task, total=self._done)
            self._bar.stop()
        elif self._total:
            self._total = self._done if whole else self._total
            self._say_how_far()
        self._bar, self._total = None, 0.0

    def _say_how_far(self) -> None:
        self._said = time.monotonic()
        seconds = self._said - self._began
        self.say(
            f"{self._name}: {self._done:,.0f}/{self._total:,.0f} {self._what} in {seconds:,.0f} s"
        )

    def _columns(self) -> Iterable[ProgressColumn]:
        count = 2 * len(f"{self._total:,.0f}") + len(self._what)
        if self._console.width < cell_len(self._name) + _BAR + count + _AROUND:
            return (_Count(self._what, speed=False),)
        return (
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=_BAR),
            _Count(self._what, speed=True),
            Remaining(),
            TextColumn("left,"),
            Elapsed(),
            TextColumn("so far"),
        )


class StudyMeter:
    """Progress of a study on stderr, its listener; an episode counts once per method."""

    def __init__(self, name: str, quiet: bool = False) -> None:
        """Nothing is shown before `begin`; arguments as of `Meter`."""
        self._meter = Meter(name, "episodes", quiet)

    def __enter__(self) -> "StudyMeter":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        # A study that stopped early is finished nevertheless.
        self._meter.end(whole=kind is None)

    def begin(self, done: int, total: int) -> None:
        """Show the bar, and how much is there already."""
        self._meter.begin(done, total)
        if done:
            self._meter.say(f"continuing: {done:,} of {total:,} episodes on disk")

    def advance(self, episodes: int) -> None:
        """Move the bar."""
        self._meter.advance(episodes)

    def stopping(self) -> None:
        """Say that Ctrl-C was understood."""
        self._meter.say("stopping: finishing the shards under way; Ctrl-C again stops at once ...")


class _Count(ProgressColumn):
    """How many are done, and per second."""

    def __init__(self, what: str, speed: bool) -> None:
        super().__init__()
        self._what, self._speed = what, speed

    def render(self, task: Task) -> Text:
        """Return "4,000/60,000 episodes  2,345/s"."""
        total = f"{task.total:,.0f}" if task.total is not None else "?"
        speed = f"  {task.speed:,.0f}/s" if task.speed and self._speed else ""
        return Text(f"{task.completed:,.0f}/{total} {self._what}{speed}", no_wrap=True)
