"""A study from its spec to its summary."""

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from usvjax.checks import file_path, shown
from usvjax.errors import BadTypeError
from usvjax.public import public
from usvjax.study.code import code_digest
from usvjax.study.finished import FINISHED, SUMMARY, as_recorded, maker, record
from usvjax.study.folder import json_bytes
from usvjax.study.manifest import MANIFEST, check_same, manifest_of, read_manifest
from usvjax.study.report import markdown
from usvjax.study.runner import Listener, Progress, pick_devices, run_episodes
from usvjax.study.shards import Layout, find_shards, is_whole
from usvjax.study.spec import StudySpec, load_spec
from usvjax.study.store import RunDirectory, leftovers
from usvjax.study.summary import summarise

_IN_WORDS = "summary.md"


@dataclass(frozen=True)
class StudyResult:
    """A finished study.

    Attributes:
        path: its run directory.
        summary: what summary.json holds; see `usvjax.study.summary.summarise`.
        written: whether the run directory holds this very summary; not where it may only be
            read, and held an older one or none.
    """

    path: Path
    summary: dict[str, Any]
    written: bool = True


@public(jit=True)
def run_study(
    study: StudySpec | str | Path,
    out: str | Path = "runs",
    *,
    devices: int | None = None,
    listener: Listener | None = None,
) -> StudyResult:
    """Run a study, or continue one, and summarise it.

    A finished run is read and not written, where its shards and its summary are whole and of
    this very code; then nothing is computed.

    Args:
        study: a spec, or a study file.
        out: folder of run directories; the study's own is named after it.
        devices: how many of the local JAX devices to use; all when None. Results do not
            depend on it.
        listener: told about progress.

    Returns:
        The run directory, with its Parquet shards, summary.json and summary.md, and the summary.

    Raises:
        BadInputError: the study or the run directory cannot be used; nothing was overwritten.
        BadTypeError: a value of the study, or an argument, has the wrong type.
        StudyStoppedError: on Ctrl-C; call again to continue.
    """
    folder = file_path("out", out)
    _check_listener(listener)
    workers = pick_devices(devices)
    spec = study if isinstance(study, StudySpec) else load_spec(study)
    path = folder / spec.name
    plugin = spec.plugin.path if spec.plugin else None
    by = maker(plugin)
    manifest = manifest_of(spec.canonical(), code_digest(spec.mission, plugin), spec.held.entry())
    finished = _shown(path, spec, manifest, by, listener)
    if finished is not None:
        return finished
    with RunDirectory.open(path, manifest, spec.held) as run:
        progress = run_episodes(spec, run, devices=workers, listener=listener)
        return _summarised(spec, run, progress, by)


def _check_listener(listener: object) -> None:
    wanted = [name for name in vars(Listener) if not name.startswith("_")]
    missing = [name for name in wanted if not callable(getattr(listener, name, None))]
    if listener is not None and missing:
        raise BadTypeError(
            f"listener: got {shown(listener)}, which has no method {missing[0]!r}; wanted one with "
            f"{', '.join(wanted)}"
        )


def _shown(
    path: Path, spec: StudySpec, manifest: Mapping[str, Any], by: str, listener: Listener | None
) -> StudyResult | None:
    """A finished run as it is; None where anything is to be computed or written."""
    if not os.path.lexists(path / MANIFEST):
        return None
    found = read_manifest(path)
    check_same(path, found, manifest)
    layout = Layout.of(found["study"])
    shards = find_shards(path, layout)
    made = as_recorded(path, FINISHED, by, shards.values())
    if made is None or leftovers(path) or not spec.held.is_whole(path, found["files"]):
        return None
    if not all(map(is_whole, shards.values())):
        return None
    if listener is not None:
        listener.begin(sum(map(layout.rows, shards)), layout.all_rows)
    return StudyResult(path, json.loads(made[SUMMARY]))


def _summarised(spec: StudySpec, run: RunDirectory, progress: Progress, by: str) -> StudyResult:
    """Summarise a run, and write it down where it can be."""
    summary = summarise(spec, run, progress)
    made = {SUMMARY: json_bytes(summary), _IN_WORDS: markdown(summary).encode()}
    if run.writable:
        for name, content in made.items():
            run.write(name, content)
        run.write_json(FINISHED, record(by, run.shards.values(), made))
    return StudyResult(run.path, summary, run.writable)
