"""What every figure of the package keeps, whatever it shows; `check_figure` asks for all of it."""

import colorsys

import numpy as np
from figure_checks import assert_inside
from matplotlib.collections import LineCollection
from matplotlib.colors import to_hex, to_rgb
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.text import Annotation, Text
from mpl_toolkits.axes_grid1.anchored_artists import AnchoredSizeBar

from usvjax.missions.cruise.chart import TOUR_ID, TRACK_ID
from usvjax.plots import style
from usvjax.plots.base_map import SHORE_ID
from usvjax.plots.labels import LABEL_ID

# Of the samples of a track, at most so many may lie below the numbers of stations.
HIDDEN = 0.005


def check_figure(fig):
    """Whole, explained, and nothing that explains lies over what is shown."""
    assert_inside(fig)
    assert_legend_is_what_is_drawn(fig)
    assert_axes_are_named(fig)
    assert_axes_hold_their_lines(fig)
    assert_maps_are_not_covered(fig)
    assert_labels_hide_no_track(fig)


def is_hue(colour):
    """Whether it is more than black, grey or white."""
    return colorsys.rgb_to_hsv(*to_rgb(colour))[1] > 0.25


def looks_of(artists):
    """Hues of lines, marks and fillings."""
    found = set()
    for artist in artists:
        if not artist.get_visible():
            continue
        if isinstance(artist, Line2D):
            if artist.get_linestyle() not in ("None", "") and len(artist.get_xdata()) != 1:
                found.add(to_hex(artist.get_color()))
            if artist.get_marker() not in ("None", "", None):
                found.add(to_hex(artist.get_markerfacecolor()))
        elif isinstance(artist, LineCollection):
            found |= {to_hex(colour) for colour in artist.get_colors()}
        elif isinstance(artist, AxesImage):
            values = np.unique(np.ma.masked_invalid(artist.get_array()).compressed())
            if artist.get_array().ndim == 2:
                found |= {to_hex(colour) for colour in artist.cmap(artist.norm(values))}
        elif not hasattr(artist, "get_fill") or artist.get_fill():
            found |= {to_hex(colour) for colour in np.atleast_2d(artist.get_facecolor())}
    return {colour for colour in found if is_hue(colour)}


def drawn_in(fig):
    """Artists with data: lines, collections, patches and images; shores and scales left out."""
    return [
        artist
        for ax in fig.axes
        if ax.get_label() != "<colorbar>"
        for artist in (*ax.lines, *ax.collections, *ax.patches, *ax.images)
        if artist.get_gid() != SHORE_ID and not is_scale(artist)
    ]


def is_scale(artist):
    """Whether a colour bar explains its hues."""
    return getattr(artist, "colorbar", None) is not None


def handles_of(fig):
    return [handle for legend in fig.legends for handle in legend.legend_handles]


def named_beside(fig):
    """Hues of methods that titles or tick labels name, and of land and water, which need none."""
    texts = [
        text.get_text()
        for ax in fig.axes
        for text in (*ax.findobj(Text), *ax.get_xticklabels(), *ax.get_yticklabels())
    ]
    named = {name for name in style._METHODS if any(name in text for text in texts)}
    named |= {ax.get_title(loc="right").split(":")[0] for ax in fig.axes} - {""}
    looks = style.method_looks(named).values()
    hues = {to_hex(c) for look in looks for c in (look.colour, look.fill)}
    return hues | {to_hex(style.LAND), to_hex(style.WATER)}


