"""The heading at the end of a voyage: Figs. 5 and 9 to 12 of Wei & Zhang 2023."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import jax
import numpy as np
from matplotlib.figure import Figure

import usvjax as uj
from experiments.claims import Claim, Finding, Numbers, below, every
from experiments.estimates import difference, mean, share
from experiments.paper import Drawing, Part
from experiments.runs import Call, Found, Run
from experiments.wei2023.bars import draw_bars
from usvjax.angles import wrapped
from usvjax.missions.fleet.run import FleetResult, navigate
from usvjax.plots import style
from usvjax.report import Section, Sheet
from usvjax.report.numbers import interval
from usvjax.units import NAUTICAL_MILE
from usvkernels.status import Status

SEED = 2023
VOYAGES, QUICK_VOYAGES = 200, 40
LENGTHS = (0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.4)
"""nm, of the guide segment."""
WAYS = (1.0, 2.0, 4.0, 6.0)
"""nm, from start to goal, where no heading is asked for."""
WAY = 3.0
"""nm, where one is."""
OBSTACLES = 3
DEFAULT = 1.0
"""nm, the length that stands for the paper's method where it is compared with none."""


@dataclass(frozen=True)
class Reading:
    """What the paper does not print.

    Attributes:
        obstacles: between start and goal.
        look_ahead: nm, of the guidance point.
        clearance: as of `FleetStatic`.
    """

    obstacles: int
    look_ahead: float
    clearance: str = "guide"


READINGS = {
    "open water, look-ahead 0.25 nm": Reading(0, 0.25),
    "open water, look-ahead 0.125 nm": Reading(0, 0.125),
    "open water, look-ahead 0.5 nm": Reading(0, 0.5),
    f"{OBSTACLES} obstacles, look-ahead 0.25 nm": Reading(OBSTACLES, 0.25),
    f"{OBSTACLES} obstacles, look-ahead 0.25 nm, dist as printed": Reading(
        OBSTACLES, 0.25, "printed"
    ),
}


@dataclass(frozen=True)
class Voyages:
    """Voyages of single vessels, B of them.

    Attributes:
        starts: float64[B, 1, 3], x, y (m), psi (rad).
        goals: float64[B, 1, 2] (m).
        headings: float64[B, 1], asked for (rad).
        circles: float64[B, K, 2] (m), or None for open water.
    """

    starts: np.ndarray
    goals: np.ndarray
    headings: np.ndarray
    circles: np.ndarray | None


def voyages(count: int, way: float, obstacles: int = 0) -> Voyages:
    """Draw voyages from the origin over some distance (nm), on any heading from any to any."""
    rng = np.random.default_rng(SEED)
    first, bearing, asked = rng.uniform(-np.pi, np.pi, (3, count, 1))
    along = np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)
    left = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    starts = np.concatenate([np.zeros((count, 1, 2)), first[..., None]], axis=-1)
    reach = way * NAUTICAL_MILE
    # Near enough to the straight way to be met, and clear of both ends.
    at, aside = rng.uniform([[[0.3]], [[-0.1]]], [[[0.7]], [[0.1]]], (2, count, OBSTACLES))
    circles = reach * (at[..., None] * along + aside[..., None] * left)
    return Voyages(starts, reach * along, asked, circles[:, :obstacles] if obstacles else None)


def runs(options: Any) -> dict[str, Run]:
    """All voyages."""
    count = QUICK_VOYAGES if options.quick else VOYAGES
    calls = len(READINGS) * (1 + len(LENGTHS)) + len(WAYS)
    return {"voyages": Call(lambda advance: _sailed(count, advance), count * calls)}


