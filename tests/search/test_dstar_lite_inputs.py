"""Every mistake in the arguments of dstar_lite is named before anything is computed."""

from typing import Any

import numpy as np
import pytest

from usvjax.errors import BadInputError, BadTypeError
from usvjax.search import replanning

BLOCKED = np.zeros((3, 5, 6), bool)
BLOCKED[1, 4, 0] = True
STARTS = np.array([[0, 0], [1, 0], [2, 0]])
GOALS = np.array([[5, 4], [5, 4], [4, 4]])
FLIPS = np.array([[[[1, 1], [-1, -1]]] * 4] * 3)  # [3, 4, 2, 2]


class ComputeError(Exception):
    """Raised in these tests where compute would begin."""


@pytest.fixture(autouse=True)
def _no_compute(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise ComputeError

    monkeypatch.setattr(replanning, "_run", refuse)


def sail(**changes: Any) -> None:
    """Check these episodes, in which nothing is wrong but the changes."""
    arguments = {"blocked": BLOCKED, "starts": STARTS, "goals": GOALS, "flips": FLIPS, **changes}
    replanning.dstar_lite(**arguments)


def assert_refused(error: type[Exception], message: str, **changes: Any) -> None:
    with pytest.raises(error, match=message) as caught:
        sail(**changes)
    assert type(caught.value) is error
    assert "\n" not in str(caught.value)


def put(array: np.ndarray, index: tuple[int, ...], value: Any) -> np.ndarray:
    array = array.copy()
    array[index] = value
    return array


@pytest.mark.parametrize(
    "fine",
    [
        {},
        {"blocked": BLOCKED[0]},
        {"blocked": BLOCKED[:1], "starts": [0, 0], "goals": GOALS[0]},
        {"flips": FLIPS[0]},
        {"flips": FLIPS.astype(np.int8)},
        {"sensing": [3, 5]},
        {"sensing": np.array([5, 5])},
        {"heuristic": "weighted_octile", "weight": 1},
    ],
)
def test_nothing_is_wrong_with_these(fine: dict[str, Any]) -> None:
    with pytest.raises(ComputeError):
        sail(**fine)


# --- maps, starts, goals ------------------------------------------------------------------------


@pytest.mark.parametrize("value", [BLOCKED.astype(int), BLOCKED.astype(float), BLOCKED[0] * 1])
def test_maps_that_are_not_boolean(value: np.ndarray) -> None:
    assert_refused(BadTypeError, f"^blocked: got dtype {value.dtype}; wanted bool", blocked=value)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"blocked": BLOCKED[:2]}, r"^blocked: got 2 rows; wanted 3"),
        ({"blocked": BLOCKED[0, 0]}, r"^blocked: got shape \(6,\)"),
        ({"blocked": BLOCKED[:, :0]}, "^blocked: .* no cells"),
        ({"blocked": [[True, False], [True]]}, "^blocked: rows of unequal length"),
        ({"blocked": ~np.zeros((5, 6), bool)}, "^blocked: all cells are blocked"),
        ({"starts": STARTS[:2]}, "^starts: got 2 rows; wanted 3"),
        ({"goals": GOALS[:, :1]}, r"^goals: got shape \(3, 1\)"),
        ({"goals": [[1, 2], [3]]}, "^goals: rows of unequal length"),
        ({"starts": put(STARTS, (1,), [6, 0])}, r"^starts: \(6, 0\) in row 1 lies outside the map"),
        ({"goals": put(GOALS, (2,), [0, -1])}, r"^goals: \(0, -1\) in row 2 lies outside the map"),
        ({"starts": put(STARTS, (1,), [0, 4])}, r"^starts: \(0, 4\) in row 1 is a blocked cell"),
        ({"goals": put(GOALS, (1,), [0, 4])}, r"^goals: \(0, 4\) in row 1 is a blocked cell"),
    ],
)
def test_maps_starts_and_goals(changes: dict[str, Any], message: str) -> None:
    assert_refused(BadInputError, message, **changes)


@pytest.mark.parametrize("name", ["starts", "goals"])
def test_ends_that_are_not_whole_numbers(name: str) -> None:
    value = {"starts": STARTS, "goals": GOALS}[name]
    assert_refused(BadTypeError, f"^{name}: got dtype float64", **{name: value + 0.0})
    assert_refused(BadTypeError, f"^{name}: got dtype bool", **{name: value > 1})


