"""Figures: what they show and label, what they refuse, and that files are whole or absent."""

from types import SimpleNamespace

import numpy as np
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.collections import EllipseCollection, LineCollection
from PIL import Image

from usvjax import plots
from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.plots import style
from usvjax.plots.animation import frame_steps
from usvkernels.status import Status

OBSTACLES = np.array([(2.0, 3.0), (5.0, 5.0), (7.0, 4.0)])
GOAL = np.array([10.0, 10.0])
LINE = np.column_stack([np.linspace(0, 10, 41)] * 2 + [np.zeros((41, 3))])


def legend_texts(fig):
    return [text.get_text() for legend in fig.legends for text in legend.get_texts()]


def assert_labelled(ax):
    for label in (ax.get_xlabel(), ax.get_ylabel()):
        assert label.endswith(")"), f"axis label {label!r} has no unit"


def assert_inside(fig):
    """No title, label or legend is cut off by the edge of the figure."""
    fig.canvas.draw()
    width, height = fig.canvas.get_width_height()
    box = fig.get_tightbbox().extents * fig.dpi
    assert (box[:2] > -1).all()
    assert (box[2:] < np.array([width, height]) + 1).all()


# --- paths ------------------------------------------------------------------------------------


def draw_paths(**changes):
    arguments = {
        "obstacles": OBSTACLES,
        "radius": 0.5,
        "trajectories": {"traditional": LINE, "improved": LINE + np.eye(5)[0]},
        "start": (0.0, 0.0, 0.8),
        "goal": GOAL,
    }
    return plots.plot_paths(**{**arguments, **changes})


def test_paths_show_both_methods_on_one_map_with_outcomes():
    outcomes = {
        "traditional": plots.Outcome(Status.COLLIDED, 61.62, 16.86),
        "improved": plots.Outcome(Status.REACHED, 36.24, 14.69),
    }
    fig = draw_paths(outcomes=outcomes, goal_tolerance=0.5, title="radius 0.5 m")
    (ax,) = fig.axes
    assert ax.get_aspect() == 1.0
    assert_labelled(ax)
    assert ax.get_title() == "radius 0.5 m"
    assert legend_texts(fig) == [
        "start",
        "goal",
        "obstacle, expanded by r = 0.5 m",
        "traditional: collided, 61.6 s, 16.86 m",
        "improved: reached, 36.2 s, 14.69 m",
    ]
    circles, goal_ring = (c for c in ax.collections if isinstance(c, EllipseCollection))
    assert len(circles.get_offsets()) == 3
    np.testing.assert_allclose(circles.get_widths(), 1.0)
    np.testing.assert_allclose(goal_ring.get_offsets(), [GOAL])
    assert_inside(fig)


def test_paths_without_outcomes_say_the_length_drawn():
    fig = draw_paths(trajectories={"improved": LINE})
    assert legend_texts(fig)[-1] == "improved: 14.14 m"


def test_paths_ignore_padding_of_tracks_and_obstacles():
    padded = np.vstack([LINE, np.full((9, 5), np.nan)])
    far = np.vstack([OBSTACLES, [(1e6, 1e6), (np.nan, np.nan)]])
    fig = draw_paths(trajectories={"improved": padded}, obstacles=far)
    (ax,) = fig.axes
    assert legend_texts(fig)[-1] == "improved: 14.14 m"
    assert -1 < ax.get_xlim()[0] < 0
    assert 10 < ax.get_xlim()[1] < 12
    assert any(np.array_equal(line.get_xydata(), LINE[:, :2]) for line in ax.lines)


def test_paths_without_any_obstacle_have_no_entry_for_them():
    fig = draw_paths(obstacles=np.empty((0, 2)))
    assert not any("obstacle" in text for text in legend_texts(fig))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"trajectories": {}}, "trajectories is empty"),
        ({"trajectories": {"a": LINE[0]}}, r"trajectory 'a' has shape \(5,\)"),
        ({"trajectories": {"a": np.full((3, 5), np.nan)}}, "'a' has no finite position"),
        ({"obstacles": OBSTACLES[0]}, r"obstacles has shape \(2,\)"),
        ({"radius": -0.1}, "radius is -0.1"),
        ({"radius": np.nan}, "radius is nan"),
        ({"outcomes": {"other": plots.Outcome(1, 1.0, 1.0)}}, "outcomes names 'other'"),
        ({"outcomes": {"improved": plots.Outcome(9, 1.0, 1.0)}}, "status is 9"),
    ],
)
def test_paths_refuse(changes, message):
    with pytest.raises(BadInputError, match=message):
        draw_paths(**changes)


