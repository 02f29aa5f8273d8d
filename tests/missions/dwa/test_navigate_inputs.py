"""Every mistake in the arguments of navigate_dwa is named before anything is computed."""

from typing import Any

import numpy as np
import pytest

import usvjax as uj
from usvjax.missions.dwa import candidates, run
from usvjax.missions.dwa.params import check_dwa

NAN, INF = float("nan"), float("inf")
OBSTACLES = np.array([[[3.0, 0.0], [0.0, 3.0]]] * 3)  # [3, 2, 2]
STARTS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [0.0, 1.0, -3.0]])
GOALS = np.full((3, 2), 8.0)

BadInput, BadType = uj.BadInputError, uj.BadTypeError


class ComputeError(Exception):
    """Raised in these tests where compute would begin."""


@pytest.fixture(autouse=True)
def _no_compute(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise ComputeError

    for name in ("sail", "_run", "_record"):
        monkeypatch.setattr(run, name, refuse)
    monkeypatch.setattr(candidates, "_open_up", refuse)


def sail(**changes: Any) -> None:
    """Check these episodes, in which nothing is wrong but the changes."""
    arguments = {"obstacles": OBSTACLES, "starts": STARTS, "goals": GOALS, **changes}
    uj.navigate_dwa(**arguments)


def assert_refused(error: type[Exception], message: str, **changes: Any) -> None:
    with pytest.raises(error, match=message) as caught:
        sail(**changes)
    assert type(caught.value) is error
    assert "\n" not in str(caught.value)


def put(array: np.ndarray, index: tuple[int, ...], value: float) -> np.ndarray:
    array = array.copy()
    array[index] = value
    return array


def test_nothing_is_wrong_with_the_others() -> None:
    with pytest.raises(ComputeError):
        sail()
    assert issubclass(BadInput, ValueError)
    assert issubclass(BadType, TypeError)


# --- poses, goals, obstacles ------------------------------------------------------------------


@pytest.mark.parametrize("value", [NAN, INF, -INF])
@pytest.mark.parametrize(
    ("name", "index"),
    [("obstacles", (1, 0, 1)), ("starts", (2, 0)), ("starts", (0, 2)), ("goals", (1, 1))],
)
def test_numbers_that_are_not_finite(name: str, index: tuple[int, ...], value: float) -> None:
    good = {"obstacles": OBSTACLES, "starts": STARTS, "goals": GOALS}[name]
    where = ", ".join(map(str, index))
    message = rf"{name}: {value} at index \[{where}\]; wanted finite numbers"
    assert_refused(BadInput, message, **{name: put(good, index, value)})


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("obstacles", np.zeros((3, 2, 3)), r"got shape \(3, 2, 3\); wanted shape \(3, any, 2\)"),
        ("obstacles", np.ones((4, 3)), r"got shape \(4, 3\); wanted shape \(any, 2\)"),
        ("obstacles", np.zeros(2), r"got shape \(2,\); wanted shape \(3, any, 2\)"),
        ("obstacles", [], r"got shape \(0,\)"),
        ("obstacles", 5.0, r"got shape \(\)"),
        ("obstacles", np.ones((1, 3, 2, 2)), r"got shape \(1, 3, 2, 2\)"),
        ("obstacles", OBSTACLES[:2], r"got shape \(2, 2, 2\); wanted shape \(3, any, 2\)"),
        ("starts", STARTS[:, :2], r"got shape \(3, 2\); wanted shape \(any, 3\)"),
        ("starts", STARTS[None], r"got shape \(1, 3, 3\); wanted shape \(any, 3\)"),
        ("starts", [0.0, 0.0], r"got shape \(2,\); wanted shape \(3\)"),
        ("starts", 0.0, r"got shape \(\); wanted shape \(any, 3\)"),
        ("starts", STARTS[:2], "got 2 rows; wanted 3, one per episode"),
        ("goals", STARTS, r"got shape \(3, 3\); wanted shape \(any, 2\)"),
        ("goals", GOALS[:2], "got 2 rows; wanted 3, one per episode"),
        ("goals", [8.0, 8.0, 8.0], r"got shape \(3,\); wanted shape \(2\)"),
    ],
)
def test_wrong_shapes(name: str, value: Any, message: str) -> None:
    assert_refused(BadInput, f"^{name}: {message}", **{name: value})


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("obstacles", [[[1.0, 2.0]], [[1.0, 2.0], [3.0, 4.0]], [[5.0, 6.0]]]),
        ("obstacles", [[1.0, 2.0], [3.0]]),
        ("starts", [[0.0, 0.0, 0.0], [1.0, 0.0]]),
        ("starts", [0.0, [0.0], 0.0]),
        ("goals", [[8.0, 8.0], [8.0]]),
        ("valid", [[True], [True, False]]),
    ],
)
def test_rows_of_unequal_length(name: str, value: Any) -> None:
    assert_refused(BadInput, f"^{name}: rows of unequal length; wanted", **{name: value})


