"""Wei & Zhang 2023, aggregation: layouts, numbers and verdicts."""

from types import SimpleNamespace

import numpy as np
import pytest

from experiments.claims import judge
from experiments.wei2023 import aggregation
from experiments.wei2023.layouts import APART, AWAY, GUIDE, HEADINGS, RADIUS, ROOM, layouts
from usvjax.report.markdown import markdown


@pytest.mark.parametrize(("n", "hull"), [(3, 231.5), (3, 50.0), (10, 231.5)])
def test_layouts_leave_room(n, hull):
    own = layouts(12, n, hull, 834.0, 5)
    assert np.degrees(own.headings) == pytest.approx(np.resize(HEADINGS, 12))
    apart = np.linalg.norm(own.starts[:, :, None, :2] - own.starts[:, None, :, :2], axis=-1)
    assert apart[:, ~np.eye(n, dtype=bool)].min() >= APART
    assert np.linalg.norm(own.starts[..., :2], axis=-1).min() >= AWAY
    reach = hull + RADIUS
    off = np.linalg.norm(own.starts[:, :, None, :2] - own.circles[:, None], axis=-1)
    assert off.min() >= reach + 2 * ROOM
    bow = np.stack([np.cos(own.headings), np.sin(own.headings)], axis=-1)[:, None]
    for share in (0.0, 0.37, 1.0):
        place = own.goals - share * GUIDE * bow
        least = np.linalg.norm(place[:, :, None] - own.circles[:, None], axis=-1).min()
        assert least >= reach + ROOM - 1.0
    again = layouts(6, n, hull, 834.0, 5)
    np.testing.assert_array_equal(own.starts[:6], again.starts)


def made(formed):
    """As what is sailed, of 60 layouts."""
    formed = np.asarray(formed)
    off = np.where(formed, 1.0, np.nan)
    return {
        "formed": formed,
        "collided": ~formed,
        "time": np.where(formed, 1000.0 + np.arange(len(formed)), np.inf),
        "least": np.where(formed, 10.0, -1.0),
        "off": off,
    }


def test_verdicts_are_those_of_the_shares():
    every, none = made(np.ones(450, bool)), made(np.zeros(450, bool))
    third = made(np.arange(450) % 3 > 0)  # nobody on the first heading
    threes = {words: every for words in aggregation.READINGS | aggregation.OTHERS}
    fleets = {f"{how}, {n}": none | {"pace": np.array(0.1)} for how, n in aggregation.LARGE}

    def verdicts(**changed):
        gathered = {"threes": threes | changed, "fleets": fleets}
        numbers = aggregation.measure(SimpleNamespace(made={"gathered": gathered}))
        found = judge(aggregation.claims(numbers), numbers)
        text = "\n".join(markdown(part) for part in aggregation.sections(numbers))
        return [one.verdict.partition(":")[0] for one in found], text

    words, text = verdicts()
    assert words == ["reproduces"] * 3
    assert "| rules | 16 | 450 | 0.0 " in text
    one = next(iter(aggregation.READINGS))
    assert verdicts(**{one: third})[0] == ["depends on the reading", "reproduces", "reproduces"]
    failing = dict.fromkeys(aggregation.READINGS, none)
    assert verdicts(**failing)[0] == ["does not reproduce"] * 3
    beside = dict.fromkeys(aggregation.OTHERS, none)
    assert verdicts(**beside)[0] == ["reproduces"] * 3
