"""Parameter sets, and what they are checked for."""

from dataclasses import fields, replace
from math import pi, radians
from typing import Any

import numpy as np
import pytest

import usvjax as uj
from usvjax.missions.dwa.params import check_dwa, window_size

KNOT = 1852.0 / 3600.0  # m/s
NAUTICAL_MILE = 1852.0  # m


# --- the sets ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", uj.preset_names())
def test_every_preset_passes_its_own_check(name: str) -> None:
    chosen = uj.preset(name)
    check_dwa(chosen.params, chosen.static)
    assert chosen.source
    assert (chosen.static.n_v, chosen.static.n_w) == window_size(chosen.params)
    for count in ("n_v", "n_w"):
        fewer = replace(chosen.static, **{count: getattr(chosen.static, count) - 1})
        with pytest.raises(uj.BadInputError, match=count):
            check_dwa(chosen.params, fewer)


def test_the_papers_and_the_demo_are_there() -> None:
    assert {"tan2022", "wei2023", "pythonrobotics"} <= set(uj.preset_names())


def test_tan2022_is_table_1() -> None:
    p, static = uj.preset("tan2022").params, uj.preset("tan2022").static
    printed = {
        "v_max": 1.0,
        "v_min": -1.0,
        "w_max": 0.5236,
        "w_min": -0.5236,
        "v_acc": 0.2,
        "v_dec": 0.2,
        "w_acc": 0.8727,
        "w_dec": 0.8727,
        "heading_weight": 0.05,
        "clearance_weight": 0.2,
        "velocity_weight": 0.1,
        "search_angle": pi / 3,
    }
    assert {name: getattr(p, name) for name in printed} == printed
    assert static.horizon * p.dt == pytest.approx(3.0)  # t_sim
    # Not printed; taken from the demo that the printed numbers come from.
    assert (p.dt, p.v_step, p.w_step) == (0.1, 0.01, pytest.approx(radians(1)))
    assert (static.n_v, static.n_w) == (5, 11)


def test_tan2022_is_the_default() -> None:
    assert uj.preset("tan2022").params == uj.DwaParams()
    assert uj.preset("tan2022").static == uj.DwaStatic()


def test_wei2023_is_tables_1_and_2_in_si() -> None:
    p, static = uj.preset("wei2023").params, uj.preset("wei2023").static
    printed = {
        "v_min": 0.0,
        "v_max": 20 * KNOT,  # 10.29 m/s
        "w_min": -radians(15),
        "w_max": radians(15),
        "v_acc": 2 * KNOT,
        "v_dec": 2 * KNOT,
        "w_acc": radians(5),
        "w_dec": radians(5),
        "radius": 0.25 * NAUTICAL_MILE,  # 463 m
        "v_step": 0.1 * KNOT,
        "w_step": radians(1),
        "heading_weight": 0.1,
        "clearance_weight": 0.1,
        "velocity_weight": 0.7,
    }
    for name, value in printed.items():
        assert getattr(p, name) == pytest.approx(value, rel=1e-12), name
    assert p.v_max == pytest.approx(10.289, abs=1e-3)
    assert p.radius == 463.0
    assert static.horizon * p.dt == pytest.approx(120.0)  # predicted track time


@pytest.mark.parametrize(
    ("asked", "nearest"),
    [("tan2021", "tan2022"), ("Wei2023", "wei2023"), ("pythonrobot", "python")],
)
def test_unknown_preset_names_the_nearest(asked: str, nearest: str) -> None:
    with pytest.raises(
        uj.BadInputError, match=rf"preset: got '{asked}'; .*did you mean '{nearest}"
    ):
        uj.preset(asked)


def test_presets_cannot_be_changed_by_accident() -> None:
    with pytest.raises(AttributeError):
        uj.preset("tan2022").params.radius = 1.0  # type: ignore[misc]
    hash(uj.preset("tan2022").static)


