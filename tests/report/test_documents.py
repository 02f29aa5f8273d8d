"""Documents: the same tree for Markdown and for a terminal, and figures to the digits they earn."""

import pytest

from usvjax.report import Bullets, Picture, Section, Sheet, markdown, terminal
from usvjax.report.numbers import change, ends, fixed, interval, listed, number, p_value
from usvjax.statistics import Estimate

TREE = Section(
    "Whole",
    [
        "First **words** in `code`.",
        "",
        Section("Part", [Bullets(["one", "two"]), Sheet("", ["a", "b|c"], [["x", "1"]])]),
        Section("Empty", [Bullets([]), Sheet("none", ["a"], [])]),
        Picture("figures/a.png", "What it shows."),
    ],
)


def test_markdown():
    assert markdown(TREE) == (
        "# Whole\n\nFirst **words** in `code`.\n\n## Part\n\n- one\n- two\n\n"
        "| a | b\\|c |\n| --- | --- |\n| x | 1 |\n\n## Empty\n\nnone\n\n"
        "![What it shows.](figures/a.png)\n\nWhat it shows.\n"
    )


def test_a_terminal_shows_the_same_without_marks():
    text = terminal(TREE, 20)
    assert "First words in code.\n" in text
    assert "**" not in text
    assert "`" not in text
    for line in ("Whole", "Part", "- one", "- two", "x    1", "figures/a.png: What"):
        assert line in text.splitlines(), text
    assert max(map(len, text.splitlines())) <= 20


def test_what_could_break_a_table_or_a_line_is_shown_as_it_is():
    text = markdown(Section("a\nb", [Sheet("", ["h"], [["x\n| y"]])]))
    assert text.count("\n") == len(text.splitlines())
    assert len(text.splitlines()) == 5


@pytest.mark.parametrize(
    ("figure", "wanted"),
    [
        (Estimate(None), "-"),
        (Estimate(1.23456), "1.235"),
        (Estimate(12.3456, 12.1, 12.6), "12.35 [12.10, 12.60]"),
        ({"value": 0.5, "low": 0.25, "high": 0.75}, "0.50 [0.25, 0.75]"),
        (Estimate(0.0, 0.0, 0.0), "0.0000 [0.0000, 0.0000]"),
    ],
)
def test_an_interval_decides_the_digits(figure, wanted):
    assert interval(figure) == wanted


def test_digits_scale_and_sign_as_asked():
    figure = Estimate(0.125, 0.1, 0.2)
    assert interval(figure, 100, True, 1) == "+12.5 [10.0, 20.0]"
    assert interval(Estimate(0.125), 100, True, 1) == "+12.5"
    assert ends(figure, 1) == "[0.1, 0.2]"
    assert ends(Estimate(0.125)) == "-"
    assert fixed(None) == "-"
    assert listed([0.5, None, -1.0], 0, 100, True) == "+50, -, -100"
    assert change(-0.026) == "-2.6 %"
    assert change(None) == "-"
    assert [p_value(p) for p in (None, 0.03456, 1e-20)] == ["-", "0.035", "<1e-16"]
    assert [number(v) for v in (None, 0, 1234.5, 0.012345)] == ["-", "0", "1234", "0.01235"]
