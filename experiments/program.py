"""What the program of every paper does before its experiments and after them."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, Protocol, TypeVar

import tyro

from experiments.files import results_folder, write_json, write_text
from experiments.verdicts import Verdict, console_table
from usvjax.cli import usage_in_one_line
from usvjax.cli.console import complain, show, show_line, use_any_encoding
from usvjax.errors import BadInputError, BadTypeError


class Options(Protocol):
    """Options that every program has; the others are sizes, None for the default."""

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


def begin(
    paper: str,
    kind: type[Given],
    argv: Sequence[str] | None,
    plan_of: Callable[[Given], Plan],
) -> tuple[Given, Plan, Path] | None:
    """Read options, plan, and make the folder for results, before anything is computed.

    Args:
        paper: its name.
        kind: the class of its options.
        argv: options; those of the process when None.
        plan_of: makes a plan of them; may refuse them.

    Returns:
        Options, plan and folder; None, after one line on stderr, for a user's mistake.
    """
    use_any_encoding()
    prog = f"usvjax reproduce {paper}"
    try:
        with usage_in_one_line(prog):
            options = tyro.cli(kind, args=argv, prog=prog)
        plan = plan_of(options)
        return options, plan, results_folder(paper, options.out, _is_a_look(options))
    except (BadInputError, BadTypeError) as error:
        complain(f"{paper}: {error}")
        return None


def _is_a_look(options: Options) -> bool:
    """Whether a run is quick or of a size of one's own, and so not one for the record."""
    sizes = {name: size for name, size in vars(options).items() if name not in ("quick", "out")}
    return options.quick or any(size is not None for size in sizes.values())


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
    show(console_table(*verdicts), done)
    for file in files:
        show_line(f"Written  {file}")
