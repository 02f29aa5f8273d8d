"""Every function that draws keeps what every figure keeps."""

import numpy as np
import pytest
from figure_checks import lake
from figure_kinds import check_figure
from matplotlib.figure import Figure
from plot_calls import plot_calls

import usvjax.missions.cruise.looks
import usvjax.missions.dwa.looks
import usvjax.missions.fleet.looks
import usvjax.missions.route.looks
from usvjax import plots
from usvjax.missions.cruise.chart import TRACK_ID
from usvjax.plots import style
from usvjax.plots.labels import LABEL_ID


@pytest.mark.parametrize("name", [n for n in plot_calls(None) if n.startswith("plot_")])
def test_every_figure_is_explained_and_whole(name, tmp_path):
    call = plot_calls(tmp_path)[name]
    fig = call.function(**call.arguments)
    assert isinstance(fig, Figure)
    check_figure(fig)


def drawn():
    """A chart of one route with everything about it."""
    return plots.plot_routes(lake(), {"astar": np.array([[3000.0, 4000.0], [8000.0, 7000.0]])})


def leave_out(fig):
    fig.axes[0].plot([4000, 5000], [5000, 5000], color=style.PURPLE)


def list_too_much(fig):
    style.outside_legend(fig, [style.method_handle(style.Look(style.PURPLE, "-", "o"), "b")], 1)


def forget_a_unit(fig):
    fig.axes[0].set_xlabel("x")


def cover_the_map(fig):
    fig.axes[0].annotate("source", (4000, 5000))


def cover_the_track(fig):
    (line,) = (x for x in fig.axes[0].lines if len(x.get_xdata()) > 1)
    line.set_gid(TRACK_ID)
    fig.axes[0].annotate("1234", line.get_xydata().mean(axis=0), gid=LABEL_ID)


def cut_the_title(fig):
    fig.set_layout_engine("none")
    fig.suptitle("long " * 50)


def end_too_early(fig):
    fig.axes[0].set_aspect("auto")
    fig.axes[0].set_xlim(3000, 4000)


@pytest.mark.parametrize(
    "spoil",
    [
        leave_out,
        list_too_much,
        forget_a_unit,
        cover_the_map,
        cover_the_track,
        cut_the_title,
        end_too_early,
    ],
)
def test_the_check_sees_what_is_wrong(spoil):
    fig = drawn()
    check_figure(fig)
    spoil(fig)
    with pytest.raises(AssertionError):
        check_figure(fig)


@pytest.mark.parametrize(
    "looks",
    [
        usvjax.missions.cruise.looks,
        usvjax.missions.dwa.looks,
        usvjax.missions.fleet.looks,
        usvjax.missions.route.looks,
    ],
)
def test_methods_of_a_mission_can_be_told_apart_in_grey(looks):
    marks = [look.marker for look in looks.LOOKS.values()]
    assert len(set(marks)) == len(marks)
