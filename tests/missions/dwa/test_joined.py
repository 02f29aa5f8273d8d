"""Conditions in one call: every row is the same bits as alone, whichever share it."""

import itertools
from dataclasses import fields, replace

import numpy as np
import pytest
from navigate_episodes import assert_same
from property_draws import FUZZ

import usvjax as uj
from usvjax.errors import BadInputError
from usvjax.missions.dwa import posed
from usvjax.missions.dwa.mission import MISSION
from usvjax.missions.dwa.params import fit_window
from usvjax.presets import preset, preset_names
from usvjax.study import parse_spec
from usvjax.study.calls import Kindred
from usvjax.study.shards import Unit
from usvjax.study.units import run_unit, run_units

pytestmark = pytest.mark.usefixtures("one_device")

COARSE = {"v_step": 0.04, "w_step": 0.1}
SHORT = {"horizon": 6, "max_steps": 200}


def study(**changes):
    base = {"name": "joined", "kind": "dwa", "episodes": 10, "shard": 6, "seed": 4}
    base |= {"maps": {"hi": 4, "goal": [4.0, 4.0]}, "params": COARSE, "static": SHORT}
    return parse_spec(base | changes)


SWEEP = {
    "params.radius": [0.3, 0.4],
    "params.clearance_cap": [0.5, 1.0],
    "maps.rate": [0.1, 0.3],
    "params.goal_tolerance": [0.4, 0.5],
}


@pytest.fixture(scope="module")
def alone():
    """A study of sixteen conditions, and the rows of each unit that had a call of its own."""
    spec = study(axes=SWEEP)
    units = [Unit(c, s) for s in range(2) for c in range(16)]
    return spec, {unit: run_unit(spec, unit) for unit in units}


@pytest.mark.parametrize("seed", range(8))
def test_rows_are_the_same_bits_in_any_company(alone, seed):
    spec, rows = alone
    rng = np.random.default_rng(seed)
    kindred = Kindred(spec)
    assert len(set(kindred.key)) == 1
    order = [list(rows)[i] for i in rng.permutation(len(rows))]
    cuts = [0, *np.sort(rng.choice(np.arange(1, len(rows)), 3, replace=False)), len(rows)]
    for first, last in itertools.pairwise(cuts):
        units = order[first:last]
        tables = run_units(spec, units, kindred, first_method=int(rng.integers(2)))
        for unit, table in zip(units, tables, strict=True):
            assert table.equals(rows[unit], null_equal=True)


@pytest.mark.skipif(not FUZZ, reason="by `make fuzz`: programs of its own")
@pytest.mark.parametrize("method", ["traditional", "improved"])
def test_one_value_per_episode_is_the_same_bits_as_one_for_all(method):
    rng = np.random.default_rng(1)
    ends: set[int] = set()
    for name in preset_names():
        base = preset(name)
        p = base.params
        # Two speeds and three yaw rates, so that one small program does for all presets.
        p = replace(
            p,
            v_step=(p.v_acc + p.v_dec) * p.dt / 1.5,
            w_step=(p.w_acc + p.w_dec) * p.dt / 2.5,
        )
        choices = {"normalise": "sum", "clearance_score": "distance", "clearance": "trajectory"}
        static = replace(base.static, method=method, horizon=4, max_steps=150, **choices)
        static = fit_window(p, replace(static, braking=True, plant="unicycle"))
        side = 16.0 * float(p.radius)
        obstacles = rng.uniform(0.2 * side, 0.9 * side, (64, 8, 2))
        starts = np.column_stack([np.zeros((64, 2)), rng.uniform(0.0, 1.5, 64)])
        where = obstacles, starts, [side, side]
        each = {f.name: np.full(64, float(getattr(p, f.name))) for f in fields(p)}
        one = uj.navigate_dwa(*where, params=p, static=static)
        assert_same(uj.navigate_dwa(*where, params=uj.DwaParams(**each), static=static), one)
        ends |= set(one.status.tolist())
    assert len(ends) > 1


def kin(**changes):
    spec = study(**changes)
    return [MISSION.kin(condition.case) for condition in spec.conditions]


@pytest.mark.parametrize(
    ("axis", "values"),
    [
        ("static.horizon", [6, 7]),
        ("static.clearance", ["endpoint", "trajectory"]),
        ("maps.hi", [4, 9]),  # larger maps, with more rows of obstacles
        ("params.w_acc", [0.5, 1.5]),  # a wider window, of more candidates
    ],
)
def test_what_differs_in_more_than_numbers_shares_no_call(axis, values):
    one, other = kin(axes={axis: values}, maps={"rate": 0.6, "goal": [4.0, 4.0]})
    assert one.key != other.key


def test_numbers_and_sources_of_circles_share_calls():
    conditions = [{"maps.rate": 0.2}, {"params.v_max": 0.8}, {"params.stuck_time": 9.0}]
    assert len({one.key for one in kin(conditions=conditions)}) == 1


def test_large_maps_have_fewer_episodes_in_a_call():
    few, many = kin(axes={"maps.hi": [4, 90]}, maps={"rate": 0.5, "goal": [4.0, 4.0]})
    assert few.most == 8192
    assert 16 <= many.most < 1024


def test_on_a_chart_those_that_see_as_far_share_calls():
    maps = {"source": "grid", "map": "hongze-1000", "shore_distance": 2500.0}
    axes = {"params.clearance_cap": [300.0, 500.0], "params.radius": [800.0, 900.0]}
    params = {"preset": "lake"}
    found = kin(maps=maps, params=params, static={}, axes=axes)
    assert [one.key == found[0].key for one in found] == [True, False, True, False]


def test_the_memory_of_all_is_asked_for_before_they_are_joined(monkeypatch):
    spec = study(axes=SWEEP)
    kindred = Kindred(spec)
    asked = []
    monkeypatch.setattr(posed, "check_memory", lambda needed, what: asked.append((needed, what)))
    kindred.pose([Unit(c, 0) for c in range(4)])
    ((four, words),) = asked
    assert "24 episodes" in words
    kindred.pose([Unit(c, 0) for c in range(8)])
    assert asked[1][0] == 2 * four

    def refuse(needed, what):
        raise BadInputError(what)

    monkeypatch.setattr(posed, "check_memory", refuse)
    with pytest.raises(BadInputError, match="at once"):
        kindred.pose([Unit(0, 0), Unit(1, 0)])
