"""Where results go and how they are written, and progress on the way there."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from usvjax.cli.console import Meter
from usvjax.errors import BadInputError
from usvjax.plots.style import write_atomically

RESULTS = Path(__file__).parent / "results"
QUICK_RESULTS = Path("runs")


def results_folder(paper: str, out: Path | None, quick: bool) -> Path:
    """Make the folder for results, before anything is computed.

    Args:
        paper: its name.
        out: the folder that was asked for, if any.
        quick: whether this is but a quick look, or of another size than the recorded results,
            which it leaves alone.

    Returns:
        `out`, else runs/PAPER_quick, else experiments/results/PAPER in the checkout.

    Raises:
        BadInputError: it cannot be written, or holds something else.
    """
    folder = out or (QUICK_RESULTS / f"{paper}_quick" if quick else RESULTS / paper)
    if not _may_be_replaced(folder, paper):
        raise BadInputError(
            f"{folder} holds files that 'usvjax reproduce {paper}' did not write; wanted a new or "
            f"empty folder, or earlier results of {paper}; name one with --out"
        )
    probe = folder / ".writable"
    write_atomically(probe, lambda path: path.write_text("", encoding="utf-8"))
    probe.unlink()
    return folder


def _may_be_replaced(folder: Path, paper: str) -> bool:
    """Whether a folder is new, empty, or holds results of the paper, whose page says so.

    Raises:
        BadInputError: it cannot be read.
    """
    page = folder / "README.md"
    try:
        if not folder.is_dir() or not any(folder.iterdir()):
            return True
        if not page.is_file():
            return False
        text = page.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise BadInputError(f"cannot read {folder}: {error.strerror}") from error
    return f"Written by `usvjax reproduce {paper}`" in text


@contextmanager
def progress(what: str, total: int) -> Iterator[Callable[[int], None]]:
    """Show a bar on stderr; yields what to call with how many were done since the last time."""
    meter = Meter(what, "done")
    meter.begin(0, total)
    try:
        yield meter.advance
    finally:
        meter.end(whole=False)


def write_text(file: Path, text: str) -> Path:
    """Write a text file, whole or not at all."""
    return write_atomically(file, lambda path: path.write_text(text, encoding="utf-8"))


def write_json(file: Path, found: Any) -> Path:
    """Write numbers to six significant digits."""
    return write_text(file, json.dumps(rounded(found), indent=1) + "\n")


def rounded(value: Any) -> Any:
    """Keep six significant digits, and None for what is not a number."""
    if isinstance(value, float):
        return float(f"{value:.6g}") if abs(value) < float("inf") else None
    if isinstance(value, dict):
        return {str(key): rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(item) for item in value]
    return value
