"""Study files: what they mean, and every way to get one wrong."""

import math
import re
import time
import tomllib
from pathlib import Path

import pytest
from study_fake import toy_study

from usvjax.errors import BadInputError, BadTypeError
from usvjax.study import load_spec, parse_spec
from usvjax.study.variants import short_names

STUDIES = Path(__file__).parents[2] / "studies"


def dwa(text: str = "") -> dict:
    return tomllib.loads(f'name = "a"\nepisodes = 4\n{text}')


def test_defaults_fill_in():
    spec = parse_spec(dwa())
    assert spec.methods == ("traditional", "improved")
    assert spec.baseline == "traditional"
    assert (spec.kind, spec.seed, spec.shard, spec.until) == ("dwa", 0, 2000, None)
    (condition,) = spec.conditions
    assert condition.label == "a"
    assert condition.case.settings["maps"]["source"] == "lattice"
    assert condition.case.settings["params"]["radius"] == 0.5


def test_axes_are_crossed_in_order():
    spec = parse_spec(dwa('[axes]\n"params.radius" = [0.2, 0.5]\nmaps.rate = [0.1, 0.2, 0.3]'))
    assert [c.label for c in spec.conditions][:2] == [
        "radius 0.2, rate 0.1",
        "radius 0.2, rate 0.2",
    ]
    assert [c.index for c in spec.conditions] == list(range(6))
    assert spec.conditions[5].case.settings["params"]["radius"] == 0.5
    assert spec.conditions[5].case.settings["maps"]["rate"] == 0.3


def test_listed_conditions_and_axes_combine():
    spec = parse_spec(
        dwa(
            '[[conditions]]\nlabel = "narrow"\nparams.radius = 0.7\nmaps.rate = 0.2\n'
            "[[conditions]]\nparams.radius = 0.2\n"
            "[axes]\nparams.clearance_cap = [1.0, inf]"
        )
    )
    assert [c.label for c in spec.conditions] == [
        "narrow, clearance_cap 1",
        "narrow, clearance_cap inf",
        "radius 0.2, clearance_cap 1",
        "radius 0.2, clearance_cap inf",
    ]
    assert spec.conditions[1].case.given.params.clearance_cap == math.inf


def test_clashing_short_names_are_written_in_full():
    assert short_names({"maps.rate", "params.rate", "params.radius"}) == {
        "maps.rate": "maps.rate",
        "params.rate": "params.rate",
        "params.radius": "radius",
    }


def test_whole_numbers_do_for_numbers():
    one = parse_spec(dwa("[params]\nradius = 1"))
    assert one.hash == parse_spec(dwa("[params]\nradius = 1.0")).hash
    assert isinstance(one.conditions[0].case.given.params.radius, float)


@pytest.mark.parametrize(
    "change",
    [
        {"seed": 8},
        {"episodes": 251},
        {"shard": 99},
        {"methods": ["better", "plain"]},
        {"baseline": "better"},
        {"until": 0.5},
        {"confidence": 0.9},
        {"name": "other"},
        {"params": {"radius": 0.6}},
        {"axes": {"params.rate": [0.5, 0.91]}},
    ],
)
def test_whatever_decides_results_changes_the_hash(change):
    assert parse_spec(toy_study(**change)).hash != parse_spec(toy_study()).hash


