"""How a vessel moves in a control period, chosen by name or a function of the user's own."""

import json
from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from navigate_episodes import PARAMS, STATIC, B, assert_same, sail, waters

import usvjax as uj
from usvjax.mission import Case, Files
from usvjax.missions.dwa.mission import MISSION
from usvjax.missions.dwa.run import NavigateResult
from usvkernels.vessel import PLANTS, unicycle_step

EAST, NORTH = 0.15, -0.05  # m/s, a current


def drifting(x: Any, y: Any, psi: Any, v: Any, w: Any, dt: Any) -> Any:
    """A unicycle in a current; its heading is not wrapped."""
    return (
        x + (v * jnp.cos(psi) + EAST) * dt,
        y + (v * jnp.sin(psi) + NORTH) * dt,
        psi + w * dt,
    )


def anchored(x: Any, y: Any, psi: Any, v: Any, w: Any, dt: Any) -> Any:
    """Stays where it is, whatever the command."""
    return x, y, psi


def sailed(plant: Any, **options: Any) -> NavigateResult:
    static = uj.DwaStatic(**{**vars(STATIC), "plant": plant})
    return sail(*waters(), **{"static": static, "record": True, **options})


def moved(path: np.ndarray, dt: Any, ahead: float, current: tuple[float, float]) -> np.ndarray:
    """Poses [B, T, 3] one step after each but the last of [B, T + 1, 5], in double precision.

    Args:
        path: x, y, psi, v, w; the commands are those of the next row.
        dt: s, a scalar or float[B].
        ahead: share of a step's turn that comes before its way.
        current: m/s east and north.
    """
    (x, y, psi), (v, w) = path[:, :-1, :3].T.astype(float), path[:, 1:, 3:].T.astype(float)
    course = psi + ahead * w * dt
    east, north = (v * np.cos(course) + current[0]) * dt, (v * np.sin(course) + current[1]) * dt
    return np.stack([x + east, y + north, psi + w * dt]).T


def assert_moved(
    found: NavigateResult, dt: Any, ahead: float, current: tuple[float, float]
) -> None:
    path = found.trajectory
    assert path is not None
    under_way = np.arange(path.shape[1] - 1) < found.steps[:, None]
    assert under_way.sum() > 20 * B
    want, got = moved(path, dt, ahead, current)[under_way], path[:, 1:][under_way]
    # A step rounds places of up to 10 m, and angles of up to pi: twice, and 2 pi besides.
    rounding = 4 * np.finfo(np.float32).eps
    np.testing.assert_allclose(got[:, :2], want[:, :2], rtol=0, atol=rounding * 10.0 / 2)
    turned = np.exp(1j * got[:, 2]) - np.exp(1j * want[:, 2])
    assert np.abs(turned).max() < rounding * np.pi
    assert (np.abs(path[..., 2]) <= np.float32(np.pi)).all()


@pytest.mark.parametrize(("plant", "ahead"), [("unicycle", 0.0), ("heading_first", 1.0)])
def test_plants_by_name(plant: str, ahead: float) -> None:
    assert_moved(sailed(plant), PARAMS.dt, ahead, (0.0, 0.0))


def test_the_names_differ() -> None:
    turned, plain = sailed("heading_first"), sailed("unicycle")
    assert (turned.path_length != plain.path_length).any()
    assert set(PLANTS) == {"unicycle", "heading_first"}


def test_a_current_of_ones_own() -> None:
    found = sailed(drifting)
    assert_moved(found, PARAMS.dt, 0.0, (EAST, NORTH))
    assert_same(sailed(drifting, record=False), found)
    # The distance is that through the water, not over ground.
    path = found.trajectory
    assert path is not None
    under_way = np.arange(1, path.shape[1]) <= found.steps[:, None]
    through = (np.abs(path[:, 1:, 3]) * under_way).sum(axis=1) * PARAMS.dt
    np.testing.assert_allclose(found.path_length, through, rtol=1e-5)


def test_a_current_of_ones_own_with_a_period_per_episode() -> None:
    dt = np.where(np.arange(B) % 2, 0.1, 0.08)
    params = uj.DwaParams(**{**vars(PARAMS), "dt": dt})
    assert_moved(sailed(drifting, params=params), dt, 0.0, (EAST, NORTH))