@pytest.mark.parametrize("name", ["obstacles", "starts", "goals"])
@pytest.mark.parametrize(
    ("convert", "dtype"),
    [
        (lambda a: a.astype(complex), "complex128"),
        (lambda a: a.astype(str), "<U"),
        (lambda a: a > 0, "bool"),
        (lambda a: a.astype(object), "object"),
        (lambda a: None, "object"),
        (lambda a: "here", "<U4"),
        (lambda a: a.astype("datetime64[s]"), "datetime64"),
    ],
)
def test_wrong_dtypes(name: str, convert: Any, dtype: str) -> None:
    good = {"obstacles": OBSTACLES, "starts": STARTS, "goals": GOALS}[name]
    assert_refused(BadType, rf"^{name}: got dtype {dtype}", **{name: convert(good)})


@pytest.mark.parametrize("name", ["starts", "goals"])
def test_zero_episodes(name: str) -> None:
    width = {"starts": 3, "goals": 2}[name]
    message = f"^{name}: got no rows; wanted at least one episode"
    assert_refused(BadInput, message, **{name: np.zeros((0, width))})


def test_zero_sets_of_obstacles() -> None:
    message = r"obstacles: got shape \(0, 2, 2\); wanted shape \(3, any, 2\)"
    assert_refused(BadInput, message, obstacles=np.zeros((0, 2, 2)))
    with pytest.raises(BadInput, match=r"obstacles: got shape \(0, 2, 2\)"):
        uj.navigate_dwa(np.zeros((0, 2, 2)), STARTS[0], GOALS[0])


@pytest.mark.parametrize(("name", "index"), [("starts", (1, 0)), ("goals", (1, 1))])
def test_coordinates_too_large_for_single_precision(name: str, index: tuple[int, int]) -> None:
    good = {"starts": STARTS, "goals": GOALS}[name]
    message = rf"^{name}: episode 1 lies at .*: subtract a local origin"
    assert_refused(BadInput, message, **{name: put(good, index, 4.2e6)})


# --- start inside an obstacle -----------------------------------------------------------------


def test_start_inside_an_obstacle() -> None:
    inside = put(STARTS, (2, 1), 2.6)  # 0.4 m from obstacle 1, radius 0.5 m
    message = (
        r"^starts: episode 2 starts inside the obstacle at \(0, 3\) m; wanted a start outside every"
    )
    assert_refused(BadInput, message, starts=inside)
    assert_refused(BadInput, message, starts=inside, obstacles=OBSTACLES[0])
    for accepted in (
        {"starts": put(STARTS, (2, 1), 2.4)},
        {"starts": put(STARTS, (2, 1), 2.5)},  # on the circle
        {"starts": inside, "params": uj.DwaParams(radius=0.3)},
        {"starts": inside, "params": uj.DwaParams(radius=np.array([0.9, 0.9, 0.3]))},
        {"starts": inside, "valid": np.array([True, False])},
        {"starts": inside, "valid": np.array([[True, True], [True, True], [True, False]])},
    ):
        with pytest.raises(ComputeError):
            sail(**accepted)
    swept = uj.DwaParams(radius=np.array([0.3, 0.3, 0.5]))
    assert_refused(BadInput, message, starts=inside, params=swept)


