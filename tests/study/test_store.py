"""The run directory: whole files only, nothing overwritten, one clear line when it cannot be."""

import errno
import json
import os
import subprocess
import sys

import pytest
from study_fake import run_files, toy_study

from usvjax.errors import BadInputError
from usvjax.study import folder, load_run, parse_spec, run_study, store
from usvjax.study.held import NOTHING
from usvjax.study.manifest import manifest_of
from usvjax.study.shards import Unit
from usvjax.study.store import RunDirectory
from usvjax.study.units import run_unit


def opened(path):
    return RunDirectory.open(
        path, manifest_of(parse_spec(toy_study()).canonical(), "code", NOTHING.entry())
    )


@pytest.fixture
def finished(tmp_path):
    return run_study(parse_spec(toy_study()), tmp_path)


def refused(tmp_path, words, **changes):
    """Expect a study to be refused, and everything on disk to stay as it is."""
    path = tmp_path / "toy"
    before = run_files(path) if path.is_dir() else path.read_bytes()
    with pytest.raises(BadInputError, match=words) as error:
        run_study(parse_spec(toy_study(**changes)), tmp_path)
    assert "\n" not in str(error.value)
    assert (run_files(path) if path.is_dir() else path.read_bytes()) == before


def test_a_shard_comes_back(tmp_path):
    unit = Unit(1, 2)
    table = run_unit(parse_spec(toy_study()), unit)
    with opened(tmp_path / "run") as run:
        run.write_shard(unit, table)
    with opened(tmp_path / "run") as run:
        assert run.done == {unit}
        assert run.read_shard(unit).equals(table)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"seed": 8}, "another study: seed is 7 there and 8 here"),
        ({"episodes": 300}, "episodes is 250 there and 300 here"),
        (
            {"params": {"radius": 0.75}},
            r"conditions\[0\].settings.params.radius is 0.5 there and 0.75 here",
        ),
        ({"methods": ["plain"]}, "methods is .* there and .* here"),
    ],
)
def test_another_study_is_refused(tmp_path, finished, changes, words):
    refused(tmp_path, words, **changes)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("usvjax", "0.0.9", "made with usvjax version 0.0.9, this is"),
        ("code", "0" * 16, "made with code 0000"),
        ("jax", "0.1", "made with jax version 0.1, this is"),
        ("device", "gpu H200", "made with device kind gpu H200, this is cpu"),
    ],
)
def test_another_version_is_refused(tmp_path, finished, key, value, words):
    manifest = finished.path / "manifest.json"
    manifest.write_text(json.dumps({**json.loads(manifest.read_text()), key: value}))
    refused(tmp_path, words)


def test_a_version_of_this_library_alone_decides(tmp_path, finished, monkeypatch):
    monkeypatch.setattr("usvjax.study.versions.__version__", "99.0")
    refused(tmp_path, "this is 99.0")


def test_a_foreign_directory_is_refused(tmp_path):
    (tmp_path / "toy").mkdir()
    (tmp_path / "toy" / "thesis.tex").write_text("years of work")
    refused(tmp_path, "not empty and not a run of usvjax .*'thesis.tex'")


def test_an_empty_directory_is_taken(tmp_path):
    (tmp_path / "toy").mkdir()
    assert run_study(parse_spec(toy_study()), tmp_path).summary["conditions"]


def test_a_file_in_place_of_the_directory_is_refused(tmp_path):
    (tmp_path / "toy").write_text("precious")
    refused(tmp_path, "is a file; choose another --out")


def test_a_file_in_place_of_its_parent_is_refused(tmp_path):
    (tmp_path / "out").write_text("precious")
    with pytest.raises(BadInputError, match=r"cannot write .*Not a directory"):
        run_study(parse_spec(toy_study()), tmp_path / "out")


@pytest.mark.parametrize("content", ["", "{", "[]", '{"hash": 1}', "\0" * 100])
def test_a_damaged_manifest_is_refused(tmp_path, finished, content):
    (finished.path / "manifest.json").write_text(content)
    refused(tmp_path, "manifest")


