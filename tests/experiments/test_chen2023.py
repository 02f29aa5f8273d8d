"""Chen et al. 2023: scenes and contacts are exact, tables and verdicts follow from the routes."""

import json
import re
from dataclasses import replace
from math import cos, hypot, pi, radians, sin

import jax
import numpy as np
import pytest
from matplotlib.path import Path as Outline
from matplotlib.transforms import Bbox

from experiments.chen2023 import __main__ as chen2023
from experiments.chen2023 import published, routes, tables, verdicts
from experiments.chen2023.runs import Job, Plan, make_job, run
from experiments.chen2023.scenes import (
    CELL,
    CELLS,
    CLEAR,
    ORIGIN,
    Waters,
    draw_scenes,
    on_blocked,
    to_cells,
    to_points,
)

WATERS = Waters(islands=25)
PAIRS = len(published.ENDS)


# --- the paper's own numbers ------------------------------------------------------------------


def test_angles_are_read_as_decimals_and_as_minutes():
    planned = published.TABLE_3[0].proposed
    assert planned.degrees == pytest.approx(87.0683)
    assert planned.degrees_by_minutes == pytest.approx(87 + 683 / 60)


@pytest.mark.parametrize("turning", [1.0, 44.15, 120.0, 179.0])
def test_two_equal_sides_are_the_longest_path_of_a_turning(turning):
    most = published.longest(100.0, turning)
    half = radians(turning) / 2
    # Isosceles: each side leaves the straight line by half the angle.
    assert most == pytest.approx(2 * 50.0 / cos(half))
    rng = np.random.default_rng(0)
    for split in rng.uniform(0.02, 0.98, 50):
        first, second = split * 2 * half, (1 - split) * 2 * half
        sides = 100.0 * (sin(second) + sin(first)) / sin(2 * half)
        assert sides <= most * (1 + 1e-12)


def test_a_path_that_turns_by_half_a_circle_may_have_any_length():
    assert published.longest(100.0, 180.0) == float("inf")


def test_the_papers_numbers_contradict_each_other_where_they_do():
    against = [c.where for c in published.arithmetic() if c.verdict == "contradicts"]
    assert against == [
        "Table 1: R against u / r",
        "Table 3, row 2: the proposed path turns less, digits as minutes",
        "Table 3, row 2, bspline: length, digits as decimals",
        "Table 3, row 2, proposed: length, digits as decimals",
    ]


# --- scenes -----------------------------------------------------------------------------------


def test_a_scene_depends_on_its_number_alone():
    several = draw_scenes(4, WATERS)
    third = draw_scenes(1, WATERS, first=2)
    np.testing.assert_array_equal(several.corners[2], third.corners[0])
    assert not np.array_equal(several.corners[2], several.corners[3])


def test_starts_and_ends_keep_clear_of_expanded_islands():
    scenes = draw_scenes(20, Waters(60))
    ends = np.array(published.ENDS).reshape(-1, 2)
    corners = scenes.expanded(published.EXPANSION).reshape(-1, 2)
    gap = np.linalg.norm(corners[:, None] - ends, axis=-1).min()
    assert gap > CLEAR
    cells = to_cells(ends)
    assert not scenes.blocked(published.EXPANSION)[:, cells[:, 1], cells[:, 0]].any()


def test_eq_4_scales_islands_about_their_centres():
    scenes = draw_scenes(1, WATERS)
    wider = scenes.expanded(1.5) - scenes.centres[:, :, None]
    np.testing.assert_allclose(
        wider, 2.5 * (scenes.corners - scenes.centres[:, :, None]), rtol=1e-5
    )


@pytest.mark.parametrize("expansion", [0.0, 1.5])
def test_blocked_cells_are_those_that_islands_touch(expansion):
    scenes = draw_scenes(1, WATERS)
    blocked = scenes.blocked(expansion)[0]
    outlines = [Outline(np.vstack([c, c[:1]]), closed=True) for c in scenes.expanded(expansion)[0]]
    rng = np.random.default_rng(1)
    near = np.argwhere(blocked | np.roll(blocked, 1, 0) | np.roll(blocked, 1, 1))
    cells = np.concatenate([rng.permutation(near)[:400], rng.integers(0, CELLS, (100, 2))])
    for y, x in cells:
        low = np.array(ORIGIN) + CELL * np.array([x, y])
        box = Bbox([low, low + CELL])
        assert blocked[y, x] == any(o.intersects_bbox(box, filled=True) for o in outlines), (x, y)


