"""`usvjax check`: what a study would run, how long and how large, without running it."""

import json
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from usvjax.cli.console import console, show
from usvjax.report.numbers import duration
from usvjax.report.sheets import Sheet

if TYPE_CHECKING:
    from usvjax.study.forecast import Forecast
    from usvjax.study.spec import StudySpec

StudyPath = Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE.toml")]
AsJson = Annotated[bool, tyro.conf.FlagCreatePairsOff, tyro.conf.arg(name="json")]
Flag = Annotated[bool, tyro.conf.FlagCreatePairsOff]

_SHOWN = 12  # conditions


def check(file: StudyPath, no_trial: Flag = False, as_json: AsJson = False) -> None:
    """Say what a study would run, how many episodes, how long and how large.

    All of the file is checked. A few episodes are tried in memory to say how long the whole would
    take; nothing is written.

    Example: usvjax check studies/tan2022.toml

    Args:
        file: The study.
        no_trial: Try no episodes; then how long and how large is not said.
        as_json: Print as JSON, for scripts.
    """
    from usvjax.devices import use_compilation_cache
    from usvjax.study.forecast import forecast
    from usvjax.study.spec import load_spec

    use_compilation_cache()
    spec = load_spec(file)
    facts = _facts(spec)
    if not as_json:
        _print(spec, facts)
    if not no_trial:
        with _waiting(as_json):
            found = forecast(spec)
        facts["estimate"] = asdict(found)
        shared = min(facts["devices"], facts["shards"])
        facts["estimate"]["wall_seconds"] = found.seconds / shared
        if not as_json:
            _print_forecast(facts, found, spec.until is not None)
    if as_json:
        print(json.dumps(facts))


@contextmanager
def _waiting(quiet: bool) -> Iterator[None]:
    """Say on stderr that a few episodes are being tried."""
    out = console(stderr=True)
    if quiet or not out.is_terminal:
        yield
        return
    with out.status("trying a few episodes ...", spinner="line"):
        yield


def _facts(spec: "StudySpec") -> dict[str, Any]:
    from usvjax.devices import local_devices

    methods, conditions = len(spec.methods), len(spec.conditions)
    devices = len(local_devices())
    shards = -(-spec.episodes // spec.shard) * conditions
    return {
        "name": spec.name,
        "kind": spec.kind,
        "seed": spec.seed,
        "methods": list(spec.methods),
        "baseline": spec.baseline,
        "conditions": [condition.label for condition in spec.conditions],
        "values": _values(spec),
        "episodes_each": spec.episodes,
        "episodes": spec.episodes * methods * conditions,
        "until": spec.until,
        "shards": shards,
        "devices": devices,
    }


def _values(spec: "StudySpec") -> dict[str, int]:
    """How many values each key has that differs between conditions."""
    found: dict[str, set[str]] = {}
    for condition in spec.conditions:
        for key, value in condition.varied.items():
            found.setdefault(key, set()).add(repr(value))
    return {key: len(values) for key, values in found.items() if len(values) > 1}


def _combinations(count: int, values: dict[str, int]) -> str:
    """How many conditions there are, and of what they are the combinations, if of all."""
    if not values or math.prod(values.values()) != count:
        return f"{count:,}"
    factors = " x ".join(f"{number:,} values of {key}" for key, number in values.items())
    return f"{count:,}: {'all combinations of ' if len(values) > 1 else ''}{factors}"


def _print(spec: "StudySpec", facts: dict[str, Any]) -> None:
    labels = facts["conditions"]
    count = len(labels)
    most = "at most " if spec.until is not None else ""
    rows = [
        ("Study", f"{spec.name}, kind {spec.kind}, seed {spec.seed}"),
        ("Methods", f"{', '.join(spec.methods)}; against {spec.baseline}"),
        ("Conditions", _combinations(count, facts["values"])),
        *(("", label) for label in labels[:_SHOWN]),
        *([("", f"... and {count - _SHOWN:,} more")] if count > _SHOWN else []),
        (
            "Episodes",
            f"{most}{facts['episodes']:,}: {spec.episodes:,} x "
            f"{_counted(len(spec.methods), 'method')} x {_counted(count, 'condition')}, in "
            f"{_counted(facts['shards'], 'shard')}",
        ),
    ]
    if spec.until is not None:
        rows.append(("Until", f"intervals of success rates are at most {spec.until:g} wide"))
    _show(rows)


def _print_forecast(facts: dict[str, Any], found: "Forecast", until: bool) -> None:
    from usvjax.checks import byte_size

    most = "at most " if until else ""
    wall = facts["estimate"]["wall_seconds"]
    _show(
        [
            (
                "Time",
                f"{most}about {duration(wall)} on {_counted(facts['devices'], 'device')}, and "
                f"compilation ({duration(found.first_seconds)} here); by "
                f"{_counted(found.tried, 'episode')} of {_counted(found.conditions, 'condition')}",
            ),
            ("Size", f"{most}about {byte_size(found.bytes)} on disk"),
        ]
    )


def _show(rows: list[tuple[str, str]]) -> None:
    """Print what things are called, all to one width, and what they are."""
    show(Sheet("", (), [(f"{name:10}", words) for name, words in rows], words=2))


def _counted(count: int, what: str) -> str:
    return f"{count:,} {what}" if count == 1 else f"{count:,} {what}s"
