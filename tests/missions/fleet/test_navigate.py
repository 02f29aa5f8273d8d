"""Fleets: who is masked is not there, endings are right, what cannot be sailed is refused."""

import time
from dataclasses import fields

import fleet_encounters
import numpy as np
import pytest
from property_draws import FUZZ

import usvjax as uj
from usvjax.missions.fleet.ground import Circles
from usvkernels.status import Status

pytestmark = pytest.mark.usefixtures("one_device")


def layouts(count: int, n: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Starts, goals and circles of fleets whose routes cross among obstacles."""
    rng = np.random.default_rng(seed)
    angle = 2 * np.pi * (np.arange(n) + rng.uniform(-0.2, 0.2, (count, n))) / n
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1) * 3000.0
    starts = np.concatenate([ring, (angle + np.pi)[..., None]], axis=-1)
    goals = -ring[:, rng.permutation(n)]
    circles = rng.uniform(-1500, 1500, (count, 4, 2))
    return starts, goals, circles


PARAMS = uj.FleetParams(hull_radius=20.0, obstacle_radius=150.0)


def sail(starts, goals, circles, strategy: str, valid=None):
    return uj.navigate(circles, starts, goals, encounters=strategy, valid=valid, params=PARAMS)


def test_who_sails_to_a_place_beside_an_obstacle_arrives():
    """Four vessels a fleet, each to a place 30 m from touching an obstacle, from all round it."""
    count, beside = 16, PARAMS.hull_radius + PARAMS.obstacle_radius + 30.0
    circles = np.array([[9e3, 0.0], [-9e3, 0.0], [0.0, 9e3], [0.0, -9e3]])
    angle = np.linspace(-np.pi, np.pi, 4 * count, endpoint=False).reshape(count, 4)
    way = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    starts = np.concatenate([circles + 1500.0 * way, angle[..., None]], axis=-1)
    goals = circles + beside * np.array([1.0, 0.0])
    every = np.tile(circles, (count, 1, 1)), starts, np.tile(goals, (count, 1, 1))
    found = uj.navigate(*every, params=PARAMS)
    assert (found.status == Status.REACHED).all()
    assert (found.path_length < 1.05 * found.route_length).all()
    printed = uj.navigate(*every, params=PARAMS, static=uj.FleetStatic(clearance="printed"))
    assert (printed.path_length > 1.2 * printed.route_length).any()


@pytest.mark.skipif(not FUZZ, reason="by `make fuzz`: programs of its own")
def test_masked_vessels_are_not_there():
    starts, goals, circles = layouts(16, 4, 2)
    valid = np.ones((16, 4), bool)
    valid[:, 3] = False
    masked = sail(starts, goals, circles, "rules", valid=valid)
    starts[:, 3, :2], goals[:, 3] = 1e5, 1e5 + 100.0
    away = sail(starts, goals, circles, "rules")
    assert (masked.vessel_status[:, 3] == -1).all()
    assert np.array_equal(masked.vessel_status[:, :3], away.vessel_status[:, :3])
    assert np.array_equal(masked.path_length[:, :3], away.path_length[:, :3])


@pytest.mark.skipif(not FUZZ, reason="by `make fuzz`: programs of its own")
def test_alone_all_strategies_sail_the_same_way():
    starts, goals, circles = layouts(16, 4, 3)
    valid = np.zeros((16, 4), bool)
    valid[:, 1] = True
    found = [sail(starts, goals, circles, how, valid) for how in ("none", "rules", "wei2023")]
    for other in found[1:]:
        assert np.array_equal(other.path_length, found[0].path_length)
        assert np.array_equal(other.status, found[0].status)
    assert (found[0].status == Status.REACHED).all()


def test_swaps_across_a_circle_end_without_contact():
    starts, valid = np.zeros((3, 8, 3)), np.zeros((3, 8), bool)
    for row, n in enumerate((3, 4, 8)):
        angle = 2 * np.pi * np.arange(8) / n
        starts[row] = np.stack([3000 * np.cos(angle), 3000 * np.sin(angle), angle + np.pi], axis=1)
        starts[row, n:, :2] *= 3.0
        valid[row, :n] = True
    found = uj.navigate(
        None, starts, -starts[..., :2], valid=valid, params=uj.FleetParams(hull_radius=20.0)
    )
    assert (found.status == Status.REACHED).all()
    assert found.min_separation.min() > 50.0


def test_random_encounters_by_the_rules_have_no_contact_and_some_without():
    met = fleet_encounters.draw(300 if FUZZ else 100, seed=11)
    params = uj.FleetParams(hull_radius=met.hull, v_max=met.speed)
    speeds = met.speed * (1 - 1e-7)
    run = {
        how: uj.navigate(None, met.start, met.goal, speeds=speeds, encounters=how, params=params)
        for how in ("rules", "none")
    }
    assert (run["rules"].status == Status.REACHED).all()
    assert run["rules"].min_separation.min() > 20.0
    touching = met.dcpa < met.hull.sum(axis=1)
    assert touching.mean() > 0.2
    assert np.mean(run["none"].status[touching] == Status.COLLIDED) > 0.9


def test_headings_at_the_goal():
    rng = np.random.default_rng(4)
    starts = np.concatenate([np.zeros((24, 1, 2)), rng.uniform(-3, 3, (24, 1, 1))], axis=2)
    goals = rng.uniform(-1, 1, (24, 1, 2)) * 4000.0
    wanted = np.repeat([0.0, np.pi / 3, np.pi / 2], 8)[:, None]
    found = uj.navigate(None, starts, goals, headings=wanted)
    assert (found.status == Status.REACHED).all()
    assert np.degrees(found.heading_error).max() < 5.0
    shut = uj.navigate(
        starts[:1, 0, :2] + np.array([[900.0, 0.0], [0.0, 900.0], [-900.0, 0.0], [0.0, -900.0]]),
        starts[:1] + np.array([5000.0, 5000.0, 0.0]),
        starts[:1, :, :2],
        headings=[[0.0]],
    )
    assert shut.status[0] == Status.NO_APPROACH


def test_a_goal_within_a_ring_of_circles_is_unreachable():
    angle = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1) * 1500.0
    found = uj.navigate(ring, [[[-5000.0, 0.0, 0.0]]], [[[0.0, 0.0]]])
    assert found.status[0] == Status.UNREACHABLE
    assert found.path_length[0, 0] == 0.0


LAKE = np.zeros((40, 40), bool)
LAKE[10:20, 10:20] = True
LAKE = uj.GridMap(LAKE, 100.0, (1000.0, 2000.0))
AFLOAT = {
    "scene": LAKE,
    "starts": [[[1150, 2150, 0], [1150, 5500, 0]]],
    "goals": [[[4550, 5550], [4550, 2550]]],
}
NAN = np.nan


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (AFLOAT | {"goals": [[[4550, 5550], [2550, 3550]]]}, r"^goals: vessel 1 .* an obstacle"),
        (AFLOAT | {"goals": [[[5550, 5550], [4550, 2550]]]}, r"^goals: vessel 0 .* off the map"),
        (
            AFLOAT | {"starts": [[[2550, 3550, 0], [1150, 5500, 0]]]},
            r"^starts: vessel 0 of fleet 0 at \(2550, 3550\) m touches an obstacle",
        ),
        (AFLOAT | {"velocities": [[1.0, 0.0]]}, "^velocities: got some; only circles move"),
        ({"scene": [[100.0, 3000.0]]}, r"^goals: vessel 1 .* wanted it 170 m from"),
        ({"scene": [[100.0, 0.0]]}, "^starts: vessel 0 .* an obstacle"),
        ({"scene": np.zeros((1, 0, 3), bool)}, r"^scene: got bool\[1, 0, 3\]"),
        (
            {"scene": np.broadcast_to(np.zeros((1, 1, 1), bool), (1, 40_000, 40_000))},
            "^scene: a map has 40,000 x 40,000 cells; wanted at most",
        ),
        (
            {"starts": [[[0, 0, 0], [30, 0, 0]]]},
            "^starts: vessels 0 and 1 of fleet 0 are 30 m apart; wanted at least 40 m",
        ),
        ({"goals": [[[0, 3000], [30, 3000]]]}, "^goals: vessels 0 and 1 of fleet 0 are 30 m"),
        ({"starts": [[[3e5, 0, 0], [0, 0, 0]]]}, r"^starts: .* within 200000 m of \(0, 0\)"),
        ({"valid": [[False, False]]}, "^valid: fleet 0 has no vessel"),
        (
            {"speeds": [[0.0, 20.0]]},
            r"^speeds: vessel 1 .* 20 m/s; wanted 0 to v_max, 10\.2889 m/s",
        ),
        ({"encounters": "rule"}, "^encounters: got 'rule'; did you mean 'rules'"),
        ({"static": uj.FleetStatic(unit_length=0.1)}, "^static.unit_length: got 0.1 m, of which"),
        ({"static": uj.FleetStatic(look_ahead=1e5)}, "^static.look_ahead: got 100000 m"),
        ({"static": uj.FleetStatic(n_v=1000, n_w=1000)}, "^static: 1000 x 1000 candidates"),
        ({"static": uj.FleetStatic(n_v=40)}, "^static.n_v: 40 candidates; .* holds 41"),
        (
            {"scene": [[1500.0, 1500.0]], "static": uj.FleetStatic(cell_size=0.01)},
            "^static.cell_size: of 0.01 m: the grid of a route has .* cells; wanted at most",
        ),
        (
            {
                "params": uj.FleetParams(v_max=0.1, v_step=0.1),
                "static": uj.FleetStatic(unit_length=0.01, look_ahead=1.0),
            },
            "^static.unit_length: got 0.01 m, for a route of .* at most 65,536 points",
        ),
        ({"starts": [[[0, NAN, 0], [3000, 0, 0]]]}, "^starts: nan at index"),
        ({"goals": [[[0, 3000], [NAN, 3000]]]}, "^goals: nan at index"),
        ({"headings": [[0.0, NAN]]}, "^headings: nan at index"),
        ({"speeds": [[0.0, NAN]]}, "^speeds: nan at index"),
        ({"scene": [[NAN, 1000.0]]}, "^scene: nan at index"),
        ({"scene": [[900.0, 900.0]], "velocities": [[NAN, 0.0]]}, "^velocities: nan at index"),
        ({"static": uj.FleetStatic(guide_length=NAN)}, "^static.guide_length: got nan"),
        *(
            ({"params": uj.FleetParams(**{f.name: NAN})}, f"^params.{f.name}: got nan")
            for f in fields(uj.FleetParams)
        ),
    ],
)
def test_what_cannot_be_sailed_is_refused_at_once(given, says):
    usual = {
        "scene": None,
        "starts": [[[0, 0, 0], [3000, 0, 3]]],
        "goals": [[[3000, 3000], [0, 3000]]],
        "params": PARAMS,
    }
    began = time.process_time()
    with pytest.raises(uj.BadInputError, match=says):
        uj.navigate(**(usual | given))
    assert time.process_time() - began < 1.0


def test_grids_of_routes_are_searched_some_at_a_time(monkeypatch):
    circles = np.array([[[1000.0, 0.0], [1000.0, 400.0]], [[2000.0, 100.0], [1000.0, -317.0]]])
    start, end = np.zeros((5, 2)), np.linspace([3000.0, -300.0], [3000.0, 300.0], 5)
    fleet, reach = np.array([0, 1, 0, 1, 0]), np.full(5, 250.0)
    ground = Circles(circles, 60.0)
    whole = ground.path(fleet, start, end, reach)
    monkeypatch.setattr("usvjax.missions.fleet.ground.MOST_CELLS", 1)
    apart = ground.path(fleet, start, end, reach)
    assert whole[2].all()
    assert whole[1].max() > 2
    for one, other in zip(whole, apart, strict=True):
        assert np.array_equal(one, other)
    for row in range(5):
        way = whole[0][row, : whole[1][row]]
        alone = np.full(len(way) - 1, fleet[row]), way[:-1], way[1:], np.full(len(way) - 1, 250.0)
        assert ground.clear(*alone).all()


def test_ways_through_long_narrow_water_have_grids_as_narrow():
    """A channel of 40 km by 100 m in cells of 3 m: a square grid of it would not fit."""
    along = np.arange(500.0, 40_000.0, 1500.0)
    ground = Circles(np.stack([along, np.zeros_like(along)], axis=-1)[None], 3.0)
    start, end = np.zeros((1, 2)), np.array([[40_000.0, 0.0]])
    grids = ground._grids_for(np.zeros(1, int), start, end, np.full(1, 12.0))
    assert grids.sides.tolist() == [[16384, 32]]


@pytest.mark.skipif(not FUZZ, reason="by `make fuzz`: programs of its own")
def test_maps_are_sailed_round_and_places_on_an_edge_are_places():
    rng = np.random.default_rng(6)
    blocked = np.zeros((16, 40, 40), bool)
    blocked[:, 8:32, 8:32] = rng.random((16, 24, 24)) < 0.06
    params = uj.FleetParams(
        v_max=2.0,
        v_acc=0.5,
        v_dec=0.5,
        v_step=0.1,
        hull_radius=0.2,
        passing=1.0,
        goal_tolerance=1.0,
        clearance_cap=3.0,
    )
    static = uj.FleetStatic(n_v=11, unit_length=1.0, look_ahead=4.0, guide_length=6.0)
    starts = np.tile([[[2.0, 2.5, 0.0], [37.5, 2.0, 1.5]]], (16, 1, 1))
    goals = np.tile([[[37.0, 37.0], [2.5, 37.5]]], (16, 1, 1))
    own = uj.navigate(blocked, starts, goals, params=params, static=static)
    assert (own.status == Status.REACHED).all()
    assert own.min_clearance.min() > 0.0
    grid = uj.GridMap(blocked[3], cell_size=1.0, origin=(1000.0, -500.0))
    corner = np.array([1000.0, -500.0])
    shared = uj.navigate(
        grid, starts + np.append(corner, 0.0), goals + corner, params=params, static=static
    )
    assert (shared.status == Status.REACHED).all()
    assert shared.final[3, :, :2] - corner == pytest.approx(own.final[3, :, :2], abs=2.0)
    shut = np.ones((40, 40), bool)
    shut[:10] = shut[30:] = False
    apart = uj.navigate(shut, starts[:1], goals[:1], params=params, static=static)
    assert (apart.vessel_status == Status.UNREACHABLE).all()