def test_writing_out_a_default_does_not_change_the_hash():
    written = toy_study(confidence=0.95, baseline="plain", params={"radius": 0.5})
    assert parse_spec(written).hash == parse_spec(toy_study()).hash


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("episode = 3", "unknown key 'episode'; did you mean 'episodes'?"),
        ("[parms]\nradius = 1", "unknown key 'parms'; did you mean 'params'?"),
        ("[params]\nraduis = 1", r"\[params\]: unknown key 'raduis'; did you mean 'radius'?"),
        ("[static]\nhorison = 3", r"\[static\]: unknown key 'horison'; did you mean 'horizon'?"),
        ("[maps]\nrat = 0.1", r"\[maps\]: unknown key 'rat'; did you mean 'rate'?"),
        ("[maps]\nsource = 'latice'", "unknown source 'latice'; did you mean 'lattice'?"),
        ("[maps]\nrate_meaning = 'counts'", "did you mean 'count'?"),
        ("kind = 'dva'", "unknown kind 'dva'; did you mean 'dwa'?"),
        ("methods = ['improvd']", "unknown method 'improvd'.*did you mean 'improved'?"),
        ("methods = ['improved', 'improved']", "names a method twice"),
        ("baseline = 'traditionel'", "did you mean 'traditional'?"),
        ("methods = ['improved']\nbaseline = 'traditional'", "not one of 'methods'"),
        ("[params]\npreset = 'tan2021'", "'tan2022'"),
        ("[static]\nmethod = 'improved'", "list methods in 'methods'"),
        ("seed = -1", "'seed' must lie between 0 and"),
        ("shard = 0", "'shard' must lie between 1 and"),
        ("until = 0.0", "'until' must lie between 0 and 1"),
        ("until = nan", "'until' must lie between 0 and 1"),
        ("confidence = 1.0", "'confidence' must lie between 0 and 1"),
        ("confidence = 0.9999999999999999", "'confidence' must be at most 0.999999, got 0.99999"),
        ("[params]\nradius = -0.5", "radius.*-0.5"),
        ("[params]\nradius = nan", "radius.*nan"),
        ("[params]\ndt = 0.0", "dt.*0"),
        ("[params]\nv_min = 2.0", "v_min.*2"),
        ("[static]\nclearance = 'trajectry'", "'trajectory'"),
        ("[static]\nhorizon = 0", "horizon.*0"),
        ("[maps]\nrate = 1.5", r"'rate' must lie in \[0, 1\], got 1.5"),
        ("[maps]\nrate = nan", r"'rate' must lie in \[0, 1\], got nan"),
        ("[maps]\nsource = 'random'\ndensity = -0.1", r"'density' must lie in \[0, 1\]"),
        ("[maps]\nsource = 'random'", "either 'number' or 'density'"),
        ("[maps]\nsource = 'random'\nnumber = -3", "discs are possible, got -3"),
        ("[maps]\nlo = 3\nhi = 3", "'lo' must be below 'hi'"),
        ("[maps]\ngoal = [0, 0]", "the same point"),
        (
            "[params]\npreset = 'lake'",
            r"\[maps\]: 'start' \[0.0, 0.0\] lies 14.1421 m from 'goal' \[10.0, 10.0\], within "
            "'goal_tolerance' of 100 m",
        ),
        ("[params]\npreset = 'wei2023'", "within 'goal_tolerance' of 92.6 m"),
        ("[params]\ngoal_tolerance = 15.0", "within 'goal_tolerance' of 15 m"),
        ("[axes]\nparams.goal_tolerance = [0.5, 15.0]", "within 'goal_tolerance' of 15 m"),
        ("[maps]\ngoal = [0.3, 0.4]", "lies 0.5 m from 'goal'"),
        (
            "[maps]\nsource = 'random'\nnumber = 5\n[[conditions]]\nmaps.goal = [1.0, 0.0]\n"
            "params.goal_tolerance = 1.0",
            "within 'goal_tolerance' of 1 m",
        ),
        (
            "[maps]\nsource = 'grid'\nmap = 'hongze-250'\nshore_distance = 400\n"
            "distance = [100, 2000]\n[params]\npreset = 'lake'\nradius = 200",
            r"'distance' must begin above 'goal_tolerance' of 100 m.*\[100.0, 2000.0\]",
        ),
        ("[maps]\ngoal = [inf, 0]", "must be finite"),
        ("[maps]\nsource = 'grid'", "the key 'map' is missing"),
        ("[maps]\nsource = 'grid'\nmap = 'nowhere.map'", "nowhere.map"),
        (
            "[maps]\nsource = 'grid'\nmap = 'hongze-1000'\n[params]\nradius = 800",
            "'shore_distance'",
        ),
        ("[maps]\nsource = 'grid'\nmap = 'hongze-1000'", "radius must be at least 707"),
        ("[axes]\nradius = [0.1]", "'radius' must be section.key; did you mean 'params.radius'?"),
        ("[axes]\nraduis = [0.1]", "must be section.key; did you mean 'params.radius'?"),
        ("[axes]\nparam.radius = [0.1]", "did you mean 'params.radius'?"),
        ("[axes]\nparams = [0.1]", "'params' must be section.key; such as params.preset"),
        ("[axes]\nstatic.radius = [1]", r"\[static\]: unknown key.*mean 'params.radius'?"),
        ("[static]\nrate = 0.2", r"\[static\]: unknown key 'rate'; did you mean 'maps.rate'?"),
        ("rate = 0.2", "unknown key 'rate'; did you mean 'maps.rate'?"),
        ("'maps.rate' = 0.2", "unknown key 'maps.rate'; write it without quotation marks"),
        ("method = 'improved'", "unknown key 'method'; did you mean 'methods'?"),
        ("Seed = 3", "unknown key 'Seed'; did you mean 'seed'?"),
        ("xyzzy = 3", "unknown key 'xyzzy'; valid: axes, baseline, conditions"),
        ("[[conditions]]\nlable = 'x'", "'lable' must be section.key; did you mean 'label'?"),
        ("[axes]\nlable = ['x']", "'lable' must be section.key"),
        ("[axes]\nparams.radius = [0.1, -1.0]", "radius.*-1"),
        ("[axes]\nparams.radus = [0.1]", "did you mean 'radius'?"),
        ("[[conditions]]\nparams.radius = 1\n[axes]\nparams.radius = [2]", "both"),
        ("name = 3", "twice|overwrite|defined"),
    ],
)
def test_bad_values_are_named(tmp_path, text, words):
    path = tmp_path / "bad.toml"
    path.write_text(f'name = "a"\nepisodes = 4\n{text}\n')
    with pytest.raises(BadInputError, match=words) as error:
        load_spec(path)
    assert "bad.toml" in str(error.value)
    assert "\n" not in str(error.value).strip()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("seed = 1.5", "'seed' must be an integer, got 1.5"),
        ("seed = true", "'seed' must be an integer, got True"),
        ("shard = '3'", "'shard' must be an integer, got '3'"),
        ("methods = 'improved'", "'methods' must be a list, each a string"),
        ("methods = [1]", r"'methods'\[0\] must be a string, got 1"),
        ("until = 'narrow'", "'until' must be a number"),
        ("params = 3", "'params' must be a table, got 3"),
        ("axes = [1]", "'axes' must be a table"),
        ("conditions = 3", r"'conditions' must be \[\[conditions\]\] tables"),
        ("[params]\nradius = '0.5'", r"\[params\]: 'radius' must be a number, got '0.5'"),
        ("[params]\nradius = true", r"\[params\]: 'radius' must be a number, got True"),
        ("[params]\npreset = 1", "'preset' must be a string"),
        ("[static]\nhorizon = 1.5", "'horizon' must be an integer"),
        ("[static]\nbraking = 1", "'braking' must be a boolean"),
        ("[maps]\ngoal = [1]", "'goal' must be a list of 2 values"),
        ("[maps]\ngoal = 'here'", "'goal' must be a list, each a number"),
        ("[maps]\nsource = 3", "'source' must be a string, got 3"),
        ("[axes]\nparams.radius = 0.5", "'params.radius' must be a list of values, got 0.5"),
        ("[axes]\nparams.radius = []", "must be a list of values"),
        ("[[conditions]]\nlabel = 3", "'label' must be a string"),
    ],
)
def test_wrong_types_are_named(tmp_path, text, words):
    path = tmp_path / "bad.toml"
    path.write_text(f'name = "a"\nepisodes = 4\n{text}\n')
    with pytest.raises(BadTypeError, match=words):
        load_spec(path)


