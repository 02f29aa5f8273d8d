"""What the results on Tan et al. 2022 come to, and their reasons: sentences from the numbers."""

from collections.abc import Iterator, Mapping
from typing import Any

from experiments.claims import Numbers, above, below
from experiments.tan2022.arithmetic import arithmetic
from experiments.tan2022.joint import LEAST_MAPS
from experiments.tan2022.measures import COUNTED, HYBRID
from experiments.tan2022.published import METHODS, RADII, TABLE4
from experiments.tan2022.readings import (
    ALONG_DEMO,
    ALONG_PRESET,
    BESIDE,
    DEMO,
    DEMO_START,
    FINE,
    PRESET,
)
from usvjax import preset
from usvjax.report.numbers import fixed, interval, listed


def summary(numbers: Numbers) -> list[str]:
    """The most important findings besides the verdicts."""
    return [_safety(numbers), _nearest(numbers), _own_numbers(numbers)]


def _safety(numbers: Numbers) -> str:
    """Say how often the improved method collides more, and succeeds less."""
    cases = [case for one in COUNTED for case in numbers["paired"][one.label]["cases"]]
    old, new = ([case["endings"][m]["COLLIDED"]["value"] for case in cases] for m in METHODS)
    more = sum(b > a for a, b in zip(old, new, strict=True))
    lower = sum(case["success"]["difference"]["value"] < 0 for case in cases)
    return (
        "**Collisions**, which the paper does not report: the improved method collides in up to "
        f"{fixed(max(new), 1, 100)} % of episodes, the traditional one in up to "
        f"{fixed(max(old), 1, 100)} %; it collides more in {more} and succeeds less often in "
        f"{lower} of {len(cases)} comparisons ({len(COUNTED)} readings, {len(RADII)} radii)."
    )


def _nearest(numbers: Numbers) -> str:
    """Name the nearest reading and the nearest hybrid."""
    ranked = numbers["ranking"]
    if not ranked["single"]:
        return "Too few maps for a ranking of the readings."
    single = ranked["single"][0]
    text = (
        f"**Which reading comes nearest to Table 4**: of {ranked['readings']} readings "
        f'"{single["traditional"]}", typically off by a factor of '
        f"{fixed(single['typical_factor'], 2)}."
    )
    if ranked["hybrid"]:
        hybrid = ranked["hybrid"][0]
        text += (
            f' The nearest hybrid, traditional "{hybrid["traditional"]}" with improved '
            f'"{hybrid["improved"]}", is off by {fixed(hybrid["typical_factor"], 2)}.'
        )
    return text + " The ranking is post hoc and decides nothing."


def _own_numbers(numbers: Numbers) -> str:
    checks = arithmetic()
    against = sum(check.verdict == "contradicts" for check in checks)
    excluded = [bound for bound in numbers["cap_bounds"] if bound["excludes_demo_cap"]]
    where = ", ".join(f"Table {b['table']} at r = {b['radius']:g} m" for b in excluded)
    return (
        f"**The paper's own numbers** contradict each other in {against} of {len(checks)} places. "
        "A cap of 2r, the demo's rule, is excluded for the improved method by its own mean speeds "
        f"and Eq. 4 in {where}."
    )


