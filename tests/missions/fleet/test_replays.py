"""Fleets judged again from their records; lanes, devices, company and order change nothing."""

from dataclasses import dataclass, fields, replace

import fleet_replay
import jax
import numpy as np
import pytest
from property_draws import FUZZ

import usvjax as uj
from usvjax.devices import chosen_devices
from usvjax.missions.fleet import run
from usvjax.missions.fleet.inputs import pack
from usvjax.programs import Programs
from usvkernels.status import Status

pytestmark = pytest.mark.usefixtures("one_device")

COUNT = 125 if FUZZ else 16  # with headings, and as many without
STRATEGIES = ("rules", "wei2023", "orca", "none")
STATIC = uj.FleetStatic(n_v=9, n_w=5, max_steps=400, guide_length=600.0)
NUMBERS = {
    "v_acc": 1.0,
    "v_dec": 1.0,
    "v_step": 0.25,
    "w_step": np.radians(2.5),
    "obstacle_radius": 80.0,
    "stuck_time": 70.0,
    "livelock_time": 95.0,
}
"""What is not per vessel; a window of few candidates compiles soon."""


@dataclass(frozen=True)
class Given:
    """Fleets of 2 to 5 vessels in 5 places, as `navigate` takes them."""

    scene: np.ndarray
    starts: np.ndarray
    goals: np.ndarray
    headings: np.ndarray | None
    valid: np.ndarray
    speeds: np.ndarray
    params: uj.FleetParams


def layouts(count: int, seed: int, headings: bool) -> Given:
    """Fleets whose routes cross among circles; some vessels too slow to arrive, or to get on."""
    rng = np.random.default_rng(seed)
    shape = (count, 5)
    angle = 2 * np.pi * (np.arange(5) + rng.uniform(-0.2, 0.2, shape)) / 5
    ring = 1500.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    across = angle + np.pi + rng.uniform(-0.3, 0.3, shape)
    starts = np.concatenate([ring, across[..., None]], axis=-1)
    goals = -ring + rng.uniform(-50, 50, (count, 5, 2))
    goals[0, 0] = ring[0, 0] + 50.0  # there from the start
    valid = rng.permuted(np.arange(5) < rng.integers(2, 6, (count, 1)), axis=1)
    valid[0] = True
    fast = rng.choice([10.0, 9.0, 6.0, 0.9, 0.03], shape, p=[0.4, 0.3, 0.2, 0.05, 0.05])
    # Of those nobody arrives: 0.0718 m/s makes just more than 5 m in 70 s.
    fast[1], fast[2], fast[3] = 0.03, 0.9, 0.0718
    return Given(
        scene=rng.uniform(-900, 900, (count, 4, 2)),
        starts=starts,
        goals=goals,
        headings=across + rng.uniform(-1, 1, shape) if headings else None,
        valid=valid,
        speeds=fast * rng.uniform(0, 0.999, shape),
        params=uj.FleetParams(hull_radius=rng.uniform(21, 55, shape), v_max=fast, **NUMBERS),
    )


def sail(given: Given, strategy: str, record: bool = True) -> uj.FleetResult:
    named = {f.name: getattr(given, f.name) for f in fields(given)}
    return uj.navigate(**named, encounters=strategy, static=STATIC, record=record)


def asked(given: Given, strategy: str) -> fleet_replay.Asked:
    """What the judge is to know: arguments and routes."""
    named = {f.name: getattr(given, f.name) for f in fields(given)}
    voyage = pack(**named, velocities=None, environment=None, static=STATIC)
    routes, shape = voyage.plan.routes, given.valid.shape
    return fleet_replay.Asked(
        strategy=strategy,
        status=voyage.status,
        circles=given.scene.astype(np.float32).astype(np.float64),
        points=np.asarray(routes.points, np.float64),
        ahead=np.asarray(routes.ahead),
        last=np.asarray(routes.last),
        gate=np.asarray(routes.gate),
        bow=np.asarray(routes.bow, np.float64),
        numbers={
            f.name: np.broadcast_to(getattr(given.params, f.name), shape)
            for f in fields(given.params)
        },
        unit=STATIC.unit_length,
        max_steps=STATIC.max_steps,
    )


@dataclass(frozen=True)
class Sailed:
    """Recorded fleets, and what the judge says of them; near: bool[B, n], of a threshold."""

    strategy: str
    given: Given
    asked: fleet_replay.Asked
    found: uj.FleetResult
    verdict: fleet_replay.Verdict
    near: np.ndarray


