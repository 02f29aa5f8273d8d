"""The folder of a run: pipes, links and places that may only be read destroy and hang nothing."""

import os
import shutil
import socket
from pathlib import Path

import pytest
from study_again import again, said_in_one_line
from study_fake import run_files

from usvjax.study import load_run, store
from usvjax.study.figures import figures_for_run

# --- what is no plain file --------------------------------------------------------------------


def put_pipe(path):
    os.mkfifo(path)


def put_folder(path):
    path.mkdir()


def put_socket(path):
    with socket.socket(socket.AF_UNIX) as made:
        here = Path.cwd()
        os.chdir(path.parent)  # a socket's path may have a hundred characters
        try:
            made.bind(path.name)
        finally:
            os.chdir(here)


def put_link(path):
    target = path.parents[1] / "precious.txt"
    target.write_text("precious")
    path.symlink_to(target)


def put_device(path):
    path.symlink_to("/dev/zero")


PUT = [put_pipe, put_folder, put_socket, put_link, put_device]
KINDS = dict(zip(PUT, ("pipe", "folder", "socket", "link", "link"), strict=True))


@pytest.mark.parametrize("put", PUT)
def test_something_else_in_place_of_a_manifest_or_a_lock_is_refused(run, put):
    for name in ("manifest.json", "run.lock"):
        kept = (run / name).read_bytes()
        (run / name).unlink()
        (run / "summary.md").unlink(missing_ok=True)  # so that there is something to write
        put(run / name)
        assert f"{name} is a {KINDS[put]}; wanted a plain file" in said_in_one_line(again, run)
        shutil.rmtree(run / name) if put is put_folder else (run / name).unlink()
        (run / name).write_bytes(kept)


@pytest.mark.parametrize("put", PUT)
def test_something_else_in_place_of_a_shard_is_refused(run, put):
    shard = min((run / "shards").iterdir())
    shard.unlink()
    put(shard)
    for call in (load_run(run).table, lambda: again(run)):
        assert f"{shard} is a {KINDS[put]}" in said_in_one_line(call)


@pytest.mark.parametrize("put", PUT)
@pytest.mark.parametrize("name", ["summary.json", "summary.md", "finished.json", "timings.json"])
def test_something_else_in_place_of_what_can_be_made_again(original, run, put, name):
    (run / name).unlink()
    (run / "finished.json").unlink(missing_ok=True)
    put(run / name)
    if name == "summary.json":
        assert f"summary.json is a {KINDS[put]}" in said_in_one_line(load_run(run).summary)
    if put is put_folder:
        assert "cannot write the run directory" in said_in_one_line(again, run)
        return
    again(run)
    assert run_files(run) == run_files(original)
    assert put is not put_link or (run.parent / "precious.txt").read_text() == "precious"


def test_a_file_too_large_to_be_ours_is_not_read(run):
    with open(run / "manifest.json", "r+b") as file:
        file.truncate(2**40)
    assert "bytes; wanted at most" in said_in_one_line(load_run, run)


# --- links ------------------------------------------------------------------------------------


@pytest.mark.parametrize("content", [b"", b"a thesis"])
def test_a_lock_that_is_a_link_destroys_nothing(run, tmp_path, content):
    precious = tmp_path / "precious"
    precious.write_bytes(content)
    (run / "run.lock").unlink()
    (run / "run.lock").symlink_to(precious)
    (run / "finished.json").unlink()
    assert "run.lock is a link" in said_in_one_line(again, run)
    assert precious.read_bytes() == content


def test_a_lock_is_not_truncated(run):
    (run / "run.lock").write_text("note")
    (run / "finished.json").unlink()
    again(run)
    assert (run / "run.lock").read_text() == "note"


@pytest.mark.parametrize("name", ["shards", "files", "figures"])
def test_a_folder_that_is_a_link_is_refused(run, tmp_path, name):
    (tmp_path / "elsewhere").mkdir()
    if (run / name).exists():
        shutil.move(run / name, tmp_path / "elsewhere" / name)
    (run / name).symlink_to(tmp_path / "elsewhere")
    before = run_files(tmp_path / "elsewhere")
    (run / "summary.md").unlink()
    call = again if name != "figures" else figures_for_run
    assert f"{run / name} is a link; nothing is written" in said_in_one_line(call, run)
    assert run_files(tmp_path / "elsewhere") == before


@pytest.mark.parametrize("name", [".tmp-summary.json", "shards/.tmp-c.parquet"])
def test_a_temporary_name_that_is_a_link_destroys_nothing(original, run, tmp_path, name):
    precious = tmp_path / "precious"
    precious.write_text("a thesis")
    (run / name).symlink_to(precious)
    (run / "summary.json").unlink()
    again(run)
    assert precious.read_text() == "a thesis"
    assert run_files(run) == run_files(original)


def test_the_run_itself_may_be_a_link(original, run, tmp_path):
    (tmp_path / "disk").mkdir()
    shutil.move(run, tmp_path / "disk" / "toy")
    run.symlink_to(tmp_path / "disk" / "toy")
    (run / "finished.json").unlink()
    again(run)
    assert run_files(run) == run_files(original)


# --- places that may only be read -------------------------------------------------------------


@pytest.fixture
def read_only(monkeypatch):
    """No file of a run can be opened for writing, as where a disk is mounted so."""
    plain = os.open

    def refusing(path, flags, *rest, **more):
        if flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT):
            raise OSError(30, "Read-only file system", str(path))
        return plain(path, flags, *rest, **more)

    monkeypatch.setattr(store.os, "open", refusing)
    monkeypatch.setattr(store.os, "access", lambda path, mode: mode != os.W_OK)


@pytest.mark.parametrize("gone", [[], ["finished.json"], ["summary.json"]])
def test_a_finished_run_that_may_only_be_read_is_shown(original, run, read_only, gone):
    for name in gone:
        (run / name).unlink()
    before = run_files(run)
    result = again(run)
    assert result.summary == load_run(original).summary()
    assert result.written == (not gone)
    assert run_files(run) == before


def test_an_unfinished_run_that_may_only_be_read_is_refused(run, read_only):
    min((run / "shards").iterdir()).unlink()
    assert "may only be read, and episodes are missing" in said_in_one_line(again, run)
