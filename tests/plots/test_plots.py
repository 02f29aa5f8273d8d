"""Figures: what they show and label, what they refuse, and that files are whole or absent."""

import numpy as np
import pytest
from figure_checks import (
    GOAL,
    LINE,
    OBSTACLES,
    assert_inside,
    assert_labelled,
    lake,
    lake_tracks,
    legend_texts,
    texts_of,
    tick_numbers,
    tracks_of,
)
from matplotlib.collections import EllipseCollection
from PIL import Image

import usvjax.missions.dwa.looks  # noqa: F401
from usvjax import plots
from usvjax.errors import BadInputError
from usvjax.plots import style
from usvkernels.status import Status

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


def test_paths_show_both_methods_on_one_map_with_endings():
    endings = {
        "traditional": plots.Ending(Status.COLLIDED, 61.62, 16.86),
        "improved": plots.Ending(Status.REACHED, 36.24, 14.69),
    }
    fig = draw_paths(endings=endings, goal_tolerance=0.5, title="radius 0.5 m")
    (ax,) = fig.axes
    assert ax.get_aspect() == 1.0
    assert_labelled(ax)
    assert ax.get_title() == "radius 0.5 m"
    assert legend_texts(fig) == [
        "start",
        "goal, reached within 0.5 m",
        "obstacle, expanded by r = 0.5 m",
        "traditional: collided, 61.6 s, 16.86 m",
        "improved: reached, 36.2 s, 14.69 m",
    ]
    circles, goal_ring = (c for c in ax.collections if isinstance(c, EllipseCollection))
    assert len(circles.get_offsets()) == 3
    np.testing.assert_allclose(circles.get_widths(), 1.0)
    np.testing.assert_allclose(goal_ring.get_offsets(), [GOAL])
    assert_inside(fig)


def test_paths_without_endings_say_the_length_drawn():
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
        ({"radius": np.nan}, "radius: got nan"),
        ({"endings": {"other": plots.Ending(1, 1.0, 1.0)}}, "endings names 'other'"),
    ],
)
def test_paths_refuse(changes, message):
    with pytest.raises(BadInputError, match=message):
        draw_paths(**changes)


# --- chart ------------------------------------------------------------------------------------


def test_chart_counts_all_episodes_and_draws_some():
    status = np.repeat([1, 2, 3, 4], 10)
    fig = plots.plot_chart(lake(), lake_tracks(), status, max_paths=20, title="Lake")
    (ax,) = fig.axes
    assert ax.get_aspect() == 1.0
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x, east (km)", "y, north (km)")
    assert tick_numbers(ax)[[0, -1]].tolist() == [2.0, 10.0]
    assert ax.get_title() == "Lake\n20 of 40 episodes drawn, marks where they ended; counts of all"
    endings = ("reached", "collided", "stuck", "timed out")
    assert legend_texts(fig) == [f"{name} 10 (25.0 %)" for name in endings]
    lines = tracks_of(ax)
    assert [len(c.get_segments()) for c in lines] == [5, 5, 5, 5]
    np.testing.assert_allclose(lines[0].get_segments()[0][[0, -1]], [(3000, 4000), (8000, 7000)])
    assert {"N", "2 km", "Shore: X, L"} <= texts_of(ax)
    assert_inside(fig)


def test_the_legend_has_the_endings_drawn_with_the_rates_of_all():
    every = np.repeat([1, 2, 3, 4], [1500, 460, 39, 1])
    sample = np.repeat([1, 3], [30, 10])
    fig = plots.plot_chart(lake(), lake_tracks(), sample, sample_of=every, title="Lake")
    assert legend_texts(fig) == ["reached 1,500 (75.0 %)", "stuck 39 (1.9 %)"]
    assert fig.axes[0].get_title().split("\n") == [
        "Lake",
        "40 of 2,000 episodes drawn, marks where they ended; counts of all",
        "not among these: collided 460 (23.0 %), timed out 1 (0.05 %)",
    ]


def test_chart_has_north_up_and_land_where_it_is():
    grid = lake()
    fig = plots.plot_chart(grid, lake_tracks(1), [1])
    (image,) = fig.axes[0].images
    assert image.origin == "lower"
    np.testing.assert_array_equal(image.get_array(), grid.blocked)
    np.testing.assert_allclose(image.get_extent(), (1000, 11000, 2000, 9500))


