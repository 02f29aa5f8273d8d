"""Figures of routes: on charts, curvature, expanded cells, replanning, and those of a run."""

import math

import matplotlib.colors
import numpy as np
import polars as pl
import pytest
from figure_checks import assert_inside, assert_labelled, legend_texts, texts_of
from figure_kinds import check_figure
from PIL import Image

from usvjax import plots
from usvjax.cli import main
from usvjax.errors import BadInputError
from usvjax.maps import GridMap, random_maps, save_map
from usvjax.missions.route import expanded, replanning
from usvjax.missions.route.figures import ROUTES
from usvjax.plots import style
from usvjax.plots.distributions import BOXES
from usvjax.plots.film import write_film
from usvjax.plots.methods import plot_methods
from usvjax.plots.route import busiest, closeup_width, length_words, view_around
from usvjax.report.sheets import text_of
from usvjax.search.astar import astar
from usvjax.search.replanning import dstar_lite
from usvjax.study import load_run, load_spec, run_study
from usvjax.study.figures import figures_for_run
from usvjax.study.report import terminal
from usvkernels.status import Status

SIZE = 20.0
ROUTE = np.array([[110.0, 50], [110, 250], [150, 290], [330, 290]])


pytestmark = pytest.mark.usefixtures("one_device")


def chart():
    blocked = np.zeros((16, 20), bool)
    blocked[:10, 7] = True
    return GridMap(blocked, SIZE, (50.0, 0.0), "Pond", "Survey: X")


def lines_of(ax):
    return {line.get_label(): line for line in ax.lines}


def test_routes_are_drawn_where_they_are_with_their_lengths():
    smooth = np.vstack([ROUTE, np.full((3, 2), np.nan)])
    fig = plots.plot_routes(chart(), {"astar": ROUTE, "smoothed": smooth}, title="T")
    (ax,) = fig.axes
    assert ax.get_aspect() == 1.0
    drawn = [line.get_xydata() for line in ax.lines if len(line.get_xydata()) == 4]
    np.testing.assert_array_equal(drawn, [ROUTE, ROUTE])
    length = 200 + 40 * math.sqrt(2) + 180
    assert f"astar: {length:.4g} m" in legend_texts(fig)
    assert {"start", "goal"} <= set(legend_texts(fig))
    assert {"N", "Survey: X"} <= texts_of(ax)
    west, east = ax.get_xlim()
    assert west < 110 < 330 < east
    assert_labelled(ax)
    assert_inside(fig)


def test_a_close_up_frames_the_turns_and_shows_the_turning_circle():
    fig = plots.plot_routes(chart(), {"astar": ROUTE}, closeup=120.0, turning_radius=25.0)
    whole, near = fig.axes
    assert near.get_xlim()[1] - near.get_xlim()[0] == pytest.approx(120.0)
    for x, y in ROUTE[1:3]:
        assert near.get_xlim()[0] < x < near.get_xlim()[1]
        assert near.get_ylim()[0] < y < near.get_ylim()[1]
    assert [p.radius for p in near.patches if hasattr(p, "radius")] == [25.0]
    assert "turning circle, R = 25 m" in legend_texts(fig)
    assert "framed part, 120 m wide" in near.get_title()
    (frame,) = whole.patches
    assert frame.get_width() == pytest.approx(120.0)
    assert_inside(fig)


def test_a_close_up_is_left_out_where_it_would_be_most_of_the_chart():
    wide = GridMap(np.zeros((90, 90), bool), SIZE)
    diagonal = [np.array([[100.0, 100.0], [1700.0, 1700.0]])]
    assert closeup_width(wide, diagonal, None) == 24 * SIZE
    assert closeup_width(wide, diagonal, 40.0) == 640.0
    assert closeup_width(wide, diagonal, 80.0) is None
    assert closeup_width(chart(), [ROUTE], None) is None


def test_the_busiest_part_is_where_the_line_turns_most():
    zigzag = np.column_stack([np.arange(12) * 10.0, np.zeros(12)])
    zigzag[8:11, 1] = (5.0, -5.0, 5.0)
    west, east, south, north = busiest(zigzag, 40.0)
    assert west < 80 < 100 < east
    assert east - west == north - south == 40.0
    assert busiest(np.array([[3.0, 4.0], [9.0, 4.0]]), 2.0) == (2.0, 4.0, 3.0, 5.0)