def readings(numbers: Numbers) -> list[str]:
    """How the paper was read."""
    params = preset("tan2022").params
    maps = [
        numbers["paired"][r.label]["cases"][0]["maps"] for r in (PRESET, BESIDE[1], ALONG_PRESET)
    ]
    return [
        "Maps: obstacle centres on the integer points 0 to 10, each with the obstacle rate as "
        "probability; start (0, 0) at rest heading for the goal (10, 10). Control period "
        f"{params.dt:g} s, speed resolution {params.v_step:g} m/s, yaw-rate resolution 1 deg/s, "
        f"goal tolerance {params.goal_tolerance:g} m. None of this is printed; Table 1 is. "
        "`docs/equations.md` has the rest.",
        f'"{PRESET.label}": dist is taken at the end of the prediction, where Fig. 1 draws it, is '
        f'not capped, and is 2 m where no obstacle counts. "{DEMO.label}": dist is at most twice '
        "the radius, the rule of a widely used demo whose weights, accelerations and resolutions "
        f'Table 1 repeats. "{DEMO_START.label}": that demo\'s start as well. "{HYBRID}": the '
        f'traditional method under "{DEMO.label}" against the improved one under "{PRESET.label}", '
        "chosen to come near to Table 4, and so beside the others.",
        '"along the trajectory": dist is the least over all predicted positions, as the words '
        'below Eq. 4 have it ("on the predicted trajectory"). Nothing in the paper says which of '
        "the two its program does.",
        '"turned up to 0.001 rad": each start heading is turned by a small draw of its own, which '
        "takes the vessel off the diagonal of the lattice, where both sides score alike.",
        "An episode ends as collided when an executed position lies inside an obstacle's circle, "
        f"as stuck after {params.stuck_time:g} s within {params.stuck_distance:g} m of one place, "
        "as timed out after 150 s. The slowest command, one step of speed, sails "
        f"{fixed(params.v_step * params.stuck_time, 1)} m in that time: a bound well below it "
        'gives up nobody who still creeps, one above it, such as "stuck within 0.5 m", does, and '
        "the bound itself would leave it to rounding. So would a whole number of the steps that "
        "such a vessel makes: with a period of 0.05 s or a speed step of 0.005 m/s the place is "
        f"{FINE['params.stuck_distance']:g} m wide.",
        "Times, lengths and speeds are compared on the maps where both methods reach the goal, "
        "and every table says how many those are.",
        "The paper shows maps on which both methods arrive and does not say how they were chosen. "
        "Ours are the first ones of a fixed sequence on which both do, and the tables say how many "
        "were passed over. Table 2 takes the first map that both methods cross at all three radii.",
        f'Sizes: {maps[0]:,} maps per radius under "{PRESET.label}", "{DEMO.label}" and '
        f'"{DEMO_START.label}", {maps[2]:,} with dist along the trajectory, which costs up to '
        f"thirty times as much, {maps[1]:,} under the other readings that count.",
    ]


def why(numbers: Numbers) -> list[str]:
    """Give the measured reasons, each from rows of the tables."""
    rows = _Rows(numbers["sensitivities"])
    choices = (_the_cap, _density, _eq_4, _stuck, _abeam, _along, _head_on, _resolution, _quicker)
    told = [line for reason in choices for line in reason(rows)]
    return [*told, _astern(numbers), _selection(numbers)]


class _Rows:
    """The table of sensitivities, asked by reading."""

    def __init__(self, rows: list[Mapping[str, Any]]) -> None:
        self._rows = {(row["reading"], row["radius"]): row for row in rows}

    def has(self, *labels: str) -> bool:
        """Whether all were run; a quick run lacks some."""
        return all((label, RADII[0]) in self._rows for label in labels)

    @property
    def labels(self) -> list[str]:
        """Of all readings."""
        return list(dict.fromkeys(label for label, _ in self._rows))

    def is_quicker(self, label: str) -> bool:
        """Whether the improved method is shown to be quicker at every radius."""
        return all(below(self._rows[label, radius]["time_ratio"], 1.0) for radius in RADII)

    def mean(self, label: str, method: str, metric: str, digits: int = 1) -> str:
        """Mean where both succeed, radius by radius."""
        rows = [self._rows[label, radius] for radius in RADII]
        return listed([row["means"] and row["means"][method][metric] for row in rows], digits)

    def ratio(self, label: str) -> str:
        """Time of the improved method over that of the traditional one, radius by radius."""
        return listed([self._rows[label, radius]["time_ratio"]["value"] for radius in RADII], 2)

    def rate(self, label: str, method: str, ending: str = "REACHED") -> str:
        """Rate of an ending in %, radius by radius."""
        rows = [self._rows[label, radius] for radius in RADII]
        return listed([row["endings"][method][ending]["value"] for row in rows], 1, 100)


