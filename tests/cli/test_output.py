"""What commands print: whole, at any width and under any encoding, on a terminal or in a pipe."""

import io
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import study_fake  # noqa: F401 - registers the kind "toy"

from usvjax.cli import COMMANDS, main
from usvjax.cli.console import Meter, console, show_line, use_any_encoding
from usvjax.maps import GridMap, save_map

FUZZ = bool(os.environ.get("USVJAX_FUZZ"))
PLACES = [("ascii", "40"), ("cp1252", None), ("utf-8", "1")]
"""Encodings and widths; None is a pipe."""
if FUZZ:
    PLACES += [(name, "80") for name in ("cp437", "latin-1", "koi8-r", "utf-16", "utf-8")]
    PLACES += [("utf-8", columns) for columns in ("1", "10", "20", "40", "60", "200", None)]

STUDY = """
name = "toy"
kind = "toy"
episodes = 60
shard = 60
methods = ["plain", "better", "worse"]
[[conditions]]
label = "Δ of été [/q], near the shore, with a long label"
params.rate = 0.5
[[conditions]]
label = "calm :smile:"
params.rate = 0.9
"""

OF_A_MAP = (
    ("maps", "show", "{map}"),
    ("maps", "convert", "{map}", "{folder}/z[/q]é.yaml", "--force"),
    ("maps", "draw", "{map}", "{folder}/z[/q].png", "--dpi", "40"),
    ("route", "{map}", "--from", "1,1", "--to", "10,8", "--csv", "{folder}/z[bold]/é.csv"),
)
OF_A_STUDY = (
    ("check", "{study}", "--no-trial"),
    ("study", "{study}", "--out", "{folder}/été[/q]", "--no-figures"),
    ("plot", "{folder}/été[/q]/toy"),
    ("export", "{folder}/été[/q]/toy", "--job", "3"),
    ("animate", "{folder}/été[/q]/toy", "--job", "3"),
    ("init", "dwa"),
    ("init", "dwa", "--out", "{folder}/z[/q].toml", "--force"),
)
LIFTED = {"map", "Condition"}
"""Names of columns that narrow tables do without, where their words stand as headings."""
COMMAND_LINES = (
    ("--help",),
    ("--version",),
    ("maps", "list"),
    *OF_A_MAP,
    *OF_A_STUDY,
    *((name, "--help") for name in COMMANDS),
)


@pytest.fixture(scope="module")
def places(tmp_path_factory):
    """Where the files are that command lines name."""
    folder = tmp_path_factory.mktemp("output")
    for name in ("z[", "z[bold]"):
        (folder / name).mkdir()
    blocked = np.zeros((10, 14), bool)
    blocked[4:6, 3:9] = True
    save_map(GridMap(blocked, 2.0, name="Étang Δ [/q]", attribution="Ω"), folder / "é[q].map")
    (folder / "toy.toml").write_text(STUDY, encoding="utf-8")
    return {"folder": folder, "map": folder / "é[q].map", "study": folder / "toy.toml"}


@pytest.fixture(autouse=True)
def no_cache_on_disk(monkeypatch):
    monkeypatch.setattr("usvjax.devices.use_compilation_cache", lambda: None)


def printed(monkeypatch, line, encoding="utf-8", columns=None, **environment):
    """Exit code, stdout and stderr of a command whose streams have an encoding."""
    for key in ("COLUMNS", "FORCE_COLOR", "TTY_COMPATIBLE"):
        monkeypatch.delenv(key, raising=False)
    for key, value in environment.items():
        monkeypatch.setenv(key, value)
    if columns is not None:
        monkeypatch.setenv("COLUMNS", columns)
    streams = [io.TextIOWrapper(io.BytesIO(), encoding=encoding) for _ in range(2)]
    with monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", streams[0])
        patch.setattr(sys, "stderr", streams[1])
        try:
            code = main(line)
        except SystemExit as stop:
            code = stop.code
        for stream in streams:
            stream.flush()
    return code, *(stream.buffer.getvalue().decode(encoding) for stream in streams)


def words_of(text, encoding="utf-8"):
    """Words as an encoding shows them, apart from how tables are drawn and how long it took."""
    text = re.sub(
        r"(?m)^time .*|[\d.,]+ ms \(compiled\)|[\u2500-\u257f\u2580\u2584\u2588|+]", " ", text
    )
    text = text.encode(encoding, "usvjax.plain").decode(encoding)
    return {word.strip(":") for word in text.split() if not set(word) <= set("#'.-")} - {""}


