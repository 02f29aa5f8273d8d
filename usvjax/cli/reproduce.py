"""`usvjax reproduce`: run the experiments of a paper from a source checkout."""

import runpy
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import tyro

import usvjax
from usvjax.errors import BadInputError

Paper = Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="PAPER")]
Options = Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="OPTION")]


def reproduce(paper: Paper, *options: Options) -> None:
    """Regenerate the tables and figures of a paper, beside the published values.

    The experiments are part of the source checkout, not of the installed package. Options after
    PAPER go to the experiment; `usvjax reproduce PAPER --help` lists them.

    Example: usvjax reproduce tan2022

    Args:
        paper: The paper, such as tan2022.
        options: Passed on to the experiment.
    """
    from usvjax.devices import use_compilation_cache
    from usvjax.suggest import did_you_mean

    root = _checkout()
    papers = _papers(root)
    if paper not in papers:
        raise BadInputError(
            f"no experiments for {paper!r} in {root / 'experiments'}; {did_you_mean(paper, papers)}"
        )
    use_compilation_cache()
    with _as_program(root, paper, options):
        runpy.run_module(f"experiments.{paper}", run_name="__main__", alter_sys=True)


def _checkout() -> Path:
    """Find the source checkout: where the command runs, or where usvjax was imported from.

    Raises:
        BadInputError: neither has an `experiments` folder.
    """
    candidates = (Path.cwd(), Path(usvjax.__file__).resolve().parent.parent)
    for root in candidates:
        if _papers(root):
            return root
    raise BadInputError(
        f"no folder 'experiments' in {candidates[0]}: 'usvjax reproduce' needs a source checkout "
        f"of usvjax; run it from there"
    )


def _papers(root: Path) -> list[str]:
    """List the papers that a checkout has experiments for, a package each."""
    programs = (root / "experiments").glob("*/__main__.py")
    return sorted(path.parent.name for path in programs)


@contextmanager
def _as_program(root: Path, paper: str, options: tuple[str, ...]) -> Iterator[None]:
    """Give a module the command line and import path that it would have on its own."""
    argv, path = sys.argv, list(sys.path)
    sys.argv = [f"usvjax reproduce {paper}", *options]
    sys.path.insert(0, str(root))
    try:
        yield
    finally:
        sys.argv, sys.path[:] = argv, path