def test_chart_shows_a_part_about_the_failures():
    tracks = lake_tracks(3)
    tracks[:, :, :2] += np.array([0.0, 0.0, -1500.0])[:, None, None]
    view = plots.chart.detail(lake(), tracks, [1, 1, 3], 1000.0)
    assert view == (6000.0, 7000.0, 5000.0, 6000.0)
    fig = plots.plot_chart(lake(), tracks, [1, 1, 3], view=view)
    np.testing.assert_allclose(fig.axes[0].get_xlim(), (6000, 7000))
    np.testing.assert_allclose(fig.axes[0].get_ylim(), (5000, 6000))
    assert fig.axes[0].get_xlabel() == "x, east (m)"
    assert "200 m" in texts_of(fig.axes[0])
    assert legend_texts(fig) == ["reached 2 (66.7 %)", "stuck 1 (33.3 %)"]
    tracks[0, :, :2] += 3000.0
    fig = plots.plot_chart(lake(), tracks, [4, 1, 3], view=view)
    assert legend_texts(fig) == ["reached 1 (33.3 %)", "stuck 1 (33.3 %)"]
    assert fig.axes[0].get_title().startswith("2 of 3 episodes drawn")
    assert fig.axes[0].get_title().endswith("\nnot among these: timed out 1 (33.3 %)")
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


# --- files and looks --------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".png", ".pdf", ".svg", ".PDF", ".SVG"])
def test_saving_twice_gives_the_same_bytes(tmp_path, suffix):
    first = plots.save(draw_paths(), tmp_path / f"a{suffix}")
    second = plots.save(draw_paths(), tmp_path / f"b{suffix}")
    assert first.read_bytes() == second.read_bytes()
    assert {p.name for p in tmp_path.iterdir()} == {f"a{suffix}", f"b{suffix}"}


def test_a_png_is_85_mm_at_200_dpi(tmp_path):
    path = plots.save(draw_paths(), tmp_path / "a.png")
    with Image.open(path) as image:
        assert image.width == pytest.approx(85 / 25.4 * 200, abs=1)


@pytest.mark.parametrize(
    ("name", "wanted"),
    [("a", "a.pdf"), ("a.png", "a.pdf"), ("a.pdf", "a.pdf"), ("r 0.5", "r 0.5.pdf")],
)
def test_a_format_asked_for_chooses_the_suffix(tmp_path, name, wanted):
    path = plots.save(draw_paths(), tmp_path / name, format="pdf")
    assert path == tmp_path / wanted
    assert path.read_bytes().startswith(b"%PDF")


def test_text_of_a_vector_file_needs_no_font_of_the_reader(tmp_path):
    fig = draw_paths()
    assert b"/FontFile2" in plots.save(fig, tmp_path / "a", format="pdf").read_bytes()
    assert b"<text" not in plots.save(fig, tmp_path / "a", format="svg").read_bytes()


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
    with pytest.raises(BadInputError, match="format: got 'jpeg'"):
        plots.save(fig, tmp_path / "a", format="jpeg")
    for dpi in (0, 19, 1201):
        with pytest.raises(BadInputError, match=f"dpi is {dpi}; 20 to 1200 was wanted"):
            plots.save(fig, tmp_path / "a.png", dpi=dpi)
    with pytest.raises(BadInputError, match="cannot write"):
        plots.save(fig, tmp_path / "file" / "a.png")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_methods_look_the_same_in_every_company():
    looks = style.method_looks(["improved", "traditional", "zeta", "alpha"])
    assert looks["improved"] == style.method_looks(["improved"])["improved"]
    assert len(set(looks.values())) == 4
    assert len({look.colour for look in looks.values()}) == 4


def test_drawing_leaves_the_users_settings_alone():
    before = dict(style.mpl.rcParams)
    draw_paths()
    assert dict(style.mpl.rcParams) == before


@pytest.mark.parametrize(
    "load",
    [
        "import usvjax",
        "import importlib, pkgutil, usvjax.maps\n"
        "for module in pkgutil.iter_modules(usvjax.maps.__path__, 'usvjax.maps.'):\n"
        "    importlib.import_module(module.name)",
    ],
    ids=["usvjax", "every module of maps"],
)
def test_importing_what_draws_nothing_does_not_load_matplotlib(load):
    import subprocess
    import sys

    code = f"import sys\n{load}\nsys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_powers_of_ten_are_labelled_alike():
    fig = style.new_figure(90.0, 60.0)
    axis = fig.add_subplot().yaxis
    axis.axes.set_yscale("log")
    axis.axes.set_ylim(0.005, 2e6)
    style.plain_powers(axis)
    assert [axis.get_major_formatter()(10.0**n) for n in range(-2, 7)] == [
        *("0.01", "0.1", "1", "10", "100"),
        *("1,000", "10,000", "100,000", "1,000,000"),
    ]
