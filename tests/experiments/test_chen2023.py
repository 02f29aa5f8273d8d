"""Chen et al. 2023: scenes and contacts are exact, tables and verdicts follow from the routes."""

import json
import re
from dataclasses import replace
from math import cos, hypot, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest
from matplotlib.path import Path as Outline
from matplotlib.transforms import Bbox

from experiments.chen2023 import __main__ as chen2023
from experiments.chen2023 import angles, claims, published, routes, scenes, studies, tables
from experiments.chen2023.arithmetic import checks, longest
from experiments.chen2023.mission import MISSION
from experiments.chen2023.scenes import CLEAR, ORIGIN, Waters, draw_scenes, on_blocked, to_cells
from experiments.chen2023.timing import WHOLE, timings, work
from experiments.claims import judge
from experiments.paper import main
from experiments.runs import Study
from usvjax.errors import BadInputError
from usvjax.mission import Files
from usvkernels.status import Status

pytestmark = pytest.mark.usefixtures("one_device")

WATERS = Waters(islands=25)
PAIRS = len(published.ENDS)
CELL = WATERS.cell


# --- the paper's own numbers ------------------------------------------------------------------


def test_angles_are_read_as_decimals_and_as_minutes():
    planned = published.TABLE_3[0].proposed
    assert angles.turning(planned, "decimals") == pytest.approx(87.0683)
    assert angles.turning(planned, "minutes") == pytest.approx(87 + 683 / 60)
    assert angles.ratio(published.TABLE_3[1], "turning", "minutes") > 1
    assert angles.ratio(published.TABLE_3[1], "turning", "decimals") < 1


@pytest.mark.parametrize("turning", [1.0, 44.15, 120.0, 179.0])
def test_two_equal_sides_are_the_longest_path_of_a_turning(turning):
    most = longest(100.0, turning)
    half = radians(turning) / 2
    # Isosceles: each side leaves the straight line by half the angle.
    assert most == pytest.approx(2 * 50.0 / cos(half))
    rng = np.random.default_rng(0)
    for split in rng.uniform(0.02, 0.98, 50):
        first, second = split * 2 * half, (1 - split) * 2 * half
        sides = 100.0 * (sin(second) + sin(first)) / sin(2 * half)
        assert sides <= most * (1 + 1e-12)


def test_a_path_that_turns_by_half_a_circle_may_have_any_length():
    assert longest(100.0, 180.0) == float("inf")


def test_the_papers_numbers_contradict_each_other_where_they_do():
    against = [c.where for c in checks() if c.verdict == "contradicts"]
    assert against == [
        "Table 1: R against u / r",
        "Table 3, row 2: the proposed path turns less, digits as minutes",
        "Table 3, row 2, bspline: length, digits as decimals",
        "Table 3, row 2, proposed: length, digits as decimals",
    ]


# --- scenes -----------------------------------------------------------------------------------


def test_a_scene_depends_on_its_number_alone():
    several = draw_scenes(range(4), WATERS)
    third = draw_scenes([2], WATERS)
    np.testing.assert_array_equal(several.corners[2], third.corners[0])
    assert not np.array_equal(several.corners[2], several.corners[3])


@pytest.mark.parametrize("cell", [5.0, 10.0])
def test_starts_and_ends_keep_clear_of_expanded_islands(cell):
    drawn = draw_scenes(range(20), Waters(60))
    ends = np.array(published.ENDS).reshape(-1, 2)
    corners = drawn.expanded(published.EXPANSION).reshape(-1, 2)
    gap = np.linalg.norm(corners[:, None] - ends, axis=-1).min()
    assert gap > CLEAR
    cells = to_cells(ends, cell)
    assert not drawn.blocked(published.EXPANSION, cell)[:, cells[:, 1], cells[:, 0]].any()


def test_eq_4_scales_islands_about_their_centres():
    drawn = draw_scenes([0], WATERS)
    wider = drawn.expanded(1.5) - drawn.centres[:, :, None]
    np.testing.assert_allclose(wider, 2.5 * (drawn.corners - drawn.centres[:, :, None]), rtol=1e-5)