@pytest.fixture(scope="module", params=STRATEGIES)
def sailed(request) -> list[Sailed]:
    """Without headings, and with."""
    made = []
    for seed, headings in ((1, False), (2, True)):
        given = layouts(COUNT, seed, headings)
        found, known = sail(given, request.param), asked(given, request.param)
        judged = fleet_replay.judged(known, found.trajectory)
        made.append(Sailed(request.param, given, known, found, *judged))
    return made


# --- judged again -----------------------------------------------------------------------------


def test_routes_lead_from_start_to_goal_clear_of_circles():
    for seed, headings in ((1, False), (2, True)):
        given = layouts(COUNT, seed, headings)
        known = asked(given, "none")
        ways = known.points.swapaxes(1, 2)
        sound = known.status == Status.RUNNING
        assert ways[:, 0] == pytest.approx(given.starts[..., :2], abs=1e-3)
        assert known.point(known.last)[sound] == pytest.approx(given.goals[sound], abs=1e-3)
        assert np.linalg.norm(np.diff(ways, axis=1), axis=-1).max() < known.unit + 1e-3
        reach = known.numbers["hull_radius"] + known.numbers["obstacle_radius"]
        clear = fleet_replay.clearances(ways, known.circles, reach)
        to_goal = np.arange(clear.shape[1])[:, None] < known.last[:, None]
        assert clear[to_goal & sound[:, None]].min() > -1e-3


TOLERANCES = {
    "place": 2e-4,  # m: at 2 km single precision resolves 0.12 mm
    "heading": 1e-6,
    "speed": 2e-6,  # m/s
    "turn": 1e-7,
    "gain": 2e-6,
    "loss": 2e-6,
    "swing": 1e-7,
    "anchor": 1e-6,
    "speeds": 2e-6,
    "turns": 1e-7,
    "cap": 3e-4,  # a candidate may lie past the edge by a thousandth of a step
}


def test_vessels_move_and_command_as_they_may(sailed):
    for own in sailed:
        track, given = own.found.trajectory, own.given
        begins = np.concatenate([given.starts, given.speeds[..., None]], axis=-1)
        assert track[:, 0, :, [0, 1, 3]] == pytest.approx(
            np.moveaxis(begins[..., [0, 1, 3]], -1, 0), abs=2e-4
        )
        off = np.abs(track[:, 0, :, 2] - begins[..., 2] + np.pi) % (2 * np.pi) - np.pi
        assert np.abs(off).max() < 1e-6
        assert not track[:, 0, :, 4].any()
        judged = given.valid & ~own.near
        found = fleet_replay.departures(own.asked, track, own.verdict, judged)
        assert {name: value for name, value in found.items() if value > TOLERANCES[name]} == {}


def test_distances_are_those_of_the_record(sailed):
    for own in sailed:
        apart, clear = fleet_replay.nearest(own.asked, own.found.trajectory)
        there, found = own.given.valid, own.found
        assert found.min_separation == pytest.approx(apart.min(axis=(1, 2)), abs=5e-4)
        assert found.min_clearance[there] == pytest.approx(clear.min(axis=1)[there], abs=5e-4)
        sailing = np.abs(found.trajectory[:, 1:, :, 3].astype(np.float64)).sum(axis=1)
        assert found.path_length[there] == pytest.approx(sailing[there], rel=2e-5, abs=1e-3)


def test_endings_are_those_of_the_record(sailed):
    for own in sailed:
        found, verdict, near = own.found, own.verdict, own.near
        reached = verdict.status == Status.REACHED
        arrival = np.where(reached, verdict.ended, np.inf)
        psi = found.trajectory[:, -1, :, 2].astype(np.float64)
        error = np.full(psi.shape, np.nan)
        if own.given.headings is not None:
            off = np.abs((psi - own.given.headings + np.pi) % (2 * np.pi) - np.pi)
            error = np.where(reached, off, np.nan)
            assert off[reached & ~near].max() < own.given.params.heading_tolerance + 1e-5
        for name, judged in (
            ("vessel_status", verdict.status),
            ("livelock", verdict.livelock),
            ("arrival_time", arrival),
        ):
            assert np.array_equal(getattr(found, name)[~near], judged[~near]), name
        assert found.heading_error[~near] == pytest.approx(error[~near], abs=1e-6, nan_ok=True)
        clear = ~near.any(axis=1)
        assert np.array_equal(found.steps[clear], verdict.steps[clear])
        assert np.array_equal(found.time[clear], verdict.ended.max(axis=1)[clear])
        assert np.array_equal(found.rest_time, verdict.moved)
        # By "orca" vessels pass each other, and circles, as near as they may: touching.
        assert near.sum() <= (0.15 if own.strategy == "orca" else 0.01) * own.given.valid.sum()


