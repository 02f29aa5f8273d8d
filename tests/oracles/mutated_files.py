"""Hands mutated files to every loader of files, and reports what came of it.

Run as a program, so that its memory is that of the loaders: `mutated_files.py COUNT FOLDER` prints
a JSON object from loader to its report. Files are mutated by a seeded generator; COUNT of a kind,
and of every shipped study a fifth of that, which is loaded a hundred times as slowly.
"""

import json
import sys
import time
import warnings
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image

from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import GridMap, load_map, save_map
from usvjax.maps.scen import read_scen
from usvjax.study import load_spec
from usvjax.study.plugin import read_plugin

ROOT = Path(__file__).parents[2]
STUDIES = sorted(path.stem for path in (ROOT / "studies").glob("*.toml"))
FILES = ("map", "sidecar", "scen", "yaml", "yaml_image", "png", "rgba", "palette", "pgm", "plugin")
LOADERS = (*FILES, *STUDIES)
"""What is mutated: a file of this kind, or a shipped study of this name."""

LONGEST = 500  # characters of a message
TOKENS = [
    *(b"\0", b"\xef\xbb\xbf", b"\xff\xfe", b"\x1b[31m", b"\xed\xa0\x80", b"\\ud800", b"\\u001b"),
    *(b"-1", b"0", b"nan", b"inf", b"-inf", b"1e400", b"1e-400", b"9" * 20, b"9" * 5000, b"0x10"),
    *(b"[" * 300, b"{" * 300, b"((((", b"]", b"'", b'"', b'"""', b"#", b"=", b":", b"[]", b"{}"),
    *(b"&a [*a]", b"*a", b"&x ", b"<<: *a\n", b"!!python/", b"\n- ", b"1:30", b"2024-13-45"),
    *(b"\n\n", b"\t", b"\r", b"true", b"null", b"../", b"/dev/zero", b"x" * 3000, b"1_000"),
    "\u202e洪".encode(),
]


def mutated(content: bytes, rng: np.random.Generator) -> bytes:
    """One to three changes of a file: of bits, pieces, lines or words."""
    for _ in range(int(rng.integers(1, 4))):
        content = _CHANGES[rng.integers(len(_CHANGES))](content, rng)
    return content


def _flip(content: bytes, rng: np.random.Generator) -> bytes:
    data = bytearray(content or b"\0")
    for place in rng.integers(0, len(data), int(rng.integers(1, 9))):
        data[place] ^= 1 << int(rng.integers(8))
    return bytes(data)


def _cut(content: bytes, rng: np.random.Generator) -> bytes:
    first, last = _piece(content, rng)
    return content[:first] if rng.integers(2) else content[:first] + content[last:]


def _double(content: bytes, rng: np.random.Generator) -> bytes:
    first, last = _piece(content, rng)
    return content[:last] + content[first:last] * int(rng.integers(1, 4)) + content[last:]


def _insert(content: bytes, rng: np.random.Generator) -> bytes:
    place = int(rng.integers(0, len(content) + 1))
    return content[:place] + TOKENS[rng.integers(len(TOKENS))] + content[place:]


def _swap_lines(content: bytes, rng: np.random.Generator) -> bytes:
    lines = content.splitlines(keepends=True) or [b""]
    one, other = rng.integers(0, len(lines), 2)
    lines[one], lines[other] = lines[other], lines[one]
    return b"".join(lines)


def _drop_line(content: bytes, rng: np.random.Generator) -> bytes:
    lines = content.splitlines(keepends=True) or [b""]
    del lines[rng.integers(len(lines))]
    return b"".join(lines)


def _other_word(content: bytes, rng: np.random.Generator) -> bytes:
    """Put a token in the place of a word, most often a value."""
    lines = content.splitlines(keepends=True) or [b""]
    place = int(rng.integers(len(lines)))
    words = lines[place].split(b" ")
    words[int(rng.integers(max(len(words) - 2, 0), len(words)))] = TOKENS[rng.integers(len(TOKENS))]
    lines[place] = b" ".join(words) + b"\n"
    return b"".join(lines)


def _piece(content: bytes, rng: np.random.Generator) -> tuple[int, int]:
    first, last = sorted(rng.integers(0, len(content) + 1, 2).tolist())
    return first, min(last, first + 200)


_CHANGES = (_flip, _cut, _double, _insert, _insert, _swap_lines, _drop_line, _other_word)

PLUGIN = (ROOT / "docs" / "examples" / "mydrift.py").read_bytes
SCEN = b"version 1\n" + b"".join(
    b"0\tpond.map\t8\t6\t0\t0\t%d\t5\t%.4f\n" % (x, 5 + (2**0.5 - 1) * x) for x in range(5)
)


