"""Studies whose units share calls against the same studies with a call for each unit."""

import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any
from unittest.mock import patch

from benchmarks.markdown import table, verdict
from benchmarks.timing import in_turns, spread
from usvjax.study import calls, load_spec, parse_spec, run_study
from usvjax.study.spec import StudySpec

TITLE = "units that share calls against a call for each"
STUDIES = Path(__file__).resolve().parents[1] / "studies"
ROUNDS = 3
LEAST = 0.98
SWEEP = "500 combinations of 64 episodes"
SECOND = "second start of a finished study"
AIM = 2.0
"""Times as fast as with a call for each unit, of many small conditions."""


def measure(quick: bool) -> dict[str, Any]:
    """Run each study both ways in turns, with all that a study does but its figures."""
    found: dict[str, Any] = {}
    for name, spec in _studies(quick).items():
        ways = {"shared": partial(_run, spec), "alone": partial(_alone, partial(_run, spec))}
        found[name] = {"rows": spec.layout.all_rows, **_timed(ways)}
    with tempfile.TemporaryDirectory() as folder:
        spec = _sweep(4 if quick else 50, 8)
        run_study(spec, folder)
        again = partial(run_study, spec, folder)
        found[SECOND] = {
            "rows": spec.layout.all_rows,
            **_timed({"shared": again, "alone": partial(_alone, again)}),
        }
    return found


def _timed(ways: dict[str, Callable[[], Any]]) -> dict[str, list[float]]:
    return {way: times["seconds"] for way, times in in_turns(ways, ROUNDS).items()}


def _studies(quick: bool) -> dict[str, StudySpec]:
    tan = load_spec(STUDIES / "tan2022.toml")
    one = {"name": "one", "episodes": 20_000, "params": {"radius": 0.5, "clearance_cap": 1.0}}
    if quick:
        tan, one = replace(tan, episodes=16, shard=8), one | {"episodes": 32, "shard": 8}
    return {
        "studies/tan2022.toml, six conditions": tan,
        SWEEP: _sweep(4 if quick else 500, 8 if quick else 64),
        "one condition of 20,000 episodes": parse_spec(one),
    }


def _sweep(conditions: int, episodes: int) -> StudySpec:
    radii = [0.2 + 0.001 * i for i in range(conditions // 2)]
    axes = {"params.radius": radii, "params.clearance_cap": [0.5, 1.0]}
    return parse_spec({"name": "sweep", "episodes": episodes, "axes": axes})


def _run(spec: StudySpec) -> float:
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        run_study(spec, folder)
        return time.perf_counter() - began


def _alone(call: Callable[[], Any]) -> None:
    with patch.object(calls, "joining", lambda mission: None):
        call()


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    rows, least = [], []
    for name, ways in found.items():
        gain = sorted(a / s for a, s in zip(ways["alone"], ways["shared"], strict=True))
        least.append(gain[len(gain) // 2])
        seconds = [sorted(ways[way])[len(gain) // 2] for way in ("alone", "shared")]
        spreads = "; ".join(spread(ways[way]) for way in ("alone", "shared"))
        cells = (f"{ways['rows']:,}", *(f"{s:.2f}" for s in seconds), f"{least[-1]:.2f}", spreads)
        rows.append((name, *cells))
    header = ("study", "rows", "a call for each, s", "shared, s", "gain", "timings")
    words = (
        "Whole studies, from the spec to the summary, compile time apart, in turns; medians, and "
        "of the gain the median of pairs. A shard is a file, and is written and synced in both."
    )
    sweep = least[list(found).index(SWEEP)]
    return "\n\n".join(
        [
            words,
            table(header, rows),
            "\n".join(
                [
                    verdict(f"{SWEEP}: {sweep:.2f}x, at least {AIM:g}x", sweep >= AIM),
                    verdict(
                        f"no study slower: least gain {min(least):.2f}x, at least {LEAST}x",
                        min(least) >= LEAST,
                    ),
                ]
            ),
        ]
    )
