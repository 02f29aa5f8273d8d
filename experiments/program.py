"""What the program of every paper does before its experiments and after them."""

import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, Protocol, TypeVar

from rich.console import Console

from experiments.files import results_folder, write_json, write_text
from experiments.verdicts import Verdict, console_table
from usvjax.errors import BadInputError, BadTypeError


class Options(Protocol):
    """Options that every program has."""

    @property
    def quick(self) -> bool:
        """Whether this is but a quick look."""
        ...

    @property
    def out(self) -> Path | None:
        """The folder that was asked for, if any."""
        ...


Given = TypeVar("Given", bound=Options)
Plan = TypeVar("Plan")


def begin(paper: str, options: Given, plan_of: Callable[[Given], Plan]) -> tuple[Plan, Path] | None:
    """Turn options into a plan and make the folder for results, before anything is computed.

    Args:
        paper: its name.
        options: of the command line.
        plan_of: makes a plan of them; may refuse them.

    Returns:
        The plan and the folder; None, after one line on stderr, for a user's mistake.
    """
    try:
        return plan_of(options), results_folder(paper, options.out, options.quick)
    except (BadInputError, BadTypeError) as error:
        print(f"{paper}: {error}", file=sys.stderr)
        return None


def conclude(
    folder: Path,
    found: dict[str, Any],
    page: str,
    figures: Callable[[Path], Iterable[Path]],
    verdicts: tuple[str, Sequence[Verdict]],
    done: str,
) -> None:
    """Write what was found, then say what reproduces and where everything is.

    Args:
        folder: for README.md, results.json and figures/.
        found: for results.json.
        page: the README.
        figures: draws into a folder and returns the files.
        verdicts: who wrote the paper, and what became of its claims.
        done: how much was run, and how long it took.
    """
    files = [
        write_text(folder / "README.md", page),
        write_json(folder / "results.json", found),
        *figures(folder / "figures"),
    ]
    console = Console(highlight=False)
    console.print(console_table(*verdicts))
    console.print(done)
    for file in files:
        console.print(f"Written  {file}", soft_wrap=True, markup=False)
