"""Figures of result tables: distributions and rates."""

import numpy as np
import polars as pl
import pytest
from figure_checks import (
    assert_inside,
    legend_texts,
)
from hypothesis import given
from hypothesis import strategies as st
from property_draws import examples

import usvjax.missions.dwa.looks  # noqa: F401
from usvjax import plots
from usvjax.errors import BadInputError
from usvjax.plots import style
from usvkernels.status import Status


def make_table(conditions=3, jobs=60, methods=("traditional", "improved"), seed=0):
    rng = np.random.default_rng(seed)
    parts = []
    for condition in range(conditions):
        for method in methods:
            time = (60.0 if method == "traditional" else 30.0) * rng.lognormal(0, 0.3, jobs)
            columns = {
                "condition": np.full(jobs, condition),
                "job": np.arange(jobs),
                "method": [method] * jobs,
                "status": rng.choice([1, 2, 3, 4], jobs, p=[0.7, 0.1, 0.15, 0.05]),
                "time": time,
                "path_length": 14.14 + rng.exponential(2.0, jobs),
            }
            parts.append(pl.DataFrame(columns))
    return pl.concat(parts)


def test_both_reached_keeps_an_episode_only_where_all_methods_reached():
    table = pl.DataFrame(
        {
            "condition": [0, 0, 0, 0, 1, 1],
            "job": [0, 0, 1, 1, 0, 0],
            "method": ["a", "b"] * 3,
            "status": [1, 1, 1, 2, 4, 1],
        }
    )
    kept = plots.both_reached(table)
    assert kept.rows() == [(0, 0, "a", 1), (0, 0, "b", 1)]


def test_both_reached_drops_an_episode_that_one_method_has_not_run():
    table = make_table(conditions=1, jobs=4).with_columns(status=pl.lit(1))
    partial = table.filter(~((pl.col("method") == "improved") & (pl.col("job") == 3)))
    assert plots.both_reached(partial)["job"].unique().sort().to_list() == [0, 1, 2]


def test_distributions_of_few_conditions_are_cumulative_curves():
    table = make_table()
    fig = plots.plot_distributions(table, labels={0: "r = 0.2 m"})
    assert len(fig.axes) == 6
    labels = ["time to the goal (s)"] * 3 + ["path length (m)"] * 3
    assert [ax.get_xlabel() for ax in fig.axes] == labels
    assert [ax.get_ylabel() for ax in fig.axes[::3]] == ["episodes up to x (%)"] * 2
    kept = plots.both_reached(table).filter(pl.col("condition") == 0)
    n = kept["job"].n_unique()
    assert 0 < n < 60
    assert fig.axes[0].get_title() == f"r = 0.2 m\nn = {n} of 60"
    assert fig.axes[1].get_title().startswith("condition 1\n")
    assert "both methods reached the goal" in fig.get_suptitle()
    assert legend_texts(fig) == ["traditional (mark: median)", "improved (mark: median)"]
    curve, median = fig.axes[0].lines[:2]
    times = kept.filter(pl.col("method") == "traditional")["time"].sort()
    np.testing.assert_allclose(curve.get_xdata(), times)
    np.testing.assert_allclose(curve.get_ydata(), np.arange(1, n + 1) / n)
    np.testing.assert_allclose(median.get_xdata(), times.median())
    assert_inside(fig)


def test_curves_are_marked_at_the_mean_where_that_is_asked_for():
    table = make_table()
    fig = plots.plot_distributions(table, mark="mean")
    assert legend_texts(fig) == ["traditional (mark: mean)", "improved (mark: mean)"]
    curve, mark = fig.axes[0].lines[:2]
    (x,), (y,) = mark.get_xdata(), mark.get_ydata()
    assert x == pytest.approx(np.mean(curve.get_xdata()))
    assert y == pytest.approx((np.asarray(curve.get_xdata()) <= x).mean())
    with pytest.raises(BadInputError, match="mark: got 'mode'"):
        plots.plot_distributions(table, mark="mode")


def test_distributions_of_many_conditions_are_boxes():
    fig = plots.plot_distributions(make_table(conditions=6), title="sweep")
    assert len(fig.axes) == 2
    assert [ax.get_ylabel() for ax in fig.axes] == ["time to the goal (s)", "path length (m)"]
    assert all(len(ax.patches) == 12 for ax in fig.axes)
    ticks = [text.get_text() for text in fig.axes[-1].get_xticklabels()]
    assert len(ticks) == 6
    assert all(text.endswith("/60") for text in ticks)
    assert "whiskers: 5th to 95th percentile" in fig.get_suptitle()
    assert legend_texts(fig) == ["traditional", "improved"]
    assert fig.get_suptitle().startswith("sweep: ")
    assert_inside(fig)


