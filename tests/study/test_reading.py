"""Reading a run back: what is not as it was written is refused, and nothing else is touched."""

import json
import os
import random
import shutil
from contextlib import suppress

import polars as pl
import pytest
from study_again import SPEC, again, said_in_one_line
from study_fake import rewrite_shards, run_files

from usvjax.errors import BadInputError
from usvjax.study import load_run, run_study
from usvjax.study.folder import digest
from usvjax.study.manifest import hash_of
from usvjax.study.shards import Unit, encode_shard
from usvjax.study.units import run_unit

FLIPS = 500 * int(os.environ.get("USVJAX_FUZZ") or "0") or 40


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
