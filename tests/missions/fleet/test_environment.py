"""Fleets in currents and wind, among moving circles, and as Otters; and what is refused."""

import fleet_replay
import jax
import numpy as np
import pytest
from garbage import problems_of, said
from public_calls import Call

import usvjax as uj
from usvjax.missions.fleet import environment as fleet_environment
from usvjax.missions.fleet.places import place
from usvkernels.status import Status

PARAMS = uj.FleetParams(hull_radius=20.0, obstacle_radius=150.0, v_step=0.25, leeway=0.04)
STATIC = uj.FleetStatic(n_v=9)
REACH = PARAMS.hull_radius + PARAMS.obstacle_radius
FLEETS, STRAIGHT = 24, 8
"""The first few sail side by side, and meet nothing but a circle that overtakes fleet 0."""


@pytest.fixture(scope="module")
def scene():
    """Starts, goals, circles, their velocities, currents and winds."""
    rng = np.random.default_rng(7)
    angle = rng.uniform(-np.pi, np.pi, FLEETS)
    bow = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    side = np.stack([-bow[:, 1], bow[:, 0]], axis=-1)
    starts, goals = np.zeros((FLEETS, 2, 3)), np.zeros((FLEETS, 2, 2))
    for i, sign in enumerate((-1, 1)):
        crossing = np.arange(FLEETS) >= STRAIGHT
        across = np.where(crossing, -sign, sign)[:, None] * 900.0 * side
        starts[:, i, :2] = -2000.0 * bow + sign * 900.0 * side
        goals[:, i] = 2000.0 * bow + across
        starts[:, i, 2] = angle
    circles = np.full((FLEETS, 1, 2), 60_000.0)
    circles[STRAIGHT:, 0] = rng.uniform(-600, 600, (FLEETS - STRAIGHT, 2))
    velocities = np.zeros((FLEETS, 1, 2))
    velocities[STRAIGHT:, 0] = rng.uniform(-3, 3, (FLEETS - STRAIGHT, 2))
    # Faster than it is wide: seen at the ends of a control period only, it would miss the vessel.
    circles[0, 0] = starts[0, 0, :2] - 1250.0 * bow[0]
    velocities[0, 0] = 500.0 * bow[0]
    currents = rng.uniform(-3.0, 3.0, (FLEETS, 2))
    winds = rng.uniform(-15.0, 15.0, (FLEETS, 2))
    return starts, goals, circles, velocities, currents, winds


@pytest.fixture(scope="module")
def sailed(scene):
    starts, goals, circles, velocities, currents, winds = scene
    return uj.navigate(
        circles,
        starts,
        goals,
        velocities=velocities,
        environment=uj.Environment(uj.UniformCurrent(currents), winds),
        params=PARAMS,
        static=STATIC,
        record=True,
    )


def test_steps_are_through_the_water_and_places_over_ground(scene, sailed):
    *_, currents, winds = scene
    assert (sailed.status[1:] == Status.REACHED).all()
    for row in range(1, FLEETS):
        drift = currents[row] + PARAMS.leeway * winds[row]
        x, y, psi, v, w = np.moveaxis(sailed.trajectory[row].astype(np.float64), -1, 0)
        ended = np.round(sailed.arrival_time[row] / PARAMS.dt)
        adrift = np.arange(len(x) - 1)[:, None] < ended
        # After the episode its last row is repeated.
        on = np.arange(len(x) - 1) < sailed.steps[row]
        east = x[:-1] + v[1:] * np.cos(psi[:-1]) + adrift * drift[0] - x[1:]
        north = y[:-1] + v[1:] * np.sin(psi[:-1]) + adrift * drift[1] - y[1:]
        assert np.abs(np.stack([east, north]))[:, on].max() < 2e-3
        turned = psi[:-1] + w[1:] - psi[1:]
        assert np.abs((turned + np.pi) % (2 * np.pi) - np.pi)[on].max() < 2e-6
        made = np.hypot(np.diff(x, axis=0), np.diff(y, axis=0)).sum(axis=0)
        assert sailed.path_length[row] == pytest.approx(made, rel=1e-4)


