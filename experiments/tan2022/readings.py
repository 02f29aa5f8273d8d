"""Ways to read what Tan et al. 2022 do not print: where obstacles stand, and how dist is taken."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import product
from math import inf, pi
from typing import Any, NamedTuple

from experiments.tan2022.published import RADII, TABLE2, TABLE3

CLEAR = 2.0  # m, dist where no obstacle counts, unless a reading says otherwise
NEVER = 1e6  # s, longer than an episode may last


class Case(NamedTuple):
    """An obstacle radius (m) and the obstacle rate that goes with it in the paper."""

    radius: float
    rate: float


CASES = tuple(map(Case, RADII, TABLE3.rates))
"""Of Tables 3 and 4."""
ONE_MAP_CASES = tuple(map(Case, RADII, TABLE2.rates))
"""Of Table 2: one map at three radii."""


@dataclass(frozen=True, eq=False)
class Reading:
    """One way to fill in what the paper leaves open; the defaults are the preset's.

    Attributes:
        label: what differs from the reading it is compared with.
        group: what is varied, for the table of sensitivities.
        cap: largest dist that counts, m.
        cap_in_radii: the same as a multiple of the obstacle radius; the smaller one holds.
        clear_distance: dist where no obstacle counts, m; never more than the cap.
        rate: in place of the case's.
        scattered: whether obstacles are discs anywhere, 100 times the rate of them, instead of
            standing on the points of a lattice.
        changes: of a study's settings, by dotted key.
    """

    label: str
    group: str
    cap: float = inf
    cap_in_radii: float = inf
    clear_distance: float = CLEAR
    rate: float | None = None
    scattered: bool = False
    changes: Mapping[str, Any] = field(default_factory=dict)

    def but(
        self, label: str, group: str, changes: Mapping[str, Any] | None = None, **own: Any
    ) -> "Reading":
        """The same with something else, named after this one; `changes` come on top of its own."""
        label = f"{self.label}, {label}"
        changes = {**self.changes, **(changes or {})}
        return replace(self, label=label, group=group, changes=changes, **own)

    def settings(self, case: Case, method: str) -> dict[str, Any]:
        """What a study of the mission "dwa" is to be run with, by dotted key.

        The traditional method has no search angle, and on these maps some obstacle always counts
        for it, so it needs no dist for when none does: without them, readings that it cannot tell
        apart share its episodes.
        """
        rate = case.rate if self.rate is None else self.rate
        cap = min(self.cap, self.cap_in_radii * case.radius)
        found = {"params.radius": case.radius}
        if cap < inf:
            found["params.clearance_cap"] = cap
        clear = min(self.clear_distance, cap)
        if method == "improved" and clear != CLEAR:
            found["params.clear_distance"] = clear
        if self.scattered:
            found |= {"maps.source": "random", "maps.number": round(100 * rate)}
        else:
            found["maps.rate"] = rate
        left_out = ["params.search_angle"] if method == "traditional" else []
        return found | {k: v for k, v in self.changes.items() if k not in left_out}

    @property
    def task(self) -> tuple[object, ...]:
        """Maps, start and goal; methods can only be compared on the same task."""
        about = {k: v for k, v in self.changes.items() if k.startswith("maps.")}
        tolerance = self.changes.get("params.goal_tolerance")
        return self.rate, self.scattered, tuple(sorted(about.items())), tolerance


ALONG = {"static.clearance": "trajectory"}
NORTH = {"maps.start_heading": pi / 2}
FORWARD = {"params.v_min": 0.0}
UNBRAKED = {"static.braking": False}
FINE = {"params.stuck_distance": 105.25 * 0.0005}
"""Goes with a control period or a speed step half as long: by 0.0005 m a straight course at one
speed step grows then, and the preset's 0.0525 m is 105 of these, which leaves it to rounding who is
stuck."""

PRESET = Reading("no cap", "clearance cap")
"""The library's preset "tan2022": no cap on dist, taken at the end of the prediction."""
DEMO = Reading("cap 2r", "clearance cap", cap_in_radii=2.0, clear_distance=inf)
"""The rule of the widely used demo that Table 1's numbers come from."""
DEMO_START = DEMO.but("start 90 deg", "start heading", changes=NORTH)
"""That demo's rule and its start, which faces north instead of the goal."""


def _numbers(
    base: Reading, group: str, words: str, key: str, values: tuple[float, ...]
) -> list[Reading]:
    """Other values of one setting; `words` hold a place for them."""
    return [base.but(words.format(v), group, changes={key: v}) for v in values]


def _beside(base: Reading) -> list[Reading]:
    """What is not printed either and may decide a verdict, about a reading of the cap."""
    return [
        base.but("along the trajectory", "dist taken", changes=ALONG),
        *_numbers(base, "given up", "stuck within {:g} m", "params.stuck_distance", (0.5,)),
        *_numbers(base, "start heading", "turned up to {:g} rad", "maps.start_jitter", (0.001,)),
    ]


MAIN = (PRESET, DEMO, DEMO_START)
"""Readings that are run on all maps."""
BESIDE = (*_beside(PRESET), *_beside(DEMO))
"""Readings that count as much for verdicts, on fewer maps."""
ALONG_PRESET, ALONG_DEMO = BESIDE[0], BESIDE[3]
NO_ASTERN = Reading("v_min 0, no cap", "no sailing astern (v_min = 0)", changes=FORWARD)
"""The preset's reading, but for vessels that may not sail astern."""