@pytest.mark.parametrize(("expansion", "cell"), [(0.0, 5.0), (1.5, 5.0), (1.5, 10.0)])
def test_blocked_cells_are_those_that_islands_touch(expansion, cell):
    drawn = draw_scenes([0], WATERS)
    blocked = drawn.blocked(expansion, cell)[0]
    assert blocked.shape == (scenes.SIDE / cell,) * 2
    outlines = [Outline(np.vstack([c, c[:1]]), closed=True) for c in drawn.expanded(expansion)[0]]
    rng = np.random.default_rng(1)
    near = np.argwhere(blocked | np.roll(blocked, 1, 0) | np.roll(blocked, 1, 1))
    cells = np.concatenate([rng.permutation(near)[:400], rng.integers(0, len(blocked), (100, 2))])
    for y, x in cells:
        low = np.array(ORIGIN) + cell * np.array([x, y])
        box = Bbox([low, low + cell])
        assert blocked[y, x] == any(o.intersects_bbox(box, filled=True) for o in outlines), (x, y)


@pytest.mark.parametrize("expansion", [0.0, 1.5])
def test_points_lie_in_islands_where_the_outline_says_so(expansion):
    drawn = draw_scenes(range(3), WATERS)
    rng = np.random.default_rng(2)
    scene = rng.integers(0, 3, 6000)
    points = rng.uniform(-455, 455, (6000, 2))
    found = drawn.inside(expansion, scene, points)
    corners = drawn.expanded(expansion)
    for j in range(3):
        own = scene == j
        outlines = [Outline(np.vstack([c, c[:1]])) for c in corners[j]]
        wanted = np.any([o.contains_points(points[own]) for o in outlines], axis=0)
        np.testing.assert_array_equal(found[own], wanted)
    assert found.any()
    cells = to_cells(points, CELL)
    assert drawn.blocked(expansion, CELL)[scene, cells[:, 1], cells[:, 0]][found].all()


def test_beyond_the_map_there_is_water():
    grids = np.ones((1, 182, 182), bool)
    places = np.array([[[0.0, 0.0], [500.0, 0.0], [0.0, -455.01]]])
    assert on_blocked(grids, CELL, np.array([0]), places).tolist() == [[True, False, False]]


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
def searched(one_device):
    """All pairs of ends in one scene."""
    return routes.search(Waters(), scenes.SEED, np.arange(PAIRS))


def test_contacts_are_nested_and_where_the_vessel_is(searched):
    island = searched.scenes.centres[0, 0]
    poses = np.zeros((PAIRS, 3, 3))
    poses[..., :2] = np.array(published.ENDS)[:, :1]
    poses[2, 1, :2] = island
    tracks = routes.Tracks(*[np.zeros(PAIRS)] * 4, poses=poses, distance=np.zeros((PAIRS, 3)))
    found = routes.contacts(tracks, searched)
    assert found[2, 1].all()
    assert found.sum() == len(routes.CONTACTS)
    status = np.where(np.arange(PAIRS) == 2, Status.UNREACHABLE, searched.found.status)
    without = replace(searched, found=replace(searched.found, status=status))
    assert not routes.contacts(tracks, without).any()  # nobody sails where there is no path


def test_columns_agree_with_the_route_they_are_of(searched):
    outcome = MISSION.run(searched, "short_arcs", record=True)
    columns, route = outcome.columns, routes.make_route(searched, routes.SHORT_ARCS)
    np.testing.assert_array_equal(columns["whole"], route.ok)
    assert route.ok.any()
    for i in np.flatnonzero(route.ok):
        points = route.points[i, : route.counts[i]]
        np.testing.assert_array_equal(outcome.recording.detail[i].path, points)
        length = np.hypot(*np.diff(points, axis=0).T).sum()
        assert columns["path_length"][i] == pytest.approx(length, rel=1e-12)
        assert columns["straight"][i] == pytest.approx(hypot(*(points[-1] - points[0])), abs=1e-3)
        assert columns["bend"][i] * 15.0 <= 1.0
        assert columns["arrived"][i]
        assert columns["error"][i] < 2.0