# --- tables -----------------------------------------------------------------------------------


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


@settings(max_examples=40, deadline=None)
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


# --- chart ------------------------------------------------------------------------------------


def lake():
    blocked = np.ones((30, 40), bool)
    blocked[5:25, 5:35] = False
    return GridMap(blocked, cell_size=250.0, origin=(1000.0, 2000.0), attribution="Shore: X, L")


def lake_tracks(count=40):
    tracks = np.full((count, 20, 5), np.nan)
    tracks[:, :15] = np.linspace([3000.0, 4000, 0, 0, 0], [8000.0, 7000, 0, 0, 0], 15)
    return tracks


def test_chart_counts_all_episodes_and_draws_some():
    status = np.repeat([1, 2, 3, 4], 10)
    fig = plots.plot_chart(lake(), lake_tracks(), status, max_paths=20, title="Lake")
    (ax,) = fig.axes
    assert ax.get_aspect() == 1.0
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x, east (km)", "y, north (km)")
    assert ax.get_title() == "Lake: 20 of 40 episodes drawn"
    endings = ("reached", "collided", "stuck", "timed out")
    assert legend_texts(fig) == [f"{name} 10 (25.0 %)" for name in endings]
    lines = [c for c in ax.collections if isinstance(c, LineCollection)]
    assert [len(c.get_segments()) for c in lines] == [5, 5, 5, 5]
    np.testing.assert_allclose(lines[0].get_segments()[0][[0, -1]], [(3, 4), (8, 7)])
    assert {"5 km", "2 km", "1 km"} & {text.get_text() for text in ax.texts}
    assert {"N", "Shore: X, L"} <= {text.get_text() for text in ax.texts}
    assert_inside(fig)


def test_chart_has_north_up_and_land_where_it_is():
    grid = lake()
    fig = plots.plot_chart(grid, lake_tracks(1), [1])
    (image,) = fig.axes[0].images
    assert image.origin == "lower"
    np.testing.assert_array_equal(image.get_array(), grid.blocked)
    np.testing.assert_allclose(image.get_extent(), (1.0, 11.0, 2.0, 9.5))


def test_chart_shows_a_part_about_the_failures():
    tracks = lake_tracks(3)
    tracks[:, :, :2] += np.array([0.0, 0.0, -1500.0])[:, None, None]
    view = plots.chart.detail(lake(), tracks, [1, 1, 3], 1000.0)
    assert view == (6000.0, 7000.0, 5000.0, 6000.0)
    fig = plots.plot_chart(lake(), tracks, [1, 1, 3], view=view)
    np.testing.assert_allclose(fig.axes[0].get_xlim(), (6, 7))
    np.testing.assert_allclose(fig.axes[0].get_ylim(), (5, 6))
    assert legend_texts(fig) == ["reached 2 (66.7 %)", "stuck 1 (33.3 %)"]
    assert plots.chart.detail(lake(), tracks, [1, 1, 1], 1000.0) is None
    wide = plots.chart.detail(lake(), tracks, [1, 1, 3], 1e6)
    np.testing.assert_allclose(wide, lake().extent)


def test_chart_refuses():
    with pytest.raises(BadInputError, match=r"status has shape \(3,\)"):
        plots.plot_chart(lake(), lake_tracks(), [1, 2, 3])
    with pytest.raises(BadInputError, match="trajectories has shape"):
        plots.plot_chart(lake(), lake_tracks()[0], [1])
    with pytest.raises(BadInputError, match="status is 8"):
        plots.plot_chart(lake(), lake_tracks(1), [8])
    with pytest.raises(BadInputError, match="view is"):
        plots.plot_chart(lake(), lake_tracks(1), [1], view=(5.0, 5.0, 0.0, 1.0))
    with pytest.raises(BadInputError, match="max_paths is 0"):
        plots.plot_chart(lake(), lake_tracks(1), [1], max_paths=0)


