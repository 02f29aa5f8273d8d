"""Every published value in the code is printed in its paper."""

import ast
import importlib
import re
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

from experiments.zhang2019.published import TRADITIONAL

ROOT = Path(__file__).parents[2]
PAPERS = ROOT.parent / "shared" / "papers"
FILES = sorted(
    [*(ROOT / "experiments").rglob("published.py"), *ROOT.glob("experiments/*/cases.py")]
)
MODULES = [".".join(file.relative_to(ROOT).with_suffix("").parts) for file in FILES]

_NUMBER = re.compile(
    r"(?P<digits>\d+(?:\.\d+)?)(?:\s*\$?(?:×|\\times)\s*10\s*\^\s*\{?\s*(?P<power>[-−–]?\s*\d+))?"
)


def printed(text: str) -> set[Decimal]:
    """The numbers in a text without their signs, as printed: 1.21×10^{-69} is one."""
    found = set()
    for number in _NUMBER.finditer(text):
        power = re.sub(r"[−–]", "-", number["power"] or "0").replace(" ", "")
        found.add(Decimal(number["digits"]).scaleb(int(power)))
    return found


def is_printed(value: float, numbers: set[Decimal]) -> bool:
    """Whether a value is printed, as it is or in per cent."""
    exact = abs(Decimal(repr(value)))
    return exact in numbers or 100 * exact in numbers


def values(found: object) -> Iterator[float]:
    """All numbers in a constant, however deep; keys, words and truth values are none."""
    if is_dataclass(found) and not isinstance(found, type):
        found = [getattr(found, field.name) for field in fields(found)]
    elif isinstance(found, Mapping):
        found = list(found.values())
    elif isinstance(found, np.ndarray):
        found = found.ravel().tolist()
    if isinstance(found, list | tuple | set | frozenset):
        for item in found:
            yield from values(item)
    elif isinstance(found, int | float) and not isinstance(found, bool):
        yield found


def constants(name: str) -> dict[str, object]:
    """The public constants of a module, without what it imports and defines."""
    module = importlib.import_module(name)
    names = set()
    for node in ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign | ast.AnnAssign):
            names |= {
                part.id
                for part in ast.walk(node)
                if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store)
            }
    public = (name for name in sorted(names & vars(module).keys()) if not name.startswith("_"))
    return {name: getattr(module, name) for name in public}


def missing(known: Mapping[str, object], numbers: set[Decimal]) -> dict[str, list[float]]:
    """By constant, the values that are not printed."""
    found = {
        name: [value for value in values(constant) if not is_printed(value, numbers)]
        for name, constant in known.items()
    }
    return {name: wrong for name, wrong in found.items() if wrong}


def text_of(module: str) -> str:
    paper = module.split(".")[1]
    texts = sorted(PAPERS.glob(f"{paper}_*.txt"))
    if not texts:
        pytest.skip(f"the text of {paper} is not in {PAPERS}")
    return texts[0].read_text(encoding="utf-8")


def test_there_are_published_values_of_every_paper():
    papers = {module.split(".")[1] for module in MODULES}
    assert papers == {"chen2023", "tan2022", "wei2023", "yu2022", "zhang2019"}


@pytest.mark.parametrize("module", MODULES)
def test_published_values_are_printed(module):
    found = missing(constants(module), printed(text_of(module)))
    assert found == {}


def test_a_value_with_another_digit_is_found_out():
    table = {"TRADITIONAL": TRADITIONAL, "TIMES": {"improved": 124.0}}
    numbers = printed(text_of("experiments.zhang2019"))
    assert missing(table, numbers) == {}
    wrong = {**table, "TRADITIONAL": replace(TRADITIONAL, total=59.4)}
    assert missing(wrong, numbers) == {"TRADITIONAL": [59.4]}
    assert missing({"TIMES": {"improved": 125.0}}, numbers) == {"TIMES": [125.0]}


def test_few_values_could_have_another_digit_unnoticed():
    unnoticed = []
    for module in MODULES:
        numbers = printed(text_of(module))
        for value in values(list(constants(module).values())):
            digits = Decimal(repr(value)).normalize()
            if len(digits.as_tuple().digits) >= 3:
                other = digits + Decimal(1).scaleb(digits.as_tuple().exponent)
                unnoticed.append(is_printed(float(other), numbers))
    assert len(unnoticed) > 300
    assert np.mean(unnoticed) < 0.05


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("4.62×10^{-16} (+)", "4.62e-16"),
        (r"$7.57 \times 10^{-191}$", "7.57e-191"),
        ("by 50.62%", "50.62"),
        ("(−84, 103)", "84"),
        ("161°1548′", "1548"),
        ("0.000067", "6.7e-5"),
    ],
)
def test_numbers_are_read_as_papers_print_them(text, number):
    assert Decimal(number) in printed(text)
    assert Decimal(number) + 1 not in printed(text)
