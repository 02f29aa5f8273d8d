"""Vessels that gather in formation: Figs. 19 to 21 of Wei & Zhang 2023, and larger fleets."""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

import usvjax as uj
from experiments.claims import Claim, Finding, Numbers, above
from experiments.estimates import mean, share
from experiments.paper import Drawing, Part
from experiments.runs import Call, Found, Run
from experiments.wei2023.layouts import HEADINGS, OBSTACLES, Layouts, layouts
from usvjax.devices import chosen_devices
from usvjax.missions.aggregate.params import AggregateParams, AggregateStatic
from usvjax.plots import style
from usvjax.report import Section, Sheet
from usvjax.report.numbers import interval
from usvjax.units import NAUTICAL_MILE
from usvkernels.status import Status

SEED = 2023
THREES = 450
"""Layouts of three, a third on each heading."""
FLEETS = 24
"""Layouts of each larger fleet."""
SIZES = (10, 16, 20)
"""Vessels, as Table 3 has for the method that it compares with."""
LARGE = [(strategy, n) for strategy in ("wei2023", "rules", "orca") for n in (3, *SIZES)]
"""Fleets by size: strategy, and vessels."""
PASSING = 0.05 * NAUTICAL_MILE
"""m, wanted between hulls."""
SAFE = 0.95
"""Share of layouts in which a fleet that gathers "ideally" forms at least."""
TOLERANCE = 5.0
"""deg, of the heading in formation."""

HULLS = {"hulls 0.125 nm": 0.125 * NAUTICAL_MILE, "hulls 50 m": 50.0}
"""m: half of the printed collision radius; or far smaller ones, as the figures draw them."""
STRAIGHT, ROUND = "straight to the guide segments", "round the formation, and around again"


@dataclass(frozen=True)
class Reading:
    """How a fleet gathers.

    Attributes:
        encounters: strategy.
        hull: words for its radius.
        way: as printed, or with what `uj.aggregate` adds.
    """

    encounters: str
    hull: str
    way: str


READINGS = {
    f"{way}: {hull}": Reading("wei2023", hull, way) for way in (STRAIGHT, ROUND) for hull in HULLS
}
"""Of the paper: coordination as printed."""
OTHERS = {
    f"{strategy}, {ROUND}": Reading(strategy, "hulls 0.125 nm", ROUND)
    for strategy in ("rules", "orca", "none")
}
"""What stands beside."""


def runs(options: Any) -> dict[str, Run]:
    """All fleets."""
    return {"gathered": Call(_gathered, THREES * len(READINGS | OTHERS) + FLEETS * len(LARGE))}


def _gathered(advance: Callable[[int], object]) -> dict[str, Any]:
    """What became of every fleet: "threes" by reading, "fleets" by strategy and size."""
    found: dict[str, Any] = {"threes": {}, "fleets": {}}
    for words, reading in (READINGS | OTHERS).items():
        found["threes"][words] = _sail(reading, 3, THREES)
        advance(THREES)
    for strategy, n in LARGE:
        reading = Reading(strategy, "hulls 0.125 nm", ROUND)
        found["fleets"][f"{strategy}, {n}"] = _sail(reading, n, FLEETS) | _pace(reading, n)
        advance(FLEETS)
    return found


def _sail(reading: Reading, n: int, count: int) -> dict[str, np.ndarray]:
    """Gather fleets of n.

    Returns:
        "formed", "collided" bool[B], "time" float[B] (s, inf where not formed), "least" float[B]
        (m between hulls), "off" float[B], the largest error of a heading (deg).
    """
    r = _gather(reading, n, count)
    off = np.degrees(r.heading_error).max(axis=1)
    formed = (r.status == int(Status.REACHED)) & (off <= TOLERANCE)
    return {
        "formed": formed,
        "collided": r.status == int(Status.COLLIDED),
        "time": np.where(formed, r.time, np.inf),
        "least": r.min_separation,
        "off": off,
    }


def _pace(reading: Reading, n: int) -> dict[str, np.ndarray]:
    """Milliseconds that a control period of one fleet takes, routes included: "pace", float[]."""
    begun = time.perf_counter()
    r = _gather(reading, n, FLEETS)  # once more: what was compiled before costs nothing
    spent = time.perf_counter() - begun
    return {"pace": np.array(1e3 * spent / r.steps.sum())}