@pytest.mark.parametrize("method", ["astar", "bspline", "arcs_3"])
def test_a_row_is_the_same_bits_alone_as_among_others(searched, method):
    alone = routes.search(Waters(), scenes.SEED, np.array([3]))
    whole, row = (MISSION.run(own, method).columns for own in (searched, alone))
    for name, values in whole.items():
        np.testing.assert_array_equal(np.asarray(values)[3:4], row[name], err_msg=name)


def test_of_the_shortest_paths_that_with_the_fewest_turns_can_be_had(one_device):
    plain, few = (
        routes.search(Waters(cell=14.0, turns=turns), scenes.SEED, np.array([3]))
        for turns in scenes.TURNS
    )
    (length, turned), (again, fewer) = (
        routes.length_and_turning(14.0 * own.found.path, own.found.path_cells)
        for own in (plain, few)
    )
    assert again == pytest.approx(length, rel=1e-9)
    assert fewer < turned


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("islands", 0),
        ("least_axis", 0.0),
        ("greatest_axis", 7.0),
        ("expansion", 1.6),
        ("cell", 6.0),
        ("turns", "most"),
    ],
)
def test_waters_that_cannot_be_used_are_refused(key, value):
    with pytest.raises(BadInputError, match=rf"\[waters\]: '{key}' must be"):
        MISSION.case({"waters": {key: value}}, Files())


# --- tables and verdicts ----------------------------------------------------------------------


def made_up(scenes, length=1.1, turning=100.0, contact=(), error=1.0, seed=0):
    """Columns of routes about `length` times the straight line long."""
    n = scenes * PAIRS
    rng = np.random.default_rng(seed)
    straight = np.tile([np.hypot(*np.subtract(*ends)) for ends in published.ENDS], scenes)
    columns = {
        "status": np.full(n, 10),
        "whole": np.ones(n, int),
        "straight": straight,
        "path_length": straight * length * rng.uniform(0.999, 1.001, n),
        "turning": np.full(n, turning * pi / 180) * rng.uniform(0.99, 1.01, n),
        "bend": np.full(n, 1 / 16.0),
        "error": np.full(n, error) * rng.uniform(0.9, 1.1, n),
        "arrived": np.ones(n, int),
        **{kind: np.full(n, int(kind in contact)) for kind in routes.CONTACTS},
        **dict(zip(routes.TEMPLATES, ([3] * n, [1] * n, [1] * n, [0] * n), strict=True)),
    }
    return tables.by_scene({name: np.array(values) for name, values in columns.items()})


def test_scenes_are_the_sample_not_their_routes():
    values = np.tile([[1.0] * PAIRS, [3.0] * PAIRS], (10, 1))
    everything = np.ones(values.shape, bool)
    some = everything.copy()
    some[1, :-1] = False  # one route of a scene of 3s is left
    assert tables.scene_mean(values, everything)["value"] == pytest.approx(2.0)
    assert tables.scene_mean(values, some)["value"] == pytest.approx(2.0)
    wide = tables.scene_mean(values, everything)
    narrow = tables.mean(values.ravel())
    assert wide["high"] - wide["low"] > 1.5 * (narrow["high"] - narrow["low"])


def test_a_rate_of_none_has_the_interval_of_its_scenes():
    flags = np.zeros((20, PAIRS), bool)
    rate = tables.scene_rate(flags, ~flags)
    assert rate["value"] == 0.0
    assert rate["high"] == pytest.approx(tables.share(np.zeros(20, bool))["high"])
    assert tables.scene_rate(flags, flags)["value"] is None
    counted = ~flags
    flags[0, 0] = True  # of a hundred routes one
    assert tables.scene_rate(flags, counted)["low"] >= 0.0


def test_contacts_are_compared_scene_by_scene():
    safe, touched = made_up(40), made_up(40, contact=("left",))
    touched["left"][1:] = 0
    compared = tables.against_astar({"arcs": safe, "astar": touched}, routes.ARCS)
    assert compared["left"][0]["baseline_only"] == 1
    assert compared["left"][0]["difference"]["value"] == pytest.approx(-1 / 40)
    assert compared["entered"][0]["neither"] == 40


