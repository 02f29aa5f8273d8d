"""Wei & Zhang 2023, encounters and the heading at the goal: layouts, numbers and verdicts."""

import jax
import numpy as np
import pytest

import usvjax as uj
from experiments.claims import judge
from experiments.wei2023 import headings
from experiments.wei2023.encounters import compare
from experiments.wei2023.encounters.claims import claims
from experiments.wei2023.encounters.mission import MISSION
from experiments.wei2023.encounters.report import sections
from experiments.wei2023.encounters.runs import ALONE, DUEL_SCENES, KIND, READINGS, SIGHTS
from usvjax.missions.fleet.params import STRATEGIES
from usvjax.missions.fleet.scenes import ENCOUNTERS, EncounterTable
from usvjax.missions.fleet.situations import HEADINGS
from usvjax.report import markdown
from usvjax.study import parse_spec
from usvkernels.status import Status


def test_duels_are_on_a_collision_course_with_the_printed_kinematics():
    for words, scene in DUEL_SCENES.items():
        drawn = EncounterTable(**scene).draw(1, np.arange(50), uj.FleetParams())
        x, y, psi = np.moveaxis(drawn.starts, -1, 0)
        place = x + 1j * y
        relative = np.diff(drawn.speeds * np.exp(1j * psi), axis=1)[:, 0]
        off = np.diff(place, axis=1)[:, 0]
        assert np.abs((off.conj() * relative).imag / np.abs(relative)).max() < 1e-6
        assert drawn.hulls == pytest.approx(50.0 if "50 m" in words else 0.125 * 1852)
        assert drawn.speeds.max() <= 20 * 1852 / 3600 * (1 + 1e-9)


def posed(scene, jobs=2):
    given = {"name": "duel", "kind": KIND, "episodes": jobs, "scenes": scene}
    spec = parse_spec({**given, "methods": ["none"]})
    return MISSION.pose(spec.conditions[0].case, spec.seed, np.arange(jobs))


def test_an_observer_notes_what_vessels_do():
    scene = {"encounter": "head-on", "hulls": [20.0, 20.0], "largest_dcpa": 4.0}
    with jax.default_device(jax.local_devices()[0]):
        own = MISSION.run(posed(scene, 16), "none").columns
    assert set(own) == {metric.name for metric in MISSION.metrics} | {"status"}
    # Nobody acts: the rules are broken wherever they would pass too close, and nowhere else.
    assert np.array_equal(own["kept"] == 0, own["meets"] == 1)
    assert 0 < own["meets"].sum() < 16
    clear = own["status"] == Status.REACHED
    assert own["turned"][clear].max() < 2.0
    assert (own["slowed"][clear] < 0.01).all()


def figure(value, half=0.01):
    return {"value": value, "low": value - half, "high": value + half}


def duel(collided=0.0, turned=10.0, more=-1.0):
    kept = {"n": 9, "reached": figure(1.0), "least": 1.0, "median_least": 2.0}
    kept |= {"extra_distance": figure(1.0), "delay": figure(1.0), "slowed": figure(0.5)}
    return kept | {
        "collided": figure(collided),
        "turned": figure(turned),
        "more_than_rules": figure(more),
        "more_than_orca": figure(more),
    }


def numbers(none=1.0, **changed):
    return {
        "duels": {
            scene: {
                name: duel(none if name == "none" else 0.0) for name in ("none", "rules", "orca")
            }
            for scene in DUEL_SCENES
        },
        "readings": {
            scene: {words: duel(**changed) for words in READINGS} for scene in DUEL_SCENES
        },
    }


def words(found):
    return [one.verdict[:10] for one in judge(claims(found), found)]


YES, NO, OPEN = "reproduces", "does not r", "undecided"


@pytest.mark.parametrize(
    ("changed", "verdicts"),
    [
        ({}, [YES] * 7),
        ({"none": 0.3}, [NO, YES, NO, YES, YES, YES, YES]),
        ({"collided": 0.07}, [YES, NO, YES, NO, YES, YES, YES]),
        ({"collided": 0.05}, [YES, OPEN, YES, OPEN, YES, YES, YES]),
        ({"turned": 30.1}, [YES, YES, YES, YES, NO, YES, YES]),
        ({"more": 0.005}, [YES, YES, YES, YES, YES, OPEN, OPEN]),
    ],
)
def test_verdicts_on_encounters_follow_from_the_numbers(changed, verdicts):
    assert words(numbers(**changed)) == verdicts