# --- the window's size ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "size"),
    [
        ({}, (5, 11)),
        ({"v_step": 0.005}, (9, 11)),
        ({"v_acc": 0.0, "v_dec": 0.0}, (1, 11)),
        ({"w_max": -0.5236 + 0.01}, (5, 1)),  # v_max - v_min bounds the window, too
        ({"w_min": 0.1, "w_max": 0.1}, (5, 1)),
        ({"v_acc": np.array([0.2, 0.4, 0.1])}, (7, 11)),  # the widest of a sweep
        ({"dt": 0.05}, (3, 6)),
    ],
)
def test_fit_window(change: dict[str, Any], size: tuple[int, int]) -> None:
    params = replace(uj.DwaParams(), **change)
    static = uj.fit_window(params, uj.DwaStatic(horizon=7, n_v=1, n_w=1))
    assert (static.n_v, static.n_w) == size
    assert static == uj.DwaStatic(horizon=7, n_v=size[0], n_w=size[1])


# --- bad parameters ---------------------------------------------------------------------------

NAN, INF = float("nan"), float("inf")
NUMBERS = [f.name for f in fields(uj.DwaParams)]


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("value", [NAN, INF, -INF])
def test_every_number_must_be_finite(name: str, value: float) -> None:
    params = replace(uj.DwaParams(), **{name: value})
    if name == "clearance_cap" and value == INF:
        check_dwa(params, uj.DwaStatic())  # no cap
        return
    with pytest.raises(uj.BadInputError, match=rf"params\.{name}: got -?(nan|inf); wanted "):
        check_dwa(params, uj.DwaStatic())


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("value", ["0.5", None, True, 1j, [["a"]]])
def test_every_number_must_be_one(name: str, value: object) -> None:
    params = replace(uj.DwaParams(), **{name: value})
    with pytest.raises(uj.BadTypeError, match=rf"params\.{name}: got .*; wanted a number"):
        check_dwa(params, uj.DwaStatic())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"radius": -0.5}, r"params\.radius: got -0\.5; wanted 0 or more"),
        ({"dt": 0.0}, r"params\.dt: got 0; wanted more than 0"),
        ({"dt": -0.1}, r"params\.dt: got -0\.1; wanted more than 0"),
        ({"v_min": 1.5}, r"params\.v_min: got 1\.5; wanted at most v_max = 1"),
        ({"w_min": 0.6}, r"params\.w_min: got 0\.6; wanted at most w_max = 0\.5236"),
        ({"v_step": 0.0}, r"params\.v_step: got 0; wanted more than 0"),
        ({"w_step": -1.0}, r"params\.w_step: got -1; wanted more than 0"),
        ({"v_acc": -0.2}, r"params\.v_acc: got -0\.2; wanted 0 or more"),
        ({"v_dec": -0.2}, r"params\.v_dec: got -0\.2; wanted 0 or more"),
        ({"w_acc": -0.2}, r"params\.w_acc: got"),
        ({"w_dec": -0.2}, r"params\.w_dec: got"),
        ({"goal_tolerance": 0.0}, r"params\.goal_tolerance: got 0; wanted more than 0"),
        ({"stuck_time": 0}, r"params\.stuck_time: got 0; wanted more than 0"),
        ({"stuck_distance": -1}, r"params\.stuck_distance: got -1; wanted 0 or more"),
        ({"clear_distance": 0.0}, r"params\.clear_distance: got 0; wanted more than 0"),
        ({"clearance_cap": -1.0}, r"params\.clearance_cap: got -1; wanted 0 or more"),
        ({"radius": 0.0}, r"params\.radius: got 0; wanted at least 0\.1 m, one step dt at full"),
        ({"dt": 0.6}, r"params\.radius: got 0\.5; wanted at least 0\.6 m, one step dt at full"),
        ({"v_min": -5.1}, r"params\.radius: got 0\.5; wanted at least 0\.51 m, one step dt at"),
        ({"search_angle": 0.0}, r"params\.search_angle: got 0; wanted an angle in \(0, pi\] rad"),
        ({"search_angle": 60.0}, r"params\.search_angle: got 60; wanted an angle in \(0, pi\]"),
    ],
)
def test_impossible_numbers(change: dict[str, float], message: str) -> None:
    with pytest.raises(uj.BadInputError, match=message):
        check_dwa(replace(uj.DwaParams(), **change), uj.DwaStatic())


def test_a_step_may_be_as_long_as_the_radius() -> None:
    params = uj.DwaParams(v_max=3.0, dt=0.1, radius=0.3)
    assert params.v_max * params.dt > 0.3, "by rounding"
    check_dwa(params, uj.DwaStatic())