def test_a_view_stays_on_the_map_and_is_not_a_sliver():
    west, east, south, north = view_around(chart(), [np.array([[60.0, 10.0], [420.0, 10.0]])])
    assert (west, south) == (50.0, 0.0)
    assert east <= 450.0
    assert north - south >= 0.3 * (east - west)


def test_many_routes_share_a_chart():
    fig = plots.plot_route_chart(chart(), [ROUTE, ROUTE[::-1], ROUTE[:2]], title="Three")
    assert legend_texts(fig) == ["3 routes", "start", "goal"]
    starts = lines_of(fig.axes[0])["start"].get_xydata()
    np.testing.assert_array_equal(starts, [ROUTE[0], ROUTE[-1], ROUTE[0]])
    assert_inside(fig)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: plots.plot_routes(chart(), {}), "routes is empty"),
        (lambda: plots.plot_route_chart(chart(), []), "routes is empty"),
        (lambda: plots.plot_routes(chart(), {"a": ROUTE}, closeup=0.0), "closeup is 0"),
        (lambda: plots.plot_routes(chart(), {"a": ROUTE[:, :1]}), "trajectory 'a' has shape"),
        (lambda: plots.plot_curvature({}, 5.0), "routes is empty"),
        (lambda: plots.plot_curvature({"a": plots.bends_of(ROUTE)}, 0.0), "turning_radius is 0"),
        (lambda: plots.bends_of(ROUTE, [0.0]), "curvature has 1 values; 4 were wanted"),
        (lambda: expanded.plot_expanded(chart(), []), "searches holds 0"),
        (lambda: expanded.expanded_cells(chart(), [0, 0], [9, 9], heuristics=()), "is empty"),
        (
            lambda: expanded.expanded_cells(chart(), [0, 0], [9, 9], heuristics=("manhattan",)),
            "heuristics: got 'manhattan'",
        ),
    ],
)
def test_figures_refuse_what_they_cannot_draw(call, words):
    with pytest.raises(BadInputError, match=words):
        call()


@pytest.mark.parametrize("wide", [False, True])
def test_many_routes_have_a_chart_each(wide):
    shift = np.array([[0.0, 10.0 * i] for i in range(5)])
    flat = ROUTE * [1.0, 0.2] if wide else ROUTE
    ways = {name: flat + shift[i] for i, name in enumerate(("a", "b", "astar", "c", "smoothed"))}
    fig = plots.plot_routes(chart(), ways, closeup=60.0, turning_radius=10.0, title="Five")
    whole, near = fig.axes[:5], fig.axes[5:]
    assert len(near) == 5
    for axes in (whole, near):
        assert [ax.get_title() for ax in axes] == list(ways)
        for ax, (name, way) in zip(axes, ways.items(), strict=True):
            colour = style.method_looks(ways)[name].colour
            (own,) = (x for x in ax.lines if x.get_color() == colour and len(x.get_xdata()) > 2)
            np.testing.assert_array_equal(own.get_xydata(), way)
            others = [x for x in ax.lines if x.get_color() == style.GREY]
            assert len(others) == 4
            assert own.get_zorder() > max(other.get_zorder() for other in others)
    check_figure(fig)


def test_routes_that_are_the_same_can_be_told_apart():
    way = {"astar": ROUTE, "weighted": ROUTE.copy(), "smoothed": ROUTE[::3]}
    fig = plots.plot_routes(chart(), way)
    texts = legend_texts(fig)
    assert sum(text.endswith("(same as astar)") for text in texts) == 1
    assert texts[3] == "weighted: 436.6 m (same as astar)"
    widths = [line.get_linewidth() for line in fig.axes[0].lines if len(line.get_xdata()) > 1]
    assert widths[0] > widths[1] == widths[2]


def test_lengths_have_the_same_digits():
    words = [length_words(m) for m in (145_000.0, 152_910.0, 5000.0, 4999.0, 120.0)]
    assert words == ["145.0 km", "152.9 km", "5.000 km", "4999 m", "120.0 m"]


