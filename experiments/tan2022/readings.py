"""Ways to read what Tan et al. 2022 do not print: where obstacles stand, and how dist is taken."""

from dataclasses import dataclass, replace
from itertools import product
from math import degrees, inf, pi
from typing import Any

from experiments.tan2022.published import RADII
from usvjax.missions.dwa.params import DwaParams, DwaStatic
from usvjax.missions.dwa.scenes import DiscTable, LatticeTable, Source

FEW_MAPS = "trajectory"
"""Clearance that looks at thirty points instead of one, and gets a fifth of the maps."""


@dataclass(frozen=True)
class Case:
    """An obstacle radius and the rate that goes with it in the paper.

    Attributes:
        radius: of the expansion circles, m.
        rate: obstacle rate.
    """

    radius: float
    rate: float


CASES = tuple(Case(radius, rate) for radius, rate in zip(RADII, (0.3, 0.3, 0.2), strict=True))
"""Of Tables 3 and 4."""
ONE_MAP_CASES = tuple(Case(radius, 0.2) for radius in RADII)
"""Of Table 2: one map at three radii."""


@dataclass(frozen=True)
class Reading:
    """One way to fill in what the paper leaves open; the defaults are the preset's.

    Attributes:
        label: what differs from the reading it is compared with.
        group: what is varied, for the table of sensitivities.
        cap: largest dist that counts, m.
        cap_in_radii: the same as a multiple of the obstacle radius; the smaller one holds.
        clear_distance: dist where no obstacle counts, m; never more than the cap.
        clearance, normalise, braking: see `usvjax.missions.dwa.params.DwaStatic`.
        v_min: m/s; Table 1 prints -1.
        search_angle: phi, rad.
        goal_tolerance: m.
        start_heading: rad; towards the goal when None.
        maps: "bernoulli", "count", "area" (what the rate is a share of, on lattice points 0 to
            10), "inner" (bernoulli on 1 to 9) or "scattered" (100 times the rate discs anywhere).
        rate: in place of the case's.
    """

    label: str
    group: str
    cap: float = inf
    cap_in_radii: float = inf
    clear_distance: float = 2.0
    clearance: str = "endpoint"
    normalise: str = "sum"
    braking: bool = True
    v_min: float = -1.0
    search_angle: float = pi / 3
    goal_tolerance: float = 0.5
    start_heading: float | None = None
    maps: str = "bernoulli"
    rate: float | None = None

    @property
    def task(self) -> tuple[str, float | None, float | None, float]:
        """Maps, start and goal; methods can only be compared on the same task."""
        return self.maps, self.rate, self.start_heading, self.goal_tolerance

    def source(self, case: Case) -> Source:
        """Return the generator of its maps."""
        rate = case.rate if self.rate is None else self.rate
        if self.maps == "scattered":
            return DiscTable(number=round(100 * rate), start_heading=self.start_heading)
        if self.maps == "inner":
            return LatticeTable(rate=rate, lo=1, hi=9, start_heading=self.start_heading)
        return LatticeTable(rate=rate, rate_meaning=self.maps, start_heading=self.start_heading)

    def params(self, case: Case, method: str) -> DwaParams:
        """Return the method's parameters.

        The traditional method has no search angle, and on these maps some obstacle always
        counts for it, so it needs no dist for when none does: those keep the preset's values,
        and readings that differ in nothing else share its episodes.
        """
        cap = min(self.cap, self.cap_in_radii * case.radius)
        numbers = {
            "radius": case.radius,
            "clearance_cap": cap,
            "clear_distance": min(self.clear_distance, cap),
            "v_min": self.v_min,
            "search_angle": self.search_angle,
            "goal_tolerance": self.goal_tolerance,
        }
        if method == "traditional":
            numbers |= {"search_angle": pi / 3, "clear_distance": 2.0}
        return DwaParams(**numbers)

    def static(self, method: str) -> DwaStatic:
        """Return the method's choices."""
        return DwaStatic(
            method=method,
            clearance=self.clearance,
            normalise=self.normalise,
            braking=self.braking,
        )