def test_one_bad_value_of_a_sweep_is_named() -> None:
    radius = np.array([0.2, 0.5, -0.7])
    with pytest.raises(uj.BadInputError, match=r"params\.radius: got -0\.7; wanted 0 or more"):
        check_dwa(uj.DwaParams(radius=radius), uj.DwaStatic(), 3)
    v_max = np.array([1.0, -2.0, 1.0])
    with pytest.raises(uj.BadInputError, match=r"params\.v_min: got -1; wanted at most v_max"):
        check_dwa(uj.DwaParams(v_max=v_max), uj.DwaStatic(), 3)


@pytest.mark.parametrize(
    ("value", "episodes", "wanted"),
    [
        (np.ones(3), None, r"shape \(3,\); wanted one number$"),
        (np.ones(3), 4, r"shape \(3,\); wanted one number, or shape \(4,\)"),
        (np.ones((4, 1)), 4, r"shape \(4, 1\); wanted one number, or shape \(4,\)"),
        (np.ones(0), 4, r"shape \(0,\); wanted one number, or shape \(4,\)"),
        ([[1.0], [1.0, 2.0]], 2, "rows of unequal length"),
    ],
)
def test_sweeps_of_the_wrong_shape(value: Any, episodes: int | None, wanted: str) -> None:
    with pytest.raises(uj.BadInputError, match=rf"params\.dt: (got )?{wanted}"):
        check_dwa(uj.DwaParams(dt=value), uj.DwaStatic(), episodes)


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"method": "tradtional"}, uj.BadInputError, "got 'tradtional'.*mean 'traditional'"),
        ({"method": "Improved"}, uj.BadInputError, "got 'Improved'.*mean 'improved'"),
        ({"method": None}, uj.BadTypeError, "got None; wanted a string"),
        ({"clearance": "endpoints"}, uj.BadInputError, "got 'endpoints'.*mean 'endpoint'"),
        ({"clearance_score": "reciprocol"}, uj.BadInputError, ".*mean 'reciprocal'"),
        ({"normalise": "summ"}, uj.BadInputError, "got 'summ'.*mean 'sum'"),
        ({"when_blocked": "break"}, uj.BadInputError, "got 'break'.*mean 'brake'"),
        ({"n_v": 4}, uj.BadInputError, "4 candidates; the window .* holds 5 .*fit_window"),
        ({"n_w": 10}, uj.BadInputError, "10 candidates; the window .* holds 11 .*fit_window"),
        ({"n_v": 0}, uj.BadInputError, "got 0; wanted 1 or more"),
        ({"horizon": 0}, uj.BadInputError, "got 0; wanted 1 or more"),
        ({"horizon": 30.0}, uj.BadTypeError, "got 30.0; wanted a whole number"),
        ({"max_steps": -1}, uj.BadInputError, "got -1; wanted 1 or more"),
        ({"max_steps": True}, uj.BadTypeError, "got True; wanted a whole number"),
        ({"n_w": "11"}, uj.BadTypeError, "got '11'; wanted a whole number"),
        ({"braking": "no"}, uj.BadTypeError, "got 'no'; wanted a bool"),
        ({"plant": "unicylce"}, uj.BadInputError, "got 'unicylce'.*mean 'unicycle'"),
        ({"plant": True}, uj.BadTypeError, "got True; wanted a function, or one of heading_first"),
    ],
)
def test_impossible_choices(change: dict[str, Any], error: type[Exception], message: str) -> None:
    (name,) = change
    with pytest.raises(error, match=rf"static\.{name}: {message}"):
        check_dwa(uj.DwaParams(), replace(uj.DwaStatic(), **change))


def test_params_and_static_of_another_class() -> None:
    with pytest.raises(uj.BadTypeError, match="params: got dict; wanted DwaParams"):
        check_dwa({"radius": 0.5}, uj.DwaStatic())  # type: ignore[arg-type]
    with pytest.raises(uj.BadTypeError, match="static: got DwaParams; wanted DwaStatic"):
        check_dwa(uj.DwaParams(), uj.DwaParams())  # type: ignore[arg-type]