def test_a_course_over_ground_is_held_across_the_drift(scene, sailed):
    starts, goals, *_, currents, winds = scene
    drifts = currents + PARAMS.leeway * winds
    for row in range(1, STRAIGHT):
        for i in range(2):
            way = (goals[row, i] - starts[row, i, :2]) / 4000.0
            ended = round(float(sailed.arrival_time[row, i] / PARAMS.dt))
            off = sailed.trajectory[row, :ended, i, :2] - starts[row, i, :2]
            assert np.abs(way[0] * off[:, 1] - way[1] * off[:, 0]).max() < 45.0
            across = way[0] * drifts[row, 1] - way[1] * drifts[row, 0]
            made = way @ drifts[row] + np.sqrt(PARAMS.v_max**2 - across**2)
            # 11 s to gather way, and the goal's edge is 93 m nearer.
            assert float(sailed.arrival_time[row, i]) == pytest.approx(3907 / made + 6, abs=12)


def test_moving_circles_are_kept_clear_of_and_pass_through_nothing(scene, sailed):
    _, _, circles, velocities, *_ = scene
    for row, track in enumerate(sailed.trajectory):
        last = sailed.steps[row] + 1
        time = np.arange(last)[:, None, None] * PARAMS.dt
        relative = track[:last, :, :2] - (circles[row] + velocities[row] * time)
        clear = fleet_replay.clearances(relative, np.zeros((1, 2)), np.full(2, REACH)).min(axis=0)
        assert sailed.min_clearance[row] == pytest.approx(clear, abs=5e-3, rel=1e-4)
        hit = clear < 0
        assert np.array_equal(hit, sailed.vessel_status[row] == Status.COLLIDED)
        at_instants = np.linalg.norm(relative, axis=-1).min(axis=0) - REACH
        if row == 0:
            assert hit[0]
            assert at_instants[0] > 0
        else:
            assert not hit.any()


def test_an_otter_makes_way_with_its_current():
    rng = np.random.default_rng(1)
    starts = np.zeros((16, 1, 3))
    goals = 100.0 * np.ones((16, 1, 2)) * [[[1.0, 0.4]]]
    params = uj.FleetParams(
        v_max=2.0,
        w_max=0.4,
        v_acc=0.3,
        v_dec=0.3,
        w_acc=0.2,
        v_step=0.1,
        w_step=0.08,
        hull_radius=1.5,
        obstacle_radius=5.0,
        goal_tolerance=3.0,
        clearance_cap=40.0,
    )
    static = uj.FleetStatic(
        model="otter", n_v=7, n_w=6, unit_length=4.0, look_ahead=20.0, guide_length=40.0
    )
    currents = rng.uniform(-0.6, 0.6, (16, 2))
    found = uj.navigate(
        None,
        starts,
        goals,
        encounters="none",
        environment=uj.Environment(uj.UniformCurrent(currents), rng.uniform(-4, 4, (16, 2))),
        params=params,
        static=static,
        record=True,
    )
    assert (found.status == Status.REACHED).all()
    speed = found.trajectory[..., 3]
    assert 1.7 < speed.max() < 2.1
    # Set points are taken on late, so less in a second than the window's acceleration.
    assert 0.15 < np.diff(speed, axis=1).max() < 0.3
    for row in range(16):
        # Who has arrived lies at anchor.
        arrived = round(float(found.arrival_time[row, 0]) / params.dt)
        track = found.trajectory[row, : arrived + 1, 0].astype(np.float64)
        psi, v = track.T[2:4]
        ahead = 0.5 * (v[1:] + v[:-1])
        turn = 0.5 * (psi[1:] + psi[:-1])
        slip = np.diff(track[:, :2], axis=0) - currents[row]
        along = slip[:, 0] * np.cos(turn) + slip[:, 1] * np.sin(turn)
        wraps = np.abs(np.diff(psi)) > 3.0
        assert np.abs(along - ahead)[~wraps].max() < 0.05
        way = np.diff(found.trajectory[row, :, 0, :2].astype(np.float64), axis=0)
        sailed = np.linalg.norm(way, axis=1).sum()
        assert sailed == pytest.approx(float(found.path_length[row, 0]), rel=1e-4)


