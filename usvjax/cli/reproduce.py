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

    root = _checkout(paper)
    use_compilation_cache()
    with _as_program(root, paper, options):
        runpy.run_module(f"experiments.{paper}", run_name="__main__", alter_sys=True)


def _checkout(paper: str) -> Path:
    """Find the source checkout: where the command runs, or where usvjax was imported from.

    A folder of one's own called `experiments` does not hide the papers of the other place.

    Raises:
        BadInputError: neither has experiments for the paper.
    """
    from usvjax.suggest import did_you_mean

    candidates = (Path.cwd(), Path(usvjax.__file__).resolve().parent.parent)
    papers = {root: _papers(root) for root in candidates if _papers(root)}
    for root, known in papers.items():
        if paper in known:
            return root
    if not papers:
        raise BadInputError(
            f"no folder 'experiments' in {candidates[0]}: 'usvjax reproduce' needs a source "
            f"checkout of usvjax; run it from there"
        )
    folders = " or ".join(str(root / "experiments") for root in papers)
    valid = {name for known in papers.values() for name in known}
    raise BadInputError(f"no experiments for {paper!r} in {folders}; {did_you_mean(paper, valid)}")


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