@pytest.mark.parametrize("episodes", [0, -1, 2**31])
def test_impossible_episode_counts_are_refused(episodes):
    with pytest.raises(BadInputError, match=f"'episodes' must lie between 1 and .*{episodes}"):
        parse_spec(toy_study(episodes=episodes))


@pytest.mark.parametrize("name", ["", "a/b", "..", "a b", "-x"])
def test_names_that_are_no_folder_are_refused(name):
    with pytest.raises(BadInputError, match="'name' must be at most 100 letters"):
        parse_spec(toy_study(name=name))


@pytest.mark.parametrize("key", ["name", "episodes"])
def test_required_keys_are_asked_for(key):
    study = toy_study()
    del study[key]
    with pytest.raises(BadInputError, match=f"the key '{key}' is missing"):
        parse_spec(study)


def test_unreadable_files_are_one_line(tmp_path):
    with pytest.raises(BadInputError, match=r"none\.toml: no such file"):
        load_spec(tmp_path / "none.toml")
    with pytest.raises(BadInputError, match="is a directory"):
        load_spec(tmp_path)
    (tmp_path / "broken.toml").write_text("name = ")
    with pytest.raises(BadInputError, match="not valid TOML"):
        load_spec(tmp_path / "broken.toml")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(BadInputError, match=r"binary\.toml: is UTF-16"):
        load_spec(tmp_path / "binary.toml")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("seed = " + "1" * 5001, "holds a whole number of thousands of digits; wanted ones of 64"),
        ("seed = " + "[" * 5000 + "]" * 5000, "is nested too deeply; wanted at most 16 tables"),
    ],
)
def test_files_that_cannot_even_be_parsed_are_one_line(tmp_path, text, words):
    (tmp_path / "a.toml").write_text(f'name = "a"\nepisodes = 4\n{text}\n')
    with pytest.raises(BadInputError, match=rf"a\.toml {words}"):
        load_spec(tmp_path / "a.toml")


