"""The summary for people: what it shows of many conditions, and how shares change."""

import copy

import pytest
from study_fake import ToyMission, toy_study

from usvjax.mission import MOST_CONDITIONS, Metric
from usvjax.registry import register_mission
from usvjax.report.sheets import text_of
from usvjax.study import parse_spec, run_study
from usvjax.study.report import FEW, markdown, terminal


@pytest.fixture(scope="module")
def many(tmp_path_factory):
    rates = [0.9 - 0.01 * i for i in range(MOST_CONDITIONS + 1)]
    spec = parse_spec(toy_study(episodes=400, shard=400, axes={"params.rate": rates}))
    return run_study(spec, tmp_path_factory.mktemp("runs")).summary


def test_of_many_conditions_a_terminal_shows_the_ends_of_their_ranking(many):
    text = text_of(terminal(many), 100)
    rates = {
        c["label"]: max(m["statuses"]["REACHED"]["value"] for m in c["methods"])
        for c in many["conditions"]
    }
    ranked = sorted(rates, key=rates.__getitem__, reverse=True)
    count = len(ranked)
    for rank, label in enumerate(ranked, start=1):
        at_an_end = rank <= FEW or rank > count - FEW
        assert (f"no. {rank} of {count}: {label}" in text) is at_an_end
    words = " ".join(text.split())
    assert f"Of {count} conditions, ranked by the success rate of their best method" in words
    assert "All of them are in summary.md, summary.json" in words
    assert len(text.splitlines()) < 80
    assert all(f"| {label} |" in markdown(many) for label in ranked)


def test_few_conditions_are_all_shown(many):
    few = many | {"conditions": many["conditions"][:MOST_CONDITIONS]}
    text = text_of(terminal(few), 100)
    assert all(c["label"] in text for c in few["conditions"])
    assert "ranked" not in text


def test_of_many_wide_intervals_a_few_are_named(many):
    wide = copy.deepcopy(many)
    wide["study"]["until"] = 0.001
    wide["conditions"] = 100 * [c | {"narrow_enough": False} for c in wide["conditions"]]
    note = terminal(wide)[-1]
    assert "; and 1,288 more (see narrow_enough in summary.json)." in note
    assert len(note) < 400


def test_a_label_of_several_lines_is_one_cell_of_markdown(many):
    first = many["conditions"][0] | {"label": "a | b\nc"}
    text = markdown(many | {"conditions": [first, *many["conditions"][1:]]})
    assert "| a \\| b\\nc | plain |" in text


class Shares(ToyMission):
    """Times as a share from 0 to 1 and in per cent, as a quantity, and with a sign."""

    metrics = (
        Metric("time", "", "As share", share=True),
        Metric("clearance", "%", "As per cent"),
        Metric("steps", "deg", "Signed"),
        Metric("length", "m", "Length"),
    )

    def run(self, scene, method, record=False):
        found = super().run(scene, method, record)
        more = {"plain": 0.008, "better": 0.998}[method] + 0.0 * found.columns["time"]
        columns = {"time": more, "clearance": 100 * more, "steps": more - 0.5, "length": 10 * more}
        return type(found)({"status": found.columns["status"], **columns}, found.recording)


def test_shares_change_by_points_and_signed_values_not_at_all(tmp_path):
    register_mission("toy_shares", Shares())
    spec = parse_spec(toy_study(kind="toy_shares", name="shares", axes={}))
    summary = run_study(spec, tmp_path).summary
    found = summary["conditions"][0]["pairs"][0]["metrics"]
    assert found["time"]["difference"]["points"] == pytest.approx(99.0)
    assert found["clearance"]["difference"]["points"] == pytest.approx(99.0)
    assert "points" not in found["length"]["difference"]
    assert found["steps"]["difference"]["relative"] is None
    assert found["length"]["difference"]["relative"] == pytest.approx(123.75)
    for text in (text_of(terminal(summary), None), markdown(summary)):
        rows = {
            name: line
            for line in text.splitlines()
            for name in ("As share", "As per cent", "Signed", "Length")
            if name in line
        }
        assert "+99.0 pp" in rows["As share"]
        assert "+99.0 pp" in rows["As per cent"]
        assert "+12375.0 %" in rows["Length"]
        assert " pp" not in rows["Signed"]
        assert "+12375" not in rows["Signed"] + rows["As share"] + rows["As per cent"]