def test_expanded_cells_bound_what_the_searches_expand():
    blocked = random_maps(5, 1, (16, 16), 0.25)[0]
    blocked[1, 1] = blocked[14, 13] = False
    grid = GridMap(blocked, SIZE)
    searches = expanded.expanded_cells(grid, [1, 1], [13, 14], heuristics=("zero", "octile"))
    zero, octile = searches
    for search in searches:
        least = int(search.surely.sum())
        assert least <= search.expanded <= least + int(search.on_tie.sum())
        assert not (search.surely & search.on_tie).any()
        assert not ((search.surely | search.on_tie) & blocked).any()
        on_path = search.surely | search.on_tie
        assert all(on_path[y, x] for x, y in search.path)
    assert zero.cost == octile.cost
    assert octile.surely.sum() < zero.surely.sum()
    fig = expanded.plot_expanded(grid, searches, title="Cells")
    assert len(fig.axes) == 2
    shade = fig.axes[0].images[1].get_array()
    np.testing.assert_array_equal(~np.ma.getmaskarray(shade), zero.surely | zero.on_tie)
    assert f"{octile.expanded:,} expanded" in fig.axes[1].get_title()
    assert_inside(fig)


@pytest.fixture(scope="module", params=[None, (5, 7)], ids=["all known", "sensing"])
def episode(request):
    """A vessel that replans; the goal is walled in for a while, and one cell flips twice."""
    rng = np.random.default_rng(3)
    blocked = random_maps(2, 1, (12, 14), 0.2)[0]
    blocked[0, 0] = blocked[11, 13] = False
    flips = rng.integers(0, (14, 12), (24, 4, 2))
    flips[::2, 2:] = -1
    flips[4, 0] = flips[4, 1]
    flips[6, :3] = flips[9, :3] = ((12, 10), (12, 11), (13, 10))
    flips[7, 0] = (13, 11)
    result = dstar_lite(blocked, [0, 0], [13, 11], flips, sensing=request.param)
    row = (result.position[0], [13, 11], result.cost_to_go[0], result.expanded[0])
    grid = GridMap(blocked, SIZE)
    return replanning.replanning_of(grid, flips, *row, sensing=request.param, title="Pond")


def test_what_the_vessel_knew_explains_its_costs(episode):
    wanted = astar(episode.known, episode.position, episode.goal, on_blocked="status").cost
    np.testing.assert_allclose(wanted, episode.cost_to_go, rtol=1e-6)
    for path, cost, place in zip(episode.ahead, episode.cost_to_go, episode.position, strict=True):
        assert (len(path) == 0) == np.isinf(cost)
        if len(path):
            assert path[0].tolist() == place.tolist()
    assert len({path.tobytes() for path in episode.known}) > 5


def test_the_film_shows_every_move_until_arrival(episode, tmp_path):
    file = tmp_path / "film.gif"
    seen = []
    write_film(
        replanning.replanning_film(episode),
        file,
        max_frames=5,
        fps=5,
        dpi=40,
        progress=lambda *at: seen.append(at),
    )
    with Image.open(file) as film:
        assert film.n_frames == len(seen) <= 6
    assert seen[-1][0] == seen[-1][1]
    for change, words in (({"fps": 0}, "fps is 0"), ({"dpi": 0}, "dpi is 0")):
        with pytest.raises(BadInputError, match=words):
            write_film(replanning.replanning_film(episode), file, **change)


def test_a_step_shows_what_is_known_and_what_changed(episode):
    film = replanning.replanning_film(episode)
    film.show(5)
    fig = film.fig
    shown = fig.axes[0]
    np.testing.assert_array_equal(shown.images[0].get_array(), episode.known[5])
    before, now = episode.known[4], episode.known[5]
    fresh = {
        matplotlib.colors.to_hex(c.get_facecolor()[0]): len(c.get_paths())
        for c in shown.collections
        if len(c.get_paths()) and c.get_facecolor().size
    }
    counts = {style.VERMILLION: (now & ~before).sum(), style.GREEN: (before & ~now).sum()}
    assert fresh == {k.lower(): n for k, n in counts.items() if n}
    assert "move 5:" in fig.get_suptitle()
    assert ("sensing window" in legend_texts(fig)) is (episode.sensing is not None)
    with pytest.raises(BadInputError, match="step is 99"):
        film.show(99)


def test_replanning_refuses_flips_of_another_episode(episode):
    grid, way = episode.grid_map, episode.position
    rest = ([13, 11], episode.cost_to_go, episode.expanded)
    with pytest.raises(BadInputError, match=r"flips has shape \(3, 1, 2\); \(24, C, 2\)"):
        replanning.replanning_of(grid, np.zeros((3, 1, 2), int), way, *rest)
    with pytest.raises(BadInputError, match=r"position has shape \(25,\)"):
        replanning.replanning_of(grid, np.zeros((24, 1, 2), int), way[:, 0], *rest)