def test_a_shard_holds_no_more_than_memory_does():
    with pytest.raises(BadInputError, match=r"'shard' must be at most 1,000,000.*got 2147483647"):
        parse_spec(toy_study(episodes=2**31 - 1, shard=2**31 - 1))
    # However large, a shard has no more episodes than the study.
    assert parse_spec(toy_study(episodes=250, shard=2**31 - 1)).shard == 2**31 - 1


def test_a_condition_has_no_more_shards_than_a_folder_holds_well():
    message = r"'shard' must be at least 2,148 for 2,147,483,647 episodes, .*got 2147$"
    with pytest.raises(BadInputError, match=message):
        parse_spec(toy_study(episodes=2**31 - 1, shard=2147, axes={}))
    assert parse_spec(toy_study(episodes=2**31 - 1, shard=2148, axes={})).shard == 2148


def test_conditions_share_the_files_of_a_study():
    axes = {"params.rate": [0.01 * i for i in range(1, 51)], "params.radius": [0.1, 0.2]}
    message = r"at least 3 for 25,000 episodes of each of 100 conditions.*got 2$"
    with pytest.raises(BadInputError, match=message):
        parse_spec(toy_study(axes=axes, episodes=25_000, shard=2))
    assert len(parse_spec(toy_study(axes=axes, episodes=25_000, shard=3)).conditions) == 100


def test_combinations_are_counted_before_any_is_made(monkeypatch):
    monkeypatch.setattr("usvjax.study.variants.itertools.product", None)
    axes = {f"params.{key}": list(range(60)) for key in ("rate", "radius", "sleep", "unsensed")}
    message = "60 x 60 x 60 x 60 = 12,960,000 conditions; wanted at most 10,000"
    with pytest.raises(BadInputError, match=message):
        parse_spec(toy_study(axes=axes))
    listed = [{"params": {"sleep": 0.0}}, {"params": {"sleep": 1e-9}}]
    axes = {"params.rate": [i / 1e4 for i in range(5001)]}
    with pytest.raises(BadInputError, match="2 x 5,001 = 10,002 conditions"):
        parse_spec(toy_study(axes=axes, conditions=listed))


@pytest.mark.parametrize("kind", ["dwa", "route", "cruise", "fleet", "aggregate"])
def test_hints_know_the_keys_of_every_kind(kind):
    study = {"name": "a", "episodes": 2, "kind": kind}
    spec = parse_spec(study)
    for section, settings in spec.conditions[0].case.settings.items():
        assert set(settings) <= set(spec.mission.tables[section].keys)
    elsewhere = {
        "dwa": "static.horizon",
        "route": "search.weight",
        "cruise": "cruise.speed",
        "fleet": "scenes.least_tcpa",
        "aggregate": "formation.hold_time",
    }[kind]
    with pytest.raises(BadInputError, match=f"did you mean '{elsewhere}'"):
        parse_spec({**study, elsewhere.partition(".")[2]: 3})


def test_a_changed_map_file_changes_the_hash(tmp_path):
    (tmp_path / "a.toml").write_text(
        'name = "a"\nepisodes = 2\n[maps]\nsource = "grid"\nmap = "lake.map"\n'
        "shore_distance = 2\ndistance = [5, 20]\n[params]\nradius = 1\n"
    )
    hashes = set()
    for corner in (".", "@"):
        rows = [corner + "." * 29] + ["." * 30] * 29
        (tmp_path / "lake.map").write_text(
            "type octile\nheight 30\nwidth 30\nmap\n" + "\n".join([*rows[:-1], "@" * 30]) + "\n"
        )
        hashes.add(load_spec(tmp_path / "a.toml").hash)
    assert len(hashes) == 2