@pytest.mark.parametrize("expansion", [0.0, 1.5])
def test_points_lie_in_islands_where_the_outline_says_so(expansion):
    scenes = draw_scenes(3, WATERS)
    rng = np.random.default_rng(2)
    scene = rng.integers(0, 3, 6000)
    points = rng.uniform(-455, 455, (6000, 2))
    found = scenes.inside(expansion, scene, points)
    corners = scenes.expanded(expansion)
    for j in range(3):
        own = scene == j
        outlines = [Outline(np.vstack([c, c[:1]])) for c in corners[j]]
        wanted = np.any([o.contains_points(points[own]) for o in outlines], axis=0)
        np.testing.assert_array_equal(found[own], wanted)
    assert found.any()
    cells = to_cells(points)
    assert scenes.blocked(expansion)[scene, cells[:, 1], cells[:, 0]][found].all()


def test_beyond_the_map_there_is_water():
    grids = np.ones((1, CELLS, CELLS), bool)
    places = np.array([[[0.0, 0.0], [500.0, 0.0], [0.0, -455.01]]])
    assert on_blocked(grids, np.array([0]), places).tolist() == [[True, False, False]]


# --- routes -----------------------------------------------------------------------------------


def test_corners_are_where_a_path_turns():
    turning = [[0, 0], [1, 0], [2, 0], [3, 1], [4, 2], [4, 3]]
    padded = [[0, 0], [1, 0], [1, 0], [1, 0], [1, 0], [1, 0]]
    path = np.array([turning, padded, [[5, 5]] * 6])
    kept, count = routes.corners_of(path, np.array([6, 2, 1]))
    assert count.tolist() == [4, 2, 1]
    assert kept[0].tolist() == [[0, 0], [2, 0], [4, 2], [4, 3]]
    assert kept[1, :2].tolist() == [[0, 0], [1, 0]]
    assert kept[2, 0].tolist() == [5, 5]


@pytest.fixture(scope="module")
def searched():
    """One scene, searched on one device."""
    with jax.default_device(jax.local_devices()[0]):
        yield routes.search(draw_scenes(1, Waters(60)), published.EXPANSION)


def test_contacts_are_nested_and_where_the_vessel_is(searched):
    island = searched.scenes.centres[0, 0]
    poses = np.zeros((PAIRS, 3, 3))
    poses[..., :2] = to_points(to_cells(np.array(published.ENDS)[:, :1]))
    poses[2, 1, :2] = island
    tracks = routes.Tracks(*[np.zeros(PAIRS)] * 4, poses=poses, distance=np.zeros((PAIRS, 3)))
    found = routes.contacts(tracks, searched)
    assert found[2, 1].all()
    assert found.sum() == len(routes.CONTACTS)


def test_measures_agree_with_the_route_they_are_of(searched):
    measured = routes.measure(searched, routes.PROPOSED)
    route = routes.make_route(searched, routes.PROPOSED)
    assert measured.ok.any()
    for i in np.flatnonzero(measured.ok):
        points = route.points[i, : route.counts[i]]
        length = np.hypot(*np.diff(points, axis=0).T).sum()
        # Chords of s between samples fall short of arcs by s**2 / (24 R**2); single precision of
        # places of 1 km by 6e-5 m each.
        short = (routes.SPACING / 15.0) ** 2 / 24
        assert -1e-5 <= measured.length[i] / length - 1 <= short + 1e-5
        assert measured.straight[i] == pytest.approx(hypot(*(points[-1] - points[0])), abs=1e-3)
        assert measured.bend[i] * 15.0 <= 1.0
        assert measured.arrived[i]
        assert measured.error[i] < 2.0
    # The same route, one row alone.
    row = int(np.flatnonzero(measured.ok)[0])
    alone = routes.make_route(searched.row(row), routes.PROPOSED)
    np.testing.assert_array_equal(
        alone.points[0, : alone.counts[0]], route.points[row, : route.counts[row]]
    )


# --- tables and verdicts ----------------------------------------------------------------------


def made_up(scenes, length=1.1, turning=100.0, ok=None, contact=(), error=1.0, seed=0):
    """Measures of routes about `length` times the straight line long."""
    n = scenes * PAIRS
    rng = np.random.default_rng(seed)
    straight = np.tile([np.hypot(*np.subtract(*ends)) for ends in published.ENDS], scenes)
    flags = np.zeros((n, len(routes.CONTACTS)), bool)
    for kind in contact:
        flags[:, list(routes.CONTACTS).index(kind)] = True
    return routes.Measures(
        found=np.ones(n, bool),
        ok=np.ones(n, bool) if ok is None else ok,
        straight=straight,
        length=straight * length * rng.uniform(0.999, 1.001, n),
        turning=np.full(n, turning * pi / 180) * rng.uniform(0.99, 1.01, n),
        bend=np.full(n, 1 / 16.0),
        error=np.full(n, error) * rng.uniform(0.9, 1.1, n),
        contact=flags,
        arrived=np.ones(n, bool),
        corners=np.tile([3, 1, 1, 0], (n, 1)),
    )


