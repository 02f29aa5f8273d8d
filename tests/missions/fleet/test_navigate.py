"""Fleets: records are judged again, orders and batches change nothing, endings are right."""

import fleet_encounters
import fleet_replay
import jax
import numpy as np
import pytest
from property_draws import FUZZ

import usvjax as uj
from usvjax.missions.fleet.run import navigate
from usvkernels.status import Status


@pytest.fixture(autouse=True, scope="module")
def one_device():
    """Each device compiles for itself."""
    with jax.default_device(jax.devices()[0]):
        yield


STRATEGIES = ("rules", "wei2023", "orca", "none") if FUZZ else ("rules", "orca")


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
    """Of one shape, and recorded: one program for each strategy."""
    return navigate(
        circles, starts, goals, encounters=strategy, valid=valid, params=PARAMS, record=True
    )


@pytest.fixture(scope="module", params=STRATEGIES)
def recorded(request):
    starts, goals, circles = layouts(16, 4, 1)
    found = sail(starts, goals, circles, request.param)
    return request.param, starts, goals, circles, found


def test_recorded_steps_are_euler_steps_within_the_limits(recorded):
    *_, found = recorded
    limits = {name: getattr(PARAMS, name) for name in ("w_max", "v_acc", "v_dec", "w_acc")}
    for track in found.trajectory:
        place, heading = fleet_replay.step_errors(track, PARAMS.dt)
        assert place < 2e-3  # m; at 3 km single precision resolves 0.25 mm
        assert heading < 2e-6
        assert fleet_replay.excess(track, PARAMS.v_max, limits, PARAMS.dt) < 2e-3


def test_distances_and_endings_are_those_of_the_record(recorded):
    _, _, goals, circles, found = recorded
    hull = np.full(4, PARAMS.hull_radius)
    reach = hull + PARAMS.obstacle_radius
    for row, track in enumerate(found.trajectory):
        pairs = fleet_replay.separations(track, hull)
        clear = fleet_replay.clearances(track, circles[row], reach)
        assert found.min_separation[row] == pytest.approx(pairs.min(), abs=5e-3)
        assert found.min_clearance[row] == pytest.approx(clear.min(axis=0), abs=5e-3)
        hit = (pairs.min(axis=(0, 2)) < 0) | (clear.min(axis=0) < 0)
        assert np.array_equal(hit, found.vessel_status[row] == Status.COLLIDED)
        left = np.linalg.norm(track[:, :, :2].astype(np.float64) - goals[row], axis=-1)
        for i in np.flatnonzero(found.vessel_status[row] == Status.REACHED):
            arrived = round(float(found.arrival_time[row, i]) / PARAMS.dt)
            assert left[arrived, i] <= PARAMS.goal_tolerance + 1e-2
            assert (left[:arrived, i] > PARAMS.goal_tolerance - 1e-2).all()
        sailed = np.abs(track[1:, :, 3].astype(np.float64)).sum(axis=0) * PARAMS.dt
        assert found.path_length[row] == pytest.approx(sailed, rel=1e-4)


def test_a_fleet_does_not_depend_on_its_company(recorded):
    strategy, starts, goals, circles, found = recorded
    two = slice(7, 9)
    alone = sail(starts[two], goals[two], circles[two], strategy)
    for name in ("status", "vessel_status", "path_length", "min_separation", "arrival_time"):
        assert np.array_equal(getattr(alone, name), getattr(found, name)[two]), name
    steps = alone.trajectory.shape[1]
    assert np.array_equal(alone.trajectory, found.trajectory[two, :steps])


def test_lanes_and_records_change_nothing():
    starts, goals, circles = layouts(16, 4, 1)
    recorded = sail(starts, goals, circles, "rules")
    again = navigate(circles, starts, goals, params=PARAMS)
    for name in ("status", "vessel_status", "path_length", "min_separation", "arrival_time"):
        assert np.array_equal(getattr(again, name), getattr(recorded, name)), name


def test_vessels_have_names_and_no_rank(recorded):
    strategy, starts, goals, circles, found = recorded
    order = np.array([2, 0, 3, 1])
    other = sail(starts[:, order], goals[:, order], circles, strategy)
    assert np.array_equal(other.vessel_status, found.vessel_status[:, order])
    assert np.array_equal(other.path_length, found.path_length[:, order])
    assert np.array_equal(other.min_separation, found.min_separation)


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
    found = navigate(
        None, starts, -starts[..., :2], valid=valid, params=uj.FleetParams(hull_radius=20.0)
    )
    assert (found.status == Status.REACHED).all()
    assert found.min_separation.min() > 50.0


def test_random_encounters_by_the_rules_have_no_contact_and_some_without():
    met = fleet_encounters.draw(300, seed=11)
    params = uj.FleetParams(hull_radius=met.hull, v_max=met.speed)
    speeds = met.speed * (1 - 1e-7)
    run = {
        how: navigate(None, met.start, met.goal, speeds=speeds, encounters=how, params=params)
        for how in ("rules", "none")
    }
    assert (run["rules"].status == Status.REACHED).all()
    assert run["rules"].min_separation.min() > 20.0
    touching = met.dcpa < met.hull.sum(axis=1)
    assert touching.mean() > 0.2
    assert np.mean(run["none"].status[touching] == Status.COLLIDED) > 0.9


def test_headings_at_the_goal():
    rng = np.random.default_rng(4)
    starts = np.concatenate([np.zeros((90, 1, 2)), rng.uniform(-3, 3, (90, 1, 1))], axis=2)
    goals = rng.uniform(-1, 1, (90, 1, 2)) * 4000.0
    wanted = np.repeat([0.0, np.pi / 3, np.pi / 2], 30)[:, None]
    found = navigate(None, starts, goals, headings=wanted)
    assert (found.status == Status.REACHED).all()
    assert np.degrees(found.heading_error).max() < 5.0
    shut = navigate(
        starts[:1, 0, :2] + np.array([[900.0, 0.0], [0.0, 900.0], [-900.0, 0.0], [0.0, -900.0]]),
        starts[:1] + np.array([5000.0, 5000.0, 0.0]),
        starts[:1, :, :2],
        headings=[[0.0]],
    )
    assert shut.status[0] == Status.NO_APPROACH


def test_a_goal_within_a_ring_of_circles_is_unreachable():
    angle = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1) * 1500.0
    found = navigate(ring, [[[-5000.0, 0.0, 0.0]]], [[[0.0, 0.0]]])
    assert found.status[0] == Status.UNREACHABLE
    assert found.path_length[0, 0] == 0.0


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
    own = navigate(blocked, starts, goals, params=params, static=static)
    assert (own.status == Status.REACHED).all()
    assert own.min_clearance.min() > 0.0
    grid = uj.GridMap(blocked[3], cell_size=1.0, origin=(1000.0, -500.0))
    corner = np.array([1000.0, -500.0])
    shared = navigate(
        grid, starts + np.append(corner, 0.0), goals + corner, params=params, static=static
    )
    assert (shared.status == Status.REACHED).all()
    assert shared.final[3, :, :2] - corner == pytest.approx(own.final[3, :, :2], abs=2.0)
    shut = np.ones((40, 40), bool)
    shut[:10] = shut[30:] = False
    apart = navigate(shut, starts[:1], goals[:1], params=params, static=static)
    assert (apart.vessel_status == Status.UNREACHABLE).all()