CAPS = {
    DEMO.label: "2r",
    "cap 1 m": "1",
    "cap 2 m": "2",
    "cap 5 m": "5",
    PRESET.label: "none",
}
"""Readings that differ in the cap alone, and what to call it."""


def sensitivities() -> list[Reading]:
    """Readings that are varied one at a time, besides those that count for verdicts."""
    found = [
        Reading(f"cap {cap:g} m", "clearance cap", cap=cap, clear_distance=cap)
        for cap in (1.0, 2.0, 5.0)
    ]
    found += [
        Reading(f"no cap, clear {clear:g} m", "dist where none counts", clear_distance=clear)
        for clear in (0.5, 1.0, 5.0, 10.0)
    ]
    return found + _forward() + _about(PRESET) + _about(DEMO)


def _forward() -> list[Reading]:
    """Vessels that may not sail astern, against Table 1."""
    return [
        replace(NO_ASTERN, label="v_min 0, cap 2r", cap_in_radii=2.0, clear_distance=inf),
        replace(NO_ASTERN, label="v_min 0, cap 1 m", cap=1.0),
        replace(NO_ASTERN, label="v_min 0, cap 2 m", cap=2.0),
        NO_ASTERN,
        replace(NO_ASTERN, label="v_min 0, no cap, clear 5 m", clear_distance=5.0),
    ]


def _about(base: Reading) -> list[Reading]:
    """Everything that is varied one at a time, about one of two readings of the cap."""
    return [
        base.but("scores by range", "normalisation", changes={"static.normalise": "range"}),
        base.but("without Eq. 4", "braking bound", changes=UNBRAKED),
        *([base.but("start 90 deg", "start heading", changes=NORTH)] if base is PRESET else []),
        *_numbers(
            base, "goal tolerance", "goal within {:g} m", "params.goal_tolerance", (0.2, 1.0)
        ),
        base.but("exact count", "obstacle rate", changes={"maps.rate_meaning": "count"}),
        base.but("share of area", "obstacle rate", changes={"maps.rate_meaning": "area"}),
        base.but("lattice 1 to 9", "obstacle rate", changes={"maps.lo": 1, "maps.hi": 9}),
        base.but("discs anywhere", "obstacle rate", scattered=True),
        *(base.but(f"rate {rate:g}", "obstacle rate", rate=rate) for rate in (0.05, 0.1, 0.2, 0.3)),
        *(
            base.but(
                f"phi {degrees} deg",
                "search angle",
                changes={"params.search_angle": degrees * pi / 180},
            )
            for degrees in (30, 90)
        ),
        *_numbers(base, "given up", "stuck within {:g} m", "params.stuck_distance", (0.1025, 0.21)),
        base.but("nobody given up", "given up", changes={"params.stuck_time": NEVER}),
        *(
            base.but(f"until {seconds} s", "given up", changes={"static.max_steps": 10 * seconds})
            for seconds in (80, 300)
        ),
        *_numbers(base, "start heading", "turned up to {:g} rad", "maps.start_jitter", (0.01, 0.1)),
        *(
            base.but(f"period {dt:g} s", "control period", changes=_period(dt) | stuck)
            for dt, stuck in ((0.05, FINE), (0.2, {}))
        ),
        *(
            base.but(f"speed step {by:g} m/s", "resolution", changes={"params.v_step": by} | stuck)
            for by, stuck in ((0.005, FINE), (0.02, {}))
        ),
        *(
            base.but(
                f"yaw-rate step {degrees:g} deg/s",
                "resolution",
                changes={"params.w_step": degrees * pi / 180},
            )
            for degrees in (0.5, 2)
        ),
    ]


def _period(dt: float) -> dict[str, Any]:
    """Another control period (s), with as long a prediction and as long episodes as before."""
    return {
        "params.dt": dt,
        "static.horizon": round(3.0 / dt),
        "static.max_steps": round(150.0 / dt),
    }


def combinations() -> list[Reading]:
    """All combinations of cap, start, sailing astern and Eq. 4, for the ranking."""
    caps: dict[str, dict[str, Any]] = {
        "cap 2r": {"cap_in_radii": 2.0, "clear_distance": inf},
        **{f"cap {cap:g} m": {"cap": cap, "clear_distance": cap} for cap in (1.0, 2.0, 5.0)},
        "no cap": {},
    }
    starts = {"": {}, ", start 90 deg": NORTH}
    speeds = {"": {}, ", v_min 0": FORWARD}
    bounds = {"": {}, ", without Eq. 4": UNBRAKED}
    return [
        Reading(
            cap + start + speed + bound,
            "combination",
            changes={**starts[start], **speeds[speed], **bounds[bound]},
            **caps[cap],
        )
        for cap, start, speed, bound in product(caps, starts, speeds, bounds)
    ]


def quick_sensitivities() -> list[Reading]:
    """A few that compile to no further programs, for a quick look."""
    names = ("cap 2 m", NO_ASTERN.label, "no cap, phi 30 deg", "no cap, rate 0.2")
    return [reading for reading in sensitivities() if reading.label in names]