def test_start_inside_an_obstacle_far_down_the_list() -> None:
    many = 20_000
    starts = np.zeros((many, 3))
    starts[-2, 0] = 3.0
    with pytest.raises(BadInput, match=r"episode 19998 starts inside the obstacle at \(3, 0\) m"):
        uj.navigate_dwa(OBSTACLES[0], starts, GOALS[0])


# --- valid, params, static, max_lanes ---------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "error", "message"),
    [
        (np.ones((3, 2)), BadType, "valid: got dtype float64; wanted bool"),
        (np.ones((3, 2), int), BadType, "valid: got dtype int64; wanted bool"),
        ([["yes", "no"]] * 3, BadType, "valid: got dtype <U3; wanted bool"),
        (np.ones((2, 3), bool), BadInput, r"valid: got shape \(2, 3\); wanted \(3, 2\) or \(2,\)"),
        (np.ones(3, bool), BadInput, r"valid: got shape \(3,\); wanted \(3, 2\) or \(2,\)"),
        (np.ones((3, 2, 1), bool), BadInput, r"valid: got shape \(3, 2, 1\)"),
        (True, BadInput, r"valid: got shape \(\); wanted"),
    ],
)
def test_bad_masks(value: Any, error: type[Exception], message: str) -> None:
    assert_refused(error, message, valid=value)
    assert_refused(error, message, valid=value, obstacles=OBSTACLES[0])


@pytest.mark.parametrize(
    ("params", "error", "message"),
    [
        (uj.DwaParams(radius=-1.0), BadInput, r"params\.radius: got -1; wanted 0 or more"),
        (uj.DwaParams(dt=0.0), BadInput, r"params\.dt: got 0; wanted more than 0"),
        (uj.DwaParams(v_min=2.0), BadInput, r"params\.v_min: got 2; wanted at most v_max = 1"),
        (uj.DwaParams(radius=NAN), BadInput, r"params\.radius: got nan; wanted a finite number"),
        (uj.DwaParams(dt="0.1"), BadType, r"params\.dt: got '0.1'; wanted a number"),
        (uj.DwaParams(dt=np.full(2, 0.1)), BadInput, r"params\.dt: got shape \(2,\); wanted one "),
        (uj.DwaParams(dt=np.full(4, 0.1)), BadInput, r"params\.dt: .* or shape \(3,\)"),
        (uj.DwaParams(dt=np.full((3, 1), 0.1)), BadInput, r"params\.dt: got shape \(3, 1\)"),
        ({"radius": 0.5}, BadType, "params: got dict; wanted DwaParams"),
        (uj.DwaStatic(), BadType, "params: got DwaStatic; wanted DwaParams"),
    ],
)
def test_bad_params(params: Any, error: type[Exception], message: str) -> None:
    assert_refused(error, message, params=params)


def test_two_sweeps_of_different_length() -> None:
    params = uj.DwaParams(radius=np.full(4, 0.5), dt=np.full(5, 0.1))
    with pytest.raises(BadInput, match=r"params\.radius: got shape \(4,\); .* or shape \(5,\)"):
        uj.navigate_dwa(OBSTACLES[0], STARTS[0], GOALS[0], params=params)


@pytest.mark.parametrize(
    ("static", "error", "message"),
    [
        (uj.DwaStatic(method="improvd"), BadInput, r"static\.method: .*mean 'improved'"),
        (uj.DwaStatic(normalise="rnage"), BadInput, r"static\.normalise: .*mean 'range'"),
        (uj.DwaStatic(n_v=4), BadInput, r"static\.n_v: 4 candidates; the window .* holds 5"),
        (uj.DwaStatic(n_w=10), BadInput, r"static\.n_w: 10 candidates; the window .* holds 11"),
        (uj.DwaStatic(max_steps=0), BadInput, r"static\.max_steps: got 0; wanted 1 or more"),
        (uj.DwaStatic(horizon=2.5), BadType, r"static\.horizon: got 2.5"),  # type: ignore[arg-type]
        ("improved", BadType, "static: got str; wanted DwaStatic"),
    ],
)
def test_bad_static(static: Any, error: type[Exception], message: str) -> None:
    assert_refused(error, message, static=static)


