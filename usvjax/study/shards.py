"""Shards: rows of one (condition, shard), all methods, in a Parquet file that is checked.

The name of a shard carries the SHA-256 of its bytes, and says which rows it holds. Both are
checked whenever it is read, so neither a failing disk nor a file under another's name is ever
passed off as results.
"""

import io
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from usvjax.errors import BadInputError
from usvjax.study.folder import check_no_link, digest, in_one_line, read_plain

FOLDER = "shards"

KEY_COLUMNS = {
    "condition": pl.Int32,
    "job": pl.Int32,
    "method": pl.String,
    "status": pl.Int32,
}
"""Columns of every result table, before the metrics of its kind."""

_NAME = re.compile(r"c(\d{4,9})-s(\d{6,9})-([0-9a-f]{16})\.parquet", re.ASCII)


@dataclass(frozen=True, order=True)
class Unit:
    """The unit of work and of resuming: some jobs of one condition, with every method.

    Attributes:
        condition: index of the condition.
        shard: index of the shard.
    """

    condition: int
    shard: int


@dataclass(frozen=True)
class Layout:
    """Which shards a study has, and which rows each must hold.

    Attributes:
        episodes: of a condition, at most.
        shard: episodes of a shard.
        conditions: how many there are.
        methods: in the order of the study.
    """

    episodes: int
    shard: int
    conditions: int
    methods: tuple[str, ...]

    @classmethod
    def of(cls, study: Mapping[str, Any]) -> "Layout":
        """That of a canonical study."""
        methods = tuple(study["methods"])
        return cls(study["episodes"], study["shard"], len(study["conditions"]), methods)

    def jobs(self, unit: Unit) -> np.ndarray:
        """The job numbers of a unit, int64[J]."""
        first = unit.shard * self.shard
        return np.arange(first, min(first + self.shard, self.episodes))

    def rows(self, unit: Unit) -> int:
        """How many rows a unit has."""
        return len(self.jobs(unit)) * len(self.methods)

    @property
    def all_rows(self) -> int:
        """How many rows the study has, at most."""
        return self.episodes * self.conditions * len(self.methods)

    def has(self, unit: Unit) -> bool:
        """Whether there is such a unit."""
        return unit.condition < self.conditions and unit.shard * self.shard < self.episodes

    def fits(self, table: pl.DataFrame, unit: Unit) -> bool:
        """Whether a table holds the rows of a unit."""
        jobs, count = self.jobs(unit), len(self.methods)
        if table.columns[: len(KEY_COLUMNS)] != list(KEY_COLUMNS):
            return False
        expected = pl.DataFrame(
            {
                "condition": np.full(len(jobs) * count, unit.condition),
                "job": np.repeat(jobs, count),
                "method": list(self.methods) * len(jobs),
            },
            schema_overrides={name: KEY_COLUMNS[name] for name in ("condition", "job", "method")},
        )
        return table.select(expected.columns).equals(expected)


def encode_shard(unit: Unit, table: pl.DataFrame) -> tuple[str, bytes]:
    """Name and content of a unit's file."""
    buffer = io.BytesIO()
    table.write_parquet(buffer, compression="zstd", statistics=False)
    content = buffer.getvalue()
    return f"c{unit.condition:04d}-s{unit.shard:06d}-{_mark(content)}.parquet", content


def find_shards(run: Path, layout: Layout) -> dict[Unit, Path]:
    """The shards of a run by their names, in order; whether they are whole, reading them says.

    Args:
        run: the run's folder.
        layout: of its study; shards that it has not are none.

    Raises:
        BadInputError: the folder of shards is a link or cannot be read, or two shards are of
            the same rows.
    """
    folder = run / FOLDER
    check_no_link(folder)
    shards: dict[Unit, Path] = {}
    with in_one_line(f"read the run at {run}"):
        names = sorted(os.listdir(folder)) if folder.exists() else []
    for name in names:
        match = _NAME.fullmatch(name)
        unit = Unit(int(match[1]), int(match[2])) if match else None
        if unit is None or not layout.has(unit):
            continue
        if unit in shards:
            raise BadInputError(
                f"{shards[unit]} and {name} are of the same episodes; delete the one that does "
                f"not belong there"
            )
        shards[unit] = folder / name
    return shards


def is_whole(path: Path) -> bool:
    """Whether a shard's bytes are those that it was written with.

    Raises:
        BadInputError: it is no plain file, or cannot be read.
    """
    return path.name.endswith(f"-{_mark(_content(path))}.parquet")


def read_shard(path: Path, unit: Unit, layout: Layout) -> pl.DataFrame:
    """The rows of a shard.

    Raises:
        BadInputError: it is no plain file, cannot be read, is damaged, or holds other rows than
            its name says.
    """
    content = _content(path)
    damaged = f"{path} is damaged; run the study again, which replaces it"
    if not path.name.endswith(f"-{_mark(content)}.parquet"):
        raise BadInputError(damaged)
    try:
        table = pl.read_parquet(io.BytesIO(content))
        right = layout.fits(table, unit)
    except (pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError) as error:
        raise BadInputError(damaged) from error
    if not right:
        raise BadInputError(
            f"{path} does not hold the rows of condition {unit.condition}, shard {unit.shard}; "
            f"delete it and run the study again"
        )
    return table


def _content(path: Path) -> bytes:
    with in_one_line(f"read {path}"):
        return read_plain(path)


def _mark(content: bytes) -> str:
    return digest(content)[:16]