# --- animation --------------------------------------------------------------------------------


def fake_decide(state):
    """A window of 3 x 4 candidates: straight paths of three points, one inadmissible."""
    v, w = state[3] + 0.1 * np.arange(3), state[4] + 0.1 * np.arange(-2, 2)
    reach = np.arange(3)[:, None] * np.ones(2)
    paths = state[:2] + reach * (v[:, None] + w)[..., None, None]
    score = np.arange(12.0).reshape(3, 4)
    admissible = np.ones((3, 4), bool)
    admissible[2, 3] = False
    score[2, 3] = -np.inf
    return SimpleNamespace(v=v, w=w, paths=paths, admissible=admissible, score=score, chosen=(2, 2))


def fake_braking(state):
    decision = fake_decide(state)
    nowhere = np.zeros((3, 4), bool)
    return SimpleNamespace(**{**vars(decision), "admissible": nowhere, "chosen": None})


def episode(**changes):
    states = LINE.copy()
    states[:, 3] = 0.5
    arguments = {
        "trajectory": states,
        "goal": GOAL,
        "obstacles": OBSTACLES,
        "radius": 0.5,
        "goal_tolerance": 0.5,
        "status": Status.REACHED,
        "title": "improved, job 3",
    }
    return plots.Episode(**{**arguments, **changes})


def test_a_decision_shows_the_fan_by_score_and_the_window():
    fig = plots.plot_decision(episode(), fake_decide, 10)
    whole, near, window = fig.axes[:3]
    assert whole.get_aspect() == near.get_aspect() == 1.0
    for ax in (whole, window):
        assert_labelled(ax)
    assert near.get_title() == "close-up, 4 m wide"
    for ax in (whole, near):
        bad, good = (c for c in ax.collections if isinstance(c, LineCollection))
        assert len(bad.get_segments()) == 1
        assert len(good.get_segments()) == 11
        assert len({tuple(colour) for colour in good.get_colors()}) == 11
    (cells,) = window.images
    assert cells.get_array().shape == (3, 4, 4)
    np.testing.assert_allclose(cells.get_array()[2, 3], style.mpl.colors.to_rgba("#D9D9D9"))
    (mark,) = window.patches
    assert mark.get_xy() == (1.5, 1.5)
    assert fig.get_suptitle() == "improved, job 3\nt = 1.0 s,  v = +0.50 m/s,  w =  0.00 rad/s"
    assert "inadmissible candidates" in legend_texts(fig)
    np.testing.assert_allclose(np.mean(near.get_xlim()), LINE[10, 0])
    assert_inside(fig)


def test_braking_and_the_end_are_said():
    view = plots.EpisodeView(episode(), fake_braking)
    assert "no admissible candidate" in view.fig.get_suptitle()
    assert len(view.window.patches) == 0
    view.show(len(LINE) - 1)
    assert view.fig.get_suptitle().endswith("reached")


def test_an_episode_ends_with_its_steps_or_its_padding():
    padded = np.vstack([LINE, np.full((5, 5), np.nan)])
    assert len(plots.EpisodeView(episode(trajectory=padded), fake_decide).states) == 41
    assert len(plots.EpisodeView(episode(steps=7), fake_decide).states) == 8


def test_a_decision_on_a_chart_draws_the_land():
    grid = lake()
    track = lake_tracks(1)[0]
    shown = episode(trajectory=track, goal=(8000, 7000), obstacles=np.empty((0, 2)), grid_map=grid)
    view = plots.EpisodeView(shown, fake_decide)
    assert len(view.map.images) == len(view.near.images) == 1


@settings(max_examples=100, deadline=None)
@given(st.integers(1, 5000), st.integers(1, 200))
def test_frames_are_few_even_and_include_both_ends(states, most):
    steps = frame_steps(states, most)
    assert steps[0] == 0
    assert steps[-1] == states - 1
    assert len(steps) <= max(most, 2)
    gaps = np.diff(steps)
    assert (gaps > 0).all()
    assert len(set(gaps[:-1].tolist())) <= 1


