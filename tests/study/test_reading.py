"""Reading a run back: what is not as it was written is refused, and nothing else is touched."""

import json
import os
import random
import shutil
import socket
from contextlib import suppress
from pathlib import Path

import polars as pl
import pytest
from study_fake import rewrite_shards, run_files, toy_study

from usvjax.errors import BadInputError
from usvjax.study import load_run, parse_spec, run_study, store
from usvjax.study.figures import figures_for_run
from usvjax.study.folder import digest
from usvjax.study.manifest import hash_of
from usvjax.study.runner import run_unit
from usvjax.study.shards import Unit, encode_shard

FLIPS = 500 * int(os.environ.get("USVJAX_FUZZ") or "0") or 40
SPEC = parse_spec(toy_study(episodes=40, shard=20))


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    return run_study(SPEC, tmp_path_factory.mktemp("original")).path


@pytest.fixture
def run(original, tmp_path):
    return shutil.copytree(original, tmp_path / "toy")


def again(run):
    return run_study(SPEC, run.parent)


def said_in_one_line(call, *arguments):
    """The message of a refusal."""
    with pytest.raises(BadInputError) as caught:
        call(*arguments)
    assert "\n" not in str(caught.value)
    return str(caught.value)


# --- shards -----------------------------------------------------------------------------------


