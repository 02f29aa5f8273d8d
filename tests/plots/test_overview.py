"""The overview of many conditions: every rate where it belongs, and what is named."""

import itertools

import numpy as np
import polars as pl
import pytest
from figure_checks import assert_inside, legend_texts

from usvjax import plots
from usvjax.errors import BadInputError
from usvjax.plots.overview import ENDS

EPISODES = 20


def study(axes):
    """Rows of a study whose condition c has c successes, and half of them by the second method."""
    keys = list(axes)
    varied = {
        c: dict(zip(keys, values, strict=True))
        for c, values in enumerate(itertools.product(*axes.values()))
    }
    rows = [
        (c, method, 1 if episode < (c % (EPISODES + 1)) // (1 + (method == "b")) else 3)
        for c in varied
        for method in ("a", "b")
        for episode in range(EPISODES)
    ]
    table = pl.DataFrame(rows, schema=["condition", "method", "status"], orient="row")
    return table, varied


def drawn(axes, **changes):
    table, varied = study(axes)
    labels = {c: f"the condition of number {c}" for c in varied}
    given = {"success": 1, "methods": ["a", "b"], "labels": labels, "words": "reached"}
    return plots.plot_overview(table, varied, **(given | changes))


def test_one_axis_is_a_line_over_its_values():
    fig = drawn({"params.radius": [0.5 * i for i in range(14)]}, units={"params.radius": "m"})
    (ax,) = fig.axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("params.radius (m)", "reached (%)")
    line = ax.containers[0].lines[0]
    np.testing.assert_allclose(line.get_xdata(), 0.5 * np.arange(14), atol=0.05)
    np.testing.assert_allclose(line.get_ydata(), 5.0 * np.arange(14))
    assert legend_texts(fig) == ["a", "b"]
    assert_inside(fig)


def test_words_of_one_axis_stand_side_by_side():
    fig = drawn({"maps.source": [f"map{i}" for i in range(14)]})
    names = [tick.get_text() for tick in fig.axes[0].get_xticklabels()]
    assert names == [f"map{i}" for i in range(14)]
    assert_inside(fig)


def test_two_axes_are_a_heat_map_for_each_method():
    fig = drawn({"maps.rate": [0.3, 0.1, 0.2], "params.radius": [1, 2, 3, 4, 5]})
    first, second, bar = fig.axes
    assert [first.get_title(), second.get_title()] == ["a", "b"]
    assert (first.get_xlabel(), first.get_ylabel()) == ("params.radius", "maps.rate")
    assert bar.get_ylabel() == "reached (%)"
    # Conditions 0 to 4 have the rate 0.3, which stands at the top.
    wanted = 5.0 * np.arange(15).reshape(3, 5)[[1, 2, 0]]
    np.testing.assert_allclose(first.images[0].get_array(), wanted)
    np.testing.assert_allclose(
        second.images[0].get_array(), 5.0 * (np.arange(15).reshape(3, 5)[[1, 2, 0]] // 2)
    )
    assert {t.get_text() for t in first.texts} == {f"{v:.0f}" for v in wanted.ravel()}
    assert_inside(fig)


def test_more_axes_are_ranked_and_the_ends_are_named():
    fig = drawn({"maps.rate": [0.1, 0.2], "params.radius": [1, 2, 3], "static.horizon": [4, 5, 6]})
    above, below = fig.axes
    ranked = above.lines[0].get_ydata()
    np.testing.assert_allclose(ranked, 5.0 * np.arange(18)[::-1])
    names = [tick.get_text().replace("\n", " ") for tick in below.get_yticklabels()]
    best = [f"{rank}. the condition of number {18 - rank}" for rank in range(1, 19)]
    assert names == best[:ENDS] + best[-ENDS:]
    assert_inside(fig)


def test_conditions_that_are_not_crossed_are_ranked():
    table, varied = study({"a.b": [1, 2], "c.d": list(range(8))})
    labels = {c: str(c) for c in varied}
    part = table.filter(pl.col("condition") != 3)
    fig = plots.plot_overview(part, varied, success=1, methods=["a", "b"], labels=labels)
    assert len(fig.axes) == 2
    assert len(fig.axes[0].lines[0].get_ydata()) == 15


def test_dollar_signs_of_a_user_are_no_formula(tmp_path):
    labels = {0: "$x^$", 1: "cost $5, $6", 2: "_{"}
    fig = drawn({"a.b": ["$x^$", "cost $5, $6", "$_{$"]}, labels=labels, title="$\\nothing$")
    names = [tick.get_text() for tick in fig.axes[0].get_xticklabels()]
    assert names == ["$x^$", "cost $5, $6", "$_{$"]
    assert fig.get_suptitle().startswith("$\\nothing$")
    plots.save(fig, tmp_path / "a.png", dpi=40)
    table, _ = study({"a.b": [1, 2, 3]})
    plots.save(plots.plot_success(table, labels=labels, title="$^$"), tmp_path / "b.png", dpi=40)


def test_an_empty_table_is_refused():
    table, varied = study({"a.b": [1, 2]})
    with pytest.raises(BadInputError, match="table is empty"):
        plots.plot_overview(table.clear(), varied, success=1, methods=["a"], labels={})