def test_an_animation_is_a_looping_gif(tmp_path):
    calls = []
    path = plots.animate_episode(
        episode(),
        fake_decide,
        tmp_path / "new" / "episode.gif",
        max_frames=4,
        dpi=60,
        progress=lambda done, total: calls.append((done, total)),
    )
    with Image.open(path) as image:
        assert image.n_frames == 4
        assert image.info["loop"] == 0
        assert image.width == pytest.approx(170 / 25.4 * 60, abs=1)
    assert calls == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert [p.name for p in path.parent.iterdir()] == ["episode.gif"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"path": "a.avi"}, "suffix '.avi' is not one of .gif, .mp4"),
        ({"max_frames": 0}, "max_frames is 0"),
        ({"fps": 0}, "fps is 0"),
        ({"dpi": 0}, "dpi is 0"),
        ({"episode": episode(trajectory=LINE[:, :3])}, "trajectory has shape"),
        ({"episode": episode(trajectory=LINE * np.nan)}, "no finite position"),
    ],
)
def test_an_animation_refuses_and_writes_nothing(tmp_path, monkeypatch, changes, message):
    monkeypatch.chdir(tmp_path)
    arguments = {"episode": episode(), "decide": fake_decide, "path": "a.gif"}
    with pytest.raises(BadInputError, match=message):
        plots.animate_episode(**{**arguments, **changes})
    assert not list(tmp_path.iterdir())


def test_mp4_without_ffmpeg_says_what_is_missing(tmp_path, monkeypatch):
    monkeypatch.setattr("usvjax.plots.animation.FFMpegWriter.isAvailable", lambda: False)
    with pytest.raises(BadInputError, match="needs ffmpeg"):
        plots.animate_episode(episode(), fake_decide, tmp_path / "a.mp4")


def test_a_step_that_is_not_there_is_refused():
    with pytest.raises(BadInputError, match="step is 41; 0 to 40"):
        plots.plot_decision(episode(), fake_decide, 41)


# --- files and looks --------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".png", ".pdf", ".svg"])
def test_saving_twice_gives_the_same_bytes(tmp_path, suffix):
    first = plots.save(draw_paths(), tmp_path / f"a{suffix}")
    second = plots.save(draw_paths(), tmp_path / f"b{suffix}")
    assert first.read_bytes() == second.read_bytes()
    assert {p.name for p in tmp_path.iterdir()} == {f"a{suffix}", f"b{suffix}"}


def test_a_png_is_85_mm_at_200_dpi(tmp_path):
    path = plots.save(draw_paths(), tmp_path / "a.png")
    with Image.open(path) as image:
        assert image.width == pytest.approx(85 / 25.4 * 200, abs=1)


def test_a_failed_save_leaves_the_old_file_and_no_rubbish(tmp_path, monkeypatch):
    path = tmp_path / "a.png"
    path.write_text("old")
    fig = draw_paths()

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(fig, "savefig", full)
    with pytest.raises(BadInputError, match=r"cannot write .*a\.png: No space left on device"):
        plots.save(fig, path)
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.png"]


def test_save_refuses(tmp_path):
    fig = draw_paths()
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInputError, match=r"suffix '\.jpeg' is not one of"):
        plots.save(fig, tmp_path / "a.jpeg")
    with pytest.raises(BadInputError, match="dpi is 0"):
        plots.save(fig, tmp_path / "a.png", dpi=0)
    with pytest.raises(BadInputError, match="cannot write"):
        plots.save(fig, tmp_path / "file" / "a.png")


def test_methods_look_the_same_in_every_company():
    looks = style.method_looks(["improved", "traditional", "zeta", "alpha"])
    assert looks["improved"] == style.method_looks(["improved"])["improved"]
    assert len(set(looks.values())) == 4
    assert len({look.colour for look in looks.values()}) == 4


def test_drawing_leaves_the_users_settings_alone():
    before = dict(style.mpl.rcParams)
    draw_paths()
    assert dict(style.mpl.rcParams) == before


def test_importing_usvjax_does_not_load_matplotlib():
    import subprocess
    import sys

    code = "import sys, usvjax; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
