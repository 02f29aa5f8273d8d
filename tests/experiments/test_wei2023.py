"""Figs. 7 and 8 of Wei & Zhang 2023: the scenes, what is measured on them, and the verdicts."""

from math import hypot
from types import SimpleNamespace

import jax
import numpy as np
import pytest

import usvjax as uj
from experiments import textbook
from experiments.claims import judge
from experiments.textbook import Rules
from experiments.wei2023 import compare
from experiments.wei2023 import mission as wei
from experiments.wei2023.__main__ import PAPER
from experiments.wei2023.claims import COUNTED, claims
from experiments.wei2023.published import AFTER, BEFORE, COLLISION_RADIUS
from experiments.wei2023.runs import FITTED, KINDS, SEARCHES
from usvjax.mission import Files


def posed(jobs, **waters):
    return wei.MISSION.pose(wei.MISSION.case({"waters": waters}, Files()), 3, np.asarray(jobs))


def test_clearance_is_the_exact_distance_to_the_obstacles():
    line = np.array([[[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [4.0, 3.0]]])
    circles = np.array([[[2.0, 1.5, 0.5], [6.0, 5.0, 1.0]]])
    assert wei.clearance(line, circles)[0] == pytest.approx(1.0)
    circles = np.array([[[7.0, 7.0, 1.0]]])
    assert wei.clearance(line, circles)[0] == pytest.approx(hypot(3, 4) - 1)


def test_scenes_bar_the_straight_course_and_leave_another():
    scene = posed(range(6))
    again = posed([4, 1])
    for name in scene._fields:
        np.testing.assert_array_equal(getattr(again, name), getattr(scene, name)[[4, 1]])
    assert len(np.unique(scene.circles[:, 0, 0])) == 6
    assert scene.blocked[:, 100:].all()
    assert scene.blocked[:, :, 100:].all()
    for row in range(6):
        ends = [tuple(map(int, cells[row])) for cells in (scene.starts, scene.goals)]
        line = wei.centre_of(np.array([ends]))
        circles = scene.circles[row : row + 1]
        assert wei.clearance(line, circles)[0] <= COLLISION_RADIUS
        path, _ = textbook.search(scene.blocked[row], *ends, Rules(1000, 1400, "octile"))
        # Between the centres of two free cells a path is nearer by a part of a cell at most.
        points = wei.centre_of(np.array([path]))
        assert wei.clearance(points, circles)[0] > COLLISION_RADIUS - 0.005


def test_all_searches_find_equally_short_paths_and_smoothing_shortens_them():
    scene = posed(range(3), side=2.5, least=0.1, most=0.35)
    with jax.default_device(jax.local_devices()[0]):
        found = {name: wei.MISSION.run(scene, name, record=True) for name in SEARCHES}
    turns = set()
    for name, outcome in found.items():
        own = outcome.columns
        np.testing.assert_allclose(
            own["length_before"], found["octile"].columns["length_before"], rtol=1e-4
        )
        for stage in ("keys", "sight"):
            assert (own[f"turns_{stage}"] <= own["turns_before"]).all()
            assert (own[f"length_{stage}"] <= own["length_before"] * (1 + 1e-6)).all()
        # Dropping points until none can be leaves no more than one pass does.
        assert (own["points_keys"] <= own["points_sight"]).all(), name
        turns.add(tuple(own["turns_before"]))
        track = outcome.recording.tracks[0]
        assert track.along[-1] == pytest.approx(1852 * own["length_before"][0], rel=1e-5)
    # Ties decide among them.
    assert len(turns) > 2


def test_key_points_of_a_scene_are_compared_with_its_path_before():
    own = {
        f"{name}_{stage}": np.array(values, float)
        for stage, values in {"before": [40, 44, 50], "keys": [2, 3, 2], "sight": [3, 3, 3]}.items()
        for name in wei.MEASURES
    }
    table = compare.compare(own)["stages"]
    assert table["keys"]["difference"]["turns"]["value"] == pytest.approx(
        np.mean([38, 41, 48]) * -1
    )
    assert table["keys"]["as_published"]["value"] == pytest.approx(2 / 3)
    assert table["before"]["rank_p"] == 1.0  # 41 is the second of four
    assert table["keys"]["rank_p"] == 1.0
    assert table["sight"]["rank_p"] == 0.5  # 2 is the least of four
    assert table["sight"]["as_published"]["value"] == 0
    assert table["keys"]["closer"]["value"] == 1
    assert table["keys"]["longer"]["value"] == 0
    assert compare.nearest(own) == 0
    assert compare.as_many(own) == {"n": 2, "after": 1}


def table(before=0.3, after=0.3, change=-35.0, half=1.0, n=100):
    """Numbers of one search: p of the turns that are published, and how they change."""

    def of(value, p):
        return {
            "spread": {"turns": {"value": value, "low": value - 5, "high": value + 5}},
            "rank_p": p,
        }

    ends = {} if half is None else {"low": change - half, "high": change + half}
    turns = {"value": change, "low": None, "high": None} | ends
    after_it = of(AFTER, after) | {"difference": {"turns": turns}}
    return {"n": n, "stages": {"before": of(BEFORE, before), "keys": after_it, "sight": after_it}}


def verdicts(*kinds, **changed):
    """Verdicts where everything fits, but for what is changed on some kinds of scenes."""
    tables = {kind: dict.fromkeys(SEARCHES, table()) for kind in KINDS}
    tables |= {kind: dict.fromkeys(SEARCHES, table(**changed)) for kind in kinds}
    numbers = {"tables": tables}
    return judge(claims(numbers), numbers)


def words(found):
    return [one.verdict for one in found]


FINE = ["not excluded", "not excluded", "reproduces"]
SMALL, LARGE = COUNTED


@pytest.mark.parametrize(
    ("changed", "place", "verdict"),
    [
        ({"before": 0.05}, 0, "does not reproduce"),
        ({"before": 0.051}, 0, "not excluded"),
        ({"after": 0.04}, 1, "does not reproduce"),
        ({"change": -0.5}, 2, "undecided"),  # not shown is not refuted
        ({"change": 1.5}, 2, "does not reproduce"),
        ({"half": None}, 2, "undecided"),
    ],
)
def test_verdicts_follow_from_the_numbers(changed, place, verdict):
    assert words(verdicts()) == FINE
    wanted = [verdict if i == place else fine for i, fine in enumerate(FINE)]
    assert words(verdicts(SMALL, LARGE, **changed)) == wanted
    on_one = {"does not reproduce": "depends on the reading"}.get(verdict, verdict)
    assert words(verdicts(LARGE, **changed))[place] == on_one


def test_few_scenes_exclude_nothing_and_show_no_difference():
    assert words(verdicts(LARGE, n=38)) == ["undecided", "undecided", "reproduces"]
    few = verdicts(LARGE, n=19)[2]
    assert few.verdict == "undecided"
    assert {one.numbers for one in few.found.values() if one.holds is None} == {"only 19 scenes"}


def test_differences_that_are_all_equal_are_told_as_they_are():
    found = verdicts(LARGE, half=None)[2].found
    assert {one.numbers for one in found.values() if one.holds is None} == {"-35.0"}


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in COUNTED])
def test_what_was_fitted_and_what_the_paper_has_not_stand_beside(kind):
    assert FITTED not in COUNTED
    found = verdicts(kind, before=0.01, after=0.01, change=9.0)
    assert words(found) == FINE
    for one in found if kind == FITTED else found[2:]:
        assert False in {given.holds for given in one.beside.values()}
        assert not any(kind in label for label in one.found)


def test_what_is_run_follows_the_options():
    part = PAPER.parts[0]
    runs = part.runs(SimpleNamespace(scenes=None, quick=False))
    assert {name: run.size for name, run in runs.items()} == {
        "batched": 4 * 2 * 1000,
        "textbook": 4 * 3 * 200,
    }
    with pytest.raises(uj.BadInputError, match="--scenes: got 0; wanted at least 1 scene"):
        part.runs(SimpleNamespace(scenes=0, quick=True))
