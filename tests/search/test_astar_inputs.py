"""Every mistake in the arguments of a search is named before anything is computed."""

import importlib
from typing import Any

import numpy as np
import pytest

from usvjax import memory
from usvjax.errors import BadInputError as BadInput
from usvjax.errors import BadTypeError as BadType
from usvjax.maps import GridMap
from usvjax.search import sweeping
from usvjax.search.inputs import search_scene

# The module: `usvjax.search.astar` may name the function that it holds.
astar_module = importlib.import_module("usvjax.search.astar")

BLOCKED = np.zeros((3, 4, 6), bool)
BLOCKED[:, 1, 2] = True
STARTS = np.array([[0, 0], [1, 1], [5, 3]])
GOALS = np.array([[5, 3], [0, 3], [3, 1]])


class ComputeError(Exception):
    """Raised in these tests where compute would begin."""


@pytest.fixture(autouse=True)
def _no_compute(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise ComputeError

    for name in ("_search", "_swept", "_run"):
        monkeypatch.setattr(astar_module, name, refuse)


def search(**changes: Any) -> None:
    """Check these queries, in which nothing is wrong but the changes."""
    arguments = {"blocked": BLOCKED, "starts": STARTS, "goals": GOALS, **changes}
    astar_module.astar(**arguments)


def assert_refused(error: type[Exception], message: str, **changes: Any) -> None:
    with pytest.raises(error, match=message) as caught:
        search(**changes)
    assert type(caught.value) is error
    assert "\n" not in str(caught.value)


def put(array: np.ndarray, row: int, cell: tuple[int, int]) -> np.ndarray:
    array = array.copy()
    array[row] = cell
    return array


@pytest.mark.parametrize("engine", ["auto", "queue", "sweep"])
def test_nothing_is_wrong_with_the_others(engine: str) -> None:
    with pytest.raises(ComputeError):
        search(engine=engine)
    with pytest.raises(ComputeError):
        search(engine=engine, blocked=GridMap(BLOCKED[0]))


# --- maps -------------------------------------------------------------------------------------


@pytest.mark.parametrize("dtype", [int, float, np.uint8, str, object])
def test_maps_that_are_not_boolean(dtype: type) -> None:
    message = r"^blocked: got dtype .*; wanted bool \[H, W\] shared or \[B, H, W\]"
    assert_refused(BadType, message, blocked=BLOCKED.astype(dtype))


@pytest.mark.parametrize(
    ("blocked", "message"),
    [
        (np.zeros(6, bool), r"got shape \(6,\); wanted"),
        (np.bool_(False), r"got shape \(\); wanted"),
        (BLOCKED[None], r"got shape \(1, 3, 4, 6\); wanted"),
        (np.zeros((0, 6), bool), r"got shape \(0, 6\), which has no cells"),
        (np.zeros((3, 4, 0), bool), r"got shape \(3, 4, 0\), which has no cells"),
        ([[True, False], [True]], "rows of unequal length; wanted bool"),
        (np.ones((4, 6), bool), "all cells are blocked; wanted a free one"),
    ],
)
def test_maps_of_no_use(blocked: Any, message: str) -> None:
    assert_refused(BadInput, f"^blocked: {message}", blocked=blocked)


def test_one_map_without_a_free_cell() -> None:
    full = BLOCKED.copy()
    full[1] = True
    assert_refused(BadInput, "^blocked: all cells are blocked in row 1; wanted", blocked=full)
    with pytest.raises(ComputeError):
        search(blocked=full, on_blocked="status")


# --- starts and goals -------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["starts", "goals"])
@pytest.mark.parametrize(
    ("cell", "said"),
    [((6, 3), r"\(6, 3\)"), ((0, 4), r"\(0, 4\)"), ((-1, 0), r"\(-1, 0\)"), ((0, -9), ".*")],
)
def test_cells_outside_the_map(name: str, cell: tuple[int, int], said: str) -> None:
    good = {"starts": STARTS, "goals": GOALS}[name]
    message = rf"^{name}: {said} in row 2 lies outside the map; wanted 0 <= x < 6 and 0 <= y < 4$"
    assert_refused(BadInput, message, **{name: put(good, 2, cell)})
    assert_refused(BadInput, message, **{name: put(good, 2, cell)}, on_blocked="status")


@pytest.mark.parametrize("name", ["starts", "goals"])
def test_cells_that_are_blocked(name: str) -> None:
    good = {"starts": STARTS, "goals": GOALS}[name]
    message = rf"^{name}: \(2, 1\) in row 1 is a blocked cell; wanted a free one"
    assert_refused(BadInput, message, **{name: put(good, 1, (2, 1))})
    with pytest.raises(ComputeError):
        search(**{name: put(good, 1, (2, 1))}, on_blocked="status")


@pytest.mark.parametrize("name", ["starts", "goals"])
@pytest.mark.parametrize("convert", [float, str, bool, complex, object])
def test_cells_that_are_not_whole_numbers(name: str, convert: type) -> None:
    good = {"starts": STARTS, "goals": GOALS}[name]
    message = rf"^{name}: got dtype .*; wanted int \[B, 2\] or \[2\], cells as \(x, y\)"
    assert_refused(BadType, message, **{name: good.astype(convert)})


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("starts", STARTS[:, :1], r"got shape \(3, 1\); wanted int \[B, 2\]"),
        ("starts", STARTS[None], r"got shape \(1, 3, 2\)"),
        ("goals", 5, r"got shape \(\)"),
        ("goals", [], r"got shape \(0,\)"),
        ("goals", np.zeros((0, 2), int), r"got shape \(0, 2\)"),
        ("goals", [[1, 2], [3]], "rows of unequal length"),
        ("starts", STARTS[:2], r"got 2 rows; wanted 3, as blocked has, or one for all"),
        ("goals", np.zeros((4, 2), int), None),
        ("blocked", BLOCKED[:2], "got 2 rows; wanted 3, as starts has, or one for all"),
    ],
)
def test_wrong_shapes(name: str, value: Any, message: str | None) -> None:
    if message is None:
        name, message = "blocked", "got 3 rows; wanted 4, as goals has"
        assert_refused(BadInput, f"^{name}: {message}", goals=value)
        return
    assert_refused(BadInput, f"^{name}: {message}", **{name: value})