# --- flips --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "cell", [(6, 0), (0, 5), (-2, 0), (-1, 3), (3, -1), (100, 100), (-5, -5), (2**31 - 1, 0)]
)
def test_flips_outside_the_map(cell: tuple[int, int]) -> None:
    message = (
        rf"^flips: \({cell[0]}, {cell[1]}\) in row 2, step 3 lies outside the map; "
        r"wanted 0 <= x < 6 and 0 <= y < 5, or \(-1, -1\) for none$"
    )
    assert_refused(BadInputError, message, flips=put(FLIPS, (2, 3, 1), cell))


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (FLIPS[:2], "^flips: got 2 rows; wanted 3, as the others have, or one for all"),
        (FLIPS[:0], "^flips: got 0 rows; wanted 3"),
        (FLIPS[..., :1], r"^flips: got shape \(3, 4, 2, 1\); wanted int \[B, T, C, 2\]"),
        (FLIPS[0, 0], r"^flips: got shape \(2, 2\)"),
        (FLIPS[None], r"^flips: got shape \(1, 3, 4, 2, 2\)"),
        (3, r"^flips: got shape \(\)"),
        ([[[[1, 1]], [[1, 1], [2, 2]]]], "^flips: rows of unequal length"),
        ([[[[1, 1]]], [[[1]]]], "^flips: rows of unequal length"),
    ],
)
def test_flips_of_other_shapes(value: Any, message: str) -> None:
    assert_refused(BadInputError, message, flips=value)


@pytest.mark.parametrize("dtype", [float, bool, str, object])
def test_flips_that_are_not_whole_numbers(dtype: type) -> None:
    assert_refused(BadTypeError, "^flips: got dtype", flips=FLIPS.astype(dtype))


# --- options ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "error"),
    [
        ((4, 5), BadInputError),
        ((5, 2), BadInputError),
        ((1, 5), BadInputError),
        ((5, -3), BadInputError),
        ((5,), BadInputError),
        ((5, 5, 5), BadInputError),
        (5, BadTypeError),
        ((5.0, 5.0), BadTypeError),
        ((True, 5), BadTypeError),
        ("5x5", BadTypeError),
    ],
)
def test_windows(value: Any, error: type[Exception]) -> None:
    message = r"^sensing: got .*; wanted \(h, w\), two odd whole numbers of 3 or more$"
    assert_refused(error, message, sensing=value)


@pytest.mark.parametrize(
    ("error", "message", "changes"),
    [
        (BadInputError, "^heuristic: got 'octil'; .*octile", {"heuristic": "octil"}),
        (BadInputError, "^heuristic: got 'manhattan'", {"heuristic": "manhattan"}),
        (BadInputError, "^weight: got 2 with heuristic='weighted'", {"heuristic": "weighted"}),
        (BadInputError, "^weight: got 2 with heuristic='octile'", {}),
        (BadTypeError, "^corner_cutting: got 1; wanted True or False", {"corner_cutting": 1}),
        (BadInputError, "^on_blocked: got 'ignore'", {"on_blocked": "ignore"}),
        (BadInputError, "^max_expansions: got 0; wanted 1 or more", {"max_expansions": 0}),
        (BadTypeError, "^max_expansions: got 2.5", {"max_expansions": 2.5}),
        (BadInputError, "^max_lanes: got 0", {"max_lanes": 0}),
    ],
)
def test_options(error: type[Exception], message: str, changes: dict[str, Any]) -> None:
    if message.startswith("^weight"):
        changes = {**changes, "weight": 2}
    assert_refused(error, message, **changes)


@pytest.mark.parametrize(
    ("value", "error"),
    [
        (0.99, BadInputError),
        (101, BadInputError),
        (float("nan"), BadInputError),
        ("2", BadTypeError),
    ],
)
def test_weights(value: Any, error: type[Exception]) -> None:
    assert_refused(error, "^weight: got", heuristic="weighted_octile", weight=value)


@pytest.mark.parametrize(
    ("given", "used"), [((10001, 10001), (9, 11)), ((3, 10001), (3, 11)), (None, None)]
)
def test_a_window_is_no_larger_than_what_sees_the_whole_map(
    given: Any, used: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    tasks: list[Any] = []
    monkeypatch.setattr(replanning, "_sail", tasks.append)
    sail(sensing=given)
    assert tasks[0].static.sensing == used
    thin = {"blocked": np.zeros((1, 9), bool), "starts": [0, 0], "goals": [5, 0]}
    sail(**thin, flips=np.full((1, 2, 1, 2), -1), sensing=given)
    assert tasks[1].static.sensing == (given and (3, min(17, given[1])))


# --- sizes --------------------------------------------------------------------------------------


def test_more_steps_than_keys_can_hold() -> None:
    flips = np.full((1, 9500, 0, 2), -1)
    message = "^flips: got 9500 steps on maps of 6 x 5 cells; wanted at most 93.. with"
    assert_refused(BadInputError, message, flips=flips)


def test_maps_too_large_for_eq_17() -> None:
    large = {"blocked": np.zeros((2, 2900), bool), "starts": [0, 0], "goals": [5, 0]}
    message = "^blocked: got maps of 2900 x 2 cells; wanted a diagonal of at most 2800 cells"
    for heuristic in ("weighted", "weighted_octile"):
        assert_refused(BadInputError, message, **large, heuristic=heuristic)
    with pytest.raises(ComputeError):
        sail(**large)


def test_more_than_the_memory_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("usvjax.memory.free_memory", lambda: 2**12)
    message = r"^blocked: \d+ episodes at once on 6 x 5 cells needs .* has 4.0 KiB left"
    assert_refused(BadInputError, message)