def test_fleets_end_in_every_way(sailed):
    ends = {
        (int(s), bool(v))
        for own in sailed
        for s, v in zip(own.found.vessel_status.flat, own.found.livelock.flat, strict=True)
    }
    wanted = {(1, False), (3, False), (3, True), (4, False)}
    if sailed[0].strategy != "rules":
        wanted.add((2, False))
    assert wanted <= ends


# --- the same, whatever it is sailed with -----------------------------------------------------


def assert_same(one: uj.FleetResult, other: uj.FleetResult, rows=slice(None)) -> None:
    """All of `one` is bitwise what `other` has of these fleets; records as far as both go."""
    for f in fields(one):
        own, theirs = getattr(one, f.name), getattr(other, f.name)
        if f.name == "trajectory":
            if own is None or theirs is None:
                continue
            theirs = theirs[:, : own.shape[1]]
        np.testing.assert_array_equal(own, theirs[rows], err_msg=f.name)


def part(given: Given, rows) -> Given:
    """Some of the fleets."""
    own = {f.name: getattr(given, f.name) for f in fields(given) if f.name != "params"}
    own = {name: value if value is None else value[rows] for name, value in own.items()}
    hull, fast = given.params.hull_radius[rows], given.params.v_max[rows]
    return Given(**own, params=replace(given.params, hull_radius=hull, v_max=fast))


def permuted(given: Given, order: np.ndarray) -> Given:
    """The fleets with their vessels under other names."""
    own = {
        f.name: getattr(given, f.name) for f in fields(given) if f.name not in ("params", "scene")
    }
    own = {name: value if value is None else value[:, order] for name, value in own.items()}
    hull, fast = given.params.hull_radius[:, order], given.params.v_max[:, order]
    return Given(
        scene=given.scene, **own, params=replace(given.params, hull_radius=hull, v_max=fast)
    )


def test_a_fleet_does_not_depend_on_its_company(sailed):
    for own in sailed:
        rows = slice(7, 9)
        assert_same(sail(part(own.given, rows), own.strategy), own.found, rows)


def test_vessels_have_names_and_no_rank(sailed):
    """By "wei2023" the first of the fleet goes before one of the same outboard angle: none here."""
    order = np.array([2, 0, 4, 1, 3])
    for own in sailed:
        other = sail(permuted(own.given, order), own.strategy)
        for f in fields(other):
            mine = getattr(own.found, f.name)
            if mine.ndim > 1:
                mine = mine.take(order, axis=2 if f.name == "trajectory" else 1)
            np.testing.assert_array_equal(getattr(other, f.name), mine, err_msg=f.name)


@pytest.mark.parametrize("lanes", [4, 16, 64] if FUZZ else [4])
def test_lanes_and_records_change_nothing(sailed, lanes, monkeypatch):
    """Recorded, each fleet has a lane of its own; else lanes take fleets one after the other."""
    if not FUZZ and sailed[0].strategy != "rules":
        pytest.skip("by `make fuzz`: programs of its own")
    monkeypatch.setattr(run, "LEAST_LANES", lanes)
    monkeypatch.setattr(run, "VESSELS_AT_ONCE", 5 * lanes)
    for own in sailed:
        assert_same(sail(own.given, own.strategy, record=False), own.found)


def test_devices_change_nothing(sailed):
    if not FUZZ and sailed[0].strategy != "none":
        pytest.skip("by `make fuzz`: each device compiles for itself")
    if len(jax.local_devices()) < 2:
        pytest.skip("one device here")
    with jax.default_device(None):
        assert len(chosen_devices()) > 1
        for own in sailed:
            assert_same(sail(own.given, own.strategy), own.found)


def test_settings_of_jax_change_nothing(sailed, monkeypatch):
    """`navigate` computes in single precision, whatever the caller does."""
    if not FUZZ and sailed[0].strategy != "none":
        pytest.skip("by `make fuzz`: programs of its own")
    monkeypatch.setattr(run, "_programs", Programs())
    with jax.enable_x64(True), jax.numpy_dtype_promotion("strict"):
        again = sail(sailed[1].given, sailed[1].strategy)
    assert again.path_length.dtype == again.trajectory.dtype == np.float32
    assert_same(again, sailed[1].found)
