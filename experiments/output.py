"""Where results go, and how they are written."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from usvjax.errors import BadInputError
from usvjax.plots.style import write_atomically
from usvjax.statistics import Estimate

RESULTS = Path(__file__).parent / "results"
RUNS = Path("runs")


def results_folder(paper: str, out: Path | None, record: bool, look: bool) -> Path:
    """Make the folder for results, before anything is computed.

    Args:
        paper: its name.
        out: the folder that was asked for, if any.
        record: whether the results that the repository keeps are to be written anew.
        look: whether this is but a quick look, or of another size than these.

    Returns:
        `out`, else experiments/results/PAPER in the checkout for the record, else runs/PAPER, or
        runs/PAPER_quick of a look.

    Raises:
        BadInputError: it cannot be written, or holds something else; or a look is to be recorded.
    """
    if record and (look or out is not None):
        raise BadInputError(
            "--record writes the results that the repository keeps, at their full size; leave out "
            "--quick, --out and sizes"
        )
    folder = RESULTS / paper if record else out or RUNS / (f"{paper}_quick" if look else paper)
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


def write_text(file: Path, text: str) -> Path:
    """Write a text file, whole or not at all."""
    return write_atomically(file, lambda path: path.write_text(text, encoding="utf-8"))


def write_json(file: Path, found: Any) -> Path:
    """Write numbers to six significant digits."""
    return write_text(file, json.dumps(rounded(found), indent=1) + "\n")


def rounded(value: Any) -> Any:
    """Keep six significant digits, and None for what is not a number."""
    if isinstance(value, Estimate):
        return rounded(asdict(value))
    if isinstance(value, np.generic):
        return rounded(value.item())
    if isinstance(value, float):
        return float(f"{value:.6g}") if abs(value) < float("inf") else None
    if isinstance(value, dict):
        return {str(key): rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(item) for item in value]
    return value
