"""The files that a study names, held by its run: maps, scenarios, a plug-in and what it imports.

A run that knew only their names could draw and replay nothing on another machine, or once they
have changed. The copies stand in `files/` as the originals stand about the study, whose own
folder there is `_/_/...`, as deep as names with ".." go up from it.
"""

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import usvjax
from usvjax.errors import BadInputError
from usvjax.study.folder import digest, in_one_line, make_folder, read_plain, write_plain

FOLDER = "files"

_MOST_DEPTH = 999
_PACKAGED = Path(usvjax.__file__).parent


@dataclass(frozen=True)
class Source:
    """A file that a study reads.

    Attributes:
        place: where the study expects it.
        path: where it is, the same unless there is a link at its place.
        digest: SHA-256 of what was read.
    """

    place: Path
    path: Path
    digest: str


@dataclass(frozen=True)
class Held:
    """The files that a study reads, by their places relative to its folder.

    Attributes:
        depth: how many folders up they reach.
        moved: names in the study that are not relative to its folder -> ones that are.
        sources: the files, by relative name.
    """

    depth: int
    moved: dict[str, str]
    sources: dict[str, Source]

    @classmethod
    def of(cls, folder: Path, sources: Iterable[Source], words: Iterable[str]) -> "Held":
        """What a run must hold; what is packaged with usvjax it need not.

        Args:
            folder: of the study.
            sources: the files that were read.
            words: strings of the study, among them names of files.
        """
        own = [source for source in sources if not _is_packaged(source.place)]
        named = {_relative(source.place, folder): source for source in own}
        depth = max((name.split("/").count("..") for name in named), default=0)
        moved = {}
        for word in dict.fromkeys(filter(None, words)):  # of all conditions, many alike
            beside, elsewhere = _relative(folder / word, folder), _relative(Path(word), folder)
            if elsewhere in named and (os.path.isabs(word) or beside not in named):
                moved[word] = elsewhere
        return cls(depth, moved, named)

    def entry(self) -> dict[str, Any]:
        """What a manifest says of them."""
        digests = {name: source.digest for name, source in self.sources.items()}
        return {"depth": self.depth, "moved": self.moved, "digests": digests}

    def is_whole(self, run: Path, entry: Mapping[str, Any]) -> bool:
        """Whether a run holds all that `write` would copy."""
        return not list(self._missing(run, entry))

    def write(self, run: Path, entry: Mapping[str, Any]) -> None:
        """Copy into a run what is not there whole.

        Args:
            run: its folder.
            entry: of its manifest. Where a file has changed since, and still means the same, the
                copy stays as it was.

        Raises:
            BadInputError: a file has changed since it was read, or something that is no plain
                file or folder is in the way.
            OSError: a copy cannot be written.
        """
        for source, place in self._missing(run, entry):
            with in_one_line(f"read {source.path}"):
                content = source.path.read_bytes()
            if digest(content) != source.digest:
                raise BadInputError(f"{source.path} has just changed; run the study again")
            for folder in (place.relative_to(run).parent, _base(entry)):
                _make_folders(run, folder)
            write_plain(place, content)

    def _missing(self, run: Path, entry: Mapping[str, Any]) -> Iterator[tuple[Source, Path]]:
        for name, (place, wanted) in _copies(run, entry).items():
            source = self.sources.get(name)
            if source is not None and source.digest == wanted and not _is_whole(place, wanted):
                yield source, place


NOTHING = Held(0, {}, {})


def held_folder(run: Path, entry: Mapping[str, Any]) -> Path:
    """The folder in a run from which the names in its study lead to what it holds.

    Args:
        run: its folder.
        entry: of its manifest.

    Raises:
        BadInputError: a file is missing or damaged.
    """
    for place, wanted in _copies(run, entry).values():
        if not _is_whole(place, wanted):
            raise BadInputError(
                f"{place} is missing or damaged; run the study again, which replaces it"
            )
    base = run / _base(entry)
    with suppress(OSError):
        base.mkdir(parents=True, exist_ok=True)  # git, for one, copies no empty folder
    return base


def are_beside(folder: Path, entry: Mapping[str, Any]) -> bool:
    """Whether a folder has files of all the names that a run holds, in whatever version."""
    names = entry["digests"]
    return bool(names) and all((folder / name).is_file() for name in names)


def with_relative_names(value: Any, moved: Mapping[str, str]) -> Any:
    """Settings, in which names that are not relative to the study's folder become so."""
    if isinstance(value, Mapping):
        return {key: with_relative_names(part, moved) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [with_relative_names(part, moved) for part in value]
    return moved.get(value, value) if isinstance(value, str) else value


def words_of(value: Any) -> Iterator[str]:
    """Every string in some settings."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | list | tuple):
        for part in value.values() if isinstance(value, Mapping) else value:
            yield from words_of(part)


def _copies(run: Path, entry: Mapping[str, Any]) -> dict[str, tuple[Path, str]]:
    """Where the copies are and their digests, by the names of the files."""
    copies = {}
    for name, wanted in entry["digests"].items():
        inside = os.path.normpath(_base(entry) / name)
        if not Path(inside).is_relative_to(FOLDER):
            raise BadInputError(f"the manifest of {run} names a file outside the run: {name!r}")
        copies[name] = run / inside, wanted
    return copies


def _base(entry: Mapping[str, Any]) -> Path:
    """The study's folder among the copies, relative to the run's."""
    if not 0 <= entry["depth"] <= _MOST_DEPTH:
        raise BadInputError(
            f"the depth of the files in a manifest is {entry['depth']}; wanted 0 up"
        )
    return Path(FOLDER, *["_"] * entry["depth"])


def _make_folders(run: Path, folder: Path) -> None:
    for part in (*reversed(folder.parents[:-1]), folder):
        make_folder(run / part)


def _is_whole(place: Path, wanted: str) -> bool:
    try:
        return digest(read_plain(place)) == wanted
    except OSError:
        return False


def _is_packaged(path: Path) -> bool:
    return Path(os.path.abspath(path)).is_relative_to(_PACKAGED)


def _relative(path: Path, folder: Path) -> str:
    return Path(os.path.relpath(path, folder)).as_posix()