def test_one_reading_that_differs_makes_a_claim_hang_on_it():
    found = numbers()
    found["readings"]["crossing, hulls 50 m, same speed"][next(iter(READINGS))] = duel(collided=0.9)
    assert words(found) == [YES, YES, YES, "depends on", YES, YES, YES]


def test_only_who_arrives_counts_for_the_way():
    own = {
        "status": np.array([Status.REACHED, Status.COLLIDED, Status.REACHED]),
        "extra_distance": np.array([1.0, 90.0, 3.0]),
        "delay": np.array([2.0, np.inf, 4.0]),
        "min_separation": np.array([5.0, -1.0, 7.0]),
    }
    table = compare.sailed(own)
    assert table["collided"]["value"] == pytest.approx(1 / 3)
    assert table["extra_distance"]["value"] == 2.0
    assert table["delay"]["value"] == 3.0
    assert (table["least"], table["median_least"]) == (-1.0, 5.0)
    seen = {"meets": np.array([1.0, 0.0, 1.0, 1.0]), "kept": np.array([1.0, 1.0, 0.0, 1.0])}
    assert compare.watched(seen)["kept"]["value"] == pytest.approx(2 / 3)
    assert compare.watched(seen)["meets"] == 3


def test_every_situation_and_strategy_is_written():
    whole = numbers()
    strategies = dict.fromkeys(STRATEGIES, duel())
    seen = {name: {"kept": figure(1.0), "meets": 5} for name in STRATEGIES}
    status = [int(Status.REACHED)] * 22
    status[3], status[4] = int(Status.COLLIDED), int(Status.STUCK)
    own = {"status": status, "least": [7.0] * 22}
    whole |= {
        "kinds": dict.fromkeys(ENCOUNTERS, strategies),
        "watched": dict.fromkeys(ENCOUNTERS, seen),
        "sights": {f"{least} s": strategies for least in SIGHTS},
        "imazu": {"all": dict.fromkeys(STRATEGIES, own), "alone": dict.fromkeys(ALONE, own)},
        "others": {str(number): list(at) for number, at in HEADINGS.items()},
    }
    text = "".join(markdown(section) for section in sections(whole))
    assert text.count("**collided**") == len(STRATEGIES) + len(ALONE)
    assert text.count("7* ") == len(STRATEGIES) + len(ALONE)
    for number, at in HEADINGS.items():
        assert f"| {number} | {', '.join(f'{one:+d}' for one in at)} |" in text


def test_voyages_have_the_way_asked_for_and_obstacles_beside_it():
    own = headings.voyages(60, 4.0, 3)
    assert np.linalg.norm(own.goals, axis=-1) == pytest.approx(4 * 1852)
    along = own.goals / np.linalg.norm(own.goals, axis=-1, keepdims=True)
    at = (own.circles * along).sum(axis=-1) / 7408
    aside = (own.circles[..., 0] * along[..., 1] - own.circles[..., 1] * along[..., 0]) / 7408
    assert 0.3 <= at.min() < 0.35
    assert 0.65 < at.max() <= 0.7
    assert np.abs(aside).max() <= 0.1
    assert headings.voyages(60, 4.0).circles is None


def turned(longer, guided=-20.0):
    steps = {f"{k} to {k + 1}": figure(value, 0.1) for k, value in enumerate(longer)}
    table = {"longer": steps, "guided_less_none": figure(guided, 0.1)}
    return {"ways_longer": steps, "guided": dict.fromkeys(headings.READINGS, table)}


@pytest.mark.parametrize(
    ("longer", "verdict"),
    [((-1.0, -0.5), YES), ((-1.0, 0.05), OPEN), ((-1.0, 0.5), NO)],
)
def test_longer_is_better_only_if_every_step_is(longer, verdict):
    found = turned(longer)
    way, guided, length = judge(headings.claims(found), found)
    assert way.verdict.startswith(verdict)
    assert guided.verdict == "reproduces"
    assert length.verdict.startswith(verdict)
    assert judge(headings.claims(turned(longer, 5.0)), turned(longer, 5.0))[1].verdict.startswith(
        NO
    )


def test_errors_are_compared_over_voyages_that_arrive_both_ways():
    found = headings._longer({"1": np.array([9.0, np.nan, 4.0]), "2": np.array([5.0, 1.0, 2.0])})
    assert found["1 to 2"]["value"] == -3.0


def test_every_reading_of_a_length_has_a_line_of_its_own():
    assert len(set(headings._LOOKS)) == len(headings._LOOKS) == len(headings.READINGS)