@pytest.mark.parametrize(
    ("names", "rotation"),
    [(["r 0.2, rate 0.3"] * 3, 0), (["clearance cap 1, rate 0.3"] * 9, 40), (["a" * 9] * 40, 90)],
)
def test_tick_names_are_folded_then_slanted_then_turned(names, rotation):
    shown, how = style.tick_names(names, room=120)
    assert how.get("rotation", 0) == rotation
    assert [" ".join(name.split()) for name in shown] == names
    if rotation == 0:
        assert max(len(line) for line in shown[0].split("\n")) <= 14


def test_a_long_tail_is_cut_and_said_so():
    table = make_table(conditions=1, jobs=1000).with_columns(status=pl.lit(1))
    longest = pl.when(pl.col("job") == 0).then(9000.0).otherwise(pl.col("time"))
    fig = plots.plot_distributions(table.with_columns(time=longest))
    ax = fig.axes[0]
    assert ax.get_xlim()[1] < 1000
    assert any("up to 9000" in text.get_text() for text in ax.texts)


def test_one_condition_has_its_metrics_side_by_side():
    fig = plots.plot_distributions(make_table(conditions=1), title="a study with a long name")
    assert [ax.get_xlabel() for ax in fig.axes] == ["time to the goal (s)", "path length (m)"]
    assert len({round(ax.get_position().y0, 6) for ax in fig.axes}) == 1
    assert_inside(fig)


def test_one_condition_of_one_method():
    fig = plots.plot_distributions(make_table(conditions=1, methods=("improved",)))
    assert "in which improved reached the goal" in fig.get_suptitle()
    assert_inside(fig)


def test_a_condition_without_common_successes_is_drawn_empty():
    table = make_table(conditions=2)
    lost = pl.when(pl.col("condition") == 1).then(2).otherwise(pl.col("status"))
    fig = plots.plot_distributions(table.with_columns(status=lost))
    assert "n = 0 of 60" in fig.axes[1].get_title()
    assert [text.get_text() for text in fig.axes[1].texts] == ["no such episode"]


def test_distributions_refuse():
    table = make_table()
    with pytest.raises(BadInputError, match="no column 'status'"):
        plots.plot_distributions(table.drop("status"))
    with pytest.raises(BadInputError, match="no column 'speed'"):
        plots.plot_distributions(table, metrics=["speed"])
    with pytest.raises(BadInputError, match="no episode in which every method reached"):
        plots.plot_distributions(table.with_columns(status=pl.lit(2)))


@examples(40)
@given(st.lists(st.sampled_from([1, 2, 3, 4]), min_size=1, max_size=200))
def test_rates_add_up_and_lie_in_their_wilson_intervals(statuses):
    n = len(statuses)
    table = pl.DataFrame({"condition": [0] * n, "method": ["m"] * n, "status": statuses})
    rates = plots.wilson_rates(table)
    assert rates["k"].sum() == n
    assert (rates["low"] <= rates["rate"] + 1e-12).all()
    assert (rates["rate"] <= rates["high"] + 1e-12).all()
    # Wilson (1927), written out.
    z, p = 1.959963984540054, rates["rate"].to_numpy()
    centre = (p + z**2 / (2 * n)) / (1 + z**2 / n)
    half = z / (1 + z**2 / n) * np.sqrt(p * (1 - p) / n + z**2 / (4 * n**2))
    np.testing.assert_allclose(rates["low"], np.maximum(centre - half, 0), atol=1e-9)
    np.testing.assert_allclose(rates["high"], np.minimum(centre + half, 1), atol=1e-9)


