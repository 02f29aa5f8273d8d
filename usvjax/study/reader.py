"""Reading a run back, for plots and for one's own analysis."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import polars as pl

from usvjax.checks import file_path
from usvjax.errors import BadInputError
from usvjax.public import public
from usvjax.study.finished import FINISHED, SUMMARY, read_record
from usvjax.study.folder import digest, read_plain
from usvjax.study.looks import look_level, look_schedule
from usvjax.study.manifest import read_manifest
from usvjax.study.shards import Layout, find_shards, read_shard


@dataclass(frozen=True)
class Run:
    """A run directory, opened for reading; a run still under way may be read too.

    Attributes:
        path: the directory.
        manifest: the study, its hash, versions, device and seed.
    """

    path: Path
    manifest: dict[str, Any]

    @property
    def name(self) -> str:
        """Name of the study."""
        return str(self.manifest["study"]["name"])

    @property
    def methods(self) -> list[str]:
        """Methods in the order of the study."""
        return list(self.manifest["study"]["methods"])

    @property
    def labels(self) -> dict[int, str]:
        """Label of each condition by its index."""
        return {i: str(c["label"]) for i, c in enumerate(self.manifest["study"]["conditions"])}

    @property
    def settings(self) -> list[dict[str, dict[str, Any]]]:
        """Every setting in force, by section and name, per condition.

        JSON values: an infinite number is the string "inf".
        """
        return [c["settings"] for c in self.manifest["study"]["conditions"]]

    @property
    def varied(self) -> list[dict[str, Any]]:
        """What distinguishes each condition, by dotted key such as "params.radius"."""
        return [c["varied"] for c in self.manifest["study"]["conditions"]]

    @property
    def level(self) -> float:
        """Coverage of every single interval, so that all looks together keep the study's."""
        study = self.manifest["study"]
        looks = look_schedule(study["episodes"], study["shard"], study["until"])
        return look_level(study["confidence"], len(looks))

    def table(self) -> pl.DataFrame:
        """Read all rows.

        Returns:
            One row per condition, job and method: "condition", "job" (int32), "method" (str),
            "status" (int32) and the metrics of its mission.

        Raises:
            BadInputError: nothing has been written yet, or a file is damaged or another's.
        """
        layout = Layout.of(self.manifest["study"])
        shards = find_shards(self.path, layout)
        if not shards:
            raise BadInputError(f"{self.path} holds no episodes yet")
        tables = [read_shard(path, unit, layout) for unit, path in shards.items()]
        try:
            return pl.concat(tables)
        except pl.exceptions.PolarsError as error:
            raise BadInputError(f"the shards of {self.path} have different columns") from error

    def summary(self) -> dict[str, Any]:
        """Read summary.json; see `usvjax.study.summary.summarise`.

        Raises:
            BadInputError: the run is not finished, or the file is damaged or was edited.
        """
        path = self.path / SUMMARY
        try:
            content = read_plain(path)
        except OSError as error:
            raise BadInputError(f"{self.path} has no summary; is the run finished?") from error
        record = read_record(self.path / FINISHED)
        if record is None or record[1].get(SUMMARY) != digest(content):
            raise BadInputError(
                f"{path} is not as it was written; run the study again, which replaces it"
            )
        found: dict[str, Any] = json.loads(content)
        return found


@public()
def load_run(path: str | Path) -> Run:
    """Open a run directory for reading.

    Args:
        path: the directory that `usvjax study` wrote.

    Raises:
        BadInputError: it is not one.
    """
    path = file_path("path", path)
    return Run(path, read_manifest(path))
