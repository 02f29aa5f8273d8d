"""The page's part on encounters."""

from collections.abc import Mapping
from typing import Any

from experiments.claims import Numbers
from experiments.wei2023.encounters.compare import OTHERS
from experiments.wei2023.encounters.runs import (
    ALONE,
    DUEL_SCENES,
    LEAST_ROOM,
    READINGS,
    THRESHOLDS,
)
from usvjax.missions.fleet.params import STRATEGIES
from usvjax.missions.fleet.situations import HULL_RADIUS
from usvjax.plots import style
from usvjax.report import Section, Sheet
from usvjax.report.numbers import fixed, interval
from usvkernels.status import Status

WORDS = {
    "none": "none (each as if alone)",
    "rules": "rules of the road",
    "wei2023": "Wei & Zhang",
    "orca": "reciprocal velocities",
}


def summary(numbers: Numbers) -> list[str]:
    """The most important findings."""
    kinds = numbers["kinds"]
    collided = {
        name: ", ".join(
            f"{kind} {interval(own[name]['collided'], 100, digits=2)} %"
            for kind, own in kinds.items()
        )
        for name in STRATEGIES
    }
    fails = {
        name: [
            least for least, own in numbers["sights"].items() if own[name]["collided"]["value"] > 0
        ]
        for name in STRATEGIES
    }
    return [
        "**Random encounters of two that collide**: "
        + "; ".join(f"{WORDS[name]}: {words}" for name, words in collided.items())
        + ".",
        "**First sight, by least time to the closest point, from which some collide**: "
        + "; ".join(
            f"{WORDS[name]}: {least[0] if least else 'none of those tried'}"
            for name, least in fails.items()
        )
        + ".",
    ]


def readings(numbers: Numbers) -> list[str]:
    """How the paper was read."""
    miles = ", ".join(f"{one:g}" for one in THRESHOLDS)
    return [
        "The layouts of Figs. 13 to 18 are not printed. Ours: random encounters of two vessels "
        "that would meet exactly, head-on (courses differ by 174 to 186 deg) or crossing (30 to "
        "150 deg, from either side), with the printed kinematics at a control period of 1 s, both "
        "at the printed largest speed, or each at 10 to 20 kn. The printed collision radius is "
        "taken as a pair's, hulls of 0.125 nm each; or hulls are of 50 m, as the figures draw "
        "vessels far smaller. Of vessels as fast as each other that would meet "
        "exactly the outboard angles are equal, so the reading of equal angles, or rounding, "
        "decides.",
        f"Guidance points meet within {miles} nm (not printed), and of equal outboard angles the "
        "first goes, or both yield (not printed either): all combinations are readings that count. "
        "How to read rings of three does not matter to two vessels, and is not varied.",
        "Random encounters: hull radii of 2 to 50 m, 2.5 to 10 m/s, the closest point within three "
        "sums of radii, first seen at least 180 s and 4 times hull radii and stopping distances "
        f"before it; closer first sights with {LEAST_ROOM:g} times. Extra distance and delay are "
        "against the straight way at full speed, over those that arrive.",
        "Rules kept: by an observer who sees the tracks alone, of encounters that would pass "
        "within the distance wanted; both vessels must have done what their roles at first sight "
        "ask.",
        f"Imazu's situations: own ship and others at 10 kn, those on its heading at 4 kn, all "
        f"meet after 12 minutes; hull radius {HULL_RADIUS:g} m.",
    ]


def sections(numbers: Numbers) -> list[Section]:
    """The tables."""
    return [
        Section(
            "Random encounters of two",
            [
                "Shares with Wilson's intervals, means with 95 % t intervals; least distances are "
                "between hulls, the least of all encounters and their median.",
                _kinds(numbers),
            ],
        ),
        Section(
            "Closer first sights",
            [
                "Share that collides (%), by the least time from first sight to the closest point.",
                _sights(numbers["sights"]),
            ],
        ),
        Section("On a collision course with the printed kinematics", _duels(numbers)),
        Section(
            "Imazu's 22 situations",
            [
                "Least distance between hulls (m), all vessels by the strategy; where own ship "
                "acts alone, its own to the others, which keep course and speed and sail through "
                "each other. A star: somebody does not arrive.",
                _imazu(numbers),
            ],
        ),
    ]


def _kinds(numbers: Numbers) -> Sheet:
    rows = []
    for kind, strategies in numbers["kinds"].items():
        for name, own in strategies.items():
            seen = numbers["watched"][kind][name]
            rows.append(
                [
                    kind,
                    WORDS[name],
                    f"{own['n']:,}",
                    interval(own["collided"], 100, digits=2),
                    interval(own["reached"], 100, digits=2),
                    interval(own["extra_distance"], sign=True, digits=2),
                    interval(own["delay"], sign=True, digits=1),
                    f"{fixed(own['least'], 1)}, {fixed(own['median_least'], 1)}",
                    interval(seen["kept"], 100, digits=1),
                    f"{seen['meets']:,}",
                ]
            )
    header = ["Encounter", "Strategy", "n", "Collided (%)", "Arrived (%)", "Extra distance (%)"]
    header += ["Delay (s)", "Least distance (m)", "Rules kept (%)", "of"]
    return Sheet("", header, rows, words=2)


def _sights(sights: Mapping[str, Any]) -> Sheet:
    rows = [
        [least, *(interval(own[name]["collided"], 100, digits=1) for name in STRATEGIES)]
        for least, own in sights.items()
    ]
    return Sheet("", ["First sight", *(WORDS[name] for name in STRATEGIES)], rows, words=1)


def _duels(numbers: Numbers) -> list[str | Sheet]:
    rows = [
        _duel(scene, WORDS[name], numbers["duels"][scene][name])
        for scene in DUEL_SCENES
        for name in ("none", *OTHERS)
    ] + [
        _duel(scene, f"Wei & Zhang; {words}", numbers["readings"][scene][words])
        for scene in DUEL_SCENES
        for words in READINGS
    ]
    header = ["Encounter", "Strategy", "n", "Collided (%)", "Arrived (%)"]
    header += ["Mean largest alteration (deg)", "Somebody slows by a tenth (%)"]
    header += ["Extra distance (%)", "Delay (s)"]
    return [Sheet("", header, rows, words=2)]


def _duel(scene: str, words: str, own: Mapping[str, Any]) -> list[str]:
    return [
        scene,
        words,
        f"{own['n']:,}",
        interval(own["collided"], 100, digits=1),
        interval(own["reached"], 100, digits=1),
        interval(own["turned"], digits=1),
        interval(own["slowed"], 100, digits=1),
        interval(own["extra_distance"], sign=True, digits=2),
        interval(own["delay"], sign=True, digits=1),
    ]


def _imazu(numbers: Numbers) -> Sheet:
    found = numbers["imazu"]
    rows = [
        [number, ", ".join(f"{one:+d}" for one in headings)]
        + [_cell(found["all"][name], k) for name in STRATEGIES]
        + [_cell(found["alone"][name], k) for name in ALONE]
        for k, (number, headings) in enumerate(numbers["others"].items())
    ]
    header = ["Situation", "Headings (deg)", *(WORDS[name] for name in STRATEGIES)]
    header += [f"own ship alone, by {words}" for words in ALONE.values()]
    return Sheet("", header, rows, words=2)


def _cell(own: Mapping[str, Any], k: int) -> str:
    status, least = own["status"][k], fixed(own["least"][k], 0)
    if status == int(Status.COLLIDED):
        return f"**{style.status_name(status)}**"
    return least if status == int(Status.REACHED) else f"{least}*"