@pytest.mark.parametrize("path", sorted(STUDIES.glob("*.toml")), ids=lambda p: p.stem)
def test_shipped_studies_are_valid(path):
    spec = load_spec(path)
    assert spec.name == path.stem
    assert spec.canonical()["conditions"]


def test_shipped_studies_are_there():
    assert {"tan2022", "hongze"} <= {path.stem for path in STUDIES.glob("*.toml")}


def test_an_axis_of_one_value_is_not_told():
    spec = parse_spec(dwa('[axes]\nparams.radius = [0.2, 0.5]\n"static.horizon" = [10]'))
    assert [c.label for c in spec.conditions] == ["radius 0.2", "radius 0.5"]
    assert all(c.case.settings["static"]["horizon"] == 10 for c in spec.conditions)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[params]\nradius = 1" + "0" * 400, "'radius' is too large"),
        ("seed = 0x" + "f" * 5000, "'seed' is too large: a whole number must fit in 64 bits"),
        ("episode = [" + "[" * 20 + "]" * 21, "'episode' is nested too deeply"),
        ("[axes]\n" + ".".join("a" * 900) + " = 3", "'a' is nested too deeply"),
        ("[params]\nv_step = 1e-300", "v_step: got 1e-300; wanted more than 0 in single"),
        ("[params]\nv_step = 1e-7", "n_v: got .*; wanted at most 1,000"),
        ("[params]\nheading_weight = 1e300", "a number that single precision holds"),
        ("[static]\nmax_steps = 10000001", "max_steps: got 10000001; wanted at most 10,000,000"),
        ("[maps]\ngoal = [1e9, 0.0]", "goals: episode 0 lies at .*: subtract a local origin"),
        ("[maps]\nhi = 60000", "lattice points; wanted at most 100,000"),
        ('[maps]\nsource = "random"\nnumber = 5\nhi = 1e200', "both within 200000 m of 0"),
        ('[maps]\nsource = "grid"\nmap = "hongze-250"\nrefine = 100000', "cells; wanted at most"),
    ],
)
def test_values_that_no_episode_could_use(text, words):
    with pytest.raises(BadInputError, match=words):
        parse_spec(dwa(text))


def test_conditions_must_all_be_tables():
    with pytest.raises(BadTypeError, match=r"'conditions' must be \[\[conditions\]\] tables"):
        parse_spec(dwa('conditions = [{label = "a"}, 3]'))


@pytest.mark.parametrize(
    "change",
    [
        {"qqqqqqqq": 1},
        {"methods": ["qqqqqqqq"]},
        {"baseline": "qqqqqqqq"},
        {"kind": "qqqqqqqq"},
        {"params": {"qqqqqqqq": 1}},
        {"axes": {"qqqqqqqq": [1]}},
        {"axes": {"params.qqqqqqqq": [1]}},
        {"conditions": [{"qqqqqqqq": 1}]},
    ],
)
def test_lists_of_names_have_each_name_once(change):
    with pytest.raises(BadInputError) as caught:
        parse_spec(toy_study(**change))
    names = re.split(r"[,;:] ", str(caught.value))
    assert len(names) == len(set(names)), str(caught.value)


@pytest.mark.parametrize(
    "change",
    [
        {"q" * 10**5: 1},
        {"methods": ["q" * 10**5]},
        {"name": "q" * 10**5},
        {"kind": "q" * 10**5},
        {"baseline": "q" * 10**5},
        {"seed": "q" * 10**5},
        {"params": {"q" * 10**5: 1}},
        {"params": {"radius": "q" * 10**5}},
        {"params": ["q" * 10**5]},
        {"axes": {"q" * 10**5: [1]}},
        {"axes": {"params.radius": "q" * 10**5}},
        {"conditions": ["q" * 10**5]},
        {"plugin": "q" * 10**5},
    ],
)
def test_messages_show_no_more_than_a_piece_of_what_was_read(change):
    began = time.process_time()
    with pytest.raises((BadInputError, BadTypeError)) as caught:
        parse_spec(toy_study(**change))
    assert len(str(caught.value)) < 300
    assert "qqqqqqqq" in str(caught.value)
    assert time.process_time() - began < 1.0