def _gather(reading: Reading, n: int, count: int) -> uj.FleetResult:
    hull = HULLS[reading.hull]
    spacing = 1.5 * (2 * hull + PASSING)
    own = layouts(count, n, hull, spacing, SEED)
    params = AggregateParams(hull_radius=hull, passing=PASSING)
    straight = reading.way == STRAIGHT
    static = AggregateStatic(clearance="printed" if straight else "guide")
    sail = _straight if straight else _round
    return sail(own, reading.encounters, params, static, spacing)


def _straight(
    own: Layouts, encounters: str, params: uj.FleetParams, static: uj.FleetStatic, spacing: float
) -> uj.FleetResult:
    """As printed: each to the guide segment of the slot of its number, and who arrives arrives."""
    n = own.goals.shape[1]
    return uj.navigate(
        own.circles,
        own.starts,
        own.goals,
        headings=np.repeat(own.headings[:, None], n, axis=1),
        encounters=encounters,
        params=replace(params, heading_tolerance=np.pi),
        static=static,
    )


def _round(
    own: Layouts, encounters: str, params: uj.FleetParams, static: uj.FleetStatic, spacing: float
) -> uj.FleetResult:
    """As `uj.aggregate` does, slots given so that the ways are least."""
    return uj.aggregate(
        own.circles,
        own.starts,
        np.zeros(2),
        own.headings,
        spacing=spacing,
        encounters=encounters,
        params=params,
        static=static,
    )


def measure(found: Found) -> dict[str, Any]:
    """Shares, times and distances."""
    made = found.made["gathered"]
    turn = {f"{heading:g}": k for k, heading in enumerate(HEADINGS)}
    return {
        "threes": {
            words: {
                **_summed(own),
                "headings": {
                    name: share(own["formed"][k :: len(HEADINGS)]) for name, k in turn.items()
                },
            }
            for words, own in made["threes"].items()
        },
        "fleets": {
            words: {**_summed(own), "pace": float(own["pace"])}
            for words, own in made["fleets"].items()
        },
    }


def _summed(own: Mapping[str, np.ndarray]) -> dict[str, Any]:
    formed, off = own["formed"], own["off"]
    return {
        "n": len(formed),
        "formed": share(formed),
        "collided": share(own["collided"]),
        "time": mean(own["time"][formed]),
        "least": float(own["least"].min()),
        "off": float(off[formed].max()) if formed.any() else None,
    }


def claims(numbers: Numbers) -> list[Claim]:
    """A claim for each figure."""
    return [
        Claim(
            f"Fig. {19 + k}: three vessels gather among obstacles on a heading of {heading:g} deg, "
            "with ideal results",
            "in words",
            lambda own, words, name=f"{heading:g}": _forms(own["threes"][words]["headings"][name]),
            {words: words for words in READINGS},
            beside={words: words for words in OTHERS},
            test=f"yes where Wilson's 95 % interval of the share of layouts in which all hold "
            f"their slots within {TOLERANCE:g} deg lies above {SAFE:g}, no where it lies below",
        )
        for k, heading in enumerate(HEADINGS)
    ]


def _forms(formed: Mapping[str, Any]) -> Finding:
    return Finding(above(formed, SAFE), f"{interval(formed, 100, digits=1)} %")


def readings(numbers: Numbers) -> list[str]:
    """How the paper was read."""
    return [
        f"Layouts are ours: fleets begin anywhere on any heading in water of 14 by 14 km (larger "
        f"for more than three), {OBSTACLES} obstacles of 0.125 nm among them, and gather in a "
        "wedge about the middle, a third of the layouts on each heading. Starts and guide "
        "segments are clear of obstacles.",
        "The paper does not say which vessel takes which place, nor how one comes to its guide "
        f"segment: {STRAIGHT} is what is printed, each to the place of its number, dist up to its "
        "cap, and who reaches its place has arrived, on whatever heading. "
        f"{ROUND.capitalize()} is what `uj.aggregate` "
        "adds: places so that ways are least, ways that cross no place, no more clearance than "
        "guidance points have, and another approach for who comes on another heading.",
        f"A step's time is that of all {FLEETS} fleets, which run side by side, over all their "
        f"steps, routes included, measured once on {_devices()}; what the method of Table 3 "
        "needs is not printed.",
        "The paper's coordination counts for its claims; other strategies stand beside.",
    ]