@pytest.mark.parametrize(
    ("ps", "n", "holds", "words"),
    [
        ([0.98, 0.80, 0.091, 0.053], [178, 176, 159, 160], True, "of 4 rows 0 excluded"),
        ([0.98, 0.80, 0.091, 0.053], [178, 176, 158, 160], None, "0 excluded, 1 too few to tell"),
        ([0.98, 0.0125, 0.091, 0.053], [178, 176, 3, 160], False, "1 excluded, 1 too few to tell"),
        ([0.98, 0.0126, 0.091, 0.053], [178, 176, 159, 160], True, "of 4 rows 0 excluded"),
    ],
)
def test_each_row_is_judged_by_its_own_scenes(ps, n, holds, words):
    assert claims.RANKED == 159
    found = claims._inside(ps, n, "means")
    assert found.holds is holds
    assert found.numbers.endswith(words)


def test_the_densest_waters_have_scenes_enough_to_exclude_a_row():
    waters = studies.planned(studies.FULL)["waters"].spec
    # Of the scenes with 100 islands, in the worst row R = 3 m smooths 131 of 200.
    assert waters.episodes / PAIRS * 131 / 200 > 1.1 * claims.RANKED


SCENES = 200


def judged(scenes=SCENES, expansions=None, grids=None, timing=None, **changes):
    """Verdicts on made-up measures: as published, but for what is changed."""
    measured = {name: made_up(scenes, seed=i) for i, name in enumerate(routes.METHODS)}
    measured["astar"] = made_up(scenes, contact=("left", "entered"), error=5.0)
    for spline in routes.SPLINES:
        plain = made_up(scenes, seed=len(spline.name))
        ratios = {
            m: [1.0, *(angles.ratio(r, m) for r in published.TABLE_3)] for m in tables.METRICS
        }
        plain["path_length"] /= ratios["length"]
        plain["turning"] /= ratios["turning"]
        measured[spline.name] = plain
    numbers = tables.tabulate(measured | changes, expansions or {}, grids or {}, {})
    row = {
        "ratio": dict.fromkeys(routes.METHODS, 0.5),
        "less": dict.fromkeys(routes.METHODS, 15),
        "repeats": 15,
    }
    numbers["timing"] = timing or {"batch": row, "single": [row] * PAIRS}
    return {one.claim: one for one in judge(claims.claims(numbers), numbers)}


COLLIDES = "Fig. 15: there it collides with an obstacle"
SAFE = "Fig. 16: on the proposed path it does not, and arrives"
SMOOTHS = "Algorithm 1 smooths the path of A*"
SHORTER = "Tables 2 and 3: the proposed path is shorter than the B-spline"
AS_SHORT = "Tables 2 and 3: by as much as printed"
TURNS_LESS = "Table 3: the proposed path turns less than the B-spline"
LENGTH = "Table 3: length of the proposed path over the straight line"
QUICKER = "Tables 2 and 3: planning takes less time than with a B-spline"


def test_verdicts_say_so_when_the_published_numbers_are_met():
    found = judged()
    missed = {claim for claim, one in found.items() if one.verdict == "does not reproduce"}
    depends = {claim for claim, one in found.items() if one.verdict == "depends on the reading"}
    assert missed == {LENGTH}
    # As minutes row 2 turns more, and by other ratios; the figures tell contacts apart.
    assert depends == {COLLIDES, TURNS_LESS, "Table 3: it turns less by as much as printed"}
    assert [one.holds for one in found[COLLIDES].found.values()] == [True, True, False, False]
    assert found[AS_SHORT].verdict == "not excluded"


def test_verdicts_say_so_when_they_are_missed():
    short = made_up(SCENES, length=0.9, turning=50.0)
    found = judged(**{spline.name: short for spline in routes.SPLINES})
    for claim in (SHORTER, AS_SHORT, TURNS_LESS):
        assert found[claim].verdict == "does not reproduce", claim


