"""The process of a command: signals, output that cannot be written, homes and platforms missing."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from usvjax.cli import main
from usvjax.study import load_run

TESTS = Path(__file__).parents[1] / "oracles"

STUDY = """
name = "toy"
kind = "toy"
episodes = 4000
shard = 100
methods = ["plain", "better"]
[params]
sleep = {sleep}
"""

MAIN = """
import sys
sys.path.insert(0, sys.argv.pop(1))
import study_fake
from usvjax.cli import main
sys.exit(main())
"""


def started(*arguments, **variables):
    """A command in a process of its own."""
    return subprocess.Popen(
        [sys.executable, "-c", MAIN, str(TESTS), *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, **variables},
    )


def ended(process):
    """Exit code, output and lines on stderr of a command."""
    out, err = process.communicate(timeout=120)
    return process.returncode, out.decode(), err.decode().splitlines()


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "toy.toml"
    path.write_text(STUDY.format(sleep=0.2))
    return path


def running(study):
    """A study, and its process once episodes are under way."""
    out = study.parent / "runs"
    process = started("study", study, "--out", out, "--no-figures")
    while not (out / "toy" / "manifest.json").exists():
        assert process.poll() is None
        time.sleep(0.01)
    time.sleep(0.5)
    return process


# --- signals ----------------------------------------------------------------------------------


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_to_stop_says_how_to_continue(study, number, code):
    process = running(study)
    process.send_signal(number)
    found, out, err = ended(process)
    assert (found, out) == (code, "")
    assert any("finishing the shards under way" in line for line in err)
    assert err[-1].startswith("usvjax: stopped with ")
    assert err[-1].endswith(f"continue with: usvjax study {study} --out {study.parent / 'runs'}")
    assert load_run(study.parent / "runs" / "toy").table().height > 0


def test_a_second_signal_stops_at_once_and_says_it_too(study):
    study.write_text(STUDY.format(sleep=60.0))
    process = running(study)
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    found, _, err = ended(process)
    assert time.monotonic() - began < 30.0
    assert found == 130
    assert err[-1].startswith("usvjax: stopped with 0 of 8,000 episodes on disk; continue with: ")


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_while_importing_is_one_line(tmp_path, number, code):
    (tmp_path / "slow.py").write_text(
        "import time\ntry:\n    print('importing', flush=True)\n    time.sleep(60)\n"
        "except BaseException:\n    raise ImportError('half')\n"
    )
    (tmp_path / "slow.toml").write_text(
        'name = "slow"\nepisodes = 1\nkind = "slow"\nplugin = "by.py"\n'
    )
    (tmp_path / "by.py").write_text("import slow\n")
    process = started("check", tmp_path / "slow.toml")
    assert process.stdout is not None
    assert process.stdout.readline() == b"importing\n"
    process.send_signal(number)
    assert ended(process) == (code, "", ["usvjax: interrupted"])


def test_handlers_of_others_are_put_back(capsys):
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    assert main(["--version"]) == 0
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == before


# --- output -----------------------------------------------------------------------------------


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device here")
@pytest.mark.parametrize(
    "arguments", [["maps", "list"], ["--help"], ["study", "--help"], ["--version"], ["study"]]
)
def test_a_full_device_is_one_line(study, arguments):
    if arguments == ["study"]:
        study.write_text(STUDY.format(sleep=0.0))
        arguments = ["study", study, "--out", study.parent, "--quiet", "--no-figures"]
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-c", MAIN, str(TESTS), *map(str, arguments)],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
        )
    assert done.stderr == "usvjax: cannot write to standard output: No space left on device\n"
    assert done.returncode == 1


def test_a_reader_that_leaves_is_no_error(study):
    process = started("--help")
    assert process.stdout is not None
    process.stdout.close()
    assert process.stderr is not None
    assert process.stderr.read() == b""
    assert process.wait(timeout=60) == 1


# --- what a process may lack ------------------------------------------------------------------


@pytest.mark.parametrize("home", ["", "/proc/nowhere"])
def test_without_a_home_there_is_no_cache_and_one_line(study, home):
    """Of matplotlib neither."""
    study.write_text(STUDY.format(sleep=0.0))
    draw = MAIN.replace("from usvjax.cli", "import pathlib\n{}\nfrom usvjax.cli").format(
        "def no_home(cls=None):\n    raise RuntimeError('no home')\npathlib.Path.home = no_home"
        if not home
        else ""
    )
    done = subprocess.run(
        [sys.executable, "-c", draw, TESTS, "study", study, "--quiet", "--out", study.parent],
        env={k: v for k, v in os.environ.items() if not k.startswith(("XDG_", "JAX_", "MPL"))}
        | {"HOME": home},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0
    (said,) = done.stderr.splitlines()
    assert said.startswith("usvjax: no folder to keep compiled kernels in")
    assert "times.csv" in done.stdout


@pytest.mark.parametrize("platform", ["cuda", "nonsense"])
@pytest.mark.parametrize("command", ["study", "check"])
def test_a_platform_that_is_not_there_is_one_line(study, platform, command):
    found, out, err = ended(started(command, study, JAX_PLATFORMS=platform))
    assert (found, out) == (2, "")
    assert err == [
        f"usvjax: JAX cannot start on this machine with JAX_PLATFORMS={platform}; unset it, or "
        f"set it to a platform that is here, such as cpu"
    ]