STUDY = """
name = "pond"
kind = "route"
episodes = 12
shard = 12
methods = ["astar", "smoothed"]
[maps]
source = "grid"
map = "pond.map"
ends = "free"
min_distance = 60.0
[smoothing]
turning_radius = 12.0
repair = 0
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    blocked = chart().blocked.copy()
    blocked[:, 17] = True
    save_map(GridMap(blocked, SIZE), folder / "pond.map")
    (folder / "pond.toml").write_text(STUDY)
    return run_study(load_spec(folder / "pond.toml"), folder / "runs", devices=1).path


def test_a_run_gives_its_figures(run):
    folder = run.parent.parent
    written = figures_for_run(run, folder=folder, max_paths=5)
    names = ["methods.png", "routes-c0.png", "curvature-c0.png", "chart-c0.png"]
    assert [path.name for path in written] == names
    assert all(Image.open(path).size[0] > 1000 for path in written)


def test_a_run_of_routes_has_a_film_and_a_track(run, tmp_path):
    folder = ["--folder", str(run.parent.parent)]
    gif, track = tmp_path / "route.gif", tmp_path / "route.csv"
    assert main(["animate", str(run), *folder, "--max-frames", "3", "--out", str(gif)]) == 0
    with Image.open(gif) as film:
        assert film.n_frames == 3
    assert main(["export", str(run), *folder, "--out", str(track)]) == 0
    rows = pl.read_csv(track)
    assert rows.columns == ["job", "distance_m", "vessel", "x_m", "y_m"]
    sailed = np.hypot(rows["x_m"].diff()[1:], rows["y_m"].diff()[1:]).sum()
    assert rows["distance_m"][-1] == pytest.approx(sailed)


def test_the_tables_of_a_run_fit_80_columns(run):
    shown = text_of(terminal(load_run(run).summary()), 80)
    assert "Unreachable" in shown
    assert "Out of budget" not in shown
    assert max(map(len, shown.splitlines())) <= 80


def test_a_run_on_another_map_is_not_drawn(run, tmp_path):
    save_map(chart(), tmp_path / "pond.map")
    with pytest.raises(BadInputError, match=r"pond\.map is not what"):
        figures_for_run(run, folder=tmp_path)


def test_methods_are_compared_on_queries_that_all_solved(run):
    opened = load_run(run)
    table = opened.table()
    lost = table["status"] == Status.UNREACHABLE
    assert 0 < lost.sum() < len(table)
    fig = plot_methods(table, opened.methods, compared=ROUTES, title="pond")
    solved = table.filter(pl.col("status") == Status.FOUND)["job"].n_unique()
    title = f"pond: boxes over the {solved} of 12 queries that every method solved"
    assert fig.get_suptitle() == f"{title}\n({BOXES})"
    share = {round(float(c.lines[0].get_ydata()[0]), 6) for c in fig.axes[0].containers}
    assert share == {round(100 * solved / 12, 6)}
    ticks = [label.get_text() for label in fig.axes[1].get_xticklabels()]
    assert ticks == ["astar", "smoothed"]
    assert_inside(fig)
    with pytest.raises(BadInputError, match="table has no column 'turns'"):
        plot_methods(table.drop("turns"), opened.methods, compared=ROUTES)
    with pytest.raises(BadInputError, match="table is empty"):
        plot_methods(table.clear(), opened.methods, compared=ROUTES)


def test_methods_over_several_conditions_have_a_legend():
    rows = [
        {
            "condition": c,
            "job": j,
            "method": m,
            "status": int(Status.UNREACHABLE if c == 2 and j < 2 else Status.FOUND),
            "ratio": 1.0 + 0.01 * j,
            "turns": j,
            "expanded": 10 + j,
        }
        for c in range(3)
        for j in range(6)
        for m in ("astar", "turning")
    ]
    fig = plot_methods(
        pl.DataFrame(rows),
        ["astar", "turning"],
        compared=ROUTES,
        labels={c: f"density 0.{c}" for c in range(3)},
    )
    assert legend_texts(fig) == ["astar", "turning"]
    ticks = [label.get_text() for label in fig.axes[3].get_xticklabels()]
    assert ticks == [f"density 0.{c}\nn = {n}" for c, n in enumerate((6, 6, 4))]
    shares = [label.get_text() for label in fig.axes[0].get_xticklabels()]
    assert shares == ["density 0.0", "density 0.1", "density 0.2"]
    assert (
        fig.get_suptitle() == f"boxes over the n of 6 queries that every method solved\n({BOXES})"
    )
    assert_inside(fig)
