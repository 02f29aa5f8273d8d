"""`uj.distance_field`: the exact way from every cell to the nearest of several goals."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from grid_oracle import lengths
from hypothesis import given
from hypothesis import strategies as st
from property_draws import examples

import usvjax as uj
from usvjax.search.distance import distance_field

RULES: dict[str, dict[str, Any]] = {
    "octile": {},
    "cutting": {"corner_cutting": True},
    "four": {"connectivity": 4},
}
DATA = Path(__file__).parents[3] / "shared" / "data" / "movingai"


def random_fields(
    seed: int, count: int, shape: tuple[int, int], most_goals: int = 4
) -> tuple[np.ndarray, np.ndarray]:
    """Random maps and goal sets padded with -1."""
    rng = np.random.default_rng(seed)
    height, width = shape
    blocked = rng.random((count, height, width)) < rng.random((count, 1, 1)) * 0.6
    goals = rng.integers(0, [width, height], (count, most_goals, 2))
    blocked[np.arange(count)[:, None], goals[..., 1], goals[..., 0]] = False
    goals[np.arange(most_goals) > rng.integers(0, most_goals, (count, 1))] = -1
    return blocked, goals


def assert_exact(
    fields: np.ndarray, blocked: np.ndarray, goals: np.ndarray, rules: dict[str, Any]
) -> None:
    assert fields.dtype == np.float32
    for field, grid, row in zip(fields, blocked, goals, strict=True):
        oracle = lengths(grid, row[row[:, 0] >= 0], **rules)
        np.testing.assert_allclose(field, oracle.astype(np.float32), rtol=1.2e-7)


@pytest.mark.parametrize("rule", RULES)
def test_random_maps(rule: str) -> None:
    blocked, goals = random_fields(1, 100, (24, 37))
    assert_exact(distance_field(blocked, goals, **RULES[rule]), blocked, goals, RULES[rule])


@pytest.mark.parametrize("shape", [(1, 9), (9, 1), (1, 1), (90, 210)])
def test_other_shapes(shape: tuple[int, int]) -> None:
    blocked, goals = random_fields(2, 5, shape)
    assert_exact(distance_field(blocked, goals), blocked, goals, {})


@examples(30)
@given(st.integers(0, 2**32 - 1))
def test_any_map(seed: int) -> None:
    blocked, goals = random_fields(seed, 8, (24, 37))
    assert_exact(distance_field(blocked, goals), blocked, goals, {})


def test_ways_longer_than_the_narrow_units() -> None:
    blocked = np.zeros((1, 61, 21), bool)
    blocked[0, 1::2] = True
    blocked[0, 1::4, -1] = blocked[0, 3::4, 0] = False
    goals = np.array([[[0, 0]]])
    fields = distance_field(blocked, goals)
    assert fields[np.isfinite(fields)].max() > 600
    assert_exact(fields, blocked, goals, {})


def test_ways_longer_than_any_units() -> None:
    blocked = np.zeros((401, 140), bool)
    blocked[1::2] = True
    blocked[1::4, -1] = blocked[3::4, 0] = False
    with pytest.raises(uj.BadInputError, match="row 0 has cells farther than 26,582 cells"):
        distance_field(blocked, [0, 0])
    assert np.isfinite(distance_field(blocked, [139, 200])).sum() == (~blocked).sum()


def test_company_makes_no_difference() -> None:
    blocked, goals = random_fields(3, 130, (24, 37))
    whole = distance_field(blocked, goals)
    for rows in (np.arange(129, -1, -1), np.array([5])):
        np.testing.assert_array_equal(distance_field(blocked[rows], goals[rows]), whole[rows])


def test_shapes_of_goals() -> None:
    blocked, _ = random_fields(4, 2, (24, 37))
    blocked[:, 3, 5] = blocked[:, 20, 30] = False
    shared = distance_field(blocked[0], [[5, 3], [30, 20]])
    assert shared.shape == (2, 24, 37)
    np.testing.assert_array_equal(shared[:1], distance_field(blocked[0], [5, 3]))
    np.testing.assert_array_equal(shared[1:], distance_field(blocked[:1], [[[30, 20], [-1, -1]]]))
    both = distance_field(blocked[0], [[[5, 3], [30, 20]]])
    np.testing.assert_array_equal(both[0], np.minimum(shared[0], shared[1]))
    each = distance_field(blocked, [5, 3])
    np.testing.assert_array_equal(each[0], shared[0])
    assert each.shape == (2, 24, 37)


def test_blocked_goals_can_be_left_out() -> None:
    blocked, _ = random_fields(5, 1, (24, 37))
    blocked[0, 3, 5], blocked[0, 20, 30] = True, False
    goals = [[[5, 3], [30, 20]]]
    with pytest.raises(uj.BadInputError, match=r"goals: \(5, 3\) in row 0 is a blocked cell"):
        distance_field(blocked, goals)
    fields = distance_field(blocked, goals, on_blocked="ignore")
    np.testing.assert_array_equal(fields, distance_field(blocked, [30, 20]))
    assert np.isinf(distance_field(blocked, [5, 3], on_blocked="ignore")).all()


def test_lake() -> None:
    lake = uj.load_map(Path(uj.__file__).parent / "data" / "hongze" / "hongze_500m.map")
    y, x = np.nonzero(~lake.blocked)
    goals = np.stack([x, y], axis=1)[:: len(x) // 3][:3, None]
    fields = distance_field(lake, goals)
    assert_exact(fields, np.repeat(lake.blocked[None], 3, axis=0), goals, {})


@pytest.mark.parametrize("name", ["cities/Shanghai_0_256", "mazes/maze512-32-0"])
def test_movingai(name: str) -> None:
    path = DATA / f"{name}.map"
    if not path.exists():
        pytest.skip(f"needs {path}")
    rows = [line.split() for line in (DATA / f"{name}.map.scen").read_text().splitlines()[1:]]
    rows = rows[:: len(rows) // 4][-4:]
    cells = np.array([[int(v) for v in row[4:8]] for row in rows])
    fields = distance_field(uj.load_map(path), cells[:, 2:])
    found = fields[np.arange(len(rows)), cells[:, 1], cells[:, 0]]
    np.testing.assert_allclose(found, [float(row[8]) for row in rows], rtol=1e-6)


# --- bad input --------------------------------------------------------------------------------

FREE = np.zeros((4, 6), bool)


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"goals": [6, 0]}, uj.BadInputError, r"goals: \(6, 0\) in row 0 lies outside the map; wa"),
        ({"goals": [[0, 0], [0, 4]]}, uj.BadInputError, r"goals: \(0, 4\) in row 1 lies outside"),
        ({"goals": [[[0, 0], [-1, 0]]]}, uj.BadInputError, r"goals: \(-1, 0\) in row 0 lies outsi"),
        ({"goals": [[[-1, -1]]]}, uj.BadInputError, "goals: row 0 is all padding; wanted at least"),
        ({"goals": [[0, 0, 0]]}, uj.BadInputError, r"goals: got shape \(1, 3\); wanted int"),
        ({"goals": np.zeros((0, 2), int)}, uj.BadInputError, r"goals: got shape \(0, 2\)"),
        ({"goals": [[0, 0], [0]]}, uj.BadInputError, "goals: rows of unequal length; wanted"),
        ({"goals": [0.0, 1.0]}, uj.BadTypeError, "goals: got dtype float64; wanted int"),
        (
            {"goals": [[0, 0]] * 2, "blocked": np.stack([FREE] * 3)},
            uj.BadInputError,
            "goals: got 2",
        ),
        ({"blocked": FREE.astype(int)}, uj.BadTypeError, "blocked: got dtype int64; wanted bool"),
        ({"blocked": FREE[:0]}, uj.BadInputError, r"blocked: got shape \(0, 6\), which has no cel"),
        ({"blocked": FREE[0]}, uj.BadInputError, r"blocked: got shape \(6,\)"),
        ({"connectivity": 6}, uj.BadInputError, "connectivity: got 6; wanted 4 or 8"),
        ({"connectivity": True}, uj.BadTypeError, "connectivity: got True; wanted a whole num"),
        (
            {"connectivity": np.array([4, 8])},
            uj.BadTypeError,
            "connectivity: got array.*; wanted a whole number",
        ),
        ({"corner_cutting": 1}, uj.BadTypeError, "corner_cutting: got 1; wanted True or False"),
        ({"on_blocked": "skip"}, uj.BadInputError, "on_blocked: got 'skip'"),
    ],
)
def test_bad_input(change: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^{message}") as caught:
        distance_field(**{"blocked": FREE, "goals": [0, 0], **change})
    assert "\n" not in str(caught.value)


def test_more_than_memory_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("usvjax.memory.free_memory", lambda: 10_000)
    with pytest.raises(uj.BadInputError, match="1000 distance fields of 6 x 4 cells needs 187"):
        distance_field(FREE, np.zeros((1000, 2), int))
