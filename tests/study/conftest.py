"""A finished run of the toy study, and copies of it to spoil."""

import shutil

import pytest
from study_again import SPEC

from usvjax.study import run_study


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    return run_study(SPEC, tmp_path_factory.mktemp("original")).path


@pytest.fixture
def run(original, tmp_path):
    return shutil.copytree(original, tmp_path / "toy")