PRESET = Reading("no cap", "preset")
"""The library's preset "tan2022": no cap on dist, 2 m where no obstacle counts."""
DEMO = Reading("cap 2r", "clearance cap", cap_in_radii=2.0, clear_distance=inf)
"""The rule of the widely used demo that Table 1's numbers come from."""
DEMO_START = replace(
    DEMO, label="cap 2r, start 90 deg", group="start heading", start_heading=pi / 2
)
"""That demo's rule and its start, which faces north instead of the goal."""

CAPS = {
    DEMO.label: "2r",
    "cap 1 m": "1",
    "cap 2 m": "2",
    "cap 5 m": "5",
    PRESET.label: "none",
}
"""Readings that differ in the cap alone, and what to call it."""


def readings() -> list[Reading]:
    """All readings of the sensitivity study, the preset first."""
    found = [PRESET, DEMO]
    found += [
        Reading(f"cap {cap:g} m", "clearance cap", cap=cap, clear_distance=cap)
        for cap in (1.0, 2.0, 5.0)
    ]
    found += [
        Reading(f"no cap, clear {clear:g} m", "dist where none counts", clear_distance=clear)
        for clear in (0.5, 1.0, 5.0, 10.0)
    ]
    return found + _forward() + _about(PRESET) + _about(DEMO) + _angles()


def _forward() -> list[Reading]:
    """Vessels that may not sail astern, against Table 1."""
    forward = Reading("", "no sailing astern (v_min = 0)", v_min=0.0)
    return [
        replace(forward, label="v_min 0, cap 2r", cap_in_radii=2.0, clear_distance=inf),
        replace(forward, label="v_min 0, cap 1 m", cap=1.0),
        replace(forward, label="v_min 0, cap 2 m", cap=2.0),
        replace(forward, label="v_min 0, no cap"),
        replace(forward, label="v_min 0, no cap, clear 5 m", clear_distance=5.0),
    ]


def _about(base: Reading) -> list[Reading]:
    """Everything that is varied one at a time, about one of two readings of the cap."""

    def varied(label: str, group: str, **changes: Any) -> Reading:
        return replace(base, label=f"{base.label}, {label}", group=group, **changes)

    return [
        varied("dist along the trajectory", "dist taken", clearance="trajectory"),
        varied("scores by range", "normalisation", normalise="range"),
        varied("without Eq. 4", "braking bound", braking=False),
        varied("start 90 deg", "start heading", start_heading=pi / 2),
        *(
            varied(f"goal tolerance {tolerance:g} m", "goal tolerance", goal_tolerance=tolerance)
            for tolerance in (0.2, 1.0)
        ),
        varied("exact count", "obstacle rate", maps="count"),
        varied("share of area", "obstacle rate", maps="area"),
        varied("lattice 1 to 9", "obstacle rate", maps="inner"),
        varied("discs anywhere", "obstacle rate", maps="scattered"),
        *(varied(f"rate {rate:g}", "obstacle rate", rate=rate) for rate in (0.05, 0.1, 0.2, 0.3)),
    ]


def _angles() -> list[Reading]:
    return [
        replace(
            base,
            label=f"{base.label}, phi {degrees(angle):.0f} deg",
            group="search angle",
            search_angle=angle,
        )
        for base in (PRESET, DEMO)
        for angle in (pi / 6, pi / 2)
    ]


def combinations() -> list[Reading]:
    """All combinations of cap, start, sailing astern and Eq. 4, for the ranking."""
    caps: dict[str, dict[str, Any]] = {
        "cap 2r": {"cap_in_radii": 2.0, "clear_distance": inf},
        **{f"cap {cap:g} m": {"cap": cap, "clear_distance": cap} for cap in (1.0, 2.0, 5.0)},
        "no cap": {},
    }
    starts = {"": None, ", start 90 deg": pi / 2}
    speeds = {"": -1.0, ", v_min 0": 0.0}
    bounds = {"": True, ", without Eq. 4": False}
    return [
        Reading(
            cap + start + speed + bound,
            "combination",
            start_heading=starts[start],
            v_min=speeds[speed],
            braking=bounds[bound],
            **caps[cap],
        )
        for cap, start, speed, bound in product(caps, starts, speeds, bounds)
    ]


def quick_readings() -> list[Reading]:
    """A few readings that compile to few programs, for a quick look."""
    names = ("cap 2 m", "v_min 0, no cap", "no cap, phi 30 deg", "no cap, rate 0.2")
    return [PRESET, DEMO, *(reading for reading in readings() if reading.label in names)]