def _the_cap(rows: _Rows) -> Iterator[str]:
    none, demo = PRESET.label, DEMO.label
    capped = [
        f"the {method} method {rows.mean(demo, method, 'path_length')} m in "
        f"{rows.mean(demo, method, 'time')} s (published "
        f"{listed(TABLE4.values[method, 'path_length'])} m in "
        f"{listed(TABLE4.values[method, 'time'])} s)"
        for method in METHODS
    ]
    yield (
        "**The cap and the traditional method.** Without one it sails "
        f"{rows.mean(none, 'traditional', 'path_length')} m on average where both arrive, and "
        f"{rows.rate(none, 'traditional', 'TIMED_OUT')} % of its episodes time out. With the cap "
        f"at 2r, {capped[0]} and {capped[1]}."
    )


def _density(rows: _Rows) -> Iterator[str]:
    labels = [f"{PRESET.label}, rate {rate:g}" for rate in (0.1, 0.05)]
    count, area = f"{PRESET.label}, exact count", f"{PRESET.label}, share of area"
    if not rows.has(*labels, count, area):
        return
    speeds = [rows.mean(label, "improved", "mean_speed", 2) for label in (PRESET.label, *labels)]
    yield (
        "**Speed and the density of maps.** The improved method's mean speed "
        f"without a cap is {speeds[0]} m/s at the printed rates, {speeds[1]} m/s at rate 0.1 and "
        f"{speeds[2]} m/s at rate 0.05; published "
        f"{listed(TABLE4.values['improved', 'mean_speed'], 2)} m/s. With the rate as an exact "
        f"count it is {rows.mean(count, 'improved', 'mean_speed', 2)} m/s, as a share of the area "
        f"{rows.mean(area, 'improved', 'mean_speed', 2)} m/s (there the number of obstacles "
        "falls with the radius)."
    )


def _eq_4(rows: _Rows) -> Iterator[str]:
    pairs = [(base.label, f"{base.label}, without Eq. 4") for base in (DEMO, PRESET)]
    if not rows.has(*(label for pair in pairs for label in pair)):
        return
    parts = [
        f"{with_it}: {rows.ratio(with_it)} with it and {rows.ratio(without)} without"
        for with_it, without in pairs
    ]
    yield (
        "**The two methods with and without Eq. 4**, by which the paper explains the gain in "
        "speed: ratio of times, improved to traditional, "
        f"{'; '.join(parts)}."
    )


def _stuck(rows: _Rows) -> Iterator[str]:
    labels = [PRESET.label, *(f"{PRESET.label}, stuck within {d} m" for d in (0.21, 0.5))]
    never = f"{PRESET.label}, nobody given up"
    limits = [f"{PRESET.label}, until {seconds} s" for seconds in (80, 300)]
    if not rows.has(*labels, never, *limits):
        return
    told = [
        f"{rows.rate(label, 'improved')} % and {rows.ratio(label)}"
        for label in (*labels, never, *limits)
    ]
    yield (
        "**Who is given up decides who is compared.** Success of the improved method without a "
        f"cap and the ratio of times, improved to traditional: {told[0]}; {told[3]} if nobody is "
        f"given up; {told[1]} if those are who stay within 0.21 m for 20 s, in which one step of "
        f"speed sails 0.20; {told[2]} within 0.5 m, more than two steps sail; {told[4]} if all are "
        f"given up after 80 s instead of 150, and {told[5]} after 300."
    )


def _abeam(rows: _Rows) -> Iterator[str]:
    labels = [f"{DEMO.label}, phi 30 deg", DEMO.label, f"{DEMO.label}, phi 90 deg"]
    if not rows.has(*labels):
        return
    parts = [rows.rate(label, "improved", "COLLIDED") for label in labels]
    yield (
        "**The search angle and collisions.** With cap 2r the improved method collides "
        f"in {parts[0]} % of episodes at phi = 30 deg, {parts[1]} % at 60 and {parts[2]} % at "
        f"90; the traditional one in {rows.rate(DEMO.label, 'traditional', 'COLLIDED')} %."
    )