@pytest.mark.parametrize("line", COMMAND_LINES, ids=" ".join)
def test_commands_print_whole_under_any_encoding_and_width(line, places, monkeypatch):
    given = [word.format(**places) for word in line]
    code, wide, err = printed(monkeypatch, given, columns="120")
    assert code == 0, err
    for encoding, columns in PLACES:
        code, out, err = printed(monkeypatch, given, encoding, columns)
        assert code == 0
        assert "Traceback" not in err
        assert not set("\x1b\r") & set(out + err)
        assert "\u2026" not in out
        missing = words_of(wide, encoding) - words_of(out, encoding)
        assert missing <= LIFTED, (encoding, columns)


@pytest.mark.parametrize("name", ["été Δ", "[/q]", "[bold]x", ":smile:", "a\x1b[31m\nb", "c\udcff"])
def test_a_path_is_printed_as_it_is_called(name, monkeypatch):
    stream = io.TextIOWrapper(io.BytesIO(), encoding="utf-8")
    monkeypatch.setattr(sys, "stdout", stream)
    show_line(f"wrote {Path(name)}")
    console().print("[bold]é :smile:")
    stream.flush()
    shown = stream.buffer.getvalue().decode()
    plain = name.replace("\x1b", "\\x1b").replace("\n", "\\n").replace("\udcff", "\\udcff")
    assert shown == f"wrote {plain}\n[bold]é :smile:\n"


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "utf-8"])
def test_a_refusal_is_one_line_under_any_encoding(encoding, tmp_path, monkeypatch):
    line = ["maps", "show", str(tmp_path / "été\x1b[31mΔ.map")]
    code, out, err = printed(monkeypatch, line, encoding)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "\\x1b[31m" in err
    assert "\x1b" not in err


def test_letters_that_an_encoding_lacks_are_replaced(monkeypatch):
    stream = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    monkeypatch.setattr(sys, "stdout", stream)
    use_any_encoding()
    print("Δ é █▀▄ ─ …")
    stream.flush()
    assert stream.buffer.getvalue() == b"? ? #'. - ...\n"


@pytest.mark.parametrize("columns", ["20", "40", "80", "100", "120", "140", "200"])
@pytest.mark.parametrize("encoding", ["ascii", "utf-8"])
def test_a_bar_shows_whole_numbers_on_a_terminal(encoding, columns, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", columns)
    stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    monkeypatch.setattr(sys, "stderr", stream)
    use_any_encoding()
    meter = Meter("a_study_of_[/q]_with_a_name", "eps.", quiet=False)
    meter.begin(10, 48_000)
    meter.advance(47_990)
    meter.end(whole=True)
    stream.flush()
    shown = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", stream.buffer.getvalue().decode(encoding))
    assert "48,000/48,000 eps." in shown
    assert ("a_study_of_[/q]_with_a_name" in shown) is (int(columns) >= 120)
    assert "\u2026" not in shown
    assert "..." not in shown


def test_progress_in_a_pipe_is_a_line_now_and_then(monkeypatch, capsys):
    clock = [0.0]
    monkeypatch.setattr("usvjax.cli.console.time.monotonic", lambda: clock[0])
    meter = Meter("toy", "episodes")
    meter.begin(0, 1000)
    for _ in range(1000):
        clock[0] += 0.1
        meter.advance(1)
    meter.end(whole=True)
    lines = capsys.readouterr().err.splitlines()
    assert 2 <= len(lines) <= 5
    assert lines[-1] == "toy: 1,000/1,000 episodes in 100 s"
    quiet = Meter("toy", "episodes", quiet=True)
    quiet.begin(0, 10)
    quiet.say("continuing")
    quiet.end(whole=True)
    assert capsys.readouterr().err == ""


@pytest.mark.skipif(not FUZZ, reason="a process for each command; set USVJAX_FUZZ=1")
@pytest.mark.parametrize(
    "environment",
    [
        {"PYTHONIOENCODING": "ascii"},
        {"PYTHONIOENCODING": "cp1252"},
        {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    ],
    ids=str,
)
def test_commands_print_in_a_process_of_their_own(environment, places):
    for line in (("maps", "show", "hongze-1000"), *OF_A_MAP, OF_A_STUDY[5]):
        program = [
            sys.executable,
            "-c",
            "import sys; from usvjax.cli import main; sys.exit(main())",
        ]
        given = [word.format(**places) for word in line]
        done = subprocess.run(
            [*program, *given], env=os.environ | environment, capture_output=True, timeout=300
        )
        assert done.returncode == 0, done.stderr
        assert b"Traceback" not in done.stderr
