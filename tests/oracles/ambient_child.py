"""Prints what public calls and small studies come to, for a process with settings of its own.

Run as `python ambient_child.py few|calls|studies FOLDER`.
"""

import dataclasses
import sys
import tomllib
from pathlib import Path

from public_calls import calls, digest

from usvjax.study import parse_spec
from usvjax.study.store import Unit
from usvjax.study.units import run_unit

FEW = (
    "astar_swept",
    "random_maps",
    "smooth_turns",
    "solve_tour",
    "minimise",
    "navigate_dwa",
    "dwa_candidates",
    "cruise",
    "shorten",
    "path_metrics",
)
STUDIES = Path(__file__).parents[2] / "studies"
EPISODES = 6


def main(which: str, folder: Path) -> None:
    if which == "studies":
        for file in sorted(STUDIES.glob("*.toml")):
            print(file.stem, study(file), flush=True)
        return
    made = calls(folder)
    for name in FEW if which == "few" else sorted(set(made) - {"save_map"}):
        print(name, digest(made[name]()), flush=True)


def study(file: Path) -> str:
    """Of the rows of the first and the last condition."""
    tables = tomllib.loads(file.read_text(encoding="utf-8"))
    tables |= {"episodes": EPISODES, "shard": EPISODES}
    tables.pop("until", None)
    spec = parse_spec(tables, folder=STUDIES)
    ends = (spec.conditions[0], spec.conditions[-1])
    spec = dataclasses.replace(spec, conditions=ends)
    rows = [run_unit(spec, Unit(condition, 0)) for condition in range(len(ends))]
    return digest([column.to_numpy() for table in rows for column in table.get_columns()])


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