@pytest.mark.parametrize(
    ("value", "error", "message"),
    [
        (0, BadInput, "max_lanes: got 0; wanted 16 or more"),
        (15, BadInput, "max_lanes: got 15; wanted 16 or more"),
        (16.0, BadType, "max_lanes: got 16.0; wanted a whole number"),
        (True, BadType, "max_lanes: got True; wanted a whole number"),
        (None, BadType, "max_lanes: got None; wanted a whole number"),
        ("all", BadType, "max_lanes: got 'all'; wanted a whole number"),
    ],
)
def test_bad_max_lanes(value: Any, error: type[Exception], message: str) -> None:
    assert_refused(error, message, max_lanes=value)


# --- maps -------------------------------------------------------------------------------------

CELLS = np.zeros((10, 12), bool)
CELLS[4, 6] = True  # centre (113, 209) with cells of 2 m and the origin below
LAKE = uj.GridMap(CELLS, cell_size=2.0, origin=(100.0, 200.0))
AFLOAT = np.array([[101.0, 201.0, 0.0], [105.0, 210.0, 1.0]])
ACROSS = np.array([[121.0, 215.0], [121.0, 201.0]])
WIDE = uj.DwaParams(radius=1.5)


def assert_refused_on_lake(error: type[Exception], message: str, **changes: Any) -> None:
    arguments = {"starts": AFLOAT, "goals": ACROSS, "params": WIDE, **changes}
    assert_refused(error, message, obstacles=LAKE, **arguments)


def test_nothing_is_wrong_with_the_lake() -> None:
    with pytest.raises(ComputeError):
        sail(obstacles=LAKE, starts=AFLOAT, goals=ACROSS, params=WIDE, sensing_range=4.0)


@pytest.mark.parametrize(
    ("point", "said"),
    [
        ((112.1, 209.9), r"\(112\.1, 209\.9\)"),  # on land
        ((99.9, 205.0), r"\(99\.9, 205\)"),  # west of the map
        ((124.0, 205.0), r"\(124, 205\)"),
        ((105.0, 220.0), r"\(105, 220\)"),
        ((105.0, 199.0), r"\(105, 199\)"),
        ((0.0, 0.0), r"\(0, 0\)"),
    ],
)
@pytest.mark.parametrize("name", ["starts", "goals"])
def test_on_land_or_off_the_map(name: str, point: tuple[float, float], said: str) -> None:
    rows = {"starts": AFLOAT, "goals": ACROSS}[name].copy()
    rows[1, :2] = point
    message = rf"^{name}: episode 1 at {said} m is on a blocked cell or off the map; wanted open"
    assert_refused_on_lake(BadInput, message, **{name: rows})


@pytest.mark.parametrize("radius", [0.1, 1.41, np.array([1.5, 1.4])])
def test_radius_that_lets_a_vessel_slip_between_cells(radius: Any) -> None:
    message = r"params\.radius: got .* m; wanted at least 1\.41421 m, half the diagonal of a 2 m"
    assert_refused_on_lake(BadInput, message, params=uj.DwaParams(radius=radius))


def test_start_inside_the_circle_of_a_cell() -> None:
    ashore = AFLOAT.copy()
    ashore[0, :2] = (111.9, 209.0)  # on water, 1.1 m from the centre of the blocked cell
    message = r"starts: episode 0 starts inside the obstacle at \(113, 209\) m"
    assert_refused_on_lake(BadInput, message, starts=ashore)


