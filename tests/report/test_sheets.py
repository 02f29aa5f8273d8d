"""Tables of text: every cell is there whole, at any width."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from usvjax.errors import printable
from usvjax.report.sheets import Sheet, folded, text_of

WIDTHS = (1, 20, 40, 60, 80, 120, 200, None)

OUTCOMES = Sheet(
    "How episodes ended (% of episodes, 95 % interval)",
    ("Condition", "Method", "Episodes", "Reached", "Timed out", "Stations skipped, mean"),
    [
        row
        for rate in range(3)
        for row in (
            (
                f"flip_rate 0.0{rate}, in a wide lake with islands",
                *("recommended", "2,147,483,647", "98.12 [97.10, 98.90]", "4.1", "-2.6"),
            ),
            ("", "turning_parent", "1", "0.00 [0.00, 79.35]", "100.00", "123456789012"),
        )
    ],
    words=2,
)
EIGHT = Sheet(
    "Difference to astar (p by Holm)",
    ("Condition", "Figure", "Baseline", "Method", "Difference", "Change", "p"),
    [
        (
            "" if place else f"a_label_without_any_space_{method}, n = 4,000 of 4,000",
            f"{figure} (m/s)",
            "123456789012",
            "-98765.4321",
            "+123456789012 [-99999999999, +99999999999]",
            "-4.1 %",
            "<1e-16",
        )
        for method in range(8)
        for place, figure in enumerate(("Smoothed inflections", "Time"))
    ],
    words=2,
    headed=True,
)
FACTS = Sheet("", (), [("map", "Hongze Lake, Jiangsu, China"), ("cells", "427 x 365")], words=2)


def words_of(sheet: Sheet) -> list[str]:
    return [word for row in sheet.rows for cell in row for word in printable(cell).split()]


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("sheet", [OUTCOMES, EIGHT, FACTS])
def test_nothing_is_cut_or_broken_at_any_width(sheet, width):
    text = text_of([sheet], width)
    found = text.split()
    for word in words_of(sheet):
        assert word in found
    if width is None:
        assert all(cell in text for row in sheet.rows for cell in row)
        return
    for line in text.splitlines():
        assert len(line) <= width or len(line.split()) == 1 or line.split()[0].endswith(":")


def test_where_columns_do_not_fit_every_figure_is_named():
    lines = text_of([OUTCOMES], 30).splitlines()
    for name in OUTCOMES.header[2:]:
        assert sum(line.strip().startswith(f"{name.split()[0]}") for line in lines) == 6
    assert lines.count("  Method: turning_parent") == 3


def test_a_table_takes_the_width_that_it_needs_and_no_more():
    assert max(map(len, text_of([EIGHT], 120).splitlines())) <= 120
    assert text_of([OUTCOMES], None) == text_of([OUTCOMES], 500)


@given(
    st.lists(
        st.tuples(st.text(max_size=30), st.text(max_size=30), st.text(max_size=12)), max_size=6
    ),
    st.integers(1, 60),
    st.booleans(),
    st.integers(1, 3),
)
def test_whatever_stands_in_cells_is_printed_whole(rows, width, headed, words):
    sheet = Sheet("title", ("one", "two", "three"), rows, words, headed)
    text = text_of([sheet], width)
    assert "\r" not in text
    found = text.split()
    for word in words_of(sheet):
        assert word in found


def test_what_a_terminal_would_obey_is_made_visible():
    assert printable("a\x1b[31mb\nc\u202ed\udcff\x9b") == "a\\x1b[31mb\\nc\\u202ed\\udcff\\x9b"
    assert printable("Δ é [/q] :smile: 湖") == "Δ é [/q] :smile: 湖"


def test_folding_keeps_words_and_the_space_before_them():
    assert folded("  one two three", 9, "    ") == ["  one two", "    three"]
    assert folded("  unbreakable", 5) == ["  unbreakable"]
    assert folded("one  two", None) == ["one  two"]