def assert_legend_is_what_is_drawn(fig):
    """Every hue of the legend is drawn, and every hue that is drawn has its name."""
    drawn, listed = looks_of(drawn_in(fig)), looks_of(handles_of(fig))
    assert listed <= drawn, f"the legend lists {listed - drawn}, not drawn"
    left_out = drawn - listed - named_beside(fig)
    assert not left_out, f"{left_out} are drawn and not explained"
    shapes = {line.get_marker() for line in fig.findobj(Line2D) if line.axes is not None}
    for handle in handles_of(fig):
        if isinstance(handle, Line2D) and handle.get_linestyle() in ("None", ""):
            assert handle.get_marker() in shapes, f"no mark of {handle.get_label()!r} is drawn"
    lines = {
        (to_hex(line.get_color()), line.is_dashed())
        for line in drawn_in(fig)
        if isinstance(line, Line2D) and line.get_linestyle() not in ("None", "")
    }
    for handle in handles_of(fig):
        if isinstance(handle, Line2D) and handle.is_dashed():
            pair = (to_hex(handle.get_color()), True)
            patches = [p for ax in fig.axes for p in ax.patches if p.get_linestyle() != "solid"]
            assert pair in lines or patches, f"no broken line of {handle.get_label()!r} is drawn"


def is_map(ax):
    return ax.get_aspect() == 1.0 and ax.name != "polar"


def assert_axes_are_named(fig):
    """Both axes of a map have a unit; of others, each says what it is, or one that shares it."""
    maps = [ax for ax in fig.axes if is_map(ax)]
    if maps:
        for axis in ("x", "y"):
            labels = {getattr(ax, f"get_{axis}label")() for ax in maps} - {""}
            assert labels, f"no map names its {axis} axis"
            assert all(label.endswith(("(m)", "(km)")) for label in labels), labels
    others = [ax for ax in fig.axes if not is_map(ax)]
    assert not others or any(ax.get_ylabel() for ax in others)


def assert_axes_hold_their_lines(fig):
    """No line or mark ends beyond the axes, unless it is said or the axes show a part of a map."""
    for ax in fig.axes:
        if is_map(ax) or any("beyond" in text.get_text() for text in ax.texts):
            continue
        for line in ax.lines:
            if line.get_transform() != ax.transData or not len(line.get_xdata()):
                continue
            for limits, data in (
                (ax.get_xlim(), line.get_xdata()),
                (ax.get_ylim(), line.get_ydata()),
            ):
                low, high = sorted(limits)
                room = 1e-6 * (high - low)
                data = np.asarray(data, float)
                assert not (data < low - room).any(), (line, limits)
                assert not (data > high + room).any(), (line, limits)


def assert_maps_are_not_covered(fig):
    """Scale bar, arrow and source lie outside of every map, and apart."""
    explaining = [
        artist
        for ax in fig.axes
        for artist in (*ax.findobj(AnchoredSizeBar), *ax.findobj(Annotation))
        if isinstance(artist, AnchoredSizeBar) or not is_inside(artist)
    ]
    for i, artist in enumerate(explaining):
        box = artist.get_window_extent()
        assert not any(box.overlaps(ax.get_window_extent()) for ax in fig.axes), artist
        assert not any(box.overlaps(other.get_window_extent()) for other in explaining[:i]), artist


def is_inside(annotation):
    """Labels of places and arrowheads on tracks belong to the map."""
    return annotation.get_gid() == LABEL_ID or not annotation.get_text()


def assert_labels_hide_no_track(fig):
    for ax in fig.axes:
        tracks = [line for line in ax.lines if line.get_gid() in (TRACK_ID, TOUR_ID)]
        labels = [text for text in ax.texts if text.get_gid() == LABEL_ID]
        if not tracks or not labels:
            continue
        points = np.concatenate([samples(ax, line.get_xydata()) for line in tracks])
        boxes = [Text.get_window_extent(label).extents for label in labels]
        hidden = [((points > box[:2]) & (points < box[2:])).all(axis=1) for box in boxes]
        assert np.mean(np.any(hidden, axis=0)) <= HIDDEN
        for i, label in enumerate(labels):
            box = Text.get_window_extent(label)
            assert not any(box.overlaps(Text.get_window_extent(other)) for other in labels[:i])


def samples(ax, line):
    """A line as points on the page, half a pixel from each other."""
    corners = ax.transData.transform(line)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    where = np.arange(0.0, along[-1], 0.5)
    return np.column_stack([np.interp(where, along, axis) for axis in corners.T])