@pytest.mark.parametrize(
    ("value", "error", "message"),
    [
        (0.0, BadInput, "got 0.0; wanted a number above 0"),
        (-3.0, BadInput, "got -3.0; wanted a number above 0"),
        (NAN, BadInput, "got nan; wanted a finite number"),
        (INF, BadInput, "got inf; wanted a finite number"),
        ("far", BadType, "got 'far'; wanted a number"),
        ([5.0, 6.0], BadType, r"got \[5\.0, 6\.0\]; wanted a number"),
        (True, BadType, "got True; wanted a number"),
        (1.55, BadInput, r"got 1\.55 m; wanted at least 1\.6 m, the radius and one step"),
    ],
)
def test_bad_sensing_range(value: Any, error: type[Exception], message: str) -> None:
    assert_refused_on_lake(error, rf"^sensing_range: {message}", sensing_range=value)


def test_what_does_not_go_together() -> None:
    assert_refused(BadInput, "sensing_range: goes with a GridMap", sensing_range=5.0)
    message = "valid: goes with obstacle centres, not with a GridMap"
    assert_refused_on_lake(BadInput, message, valid=np.ones(2, bool))


def test_far_from_the_corner_of_the_map_is_what_counts() -> None:
    remote = uj.GridMap(CELLS, cell_size=2.0, origin=(5e5, 3.7e6))  # as UTM coordinates are
    moved = np.array([5e5, 3.7e6]) - LAKE.origin
    with pytest.raises(ComputeError):
        sail(
            obstacles=remote,
            starts=AFLOAT + np.append(moved, 0.0),
            goals=ACROSS + moved,
            params=WIDE,
        )


# --- one decision -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"obstacles": [[NAN, 0.0]]}, BadInput, r"obstacles: nan at index \[0, 0\]"),
        ({"obstacles": OBSTACLES}, BadInput, r"obstacles: got shape \(3, 2, 2\); wanted shape"),
        ({"obstacles": [[1.0], [1.0, 2.0]]}, BadInput, "obstacles: rows of unequal length"),
        ({"state": [0.0, 0.0, 0.0]}, BadInput, r"state: got shape \(3,\); wanted shape \(5\)"),
        ({"state": [0.0, 0.0, INF, 0.0, 0.0]}, BadInput, r"state: inf at index \[2\]"),
        ({"goal": [[8.0, 8.0]]}, BadInput, r"goal: got shape \(1, 2\); wanted shape \(2\)"),
        ({"goal": "north"}, BadType, "goal: got dtype <U5"),
        ({"state": [5e5, 4.4e6, 0.0, 0.0, 0.0]}, BadInput, r"state: got \(500000, 4\.4e\+06\) m"),
        ({"goal": [0.0, 3e5]}, BadInput, r"goal: got \(0, 300000\) m; single precision wants"),
        ({"params": uj.DwaParams(dt=0.0)}, BadInput, r"params\.dt: got 0"),
        ({"params": uj.DwaParams(dt=np.ones(2))}, BadInput, r"params\.dt: .* wanted one number$"),
        ({"static": uj.DwaStatic(clearance="end")}, BadInput, r"static\.clearance: got 'end'"),
    ],
)
def test_bad_candidates(change: dict[str, Any], error: type[Exception], message: str) -> None:
    good = {"obstacles": OBSTACLES[0], "state": np.zeros(5), "goal": GOALS[0]}
    with pytest.raises(ComputeError):
        uj.dwa_candidates(**good)
    with pytest.raises(error, match=f"^{message}"):
        uj.dwa_candidates(**{**good, **change})


@pytest.mark.parametrize(
    ("choices", "refused"),
    [
        ({"n_v": 200, "n_w": 100}, False),
        ({"n_v": 201, "n_w": 100}, True),
        ({"n_v": 50, "n_w": 10, "horizon": 10_000, "clearance": "trajectory"}, False),
        ({"n_v": 51, "n_w": 10, "horizon": 10_000, "clearance": "trajectory"}, True),
        ({"n_v": 51, "n_w": 10, "horizon": 10_000}, False),
    ],
)
def test_windows_too_large_to_decide_in_are_refused(choices: dict[str, Any], refused: bool) -> None:
    params, static = uj.DwaParams(w_step=0.5), uj.DwaStatic(**choices)
    if refused:
        with pytest.raises(BadInput, match="wanted at most 20,000 candidates, and 5,000,000"):
            check_dwa(params, static)
    else:
        check_dwa(params, static)