def test_a_vessel_that_stays_where_it_is() -> None:
    found = sailed(anchored)
    assert found.trajectory is not None
    assert (found.trajectory[..., :3] == found.trajectory[:, :1, :3]).all()
    assert set(found.status) == {uj.Status.STUCK}


def test_a_function_may_be_the_plant_of_a_name() -> None:
    given, named = sailed(unicycle_step), sailed("unicycle")
    np.testing.assert_allclose(given.path_length, named.path_length, atol=1e-3)
    np.testing.assert_array_equal(given.status, named.status)


def test_a_plant_of_ones_own_is_predicted_as_a_unicycle() -> None:
    obstacles, starts, goals = waters()
    state = np.append(starts[0], [0.3, 0.1])

    def window(plant: Any) -> uj.DwaCandidates:
        static = uj.DwaStatic(**{**vars(STATIC), "plant": plant})
        return uj.dwa_candidates(obstacles[0], state, goals[0], params=PARAMS, static=static)

    np.testing.assert_array_equal(window(drifting).paths, window("unicycle").paths)
    assert (window("heading_first").paths != window("unicycle").paths).any()


class Unhashable:
    """A function that cannot be a key."""

    __hash__ = None  # type: ignore[assignment]

    def __call__(self, *_: Any) -> Any:
        raise NotImplementedError

    def __repr__(self) -> str:
        return "Unhashable()"


def in_numpy(x: Any, y: Any, psi: Any, v: Any, w: Any, dt: Any) -> Any:
    return x + v * np.cos(psi) * dt, y, psi


def with_a_branch(x: Any, y: Any, psi: Any, v: Any, w: Any, dt: Any) -> Any:
    return (x, y, psi) if w > 0 else (x, y, -psi)


@pytest.mark.parametrize(
    ("plant", "error", "message"),
    [
        ("unicyle", uj.BadInputError, "got 'unicyle'; did you mean 'unicycle'"),
        (None, uj.BadTypeError, "got None; wanted a function, or one of heading_first, unicycle"),
        (Unhashable(), uj.BadTypeError, r"got Unhashable\(\); wanted a function that hashes"),
        (lambda x: x, uj.BadInputError, r"cannot be traced \(TypeError: .*; wanted a function of"),
        (in_numpy, uj.BadInputError, r"in_numpy cannot be traced \(TracerArrayConversionError"),
        (with_a_branch, uj.BadInputError, r"with_a_branch cannot be traced \(.*truth value"),
        (lambda x, *_: x, uj.BadInputError, "returned .*; wanted .*, each"),
        (lambda x, y, *_: (x, y), uj.BadInputError, "returned .*; wanted .*, each"),
        (lambda x, y, *_: (x, y, 0.0), uj.BadInputError, "returned .*; wanted .*, each"),
    ],
)
def test_what_is_no_plant(plant: Callable[..., Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=rf"static\.plant: .*{message}") as caught:
        sailed(plant)
    assert "\n" not in str(caught.value)


def case_of(static: dict[str, Any]) -> Case:
    return MISSION.case({"maps": {}, "params": {}, "static": static}, Files(where="a.toml"))


def test_a_study_names_its_plant() -> None:
    found = case_of({"plant": "heading_first"})
    assert found.given.static.plant == "heading_first"
    assert json.loads(json.dumps(found.settings))["static"]["plant"] == "heading_first"
    assert case_of({}).settings["static"]["plant"] == "unicycle"


@pytest.mark.parametrize(
    ("static", "error", "message"),
    [
        ({"plant": "unicyle"}, uj.BadInputError, "static.plant: got 'unicyle'; did you mean 'uni"),
        ({"plant": True}, uj.BadTypeError, "'plant' must be a string, got True"),
        ({"heading_first": True}, uj.BadInputError, "unknown key 'heading_first'"),
    ],
)
def test_a_study_knows_plants_by_name_only(
    static: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=rf"a\.toml: .*{message}"):
        case_of(static)