def test_a_shortening_of_ours_stands_beside_and_does_not_count():
    longer = made_up(SCENES, length=1.3)
    found = judged(arcs=longer, arcs_wide=longer, arcs_3=longer)[SHORTER]
    assert found.verdict == "does not reproduce"
    assert found.beside["shortened first, R = 15 m"].holds
    assert not any("shortened" in label for one in judged().values() for label in one.found)


def test_the_grid_that_is_not_printed_is_a_reading():
    other = {name: made_up(SCENES, seed=i) for i, name in enumerate(routes.METHODS)}
    shorter = other | {"bspline": made_up(SCENES, length=1.05)}
    found = judged(grids={"fewest turns": shorter})[SHORTER]
    assert found.verdict == "depends on the reading"
    assert found.found["fewest turns, R = 3 m"].holds is False


def test_digits_as_minutes_are_a_reading_of_every_claim_on_turning():
    found = judged()[TURNS_LESS]
    assert found.found["R = 15 m"].holds
    assert found.found["R = 15 m, as minutes"].holds is False  # row 2 prints more, and has less


def test_one_contact_is_one_too_many():
    touched = made_up(SCENES)
    touched["left"][1, 2] = 1
    found = judged(arcs=touched)[SAFE]
    assert found.verdict == "depends on the reading"
    assert "1 of 1,000" in found.found["R = 15 m, E = 1.5, a cell kept clear of"].numbers


def test_one_that_does_not_arrive_is_one_too_many():
    lost = made_up(SCENES)
    lost["arrived"][1, 2] = 0
    one = judged(arcs=lost)[SAFE].found["R = 15 m, E = 1.5, an island"]
    assert one.holds is False
    assert "1 not arrived" in one.numbers


def test_a_corner_left_over_is_told_and_its_path_left_out():
    broken = made_up(SCENES)
    broken["whole"][:198, 0] = False
    broken["left"][0, 0] = 1
    found = judged(arcs=broken)
    smooths = found[SMOOTHS].found["R = 15 m"]
    assert smooths.holds is False
    assert "802 of 1,000 paths whole; all five in 1.0 % of scenes" in smooths.numbers
    assert found[SMOOTHS].verdict == "depends on the reading"
    assert found[SAFE].found["R = 15 m, E = 1.5, a cell kept clear of"].holds


def test_islands_that_are_not_expanded_are_a_reading_of_the_collision():
    bare = {name: made_up(SCENES, contact=("touched",)) for name in routes.METHODS}
    found = judged(expansions={0.0: bare})[COLLIDES].found
    assert found["E = 0, a cell of an island"].holds
    assert found["E = 0, an island"].holds is False


def test_a_sharper_path_than_the_vessel_turns_is_told():
    sharp = made_up(SCENES)
    sharp["bend"][:] = 1 / 14.9
    claim = "The proposed path bends no more than the vessel can turn"
    assert judged(arcs=sharp)[claim].found["R = 15 m"].holds is False
    assert judged()[claim].found["R = 15 m"].holds


@pytest.mark.parametrize(("less", "holds"), [(12, True), (11, None), (4, None), (3, False)])
def test_times_are_told_apart_by_a_sign_test(less, holds):
    ratio = dict.fromkeys(routes.METHODS, 0.9)
    quick = {"ratio": ratio, "less": dict.fromkeys(routes.METHODS, 15), "repeats": 15}
    last = quick | {"less": dict.fromkeys(routes.METHODS, less)}
    found = judged(timing={"batch": quick, "single": [quick] * (PAIRS - 1) + [last]})[QUICKER]
    assert found.found["R = 15 m, one path a call"].holds is holds
    assert found.found["R = 15 m, many at once"].holds


def test_few_scenes_give_no_verdict():
    few = {name: made_up(3) for name in routes.METHODS}
    found = judged(scenes=3, **few)
    assert {one.verdict for claim, one in found.items() if claim != QUICKER} == {"undecided"}
    # Enough for a difference, and too few for a rank to exclude anything.
    some = judged(scenes=40)
    assert some[SHORTER].verdict == "reproduces"
    assert some[AS_SHORT].verdict == "undecided"