def test_success_has_a_row_per_ending_and_a_column_per_obstacle_rate():
    radius = {c: [0.2, 0.5, 0.7][c % 3] for c in range(6)}
    rate = {c: [0.2, 0.3][c // 3] for c in range(6)}
    table = make_table(conditions=6)
    fig = plots.plot_success(table, radius=radius, rate=rate)
    assert len(fig.axes) == 8
    assert [ax.get_title() for ax in fig.axes[:2]] == ["obstacle rate 0.2", "obstacle rate 0.3"]
    endings = ["reached (%)", "collided (%)", "stuck (%)", "timed out (%)"]
    assert [ax.get_ylabel() for ax in fig.axes[::2]] == endings
    assert all(ax.get_xlabel() == "obstacle radius r (m)" for ax in fig.axes[-2:])
    assert legend_texts(fig) == ["traditional", "improved"]
    assert "60 episodes per point" in fig.get_suptitle()
    shown = np.sort([bar.lines[0].get_ydata() for bar in fig.axes[0].containers])
    inside = table.filter(pl.col("condition") < 3).group_by("condition", "method")
    expected = inside.agg((pl.col("status") == 1).mean())["status"].to_numpy()
    np.testing.assert_allclose(np.sort(shown, axis=None), np.sort(expected))
    assert_inside(fig)


def over_radius(table):
    return plots.plot_success(
        table, radius={0: 0.2, 1: 0.3, 2: 0.4}, rate=dict.fromkeys(range(3), 0.2)
    )


@pytest.mark.parametrize("draw", [over_radius, plots.plot_distributions])
def test_a_legend_shows_that_a_line_is_broken(draw):
    (legend,) = draw(make_table()).legends
    line = legend.get_lines()[0]
    assert line.is_dashed()
    length = np.ptp(line.get_xdata())
    # A dash and a gap, 3.7 and 1.6 times the width of the line, are seen at each side of the mark.
    assert 0.5 * (length - line.get_markersize()) > (3.7 + 1.6) * line.get_linewidth()


@pytest.mark.parametrize("conditions", [1, 4, 9])
def test_success_of_conditions_that_form_no_grid_stand_under_their_labels(conditions):
    labels = {c: f"clearance cap {c} m" for c in range(conditions)}
    fig = plots.plot_success(make_table(conditions=conditions), labels=labels)
    assert len(fig.axes) == 4
    ticks = [" ".join(t.get_text().split()) for t in fig.axes[-1].get_xticklabels()]
    assert ticks == list(labels.values())
    assert_inside(fig)


def test_success_of_one_obstacle_rate_is_drawn_against_radius():
    radius, rate = {0: 0.2, 1: 0.5, 2: 0.7}, dict.fromkeys(range(3), 0.3)
    fig = plots.plot_success(make_table(), radius=radius, rate=rate, title="Table 4")
    assert fig.get_suptitle().startswith("Table 4: obstacle rate 0.3: ")
    np.testing.assert_allclose(fig.axes[-1].get_xticks(), [0.2, 0.5, 0.7])


def test_success_refuses():
    table = make_table()
    with pytest.raises(BadInputError, match="no column 'condition'"):
        plots.plot_success(table.drop("condition"))
    with pytest.raises(BadInputError, match="table is empty"):
        plots.plot_success(table.clear())
    with pytest.raises(BadInputError, match="status is 7"):
        plots.plot_success(table.with_columns(status=pl.lit(7)))


def test_success_draws_the_endings_of_the_mission_only():
    endings = (Status.FOUND, Status.UNREACHABLE, Status.OUT_OF_BUDGET)
    table = make_table(conditions=2).with_columns(
        status=pl.when(pl.col("job") < 45).then(int(Status.FOUND)).otherwise(int(endings[1]))
    )
    fig = plots.plot_success(table, endings=endings)
    names = ["found (%)", "unreachable (%)", "out of budget (%)"]
    assert [ax.get_ylabel() for ax in fig.axes] == names
    for ax, share in zip(fig.axes, (0.75, 0.25, 0.0), strict=True):
        values = np.concatenate([bar.lines[0].get_ydata() for bar in ax.containers])
        np.testing.assert_allclose(values, share)
    # Nothing stands below the second: its conditions are named although its row is not the last.
    assert [ax.get_xlabel() for ax in fig.axes] == ["", "condition", "condition"]
    labelled = [ax.xaxis.get_tick_params()["labelbottom"] for ax in fig.axes]
    assert labelled == [False, True, True]
    assert_inside(fig)


@pytest.mark.parametrize("count", [1, 2, 3, 5])
@pytest.mark.parametrize("conditions", [2, 12])
def test_success_of_any_number_of_endings(count, conditions):
    endings = list(Status)[1 : count + 1]
    fig = plots.plot_success(make_table(conditions=conditions), endings=endings)
    assert len(fig.axes) == count
    assert_inside(fig)


def test_success_shows_methods_in_the_order_of_the_study():
    table = make_table(methods=("allowed", "field", "zigzag"))
    assert legend_texts(plots.plot_success(table)) == ["allowed", "field", "zigzag"]
    order = ["zigzag", "field", "never run"]
    fig = plots.plot_success(table, methods=order)
    assert legend_texts(fig) == order[:2]
    first, second = (bar.lines[0].get_xdata() for bar in fig.axes[0].containers)
    assert (first < second).all()


def test_success_refuses_what_it_cannot_draw():
    with pytest.raises(BadInputError, match="endings is empty"):
        plots.plot_success(make_table(), endings=())
    with pytest.raises(BadInputError, match=r"methods is \['other'\]; the table has traditional"):
        plots.plot_success(make_table(), methods=["other"])