def _sailed(count: int, advance: Callable[[int], object]) -> dict[str, Any]:
    """Errors of the heading at the goal, deg, NaN for who does not arrive.

    Returns:
        "ways": float[B] by distance; "guided": by reading, then length, 0 for none.
    """

    def errors(own: Voyages, asked: np.ndarray, guide: float, by: Reading) -> np.ndarray:
        found = _sail(own, guide, by)
        advance(count)
        off = wrapped(found.final[:, 0, 2] - asked[:, 0])
        return np.where(found.status == int(Status.REACHED), np.degrees(np.abs(off)), np.nan)

    # Each device would compile for itself.
    with jax.default_device(jax.local_devices()[0]):
        ways = {}
        for way in WAYS:
            own = voyages(count, way)
            ways[f"{way:g}"] = errors(
                own, np.arctan2(*own.goals[..., ::-1].T).T, 0.0, Reading(0, 0.25)
            )
        guided: dict[str, dict[str, np.ndarray]] = {}
        for words, reading in READINGS.items():
            own = voyages(count, WAY, reading.obstacles)
            guided[words] = {
                f"{guide:g}": errors(own, own.headings, guide, reading) for guide in (0.0, *LENGTHS)
            }
    return {"ways": ways, "guided": guided}


def _sail(own: Voyages, guide: float, by: Reading) -> FleetResult:
    """Sail by a guide segment of so many nm, without a heading for 0."""
    static = uj.FleetStatic(look_ahead=by.look_ahead * NAUTICAL_MILE, clearance=by.clearance)
    if guide:
        static = replace(static, guide_length=guide * NAUTICAL_MILE)
    return navigate(
        own.circles,
        own.starts,
        own.goals,
        headings=own.headings if guide else None,
        encounters="none",
        # Who arrives has arrived, on whatever heading: going around is ours, not the paper's.
        params=uj.FleetParams(heading_tolerance=np.pi),
        static=static,
    )


def measure(found: Found) -> dict[str, Any]:
    """Mean errors, and paired differences from one length to the next, and to no guide segment."""
    sailed = found.made["voyages"]
    return {
        "ways": {way: _error(error) for way, error in sailed["ways"].items()},
        "ways_longer": _longer(sailed["ways"]),
        "guided": {
            words: {
                "lengths": {length: _error(error) for length, error in own.items()},
                "longer": _longer({k: v for k, v in own.items() if k != "0"}),
                "guided_less_none": _paired(own[f"{DEFAULT:g}"], own["0"]),
            }
            for words, own in sailed["guided"].items()
        },
    }


def _error(error: np.ndarray) -> dict[str, Any]:
    arrived = np.isfinite(error)
    known = error[arrived]
    return {
        "n": len(error),
        "arrived": share(arrived),
        "error": mean(known),
        "most": float(known.max()) if len(known) else None,
    }


def _longer(errors: Mapping[str, np.ndarray]) -> dict[str, Any]:
    """Change of the error from one length to the next."""
    return {f"{a} to {b}": _paired(errors[b], errors[a]) for a, b in pairwise(errors)}


def _paired(new: np.ndarray, old: np.ndarray) -> dict[str, Any]:
    both = np.isfinite(new) & np.isfinite(old)
    return difference(new[both] - old[both])


_TEST = (
    "yes where the mean paired difference of the error, over voyages that arrive both ways, lies "
    "below 0 with its 95 % t interval, no where it lies above"
)
_ALL = f"{_TEST}; of all steps from one length to the next, yes where all are, no where one is not"


def claims(numbers: Numbers) -> list[Claim]:
    """Every claim about the heading at the end."""
    readings = {words: words for words in READINGS}
    return [
        Claim(
            "Fig. 5: without a guide segment, the longer the way, the nearer the last heading to "
            "the bearing of the goal",
            "in words",
            lambda own, _: _every_step(own["ways_longer"]),
            {"open water, look-ahead 0.25 nm": None},
            test=_ALL,
        ),
        Claim(
            f"Figs. 9 to 12: a guide segment (of {DEFAULT:g} nm) brings the last heading to the "
            "one asked for",
            "in words",
            _guided,
            readings,
            test=_TEST,
        ),
        Claim(
            "2.3.2: the longer the guide segment, the smaller the error",
            "in words",
            lambda own, words: _every_step(own["guided"][words]["longer"]),
            readings,
            test=_ALL,
        ),
    ]