def _devices() -> str:
    devices = chosen_devices()
    return f"{len(devices)} {devices[0].platform} device{'s' if len(devices) > 1 else ''}"


def sections(numbers: Numbers) -> list[Section]:
    """The tables."""
    header = ["n", "Formed (%)", "Collided (%)", "Time (s)", "Least distance (m)", "Heading (deg)"]
    threes = [
        _row([words if words in OTHERS else f"wei2023, {words}"], own)
        for words, own in numbers["threes"].items()
    ]
    fleets = [
        [*_row(words.split(", "), own), f"{own['pace']:.3f}"]
        for words, own in numbers["fleets"].items()
    ]
    return [
        Section("Three vessels that gather", [Sheet("", ["How", *header], threes)]),
        Section(
            "Fleets that gather, by size (Table 3 has none of these numbers)",
            [Sheet("", ["Strategy", "Vessels", *header, "ms a step of one"], fleets)],
        ),
    ]


def _row(cells: list[str], own: Mapping[str, Any]) -> list[str]:
    off = "-" if own["off"] is None else f"{own['off']:.1f}"
    return [
        *cells,
        f"{own['n']:,}",
        interval(own["formed"], 100, digits=1),
        interval(own["collided"], 100, digits=1),
        interval(own["time"], digits=0),
        f"{own['least']:.0f}",
        off,
    ]


def figures(found: Found, numbers: Numbers) -> Iterator[Drawing]:
    """A fleet of three on each heading, by the rules."""
    yield Drawing(
        "gathering",
        "Three vessels that gather on 0, 60 and 90 deg by the rules, hulls (0.125 nm) every 300 s; "
        "obstacles grey, guide segments dotted.",
        gathering_figure(),
    )


_COLOURS = (style.BLUE, style.VERMILLION, style.GREEN)


@style.styled
def gathering_figure() -> Figure:
    """Tracks of the first layout on each heading."""
    hull = HULLS["hulls 0.125 nm"]
    spacing = 1.5 * (2 * hull + PASSING)
    own = layouts(len(HEADINGS), 3, hull, spacing, SEED)
    r = uj.aggregate(
        own.circles, own.starts, np.zeros(2), own.headings, spacing=spacing, record=True
    )
    fig = style.new_figure(style.DOUBLE_MM, 70)
    for ax, k in zip(fig.subplots(1, len(HEADINGS)), range(len(HEADINGS)), strict=True):
        for circle in own.circles[k] / 1e3:
            ax.add_patch(_circle(circle, hull, facecolor=style.GREY, edgecolor="none"))
        bow = np.array([np.cos(own.headings[k]), np.sin(own.headings[k])])
        for i, colour in enumerate(_COLOURS):
            track = r.trajectory[k, :, i, :2] / 1e3
            ax.plot(*track.T, color=colour, linewidth=1.0)
            for place in track[::300]:
                ax.add_patch(_circle(place, hull, facecolor="none", edgecolor=colour))
            slot = r.slots[k, i] / 1e3
            ax.plot(*np.transpose([slot - bow * NAUTICAL_MILE / 1e3, slot]), ":", color=colour)
        ax.set(title=f"{HEADINGS[k]:g} deg", xlabel="x (km)", aspect="equal")
    fig.axes[0].set_ylabel("y (km)")
    return style.settle(fig)


def _circle(place: np.ndarray, radius: float, **looks: Any) -> Circle:
    return Circle(tuple(place), radius / 1e3, linewidth=0.6, **looks)


PART = Part(
    name="aggregation",
    title="Aggregation: Figs. 19 to 21",
    runs=runs,
    measure=measure,
    claims=claims,
    sections=sections,
    figures=figures,
    readings=readings,
    quick=False,
)