def test_scenes_are_the_sample_not_their_routes():
    values = np.tile([[1.0] * PAIRS, [3.0] * PAIRS], (10, 1)).ravel()
    all_of_them = np.ones(len(values), bool)
    some = all_of_them.copy()
    some[PAIRS : 2 * PAIRS - 1] = False  # one route of a scene of 3s is left
    assert tables.scene_mean(values, all_of_them)["value"] == pytest.approx(2.0)
    assert tables.scene_mean(values, some)["value"] == pytest.approx(2.0)
    wide = tables.scene_mean(values, all_of_them)
    narrow = tables.mean(values)
    assert wide["high"] - wide["low"] > 1.5 * (narrow["high"] - narrow["low"])


def test_a_rate_of_none_has_the_interval_of_its_scenes():
    flags = np.zeros(20 * PAIRS, bool)
    rate = tables.scene_rate(flags, np.ones_like(flags))
    assert rate["value"] == 0.0
    assert rate["high"] == pytest.approx(tables.share(np.zeros(20, bool))["high"])


def test_contacts_are_compared_scene_by_scene():
    safe, touched = made_up(40), made_up(40, contact=("left",))
    touched.contact[PAIRS:, 0] = False  # in the first scene alone
    compared = tables.paired_contacts({"smoothed": safe, "astar": touched})
    assert compared["left"][0]["baseline_only"] == 1
    assert compared["left"][0]["difference"]["value"] == pytest.approx(-1 / 40)
    assert compared["entered"][0]["neither"] == 40


def test_nothing_counted_gives_no_figure():
    flags = np.zeros(2 * PAIRS, bool)
    assert tables.scene_mean(np.ones(len(flags)), flags)["value"] is None
    assert tables.spread(np.zeros(0))["median"] is None


def judged(**changes):
    """Verdicts on made-up measures: as published, but for what is changed."""
    scenes = 40
    ratios = [1.0] + [row.proposed.length / row.bspline.length for row in published.TABLE_3]
    turning = [1.0] + [row.proposed.degrees / row.bspline.degrees for row in published.TABLE_3]
    measured = {method.name: made_up(scenes, seed=i) for i, method in enumerate(routes.METHODS)}
    measured["astar"] = made_up(scenes, contact=("left", "entered"), error=5.0)
    for spline in tables.SPLINES:
        plain = made_up(scenes, seed=len(spline.name))
        measured[spline.name] = replace(
            plain,
            length=plain.length / np.tile(ratios, scenes),
            turning=plain.turning / np.tile(turning, scenes),
        )
    measured["smoothed"] = replace(measured["smoothed"], error=0.1 * measured["smoothed"].error)
    measured |= changes
    one = {"search": 0.01, "a_bspline": 0.03, "a_proposed": 0.02}
    found = {
        "settings": {"main": {"words": "60 islands"}},
        "sailing": tables.sailing(measured, routes.METHODS),
        "bends": tables.bends(measured, routes.METHODS),
        "corners": tables.corners(measured, routes.METHODS),
        "compared": tables.compare(measured),
        "expansions": [],
        "waters": [],
        "timing": {"batch": one, "single": [one] * PAIRS},
    }
    return {verdict.claim: verdict for verdict in verdicts.judge(found)}


def test_verdicts_say_so_when_the_published_numbers_are_met():
    found = judged()
    missed = {claim for claim, verdict in found.items() if verdict.verdict != "reproduces"}
    collision = "Fig. 15: there it collides with an obstacle"
    assert missed == {collision, "Table 3: length of the proposed path over the straight line"}
    collides = found[collision].found
    assert [finding.holds for finding in collides.values()] == [True, True, False, False]


def test_verdicts_say_so_when_they_are_missed():
    short = made_up(40, length=0.9, turning=300.0)
    found = judged(**{spline.name: short for spline in tables.SPLINES})
    assert found["Tables 2 and 3: by as much as printed"].verdict == "does not reproduce"
    assert (
        found["Tables 2 and 3: the proposed path is shorter than the B-spline"].verdict
        == "does not reproduce"
    )
    assert found["Table 3: by as much as printed"].verdict == "does not reproduce"