def test_a_directory_in_use_is_refused(tmp_path):
    (tmp_path / "toy").mkdir()
    code = "import fcntl, sys; f = open(sys.argv[1], 'w'); fcntl.flock(f, fcntl.LOCK_EX);"
    code += "print('locked', flush=True); sys.stdin.read()"
    command = [sys.executable, "-c", code, str(tmp_path / "toy" / "run.lock")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        assert other.stdout is not None
        assert other.stdout.readline() == b"locked\n"
        refused(tmp_path, "in use by another usvjax process")
        other.communicate()
    run_study(parse_spec(toy_study()), tmp_path)


def test_a_run_that_another_began_just_before_the_lock_is_not_mixed(tmp_path, monkeypatch):
    locked = store._locked

    def late(path):
        monkeypatch.setattr(store, "_locked", locked)
        run_study(parse_spec(toy_study(seed=8)), tmp_path)
        return locked(path)

    monkeypatch.setattr(store, "_locked", late)
    with pytest.raises(BadInputError, match="seed is 8 there and 7 here"):
        run_study(parse_spec(toy_study()), tmp_path)
    assert run_study(parse_spec(toy_study(seed=8)), tmp_path).summary["study"]["seed"] == 8


@pytest.mark.parametrize("cut", [0, 1, 100, -1])
def test_truncated_and_damaged_shards_are_computed_again(tmp_path, finished, cut):
    before = run_files(finished.path)
    shards = sorted((finished.path / "shards").iterdir())
    shards[1].write_bytes(shards[1].read_bytes()[:cut])
    content = bytearray(shards[4].read_bytes())
    content[len(content) // 2] ^= 1
    shards[4].write_bytes(content)
    run_study(parse_spec(toy_study()), tmp_path)
    assert run_files(finished.path) == before


def test_leftovers_of_a_crash_are_cleared(tmp_path, finished):
    before = run_files(finished.path)
    (finished.path / ".tmp-summary.json").write_text("{")
    (finished.path / "shards" / ".tmp-c0000-s000001-x.parquet").write_bytes(b"PAR1")
    run_study(parse_spec(toy_study()), tmp_path)
    assert run_files(finished.path) == before


def test_a_crash_before_the_manifest_is_no_foreign_directory(tmp_path):
    (tmp_path / "toy" / "shards").mkdir(parents=True)
    (tmp_path / "toy" / "run.lock").touch()
    (tmp_path / "toy" / ".tmp-manifest.json").write_text("{")
    assert run_study(parse_spec(toy_study()), tmp_path).summary["conditions"]


def failing(call, error, after):
    """Make an os call fail from its `after`-th use on."""
    calls = 0

    def wrapped(*args, **kwargs):
        nonlocal calls
        calls += 1
        if calls > after:
            raise OSError(error, os.strerror(error))
        return call(*args, **kwargs)

    return wrapped


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        ("fsync", errno.ENOSPC, "No space left on device"),
        ("replace", errno.EACCES, "Permission denied"),
        ("replace", errno.EROFS, "Read-only file system"),
        ("fsync", errno.EIO, "Input/output error"),
    ],
)
@pytest.mark.parametrize("after", [0, 4, 7])
def test_a_full_or_unwritable_directory_loses_nothing(
    tmp_path, monkeypatch, call, error, words, after
):
    with monkeypatch.context() as patch:
        patch.setattr(folder.os, call, failing(getattr(os, call), error, after))
        with pytest.raises(BadInputError, match=f"cannot write .*{words}") as caught:
            run_study(parse_spec(toy_study()), tmp_path / "full", devices=1)
        assert "\n" not in str(caught.value)
    assert not list((tmp_path / "full").rglob(".tmp-*"))
    written = [s.read_bytes() for s in (tmp_path / "full" / "toy" / "shards").iterdir()]
    assert len(written) >= (after > 1)
    assert ("was written before is kept" in str(caught.value)) == bool(written)
    result = run_study(parse_spec(toy_study()), tmp_path / "full")
    reference = run_study(parse_spec(toy_study()), tmp_path / "reference")
    assert run_files(result.path) == run_files(reference.path)
    assert set(written) <= set(run_files(reference.path).values())


def test_the_manifest_says_what_made_the_run(finished):
    manifest = load_run(finished.path).manifest
    assert manifest["hash"] == parse_spec(toy_study()).hash
    assert manifest["study"] == parse_spec(toy_study()).canonical()
    assert {"usvjax", "jax", "jaxlib", "numpy", "polars", "python", "device", "code"} <= set(
        manifest
    )
    assert manifest["device"].startswith("cpu")


def test_reading_what_is_no_run_is_one_line(tmp_path, finished):
    with pytest.raises(BadInputError, match="not a run of usvjax"):
        load_run(tmp_path)
    (finished.path / "summary.json").unlink()
    with pytest.raises(BadInputError, match="no summary; is the run finished"):
        load_run(finished.path).summary()
    for shard in (finished.path / "shards").iterdir():
        shard.unlink()
    with pytest.raises(BadInputError, match="holds no episodes yet"):
        load_run(finished.path).table()


def test_a_run_tells_its_labels_and_settings(finished):
    run = load_run(finished.path)
    assert run.name == "toy"
    assert run.methods == ["plain", "better"]
    assert run.labels == {0: "rate 0.5", 1: "rate 0.9"}
    assert run.varied == [{"params.rate": 0.5}, {"params.rate": 0.9}]
    assert run.settings[1]["params"]["rate"] == 0.9
    assert run.summary() == finished.summary
