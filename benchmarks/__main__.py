"""Run the benchmarks: `python -m benchmarks [NAME ...] [--quick] [--out FOLDER]`."""

import argparse
import sys
import time
from pathlib import Path

from benchmarks import record
from benchmarks.processes import FreshProcess, ProcessFailedError
from usvjax.cli.console import use_any_encoding

NAMES = (
    "dwa_peers",
    "dwa_oracle",
    "dwa_cores",
    "dwa_scaling",
    "dwa_memory",
    "lane_occupancy",
    "lane_invariance",
    "compile_time",
    "study_resume",
    "study_calls",
    "search_oracle",
    "search_peers",
    "search_growth",
    "pqueue_designs",
    "dstar_oracle",
    "dstar_replanning",
    "turning_corners",
    "swarm_peers",
    "tour_optima",
    "tour_peers",
    "planner_paths",
    "cruise_rate",
    "fleets",
    "lake_guided",
    "orca",
)

ORDER = (*NAMES, "against")
"""Of the page; the last is run on its own, since it wants another checkout."""


def main() -> int:
    """Run what was asked for, each in a fresh process, and write down what came out."""
    use_any_encoding()
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of: {', '.join(NAMES)}")
    parser.add_argument("--quick", action="store_true", help="tiny sizes; only prints the result")
    parser.add_argument("--out", type=Path, help="folder of RESULTS.md, by default benchmarks/")
    given = parser.parse_args()
    unknown = [name for name in given.names if name not in NAMES]
    if unknown:
        parser.error(f"no benchmark {unknown[0]!r}; there are: {', '.join(NAMES)}")
    failed = 0
    for name in given.names or NAMES:
        failed += not _run(name, given.quick, given.out)
    return failed


def _run(name: str, quick: bool, out: Path | None) -> bool:
    print(f"{time.strftime('%H:%M:%S')} {name} ...", file=sys.stderr, flush=True)
    try:
        with FreshProcess() as process:
            result = process.call(record.run, name, quick)
    except ProcessFailedError as error:
        print(f"{name} failed: {error}", file=sys.stderr)
        return False
    print(result["section"], flush=True)
    if out or not quick:
        print(record.write(result, ORDER, out or record.HERE), file=sys.stderr)
    return True


if __name__ == "__main__":
    sys.exit(main())