def _along(rows: _Rows) -> Iterator[str]:
    label = ALONG_DEMO.label
    yield (
        "**dist along the whole trajectory** instead of at its end, with cap 2r: the traditional "
        f"method collides in {rows.rate(label, 'traditional', 'COLLIDED')} % of episodes, the "
        f"improved one in {rows.rate(label, 'improved', 'COLLIDED')} % (at the end: "
        f"{rows.rate(DEMO.label, 'traditional', 'COLLIDED')} % and "
        f"{rows.rate(DEMO.label, 'improved', 'COLLIDED')} %). The improved one ignores what lies "
        "behind the end of the prediction, by its search angle, under either reading. Without a "
        "cap the traditional method then sails "
        f"{rows.mean(ALONG_PRESET.label, 'traditional', 'path_length')} m in "
        f"{rows.mean(ALONG_PRESET.label, 'traditional', 'time')} s on average (published "
        f"{listed(TABLE4.values['traditional', 'path_length'])} m in "
        f"{listed(TABLE4.values['traditional', 'time'])} s) and succeeds on "
        f"{rows.rate(ALONG_PRESET.label, 'traditional')} % of maps."
    )


def _head_on(rows: _Rows) -> Iterator[str]:
    turned = f"{DEMO.label}, turned up to 0.001 rad"
    told = [
        f"{rows.rate(label, 'traditional')} % (traditional) and {rows.rate(label, 'improved')} % "
        "(improved)"
        for label in (DEMO.label, turned, DEMO_START.label)
    ]
    yield (
        "**The start towards the goal** lies on the lattice's diagonal, where both sides of an "
        f"obstacle that is met head-on score alike. With cap 2r {told[0]} succeed from a start "
        f"towards the goal, {told[1]} from one turned by up to 0.001 rad, {told[2]} from one "
        "facing north."
    )


def _resolution(rows: _Rows) -> Iterator[str]:
    varied = ("period 0.05 s", "period 0.2 s", "speed step 0.005 m/s", "speed step 0.02 m/s")
    labels = [PRESET.label, *(f"{PRESET.label}, {words}" for words in varied)]
    if not rows.has(*labels):
        return
    told = [f"{words} {rows.ratio(f'{PRESET.label}, {words}')}" for words in varied]
    yield (
        "**Control period and resolution** are not printed either. Without a cap the ratio of "
        f"times, improved to traditional, is {rows.ratio(PRESET.label)}; {'; '.join(told)}."
    )


def _quicker(rows: _Rows) -> Iterator[str]:
    """Under which of all readings the claim on time holds at each radius."""
    quicker = [label for label in rows.labels if rows.is_quicker(label)]
    yield (
        f"**Of all {len(rows.labels)} readings below**, those that count for verdicts and those "
        "that vary one choice at a time, the improved method is quicker at every radius (the "
        f"interval of the time ratio below 1) under {len(quicker)}"
        f"{': ' * bool(quicker)}{'; '.join(quicker)}."
    )


def _astern(numbers: Numbers) -> str:
    """Say what sailing astern costs, map by map, in words that the intervals choose."""
    found = numbers["astern"]
    costs = [above(one) if one["maps"] >= LEAST_MAPS else None for one in found]
    words = {True: "longer", False: "shorter", None: "not shown to differ"}
    told = [
        f"{interval(one, 1, True, 1)} s at r = {radius:g} m ({one['maps']} maps: {words[cost]})"
        for radius, one, cost in zip(RADII, found, costs, strict=True)
    ]
    return (
        "**The time of sailing astern.** Without a cap, on the maps that the improved method "
        "crosses with Table 1's v_min = -1 m/s and with v_min = 0 alike, it takes so much longer "
        f"with the former, with 95 % t intervals: {'; '.join(told)}."
    )


def _selection(numbers: Numbers) -> str:
    parts = []
    for label in (PRESET.label, DEMO.label, DEMO_START.label, ALONG_PRESET.label, HYBRID):
        found = [case["as_much_as_published"] for case in numbers["paired"][label]["cases"]]
        parts.append(f"{label}: {listed([share and share['time'] for share in found], 1, 100)} %")
    return (
        "**How many maps save the published time.** Of the maps where both succeed, the improved "
        "method saves at least as much time as Table 4 says on average on this share: "
        f"{'; '.join(parts)}."
    )