def _guided(numbers: Numbers, words: str) -> Finding:
    change = numbers["guided"][words]["guided_less_none"]
    return Finding(below(change), f"{interval(change, sign=True, digits=1)} deg")


def _every_step(steps: Mapping[str, Any]) -> Finding:
    worst = max(steps, key=lambda step: steps[step]["value"] or 0.0)
    found = every([below(change) for change in steps.values()])
    return Finding(found, f"{worst} nm: {interval(steps[worst], sign=True, digits=2)} deg")


def readings(numbers: Numbers) -> list[str]:
    """How the paper was read."""
    return [
        f"Layouts are ours: single vessels at rest, on any heading, over {WAY:g} nm to a goal in "
        f"any direction at which any heading is asked for; in open water, or with {OBSTACLES} "
        "obstacles near the straight way. The error is the difference of the heading at rest to "
        "the one asked for, to either side, of vessels that arrive.",
        "The guide segment is laid as long as asked for, or three quarters or a half of that where "
        "an obstacle bars it; beyond the goal the line leads on by a look-ahead. The look-ahead is "
        "not printed and is varied.",
        "Without a guide segment, as with the traditional algorithm, the error is that to the "
        "bearing of the goal from the start for Fig. 5, and to the heading asked for in Figs. 9 to "
        "12.",
    ]


def sections(numbers: Numbers) -> list[Section]:
    """The tables."""
    ways = [_row([way, "-"], own) for way, own in numbers["ways"].items()]
    guided = [
        _row([words, length if length != "0" else "none"], own)
        for words, table in numbers["guided"].items()
        for length, own in table["lengths"].items()
    ]
    header = ["n", "Arrived (%)", "Mean error (deg)", "Largest (deg)"]
    return [
        Section(
            "The last heading without a guide segment",
            [Sheet("", ["Way (nm)", "Guide segment (nm)", *header], ways, words=2)],
        ),
        Section(
            "The last heading by the length of the guide segment",
            [Sheet("", ["Reading", "Guide segment (nm)", *header], guided, words=2)],
        ),
    ]


def _row(cells: list[str], own: Mapping[str, Any]) -> list[str]:
    arrived, error = interval(own["arrived"], 100, digits=1), interval(own["error"], digits=2)
    most = "-" if own["most"] is None else f"{own['most']:.1f}"
    return [*cells, f"{own['n']:,}", arrived, error, most]


def figures(found: Found, numbers: Numbers) -> Iterator[Drawing]:
    """The error against the length."""
    yield Drawing(
        "guide_length",
        "Mean error of the heading at the goal against the length of the guide segment, with 95 % "
        "t intervals.",
        length_figure(numbers["guided"]),
    )


_LOOKS = (
    style.Look(style.BLUE, "-", "o"),
    style.Look(style.VERMILLION, "--", "s"),
    style.Look(style.GREEN, "-.", "^"),
    style.Look(style.BLACK, ":", "D"),
    style.Look(style.ORANGE, "-", "v"),
)


@style.styled
def length_figure(guided: Mapping[str, Any]) -> Figure:
    """Error against length, a line per reading."""
    fig = style.new_figure(style.DOUBLE_MM, 90)
    ax = fig.subplots()
    at = np.array(LENGTHS)
    for k, ((_, table), look) in enumerate(zip(guided.items(), _LOOKS, strict=True)):
        errors = [table["lengths"][f"{length:g}"]["error"] for length in LENGTHS]
        draw_bars(ax, at * 1.015 ** (k - 2), errors, look)
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xticks(at, [f"{one:g}" for one in at])
    ax.minorticks_off()
    style.plain_powers(ax.yaxis)
    ax.set(xlabel="length of the guide segment (nm)", ylabel="mean error of the heading (deg)")
    handles = [style.method_handle(look, words) for words, look in zip(guided, _LOOKS, strict=True)]
    style.outside_legend(fig, handles, columns=2)
    return style.settle(fig)


PART = Part(
    name="headings",
    title="The heading at the goal: Figs. 5 and 9 to 12",
    runs=runs,
    measure=measure,
    claims=claims,
    sections=sections,
    figures=figures,
    readings=readings,
)