def test_an_origin_moves_places_and_nothing_else():
    for current in (
        uj.UniformCurrent((1.0, 2.0)),
        uj.ShearCurrent(0.3, 1.0, 0.01, (50.0, 7.0)),
        uj.VortexCurrent((50.0, 7.0), 1.0, 30.0),
        uj.FieldCurrent(np.ones((3, 4, 2)), 10.0, (50.0, 7.0)),
    ):
        packed = fleet_environment.pack(uj.Environment(current), 5, 0.0)
        moved = fleet_environment.moved(packed, np.array([20.0, 4.0]))
        if not isinstance(current, uj.UniformCurrent):
            assert [float(part) for part in moved.current.place] == [30.0, 3.0]
        else:
            assert moved is packed


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (
            {"environment": uj.Environment(uj.UniformCurrent((0.0, -20.578)))},
            r"vessel 0 of fleet 0 drifts at 20\.578 m/s .* more than 30 deg",
        ),
        (
            {"environment": uj.Environment(wind=(0.0, 1000.0))},
            r"environment: vessel 0 of fleet 0 drifts at 40 m/s",
        ),
        ({"environment": uj.Environment(uj.UniformCurrent((np.nan, 0.0)))}, "current.velocity"),
        ({"environment": uj.Environment(uj.VortexCurrent((0, 0), 1.0, 0.0))}, "current.radius"),
        ({"environment": uj.Environment(wind=(1.0, 2.0, 3.0))}, "environment.wind"),
        ({"environment": uj.Environment((1.0, 0.0))}, "environment.current: got tuple"),
        ({"environment": (1.0, 0.0)}, "environment"),
        ({"velocities": np.zeros((1, 2))}, "velocities: got some"),
        ({"static": uj.FleetStatic(model="oter")}, "otter"),
        ({"static": uj.FleetStatic(model="otter")}, r"makes at most 3\.08 m/s"),
    ],
)
def test_what_is_refused(given, says):
    with pytest.raises((uj.BadInputError, uj.BadTypeError), match=says):
        uj.navigate(None, [[[0, 0, 0]]], [[[4000, 0]]], **({"params": PARAMS} | given))


def test_a_start_in_a_moving_circle_is_refused():
    with pytest.raises(uj.BadInputError, match="starts: vessel 0"):
        uj.navigate([[50.0, 0]], [[[0, 0, 0]]], [[[4000, 0]]], velocities=[[1.0, 0]], params=PARAMS)


CURRENTS = {
    "uniform": uj.UniformCurrent(np.ones((3, 2))),
    "shear": uj.ShearCurrent(np.zeros(3), np.ones(3), 0.01, np.zeros((3, 2))),
    "vortex": uj.VortexCurrent((50.0, 7.0), 1.0, 30.0),
    "field": uj.FieldCurrent(np.ones((3, 4, 2)), 10.0, (50.0, 7.0)),
}


@pytest.mark.parametrize("current", CURRENTS.values(), ids=CURRENTS)
def test_garbage_in_currents_is_refused_in_one_line(current):
    def packed(**given):
        found = fleet_environment.pack(uj.Environment(type(current)(**given)), 3, 0.0)
        # A warning of overflow is an error here.
        return [np.square(np.asarray(leaf, np.float32)) for leaf in jax.tree.leaves(found)]

    problems = problems_of(Call(packed, vars(current)))
    assert not problems, said(problems)


def test_garbage_for_velocities_is_refused_in_one_line():
    def placed(velocities):
        return place(np.ones((2, 2)), velocities, 3, np.ones((3, 1)), PARAMS, STATIC)

    for valid in (np.ones((2, 2)), np.ones((1, 2, 2)), np.ones((3, 2, 2))):
        problems = problems_of(Call(placed, {"velocities": valid}))
        assert not problems, said(problems)