# --- options ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"heuristic": "octal"}, BadInput, "heuristic: got 'octal'; .*octile"),
        ({"turn_mode": "none"}, BadInput, "turn_mode: got 'none'; valid: accumulated, exact"),
        ({"on_blocked": "skip"}, BadInput, "on_blocked: got 'skip'; valid: raise, status"),
        ({"engine": "heap"}, BadInput, "engine: got 'heap'; valid: auto, queue, sweep"),
        ({"connectivity": 6}, BadInput, "connectivity: got 6; wanted 4 or 8"),
        ({"connectivity": "8"}, BadType, "connectivity: got '8'; wanted a whole number"),
        ({"weight": -1.0}, BadInput, "weight: got -1.0; wanted 0 or more"),
        ({"weight": float("nan")}, BadInput, "weight: got nan; wanted a finite number"),
        ({"turn_cost": -0.5}, BadInput, "turn_cost: got -0.5; wanted 0 or more"),
        ({"turn_cost": 1e9}, BadInput, r"turn_cost: got 1000000000.0; wanted at most 1000"),
        ({"turn_cost": "0.5"}, BadType, "turn_cost: got '0.5'; wanted a number"),
        ({"turn_cost": 1e-5}, BadInput, "turn_cost: got 1e-05; wanted 0, or more than 1/4756"),
        ({"corner_cutting": "false"}, BadType, "corner_cutting: got 'false'; wanted True or Fal"),
        ({"corner_cutting": 2}, BadType, "corner_cutting: got 2; wanted True or False"),
        ({"connectivity": np.array([4, 8])}, BadType, "connectivity: got array"),
        ({"max_expansions": 0}, BadInput, "max_expansions: got 0; wanted 1 or more"),
        ({"max_expansions": 2.5}, BadType, "max_expansions: got 2.5; wanted a whole number"),
        ({"max_lanes": 0}, BadInput, "max_lanes: got 0; wanted 1 or more"),
    ],
)
def test_bad_options(options: dict[str, Any], error: type[Exception], message: str) -> None:
    assert_refused(error, f"^{message}", **options)


@pytest.mark.parametrize(
    "options",
    [{"turn_cost": 0.5}, {"weight": 2.0}, {"max_expansions": 9}, {"heuristic": "manhattan"}],
)
def test_what_sweeps_cannot_do(options: dict[str, Any]) -> None:
    message = "^engine: got 'sweep' with a turn cost, .* wanted 'queue'$"
    assert_refused(BadInput, message, engine="sweep", **options)


# --- memory -----------------------------------------------------------------------------------


def test_a_map_too_large_for_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "free_memory", lambda: 3 * 2**20)
    blocked = np.zeros((400, 500), bool)
    message = (
        r"^blocked: a search on 500 x 400 cells needs \d+\.\d MiB of memory; "
        r"this machine has 3\.0 MiB left$"
    )
    assert_refused(BadInput, message, blocked=blocked, engine="queue")


def test_sweeps_and_paths_that_memory_cannot_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = search_scene(np.zeros((400, 500), bool), STARTS, GOALS)
    table = sweeping._Table.empty(3)
    table.path_cells[:] = 9
    assert table.paths(scene).path.shape == (3, 9, 2)
    monkeypatch.setattr(memory, "free_memory", lambda: 200)
    with pytest.raises(BadInput, match="starts: 3 paths of up to 9 cells needs 216 bytes"):
        table.paths(scene)
    none = np.zeros((0, 9, 2), np.int32)
    block = astar_module._Block(
        *np.zeros((3, 0), np.int32), astar_module.TracedPaths(none, *np.zeros((3, 0)))
    )
    with pytest.raises(BadInput, match="starts: 3 paths of up to 9 cells needs"):
        astar_module._collected(scene, [block], 0.0)
    said = "^blocked: searches of 3 queries on 500 x 400 cells needs .* MiB"
    with pytest.raises(BadInput, match=said):
        sweeping.sweep_paths(scene)


# --- what the checks return -------------------------------------------------------------------


def test_scene_of_shared_and_of_own_maps() -> None:
    own = search_scene(BLOCKED, STARTS.tolist(), [3, 1])
    assert (len(own), own.shared, own.shape) == (3, False, (4, 6))
    assert own.goals.tolist() == [[3, 1]] * 3
    assert own.starts.dtype == own.goals.dtype == np.int32
    shared = search_scene(GridMap(BLOCKED[0]), STARTS.astype(np.uint8), GOALS)
    assert (len(shared), shared.shared, shared.blocked.shape) == (3, True, (1, 4, 6))
    one = search_scene(BLOCKED[:1], STARTS, GOALS)
    assert (len(one), one.shared) == (3, True)


def test_ends_that_are_blocked_are_marked() -> None:
    scene = search_scene(BLOCKED, put(STARTS, 0, (2, 1)), put(GOALS, 2, (2, 1)), "status")
    assert scene.open_ends.tolist() == [False, True, False]
