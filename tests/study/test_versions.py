"""What a run was made with: what cannot be pinned and decides results is compared."""

import json

import jax
import pytest
from study_fake import toy_study

from usvjax.errors import BadInputError
from usvjax.study import parse_spec, run_study
from usvjax.study.versions import xla_flags


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("", ""),
        ("--xla_force_host_platform_device_count=4", ""),
        ("--xla_dump_to=/tmp/x --xla_dump_hlo_as_text", ""),
        ("--xla_cpu_enable_fast_math=true", "--xla_cpu_enable_fast_math=true"),
        ("--xla_b=1  --xla_a=2 --xla_b=3", "--xla_a=2 --xla_b=3"),
    ],
)
def test_flags_that_decide_results_are_kept_in_order(text, kept):
    assert xla_flags(text) == kept


def test_flags_in_a_file_count_by_what_it_holds(tmp_path):
    (tmp_path / "flags").write_text("--xla_a=1\n--xla_dump_to=x\n")
    assert xla_flags(str(tmp_path / "flags")) == "--xla_a=1"


def test_a_run_is_not_continued_with_other_flags(tmp_path, monkeypatch):
    spec = parse_spec(toy_study(episodes=4))
    path = run_study(spec, tmp_path).path
    flags = "--xla_cpu_enable_fast_math=true"
    monkeypatch.setenv("XLA_FLAGS", f"{flags} --xla_force_host_platform_device_count=2")
    with pytest.raises(BadInputError, match=f"made with XLA_FLAGS none, this is {flags}, and"):
        run_study(spec, tmp_path)
    monkeypatch.setenv("XLA_FLAGS", "--xla_force_host_platform_device_count=3")
    run_study(spec, tmp_path)
    assert json.loads((path / "manifest.json").read_text())["xla_flags"] == ""


def test_a_run_is_not_continued_with_other_settings_of_jax(tmp_path):
    spec = parse_spec(toy_study(episodes=4))
    run_study(spec, tmp_path)
    jax.config.update("jax_disable_most_optimizations", True)
    try:
        with pytest.raises(BadInputError, match=r"made with settings of JAX .*=False .*=True"):
            run_study(spec, tmp_path)
    finally:
        jax.config.update("jax_disable_most_optimizations", False)
    run_study(spec, tmp_path)
