"""A study from its spec to its summary."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from usvjax.public import public
from usvjax.study.code import code_digest
from usvjax.study.report import markdown
from usvjax.study.runner import Listener, pick_devices, run_episodes
from usvjax.study.spec import StudySpec, load_spec
from usvjax.study.store import RunDirectory
from usvjax.study.summary import summarise


@dataclass(frozen=True)
class StudyResult:
    """A finished study.

    Attributes:
        path: its run directory.
        summary: what summary.json holds; see `usvjax.study.summary.summarise`.
    """

    path: Path
    summary: dict[str, Any]


@public(jit=True)
def run_study(
    study: StudySpec | str | Path,
    out: str | Path = "runs",
    *,
    devices: int | None = None,
    listener: Listener | None = None,
) -> StudyResult:
    """Run a study, or continue one, and summarise it.

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
        BadTypeError: a value of the study has the wrong type.
        StudyStoppedError: on Ctrl-C; call again to continue.
    """
    spec = study if isinstance(study, StudySpec) else load_spec(study)
    workers = pick_devices(devices)
    path = Path(out) / spec.name
    code = code_digest(spec.mission, spec.plugin.path if spec.plugin else None)
    with RunDirectory.open(path, spec.canonical(), spec.hash, code) as run:
        progress = run_episodes(spec, run, devices=workers, listener=listener)
        summary = summarise(spec, run, progress)
        run.write_json("summary.json", summary)
        run.write_text("summary.md", markdown(summary))
    return StudyResult(path, summary)