# --- the program ------------------------------------------------------------------------------


def test_quick_leaves_out_what_takes_long():
    full, quick = (studies.runs(studies.Chen(quick=quick)) for quick in (False, True))
    assert set(full) - set(quick) == {"waters", "grids"}
    size = {
        name: sum(r.size for r in own.values() if isinstance(r, Study))
        for name, own in (("full", full), ("quick", quick))
    }
    assert size["quick"] < 0.05 * size["full"]
    given = full["scenes"].spec.conditions[0].case.settings["waters"]
    assert given == vars(Waters()) == {**given, "expansion": published.EXPANSION}
    assert full["scenes"].spec.episodes == 1000 * PAIRS


def timed(waters, scenes, repeats, advance):
    """Timings that take no time."""
    names = ("search", "shortening", "spline", "arcs", "arcs_3", "arcs_shortened")
    row = {
        "stages": dict.fromkeys(names, 0.001),
        **{of: dict.fromkeys(WHOLE, 0.004) for of in ("whole", "ratio")},
        "less": dict.fromkeys(WHOLE, 0),
        "repeats": repeats,
    }
    return {"paths": scenes * PAIRS, "batch": row, "single": [row] * PAIRS}


def test_timings_are_of_every_stage_and_algorithm(one_device):
    done = []
    found = timings(Waters(cell=14.0), 1, 1, done.append)
    assert sum(done) == work(1)
    wanted = timed(Waters(), 1, 1, done.append)
    assert {key: set(of) for key, of in found["batch"].items() if key != "repeats"} == {
        key: set(of) for key, of in wanted["batch"].items() if key != "repeats"
    }
    row, whole = found["single"][0], found["single"][0]["whole"]
    assert whole["short_arcs"] == pytest.approx(
        sum(row["stages"][stage] for stage in WHOLE["short_arcs"])
    )
    assert row["ratio"]["arcs"] == pytest.approx(whole["arcs"] / whole["bspline"])
    assert row["less"]["bspline"] == 0


def test_the_program_writes_page_numbers_and_figures(tmp_path, monkeypatch):
    tiny = studies.Sizes(scenes=4, few=1, waters=1, repeats=1, timed=1, whole=True)
    small = {name: grid for name, grid in studies.OTHER_GRIDS.items() if name != "fewest turns"}
    monkeypatch.setattr(studies, "OTHER_GRIDS", small)
    monkeypatch.setattr(studies, "OTHER_WATERS", studies.OTHER_WATERS[:1])
    monkeypatch.setattr(studies, "BY_EXPANSION", {0.0: studies.BY_EXPANSION[0.0]})
    monkeypatch.setattr(studies, "QUICK", tiny)
    monkeypatch.setattr(studies, "timings", timed)
    monkeypatch.chdir(tmp_path)
    assert main(chen2023.PAPER, ["--quick"]) == 0
    folder = Path("runs/chen2023_quick")
    page = (folder / "README.md").read_text()
    for words in ("| Row 2 |", "20 islands", "10 m cells", "| contradicts |", "Figs. 19 to 25"):
        assert words in page, words
    assert " nan" not in page
    for table in re.findall(r"(?:^\|.*\n)+", page, re.MULTILINE):
        assert len({line.count(" | ") for line in table.splitlines()}) == 1, table
    found = json.loads((folder / "results.json").read_text())["paths"]
    assert len(found["compared"]["scenes"]["arcs"]["bspline"]) == PAIRS
    drawn = {path.stem for path in (folder / "figures").iterdir()}
    assert drawn >= {"ratios", "lengths_and_turning", "sailing", "corners"}


def test_no_scenes_are_refused_before_anything_is_written(tmp_path, capsys):
    out = tmp_path / "new"
    assert main(chen2023.PAPER, ["--scenes", "0", "--out", str(out)]) == 2
    assert "--scenes: got 0" in capsys.readouterr().err
    assert not out.exists()
