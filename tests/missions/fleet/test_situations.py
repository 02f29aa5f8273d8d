"""Imazu's 22 situations: all meet at one point, and nobody collides by the rules of the road."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from property_draws import FUZZ

import usvjax as uj
from usvjax.errors import BadInputError
from usvjax.missions.fleet.mission import MISSION
from usvjax.missions.fleet.run import navigate
from usvjax.missions.fleet.situations import HEADINGS, imazu
from usvjax.study import parse_spec
from usvkernels.status import Status

COPY = Path(__file__).parents[4] / "shared" / "data" / "imazu22.json"
KNOT = 1852 / 3600


pytestmark = pytest.mark.usefixtures("one_device")


@pytest.mark.skipif(not COPY.exists(), reason="the shared data is not here")
def test_headings_are_those_of_the_copy():
    cases = json.loads(COPY.read_text(encoding="utf-8"))["cases"]
    theirs = {int(number): tuple(t["heading_deg"] for t in own) for number, own in cases.items()}
    assert theirs == HEADINGS
    slow = [(t["heading_deg"] == 0) == t["slow"] for own in cases.values() for t in own]
    assert all(slow)


def test_all_meet_own_ship_after_twelve_minutes():
    met = imazu()
    assert (met.valid.sum(axis=1) == [1 + len(own) for own in HEADINGS.values()]).all()
    x, y, psi = np.moveaxis(met.starts, -1, 0)
    at = x + 720 * met.speeds * np.cos(psi), y + 720 * met.speeds * np.sin(psi)
    assert np.abs(np.stack(at)[:, met.valid]).max() < 1e-6
    own = met.speeds[:, 0] / KNOT, np.degrees(psi[:, 0]), y[:, 0] / 1852
    assert np.allclose(own, np.array([[10.0], [90.0], [-2.0]]))
    # On own ship's heading from ahead at 4 kn; from starboard, astern to port, right ahead.
    assert met.starts[2, 1] == pytest.approx([0, -0.8 * 1852, np.pi / 2])
    assert met.speeds[2, 1] == pytest.approx(4 * KNOT)
    assert met.starts[1, 1, :2] == pytest.approx([2 * 1852, 0])
    assert met.starts[3, 1, :2] == pytest.approx([-(2**0.5) * 1852] * 2)
    assert met.starts[0, 1, :2] == pytest.approx([0, 2 * 1852])
    assert np.array_equal(met.goals[met.valid], -met.starts[..., :2][met.valid])


def test_by_the_rules_no_two_of_them_collide():
    met = imazu()
    found = navigate(
        None, met.starts, met.goals, valid=met.valid, speeds=met.speeds, params=met.params
    )
    assert (found.status == Status.REACHED).all()
    assert found.min_separation.min() > 0.5 * uj.FleetParams().passing


@pytest.mark.skipif(not FUZZ, reason="by `make fuzz`: a program of its own")
def test_own_ship_keeps_clear_of_others_that_do_not_act():
    met = imazu()
    own, others = np.s_[:, :1], np.s_[:, 1:]
    params = replace(met.params, v_max=met.speeds[0, 0], obstacle_radius=met.params.hull_radius)
    found = navigate(
        met.starts[others][..., :2],
        met.starts[own],
        met.goals[own],
        speeds=met.speeds[own],
        velocities=met.velocities[others],
        params=params,
        static=uj.FleetStatic(max_steps=1500),
    )
    assert (found.vessel_status != Status.COLLIDED).all()
    assert found.min_clearance.min() > 10.0
    # Nobody is met who is not there: the closest is one of the situation, or own ship kept away.
    assert found.min_clearance.max() < 1000.0


def test_a_study_has_them_one_by_one():
    met = imazu(20.0)
    for number in (1, 12, 22):
        scenes = {"source": "imazu", "situation": number, "hull": 20.0}
        spec = parse_spec({"name": "met", "kind": "fleet", "episodes": 1, "scenes": scenes})
        posed = MISSION.pose(spec.conditions[0].case, spec.seed, np.arange(1))
        there = met.valid[number - 1]
        for name in ("starts", "goals", "speeds"):
            rows = getattr(met, name)[number - 1, there]
            assert np.array_equal(getattr(posed.scenes, name)[0], rows), name
        assert (posed.hulls == 20.0).all()
        assert np.array_equal(posed.params.v_max, posed.scenes.speeds)


@pytest.mark.parametrize(
    ("scenes", "words"),
    [
        ({"situation": 23}, "'situation' must be 1 to 22, got 23"),
        ({"situation": 0}, "'situation' must be 1 to 22, got 0"),
        ({"hull": 0.0}, "'hull': got 0.0; wanted a number above 0"),
    ],
)
def test_other_situations_are_refused(scenes, words):
    scenes = {"source": "imazu", **scenes}
    with pytest.raises(BadInputError, match=words):
        parse_spec({"name": "met", "kind": "fleet", "episodes": 1, "scenes": scenes})
    with pytest.raises(BadInputError, match="hull_radius"):
        imazu(-1.0)