def flipped(file, rng):
    content = bytearray(file.read_bytes())
    content[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
    file.write_bytes(content)


def test_no_flipped_bit_is_silently_wrong(original, run):
    """Of shards, which hold the results, of the summary, and of what is written about both."""
    rng = random.Random(5)
    table, summary = load_run(original).table(), load_run(original).summary()
    files = sorted(
        path.relative_to(run)
        for path in run.rglob("*")
        if path.suffix in (".parquet", ".json") and path.name != "timings.json"
    )
    refusals = 0
    for _ in range(FLIPS):
        file = rng.choice(files)
        flipped(run / file, rng)
        try:
            opened = load_run(run)
            assert opened.table().equals(table), file
            assert opened.summary() == summary, file
            assert opened.methods == ["plain", "better"], file
            assert opened.level == load_run(original).level, file
        except BadInputError:
            refusals += 1
        shutil.copy(original / file, run / file)
    assert refusals > FLIPS / 2


def test_a_flipped_bit_of_a_shard_is_always_refused(original, run):
    rng = random.Random(6)
    names = [path.name for path in sorted((run / "shards").iterdir())]
    for _ in range(FLIPS):
        name = rng.choice(names)
        flipped(run / "shards" / name, rng)
        assert f"{name} is damaged" in said_in_one_line(load_run(run).table)
        shutil.copy(original / "shards" / name, run / "shards" / name)


def test_no_bytes_make_the_reader_of_parquet_panic(run, capfd):
    """Not even bytes that were given their own digest."""
    rng = random.Random(7)
    unit = Unit(0, 0)
    _, content = encode_shard(unit, run_unit(SPEC, unit))
    (path,) = (run / "shards").glob("c0000-s000000-*")
    for _ in range(FLIPS):
        broken = bytearray(content)
        broken[rng.randrange(len(broken))] ^= 1 << rng.randrange(8)
        path.unlink()
        path = path.with_name(f"c0000-s000000-{digest(broken)[:16]}.parquet")
        path.write_bytes(broken)
        with suppress(BadInputError):
            load_run(run).table()
    capfd.readouterr()


@pytest.mark.parametrize(
    "change",
    [
        lambda table: table.with_columns(condition=pl.lit(1, pl.Int32)),
        lambda table: table.with_columns(job=pl.col("job") + 1),
        lambda table: table.reverse(),
        lambda table: table.head(3),
        lambda table: table.with_columns(method=pl.lit("best")),
        lambda table: table.drop("status"),
        lambda table: table.with_columns(condition=pl.lit("0")),
    ],
)
def test_rows_that_are_not_those_of_the_name_are_refused(run, change):
    rewrite_shards(run, change)
    assert "does not hold the rows of condition" in said_in_one_line(load_run(run).table)
    assert "does not hold the rows of condition" in said_in_one_line(again, run)


def test_a_shard_under_another_name_is_refused(run):
    (shard,) = (run / "shards").glob("c0000-s000000-*")
    (other,) = (run / "shards").glob("c0001-s000000-*")
    shutil.copy(shard, shard.with_name(shard.name.replace("c0000", "c0001")))
    other.unlink()
    assert "does not hold the rows of condition 1" in said_in_one_line(load_run(run).table)


def test_two_shards_of_the_same_episodes_are_refused(run):
    (shard,) = (run / "shards").glob("c0000-s000000-*")
    shutil.copy(shard, shard.with_name("c0000-s000000-0123456789abcdef.parquet"))
    for call in (load_run(run).table, lambda: again(run)):
        assert "of the same episodes; delete the one" in said_in_one_line(call)


@pytest.mark.parametrize("name", ["c1.parquet", "c0009-s000000-0123456789abcdef.parquet", "a.txt"])
def test_what_no_run_of_the_study_wrote_is_no_shard(original, run, name):
    (run / "shards" / name).write_bytes(b"PAR1")
    assert load_run(run).table().equals(load_run(original).table())
    again(run)
    assert (run / "shards" / name).read_bytes() == b"PAR1"


@pytest.mark.parametrize("name", ["runs[1]", "v*", "~"])
def test_a_name_is_no_pattern(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    for out in ("v1", "runs1", "ab", "x", name):
        path = run_study(SPEC, out).path
    assert load_run(path).table().height == 40 * 2 * 2
    assert run_study(SPEC, name).summary == load_run(path).summary()


# --- manifest, summary, timings ---------------------------------------------------------------


def edited(run, change):
    """A manifest whose study was changed, with the hash that it then has."""
    path = run / "manifest.json"
    manifest = json.loads(path.read_text())
    change(manifest)
    manifest["hash"] = hash_of(manifest["study"])
    path.write_text(json.dumps(manifest))


def without(*keys):
    def change(value):
        for key in keys[:-1]:
            value = value[key]
        del value[keys[-1]]

    return change


def with_value(new, *keys):
    def change(value):
        for key in keys[:-1]:
            value = value[key]
        value[keys[-1]] = new

    return change


@pytest.mark.parametrize(
    "change",
    [
        with_value(3, "study"),
        with_value([], "study"),
        without("study", "conditions"),
        with_value([], "study", "conditions"),
        with_value([3], "study", "conditions"),
        without("study", "conditions", 0, "settings"),
        with_value({"params": 3}, "study", "conditions", 0, "settings"),
        with_value({"a.map": 3}, "study", "conditions", 0, "inputs"),
        with_value("plain", "study", "methods"),
        with_value([1], "study", "methods"),
        with_value("many", "study", "episodes"),
        with_value(True, "study", "seed"),
        with_value(None, "study", "name"),
        with_value("0.9", "study", "confidence"),
        without("code"),
        without("files"),
        with_value({"depth": 0, "moved": {}, "digests": [1]}, "files"),
    ],
)
def test_a_manifest_of_another_shape_is_refused(run, change):
    edited(run, change)
    before = run_files(run)
    for call in (lambda: load_run(run), lambda: again(run)):
        assert "is not a manifest of this version of usvjax: it" in said_in_one_line(call)
    assert run_files(run) == before


@pytest.mark.parametrize(
    "change",
    [
        with_value(8, "study", "seed"),
        with_value("best", "study", "methods", 0),
        with_value(0.7, "study", "conditions", 0, "settings", "params", "radius"),
        with_value("rate 0.6", "study", "conditions", 0, "label"),
        with_value("0" * 64, "hash"),
        with_value(float("nan"), "study", "confidence"),
    ],
)
def test_an_edited_manifest_under_its_old_hash_is_refused(run, change):
    path = run / "manifest.json"
    manifest = json.loads(path.read_text())
    change(manifest)
    path.write_text(json.dumps(manifest))
    for call in (lambda: load_run(run), lambda: again(run)):
        assert "was edited or damaged" in said_in_one_line(call)


@pytest.mark.parametrize("content", ["3", "[]", "{}", "", "null", "\0", "[" * 100_000])
def test_a_summary_of_another_shape_is_refused_and_made_again(original, run, content):
    (run / "summary.json").write_text(content)
    assert "is not as it was written" in said_in_one_line(load_run(run).summary)
    assert again(run).summary == load_run(original).summary()
    assert run_files(run) == run_files(original)


@pytest.mark.parametrize("name", ["summary.json", "summary.md", "finished.json"])
def test_an_edited_summary_is_never_shown(original, run, name):
    path = run / name
    path.write_text(path.read_text().replace("5", "6"))
    assert again(run).summary == load_run(original).summary()
    assert run_files(run) == run_files(original)


@pytest.mark.parametrize(
    "content",
    [
        '{"units": {"c0-s0": null}}',
        '{"units": {"c0-s0": "long"}}',
        '{"units": {"c0-s0": 1e999, "c0-s1": -1, "c1-s0": true, "x": 1}}',
        '{"units": [1]}',
        '{"units": {"c0-s0": 1' + "0" * 400 + "}}",
        "null",
        "{",
        "[" * 100_000,
    ],
)
def test_rubbish_among_the_timings_is_passed_over(original, run, content):
    (run / "timings.json").write_text(content)
    (run / "finished.json").unlink()  # or nothing would be written
    again(run)
    units = json.loads((run / "timings.json").read_text())["units"]
    assert units == {}
    assert run_files(run) == run_files(original)


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
