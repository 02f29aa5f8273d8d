"""Every mistake in the arguments of what is done to paths is named before anything is computed."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import usvjax as uj
from usvjax import batches
from usvjax.paths import tracking as path_tracking
from usvjax.paths.inputs import Frame
from usvjax.paths.metrics import path_metrics
from usvjax.paths.smoothing import bspline, key_points, redensify, shorten
from usvjax.paths.tracking import track_paths
from usvjax.paths.turns import smooth_turns
from usvjax.paths.water import segments_clear
from usvkernels.paths.tracking import TrackParams

BadInput, BadType = uj.BadInputError, uj.BadTypeError
NAN, INF = float("nan"), float("inf")
CELLS = np.array([[[0, 0], [1, 1], [2, 1]], [[3, 3], [4, 3], [4, 4]]])
METRES = CELLS + 0.5
WATER = np.zeros((8, 10), bool)
NO_MEASURES = (np.zeros(2),) * 4
LAKE = uj.GridMap(WATER, cell_size=2.0)


class ComputeError(Exception):
    """Raised in these tests where compute would begin."""


@pytest.fixture(autouse=True)
def _no_compute(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise ComputeError

    monkeypatch.setattr(batches, "share_out", refuse)


def call(function: Callable[..., Any], **changes: Any) -> None:
    """Call it with arguments in which nothing is wrong but the changes."""
    arguments = {"paths": CELLS, "lengths": [3, 2], "blocked": WATER}
    if function in (redensify, bspline):
        del arguments["blocked"]
    arguments |= {redensify: {"unit": 1.0}, smooth_turns: {"turning_radius": 1.0}}.get(function, {})
    function(**{**arguments, **changes})


EVERY = (shorten, key_points, redensify, bspline, smooth_turns, path_metrics, track_paths)
ON_MAPS = (shorten, key_points, smooth_turns, path_metrics, track_paths)
ON_WATER = (shorten, key_points, smooth_turns)


def refused(
    function: Callable[..., Any], error: type[Exception], said: str, **changes: Any
) -> None:
    with pytest.raises(error, match=said) as caught:
        call(function, **changes)
    assert type(caught.value) is error
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("function", EVERY)
def test_nothing_is_wrong_with_the_others(function: Callable[..., Any]) -> None:
    with pytest.raises(ComputeError):
        call(function)
    if function in (smooth_turns, path_metrics, track_paths, redensify, bspline):
        with pytest.raises(ComputeError):
            call(function, paths=METRES)


@pytest.mark.parametrize("function", EVERY)
@pytest.mark.parametrize(
    ("changes", "error", "said"),
    [
        ({"paths": [[[0, 0], [1, 1]], [[0, 0]]]}, BadInput, "paths: rows of unequal length"),
        ({"paths": CELLS[0]}, BadInput, r"paths: got shape \(3, 2\); wanted"),
        ({"paths": CELLS[:, :0]}, BadInput, r"paths: got shape \(2, 0, 2\); wanted"),
        ({"paths": CELLS[:0]}, BadInput, r"paths: got shape \(0, 3, 2\)"),
        ({"paths": np.zeros((2, 3, 3), int)}, BadInput, r"paths: got shape \(2, 3, 3\)"),
        ({"paths": CELLS > 0}, BadType, "paths: got dtype bool; wanted"),
        ({"paths": CELLS.astype(str)}, BadType, "paths: got dtype <U21; wanted"),
        ({"lengths": [3, 4]}, BadInput, "lengths: got 4 in row 1; wanted .* 0 to 3"),
        ({"lengths": [-1, 3]}, BadInput, "lengths: got -1 in row 0"),
        ({"lengths": [3]}, BadInput, r"lengths: got shape \(1,\); wanted int \[2\]"),
        ({"lengths": [3.0, 3.0]}, BadType, "lengths: got dtype float64"),
        ({"lengths": [[3], [3, 3]]}, BadInput, "lengths: rows of unequal length"),
    ],
)
def test_paths_and_lengths(
    function: Callable[..., Any], changes: dict[str, Any], error: type[Exception], said: str
) -> None:
    refused(function, error, said, **changes)


@pytest.mark.parametrize("function", [redensify, bspline, smooth_turns, path_metrics, track_paths])
@pytest.mark.parametrize("value", [NAN, INF, -INF])
def test_points_that_are_not_finite(function: Callable[..., Any], value: float) -> None:
    paths = METRES.copy()
    paths[1, 2, 0] = value  # beyond the end of the path, where nobody looks
    with pytest.raises(ComputeError):
        call(function, paths=paths)
    refused(
        function, BadInput, rf"paths: {value} at index \[1, 2, 0\]", paths=paths, lengths=[3, 3]
    )


@pytest.mark.parametrize("function", [shorten, key_points])
def test_metres_where_cells_are_wanted(function: Callable[..., Any]) -> None:
    refused(function, BadType, "paths: got dtype float64; wanted int", paths=METRES)


@pytest.mark.parametrize("function", ON_MAPS)
@pytest.mark.parametrize(
    ("blocked", "error", "said"),
    [
        (WATER.astype(int), BadType, "blocked: got dtype int64; wanted bool"),
        (WATER[0], BadInput, r"blocked: got shape \(10,\)"),
        (WATER[:0], BadInput, "which has no cells"),
        ([[True], [True, False]], BadInput, "blocked: rows of unequal length"),
        (np.stack([WATER] * 3), BadInput, "blocked: got 3 maps for 2 paths"),
    ],
)
def test_maps(
    function: Callable[..., Any], blocked: Any, error: type[Exception], said: str
) -> None:
    refused(function, error, said, blocked=blocked)


@pytest.mark.parametrize("function", ON_MAPS)
@pytest.mark.parametrize("cell", [(10, 0), (-1, 0), (0, 8), (0, -1)])
def test_paths_that_leave_the_map(function: Callable[..., Any], cell: tuple[int, int]) -> None:
    paths = CELLS.copy()
    paths[1, 1] = cell
    said = rf"paths: point 1 of row 1, cell \({cell[0]}, {cell[1]}\), lies outside .* 10 x 8 cells"
    refused(function, BadInput, said, paths=paths)


def test_points_in_metres_off_the_map() -> None:
    said = r"paths: point 2 of row 0, \(2\.5, 1\.5\) m, lies outside the map"
    refused(smooth_turns, BadInput, said, paths=METRES, origin=(-7.6, 0.0), lengths=[3, 0])


@pytest.mark.parametrize("function", ON_WATER)
@pytest.mark.parametrize(
    ("cell", "row"), [((3, 3), 1), ((1, 0), 0), ((0, 1), 0), ((2, 1), 0), ((4, 3), 1)]
)
def test_paths_through_blocked_cells(
    function: Callable[..., Any], cell: tuple[int, int], row: int
) -> None:
    blocked = WATER.copy()
    blocked[cell[1], cell[0]] = True
    refused(function, BadInput, f"paths: row {row} meets a blocked cell", blocked=blocked)
    cut = cell in ((1, 0), (0, 1))  # touched at a corner only
    with pytest.raises(ComputeError if cut else BadInput):
        call(function, blocked=blocked, corner_cutting=True)


def test_long_segments_through_blocked_cells() -> None:
    blocked = WATER.copy()
    blocked[3, 4] = True
    across = np.array([[[0, 0], [9, 7], [9, 7]]] * 2)
    for paths in (across, across + 0.5):
        refused(smooth_turns, BadInput, "row 0 meets a blocked cell", paths=paths, blocked=blocked)
    with pytest.raises(ComputeError):
        call(smooth_turns, paths=across + np.array([[0, 0], [0, -3], [0, -3]]), blocked=blocked)


@pytest.mark.parametrize("function", EVERY)
@pytest.mark.parametrize("far", [2**40, -(2**32) - 3, 2**31])
def test_cells_that_no_map_has(function: Callable[..., Any], far: int) -> None:
    """They are refused before they are cut to 32 bits, where 2^32 would be cell 0."""
    paths = CELLS.astype(np.int64)
    paths[1, 1, 0] = far
    refused(function, BadInput, r"paths: point 1 of row 1 is \(.*; wanted coordinates", paths=paths)


@pytest.mark.parametrize("function", [redensify, bspline, smooth_turns, path_metrics, track_paths])
@pytest.mark.parametrize("far", [1e12, -1e30])
def test_points_that_are_nowhere(function: Callable[..., Any], far: float) -> None:
    paths = METRES.copy()
    paths[0, 1, 1] = far
    refused(function, BadInput, "paths: point 1 of row 0 is .*; wanted coordinates", paths=paths)
    if function is path_metrics:
        said = "paths: point 1 of row 0 is"
        refused(function, BadInput, said, paths=paths, blocked=None)


@pytest.mark.parametrize("function", ON_WATER)
@pytest.mark.parametrize("value", ["false", 2, 0, None])
def test_corner_cutting_is_true_or_false(function: Callable[..., Any], value: Any) -> None:
    said = f"corner_cutting: got {value!r}; wanted True or False"
    refused(function, BadType, said, corner_cutting=value)


def test_more_points_than_memory_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("usvjax.memory.free_memory", lambda: 50_000)
    refused(bspline, BadInput, r"samples: got 1,000; 2 x 1,000 points needs", samples=1000)
    refused(redensify, BadInput, r"unit: got 0\.001 m; 2 x \d+ points needs", unit=0.001)
    refused(bspline, BadInput, "samples: got 1,000,000,000,000; wanted at most", samples=10**12)
    said = r"spacing: 0\.001 m: 2 x 4096 samples needs"
    refused(track_paths, BadInput, said, spacing=0.001)
    slow = TrackParams(speed=1e-3)
    said = r"params: speed 0\.001 m/s and dt 0\.05 s, .* make .* control periods; tracking 2 paths"
    monkeypatch.setattr("usvjax.memory.free_memory", lambda: 2**20)
    smooth = {"paths": METRES, "curvature": np.zeros((2, 3)), "params": slow}
    refused(track_paths, BadInput, said, **smooth)
    slow = TrackParams(speed=1e-6)
    refused(track_paths, BadInput, "wanted fewer than 16,777,216", **{**smooth, "params": slow})


def test_clearance_of_more_points_than_memory_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batches, "share_out", lambda work, items, devices: [NO_MEASURES])
    monkeypatch.setattr("usvjax.memory.free_memory", lambda: 8000)
    said = r"paths: clearance at points 0\.5 m apart: 2 x 64 samples needs 8\.0 KiB"
    refused(path_metrics, BadInput, said)


@pytest.mark.parametrize(("cell_size", "wanted"), [(1.0, 0.75), (5.0, 1.0), (250.0, 50.0)])
def test_spacing_of_tracks_goes_with_the_cells(
    cell_size: float, wanted: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(_: float, spacing: float, *__: object) -> None:
        raise ComputeError(spacing)

    monkeypatch.setattr(path_tracking, "sample_room", stop)
    with pytest.raises(ComputeError) as caught:
        call(track_paths, cell_size=cell_size)
    assert caught.value.args == (wanted,)


@pytest.mark.parametrize("name", ["turning_radius", "safety_range"])
@pytest.mark.parametrize(
    ("value", "error", "said"),
    [
        (0.0, BadInput, "wanted a number above 0"),
        (-3.0, BadInput, "wanted a number above 0"),
        (NAN, BadInput, "got nan; wanted a finite number"),
        ("wide", BadType, "got 'wide'; wanted a number"),
        (11.0, BadInput, "got 11 m; wanted at most 10 m, the longer side of the map"),
        ([1.0, 0.0], BadInput, "got 0 in row 1; wanted a number above 0"),
        ([1.0, 1.0, 1.0], BadInput, r"got shape \(3,\); wanted shape \(2\)"),
    ],
)
def test_radius(name: str, value: Any, error: type[Exception], said: str) -> None:
    refused(smooth_turns, error, rf"^{name}: .*{said}", **{name: value})


@pytest.mark.parametrize(
    ("function", "changes", "error", "said"),
    [
        (smooth_turns, {"margin": -0.1}, BadInput, "margin: got -0.1; wanted 0 or more"),
        (smooth_turns, {"margin": 0.3}, BadInput, "margin: got 0.3 m; wanted at most 0.2 m"),
        (smooth_turns, {"spacing": 0.0}, BadInput, "spacing: got 0.0; wanted a number above 0"),
        (smooth_turns, {"repair": -1}, BadInput, "repair: got -1; wanted 0 or more"),
        (smooth_turns, {"repair": 1.5}, BadType, "repair: got 1.5; wanted a whole number"),
        (smooth_turns, {"cell_size": 1e30}, BadInput, "cell_size: got 1e.30 m; wanted 1e-06 to"),
        (smooth_turns, {"origin": (0, 1e12)}, BadInput, "origin: .* at most 1,000,000,000 m"),
        (smooth_turns, {"cell_size": 0}, BadInput, "cell_size: got 0; wanted a number above 0"),
        (smooth_turns, {"origin": 3.0}, BadType, "origin: got 3.0; wanted two numbers"),
        (smooth_turns, {"blocked": LAKE, "cell_size": 1.0}, BadInput, "cell_size: .* GridMap"),
        (redensify, {"unit": 0.0}, BadInput, "unit: got 0.0; wanted a number above 0"),
        (redensify, {"unit": 1e-9}, BadInput, "unit: got 1e-09 m; that makes"),
        (bspline, {"samples": 1}, BadInput, "samples: got 1; wanted 2 or more"),
        (bspline, {"lengths": [3, 1]}, BadInput, "paths: row 1 has one point"),
        (path_metrics, {"turn_cost": -1.0}, BadInput, "turn_cost: got -1.0; wanted 0 or more"),
        (path_metrics, {"energy_unit": 0.0}, BadInput, "energy_unit: got 0.0"),
        (path_metrics, {"tolerance": NAN}, BadInput, "tolerance: got nan"),
        (path_metrics, {"clearance_limit": 0.0}, BadInput, "clearance_limit: got 0.0"),
        (track_paths, {"spacing": -1.0}, BadInput, "spacing: got -1.0"),
        (track_paths, {"params": 15.0}, BadType, "params: got float; wanted TrackParams"),
        (track_paths, {"params": TrackParams(dt=0.0)}, BadInput, "params.dt: got 0.0"),
        (track_paths, {"curvature": [[0.0]]}, BadInput, r"curvature: got shape \(1, 1\)"),
    ],
)
def test_numbers(
    function: Callable[..., Any], changes: dict[str, Any], error: type[Exception], said: str
) -> None:
    refused(function, error, said, **changes)


def test_a_segment_that_leaves_the_map_is_not_followed_beyond_it() -> None:
    frame = Frame(np.zeros((1, 5, 5), bool), 1.0, np.zeros(2))
    starts, ends = np.full((3, 2), 1.0), np.array([[4.0, 3.0], [1e13, 1.0], [1.0, -1e13]])
    found = segments_clear(starts, ends, np.arange(3), frame, False)
    assert found.tolist() == [True, False, False]
