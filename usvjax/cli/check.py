"""`usvjax check`: what a study would run, how long and how large, without running it."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro
from rich.console import Console

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
    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield
        return
    with console.status("trying a few episodes ..."):
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
        "episodes_each": spec.episodes,
        "episodes": spec.episodes * methods * conditions,
        "until": spec.until,
        "shards": shards,
        "devices": devices,
    }


def _print(spec: "StudySpec", facts: dict[str, Any]) -> None:
    console = Console(highlight=False, markup=False, soft_wrap=True)
    labels = facts["conditions"]
    most = "at most " if spec.until is not None else ""
    console.print(f"Study      {spec.name}, kind {spec.kind}, seed {spec.seed}")
    console.print(f"Methods    {', '.join(spec.methods)}; against {spec.baseline}")
    for index, label in enumerate(labels[:_SHOWN]):
        console.print(f"{'Conditions' if index == 0 else ' ' * 10} {label}")
    if len(labels) > _SHOWN:
        console.print(f"{' ' * 10} ... and {len(labels) - _SHOWN:,} more")
    console.print(
        f"Episodes   {most}{facts['episodes']:,}: {spec.episodes:,} x "
        f"{_counted(len(spec.methods), 'method')} x {_counted(len(labels), 'condition')}, in "
        f"{_counted(facts['shards'], 'shard')}"
    )
    if spec.until is not None:
        console.print(f"Until      intervals of success rates are at most {spec.until:g} wide")


def _print_forecast(facts: dict[str, Any], found: "Forecast", until: bool) -> None:
    from usvjax.checks import byte_size

    console = Console(highlight=False, markup=False, soft_wrap=True)
    most = "at most " if until else ""
    wall = facts["estimate"]["wall_seconds"]
    console.print(
        f"Time       {most}about {_duration(wall)} on {_counted(facts['devices'], 'device')}, and "
        f"compilation ({_duration(found.first_seconds)} here); by "
        f"{_counted(found.tried, 'episode')} of {_counted(found.conditions, 'condition')}"
    )
    console.print(f"Size       {most}about {byte_size(found.bytes)} on disk")


def _counted(count: int, what: str) -> str:
    return f"{count:,} {what}" if count == 1 else f"{count:,} {what}s"


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s" if seconds >= 1 else f"{seconds:.1f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
