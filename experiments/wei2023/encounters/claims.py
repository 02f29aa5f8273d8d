"""What Wei & Zhang 2023 say of encounters, under every way to read their coordination."""

from collections.abc import Callable
from typing import Any

from experiments.claims import Claim, Finding, Numbers, above, below
from experiments.wei2023.encounters.compare import OTHERS
from experiments.wei2023.encounters.runs import DUEL_SCENES, FIGURES, READINGS
from usvjax.report.numbers import interval

SAFE, MOST, LARGE = 0.05, 0.5, 30.0
"""Share that collides at most where encounters are safe, and at least where vessels collide; deg,
from which an alteration is large (what Rule 8 of the regulations asks for)."""


def claims(numbers: Numbers) -> list[Claim]:
    """Every claim about encounters."""
    found = []
    for kind, (before, after) in FIGURES.items():
        scenes = [scene for scene in DUEL_SCENES if scene.startswith(kind)]
        found += [
            Claim(
                f"{before}: {kind}, without coordination the vessels collide",
                "collision",
                _collide,
                {_short(scene): scene for scene in scenes},
                test=f"yes where Wilson's interval of the share that collides lies above "
                f"{MOST:g}, no where it lies below",
            ),
            Claim(
                f"{after}: {kind}, with coordination they sail safely",
                "no collision",
                _of_reading("collided", SAFE, 100.0),
                _given(scenes),
                test=f"yes where Wilson's interval of the share that collides lies below {SAFE:g}, "
                "no where it lies above",
            ),
        ]
    crossing = [scene for scene in DUEL_SCENES if scene.startswith("crossing")]
    found.append(
        Claim(
            "Figs. 17, 18: no alteration of course is large",
            "in words",
            _of_reading("turned", LARGE, 1.0),
            _given(crossing),
            test=f"yes where the mean of the largest alteration lies below {LARGE:g} deg with its "
            "95 % t interval, no where it lies above",
        )
    )
    found += [
        Claim(
            f"Figs. 17, 18: the way is shorter than by {name}",
            "in words",
            _of_reading(f"more_than_{name}", 0.0, 1.0),
            _given(crossing),
            test="yes where the mean paired difference of the way, over encounters that end well "
            "by both, lies below 0 with its 95 % t interval, no where it lies above",
        )
        for name in OTHERS
    ]
    return found


def _given(scenes: list[str]) -> dict[str, tuple[str, str]]:
    """Readings by their words, those of one kind of scene counted together."""
    return {f"{_short(scene)}: {words}": (scene, words) for scene in scenes for words in READINGS}


def _short(scene: str) -> str:
    """Words for a scene less the kind of encounter, which the claim names."""
    return scene.partition(", ")[2]


def _collide(numbers: Numbers, scene: str) -> Finding:
    collided = numbers["duels"][scene]["none"]["collided"]
    return Finding(above(collided, MOST), f"{interval(collided, 100, digits=1)} %")


def _of_reading(
    name: str, bound: float, scale: float
) -> Callable[[Numbers, tuple[str, str]], Finding]:
    def found(numbers: Numbers, given: tuple[str, str]) -> Finding:
        scene, words = given
        figure: Any = numbers["readings"][scene][words][name]
        return Finding(below(figure, bound), interval(figure, scale, digits=1))

    return found