def with_checks(content: bytes) -> bytes:
    """A mutated PNG with the sums of its chunks put right, so that more of it is believed."""
    place, data = 8, bytearray(content)
    while place + 12 <= len(data):
        end = place + 8 + int.from_bytes(data[place : place + 4], "big")
        data[end : end + 4] = zlib.crc32(data[place + 4 : end]).to_bytes(4, "big")
        place = end + 4
    return bytes(data[: len(content)])


def valid(folder: Path, loader: str) -> tuple[Path, Callable[[], object]]:
    """Write the valid files of a loader: that which is to be mutated, and how it is loaded."""
    grid = GridMap(np.zeros((6, 8), bool), 2.0, (3.0, 4.0), "pond", "a survey")
    if loader in STUDIES:
        path = folder / f"{loader}.toml"
        path.write_bytes((ROOT / "studies" / path.name).read_bytes())
        return path, lambda: load_spec(path)
    if loader in ("map", "sidecar"):
        save_map(grid, folder / "pond.map")
        path = folder / ("pond.map" if loader == "map" else "pond.json")
        return path, lambda: load_map(folder / "pond.map")
    if loader == "scen":
        save_map(GridMap(grid.blocked), folder / "pond.map")
        (folder / "pond.scen").write_bytes(SCEN)
        return folder / "pond.scen", lambda: read_scen("pond.scen", None, 1.0, folder, "study")
    if loader in ("yaml", "yaml_image"):
        save_map(grid, folder / "pond.yaml")
        path = folder / ("pond.yaml" if loader == "yaml" else "pond.pgm")
        return path, lambda: load_map(folder / "pond.yaml")
    if loader == "plugin":
        path = folder / "mine.py"
        path.write_bytes(PLUGIN())
        return path, lambda: read_plugin("mine.py", folder, "study").load("study")
    image = folder / ("pond.pgm" if loader == "pgm" else "pond.png")
    picture = Image.fromarray(np.arange(48, dtype=np.uint8).reshape(6, 8) * 5)
    mode = {"rgba": "RGBA", "palette": "P"}.get(loader, "L")
    picture.convert(mode).save(image)
    return image, lambda: load_map(image, cell_size=1.0)


def count_of(loader: str, count: int) -> int:
    """How many files a loader is handed."""
    return count // 5 if loader in STUDIES else count


def report(loader: str, count: int, folder: Path) -> dict[str, object]:
    """Load `count` mutated files of a kind: what went wrong, and what it took at most."""
    folder.mkdir()
    path, load = valid(folder, loader)
    load()
    content, there = path.read_bytes(), sorted(folder.iterdir())
    rng = np.random.default_rng([LOADERS.index(loader), 2024])
    wrong: list[str] = []
    refused, slowest = 0, 0.0
    for number in range(count):
        changed = mutated(content, rng)
        path.write_bytes(with_checks(changed) if path.suffix == ".png" else changed)
        began = time.process_time()  # other programs may keep this one waiting
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            warnings.simplefilter("ignore", SyntaxWarning)  # is for a plug-in's author
            problem, said = outcome(load)
        took = time.process_time() - began
        refused += said
        slowest = max(slowest, took)
        if warned:
            problem = f"warns: {warned[0].message}"
        if sorted(p for p in folder.iterdir() if p.name != "__pycache__") != there:
            problem = f"leaves {sorted(folder.iterdir())}"
        if problem:
            wrong.append(f"file {number}: {problem}")
            path.with_suffix(f".{number}.wrong").write_bytes(path.read_bytes())
            there = sorted(folder.iterdir())
    return {"wrong": wrong, "refused": refused, "slowest": slowest, "peak": peak()}


def peak() -> int:
    """Bytes that this process has held at most; `ru_maxrss` counts those of its parent as well."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    facts = dict(line.split(":", 1) for line in lines)
    return int(facts["VmHWM"].split()[0]) * 1024


def outcome(load: Callable[[], object]) -> tuple[str, bool]:
    """What is wrong with how a file was loaded, "" for nothing, and whether it was refused."""
    try:
        load()
    except (BadInputError, BadTypeError) as error:
        text = str(error)
        if len(text) >= LONGEST or not text.isprintable():
            return f"says {text!r}", True
        return "", True
    except BaseException as error:
        return f"raises {type(error).__name__}: {str(error)[:200]}", False
    return "", False


if __name__ == "__main__":
    reports = {
        loader: report(loader, count_of(loader, int(sys.argv[1])), Path(sys.argv[2]) / loader)
        for loader in sys.argv[3:] or LOADERS
    }
    print(json.dumps(reports))
