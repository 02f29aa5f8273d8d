"""What the documents say: names and files that are there, code that can be read, and runs."""

import ast
import re
import tomllib
from pathlib import Path

import pytest
from property_draws import FUZZ

import usvjax as uj
from usvjax.study import parse_spec

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def blocks(page, language):
    return re.findall(rf"```{language}\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_names_and_files_that_are_named_are_there(page):
    text = page.read_text(encoding="utf-8")
    assert not [name for name in re.findall(r"\buj\.(\w+)", text) if not hasattr(uj, name)]
    for block in blocks(page, "python"):
        ast.parse(block)
    files = re.findall(r"\b(?:studies|docs)/[\w/]+\.(?:toml|md|py)", text)
    files += [str(page.parent / link) for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text)]
    assert not [name for name in files if not (ROOT / name).exists()]


@pytest.mark.skipif(not FUZZ, reason="by `make fuzz`: it compiles for a minute")
def test_the_page_on_fleets_runs(one_device):
    page = ROOT / "docs" / "fleets.md"
    names = {}
    for block in blocks(page, "python"):
        exec(block, names)
        assert (names["r"].status == uj.Status.REACHED).all(), block
    assert names["a"].formed.all()


def test_the_study_of_the_page_on_fleets_is_one():
    (study,) = blocks(ROOT / "docs" / "fleets.md", "toml")
    assert len(parse_spec(tomllib.loads(study)).conditions) == 2


def test_links_into_a_page_lead_to_its_headings():
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        for file, anchor in re.findall(r"\]\(([^)#:]+)#([^)]+)\)", text):
            heads = re.findall(r"^#+ (.*)$", (page.parent / file).read_text(), re.MULTILINE)
            assert anchor in {
                re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads
            }