def test_one_contact_is_one_too_many():
    touched = made_up(40)
    touched.contact[7] = True
    found = judged(smoothed=touched)["Fig. 16: on the proposed path it does not, and arrives"]
    assert found.verdict == "depends on the reading"
    assert "1 of 200" in found.found["R = u/r = 15 m, E = 1.5: an expanded island"].numbers


def test_a_corner_left_over_is_told_and_its_path_left_out():
    fitted = np.ones(40 * PAIRS, bool)
    fitted[3] = False
    broken = made_up(40, ok=fitted)
    broken.contact[3] = True
    found = judged(smoothed=broken)
    smooths = found["Algorithm 1 smooths the path of A*"].found["after shortening, R = 15 m"]
    assert not smooths.holds
    assert "199 of 200 paths" in smooths.numbers
    safe = found["Fig. 16: on the proposed path it does not, and arrives"]
    assert safe.found["R = u/r = 15 m, E = 1.5: an expanded island"].holds


def test_a_sharper_path_than_the_vessel_turns_is_told():
    sharp = made_up(40)
    found = judged(smoothed=replace(sharp, bend=np.full_like(sharp.bend, 1 / 14.9)))
    claim = "The proposed path bends no more than the vessel can turn"
    assert not found[claim].found["R = u/r = 15 m"].holds


def test_few_scenes_give_no_verdict():
    few = {m.name: made_up(3) for m in routes.METHODS}
    found = judged(**few)
    assert found["Tables 2 and 3: by as much as printed"].verdict == "too few maps"


# --- the program ------------------------------------------------------------------------------


def test_quick_leaves_out_what_takes_long():
    full, quick = make_job(1000, 200, 15, quick=False), make_job(36, 24, 3, quick=True)
    assert full.main.expansion == quick.main.expansion == published.EXPANSION
    assert {plan.expansion for plan in quick.plans} == {0.0, published.EXPANSION}
    assert sum(p.routes for p in quick.plans) < 0.05 * sum(p.routes for p in full.plans)


def test_plans_are_run_block_by_block(searched):
    told = []
    plan = Plan(1, methods=(routes.PROPOSED,))
    with jax.default_device(jax.local_devices()[0]):
        results = run(Job(plan, (), (), repeats=1, block=1), told.append)
        wanted = routes.measure(searched, routes.PROPOSED)
    assert sum(told) == plan.routes == PAIRS
    np.testing.assert_array_equal(results[plan]["smoothed"].length, wanted.length)


def made_up_results(job, advance):
    """Measures of every plan, the vessel in contact everywhere."""
    results = {}
    for plan in job.plans:
        advance(plan.routes)
        results[plan] = {m.name: made_up(plan.scenes, seed=i) for i, m in enumerate(plan.methods)}
        for measures in results[plan].values():
            measures.contact[:] = True
    return results


@pytest.mark.usefixtures("searched")
def test_the_program_writes_report_numbers_and_figures(tmp_path, monkeypatch):
    job = make_job(scenes=2, few=2, repeats=1, quick=False)
    monkeypatch.setattr(chen2023, "_job", lambda options: replace(job, block=1))
    monkeypatch.setattr(chen2023, "run", made_up_results)
    with jax.default_device(jax.local_devices()[0]):
        assert chen2023.main(["--out", str(tmp_path)]) == 0
    report = (tmp_path / "README.md").read_text()
    for words in ("| Row 2 |", "100 islands", "| 0.25 |", "**contradicts**"):
        assert words in report, words
    assert " nan" not in report
    for table in re.findall(r"(?:^\|.*\n)+", report, re.MULTILINE):
        assert len({line.count(" | ") for line in table.splitlines()}) == 1, table
    found = json.loads((tmp_path / "results.json").read_text())
    assert len(found["compared"]) == PAIRS
    assert found["settings"]["main"]["scenes"] == 2
    drawn = {path.stem for path in (tmp_path / "figures").iterdir()}
    scenes = {"figs_15_16", "figs_15_16_not_expanded", "figs_17_18"}
    assert drawn == {"monte_carlo", "corners", *scenes}


def test_no_scenes_are_refused_before_anything_is_written(tmp_path, capsys):
    out = tmp_path / "new"
    assert chen2023.main(["--scenes", "0", "--out", str(out)]) == 2
    assert "--scenes: got 0" in capsys.readouterr().err
    assert not out.exists()


def test_a_folder_that_cannot_be_written_is_told(tmp_path, capsys):
    blocker = tmp_path / "file"
    blocker.write_text("")
    assert chen2023.main(["--quick", "--out", str(blocker / "sub")]) == 2
    assert "cannot write" in capsys.readouterr().err
