"""Time this checkout against another: `python -m benchmarks.against FOLDER [--rounds N]`.

For changes that must not cost speed. A process of each checkout answers the same calls of the
public interface, in turns; so does the second start of a small study.
"""

import argparse
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from benchmarks import record
from benchmarks.__main__ import ORDER
from benchmarks.markdown import table
from benchmarks.processes import environment
from benchmarks.timing import seconds_of

HERE = Path(__file__).resolve().parents[1]
WORK = Path(__file__).with_name("against_work.py")
ROUNDS = 7
LEAST = 0.98
START = "usvjax study, second start"
_MAIN = "import sys; from usvjax.cli import main; sys.exit(main(sys.argv[1:]))"
_STUDY = 'name = "small"\nkind = "dwa"\nepisodes = 64\nshard = 32\n[params]\nradius = 0.5\n'


class Checkout:
    """A process that imports usvjax from a folder."""

    def __init__(self, folder: Path, cache: Path) -> None:
        paths = f"{folder}:{folder / 'kernels'}"
        self.variables = environment({"PYTHONPATH": paths, "XDG_CACHE_HOME": str(cache)})
        self._process = subprocess.Popen(
            [sys.executable, str(WORK)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=self.variables,
        )
        assert self._process.stdout is not None
        self.names = self._process.stdout.readline().rstrip("\n").split("\t")

    def seconds(self, name: str) -> float:
        """Time one call there."""
        if name == START:
            return seconds_of(self._start)
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(name, file=self._process.stdin, flush=True)
        return float(self._process.stdout.readline())

    def _start(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            file = Path(name) / "small.toml"
            file.write_text(_STUDY, encoding="utf-8")
            command = ["study", str(file), "--out", name, "--quiet", "--no-figures", "--json"]
            subprocess.run(
                [sys.executable, "-c", _MAIN, *command],
                check=True,
                cwd=name,  # from which Python would import first
                env=self.variables,
                stdout=subprocess.DEVNULL,
            )


def measure(other: Path, rounds: int) -> dict[str, Any]:
    """Time both in turns; seconds by workload, the other's and ours."""
    found: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as name:
        sides = [Checkout(other, Path(name) / "other"), Checkout(HERE, Path(name) / "ours")]
        for work in [START, *sides[1].names]:
            for side in sides:
                side.seconds(work)  # compiles
            pairs = [[side.seconds(work) for side in sides] for _ in range(rounds)]
            found[work] = {"before": [p[0] for p in pairs], "now": [p[1] for p in pairs]}
            print(work, f"{_ratio(found[work]):.3f}", file=sys.stderr, flush=True)
    return found


def _ratio(seconds: dict[str, list[float]]) -> float:
    return statistics.median(seconds["before"]) / statistics.median(seconds["now"])


def report(found: dict[str, Any]) -> str:
    """The table: above 1 is faster than the other."""
    rows = []
    for name, seconds in found.items():
        each = sorted(b / n for b, n in zip(seconds["before"], seconds["now"], strict=True))
        rows.append(
            [
                name,
                f"{1e3 * statistics.median(seconds['before']):,.1f}",
                f"{1e3 * statistics.median(seconds['now']):,.1f}",
                f"{_ratio(seconds):.3f}",
                f"{statistics.median(each):.3f} [{each[1]:.3f}, {each[-2]:.3f}]",
                "yes" if max(_ratio(seconds), each[-2]) >= LEAST else "NO",
            ]
        )
    header = ["", "before, ms", "now, ms", "before / now", "of pairs", f"{LEAST} within"]
    words = (
        "Medians of calls in turns, of two processes. Of pairs: the median of their ratios, and in "
        "brackets the second least and the second largest."
    )
    return f"{table(header, rows)}\n\n{words}"


def main() -> int:
    """Compare, print, and record."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.against", description=__doc__)
    parser.add_argument("other", type=Path, metavar="FOLDER", help="another checkout")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="calls of each, in turns")
    given = parser.parse_args()
    found = measure(given.other.resolve(), given.rounds)
    section = f"## against: This checkout against the one before the change\n\n{report(found)}\n"
    print(section)
    result = {"name": "against", "section": section, "found": found}
    print(record.write(result, ORDER), file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
