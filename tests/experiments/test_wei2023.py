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
from experiments.wei2023.claims import claims
from experiments.wei2023.published import AFTER, BEFORE, COLLISION_RADIUS
from experiments.wei2023.runs import AS_PRINTED, FITTED, KINDS, SEARCHES
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
    assert table["sight"]["as_published"]["value"] == 0
    assert table["keys"]["closer"]["value"] == 1
    assert table["keys"]["longer"]["value"] == 0
    assert compare.nearest(own) == 0
    assert compare.as_many(own) == {"n": 2, "after": 1}


def table(before, after, change, n=100):
    def of(value, half):
        return {"turns": {"value": value, "low": value - half, "high": value + half}}

    after_it = {"spread": of(after, 1), "difference": of(change, 1)}
    stages = {"before": {"spread": of(before, 5)}, "keys": after_it, "sight": after_it}
    return {"n": n, "stages": stages}


def verdicts(change=None, **others):
    tables = {kind: dict.fromkeys(SEARCHES, table(38.0, 2.5, -35.0)) for kind in KINDS}
    for kind, own in (change or {}).items():
        tables[kind] = tables[kind] | own
    numbers = {"tables": tables}
    return judge(claims(numbers), numbers)


def test_verdicts_follow_from_the_numbers():
    assert [v.verdict for v in verdicts()] == ["not excluded", "not excluded", "reproduces"]
    far = {"octile": table(15.0, 4.0, -0.5)}
    found = [v.verdict for v in verdicts({AS_PRINTED[1]: far})]
    assert found == ["depends on the reading"] * 3
    few = {AS_PRINTED[2]: dict.fromkeys(SEARCHES, table(BEFORE, AFTER, -1.0, n=5))}
    found = verdicts(few)
    assert found[0].found["A*, octile distance: 10 nm"].holds is None
    assert found[1].verdict == "undecided"


def test_the_side_that_was_fitted_to_fig_7_does_not_count_for_it():
    far = {FITTED: dict.fromkeys(SEARCHES, table(15.0, 2.5, -12.0))}
    first, second, _ = verdicts(far)
    assert first.verdict == "not excluded"
    assert {one.holds for one in first.beside.values()} == {False}
    assert len(first.beside) == len(SEARCHES)
    assert not second.beside


def test_what_is_run_follows_the_options():
    (part,) = PAPER.parts
    runs = part.runs(SimpleNamespace(scenes=None, quick=False))
    assert {name: run.size for name, run in runs.items()} == {
        "batched": 4 * 2 * 1000,
        "textbook": 4 * 3 * 200,
    }
    with pytest.raises(uj.BadInputError, match="--scenes: got 0; wanted at least 1 scene"):
        part.runs(SimpleNamespace(scenes=0, quick=True))
