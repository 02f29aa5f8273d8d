"""What the results on Tan et al. 2022 come to, in sentences made from the numbers."""

from typing import Any

from experiments.markdown import bullets, grid
from experiments.tan2022.markdown import radii
from experiments.tan2022.published import METHODS, METRICS, RADII, TABLE4, TABLE4_MAPS
from experiments.tan2022.readings import DEMO, DEMO_START, PRESET

_VERBS = {
    "reproduces": "Reproduces",
    "depends on the reading": "Depends on the reading",
    "does not reproduce": "Does not reproduce",
    "too few maps": "Too few maps to tell",
}


def summary(found: dict[str, Any]) -> str:
    """Say what reproduces and what does not, as Markdown."""
    lines = [
        f"**{words}**: {'; '.join(claims)}."
        for verdict, words in _VERBS.items()
        if (claims := [v["claim"] for v in found["verdicts"] if v["verdict"] == verdict])
    ]
    lines += [_safety(found), _nearest(found), _own_numbers(found)]
    note = (
        "Improved against traditional at r = " + ", ".join(f"{r:g}" for r in RADII) + " m. Changes "
        "are means over the maps where both methods succeed of the change per map (in brackets: "
        "change of the means). The readings are explained below."
    )
    return "\n\n".join([bullets(lines), note, _overview(found)])


def _overview(found: dict[str, Any]) -> str:
    header = ["", "Time (%)", "Path length (%)", "Mean speed (%)", "Success (%)", "Collisions (%)"]
    published = [
        radii([100 * share for share in TABLE4.change[metric]], sign=True) for metric in METRICS
    ]
    rows = [["published (Table 4)", *published, "not given", "not given"]]
    for row in found["paired"]:
        rates = [
            " to ".join(radii(_rates(row, method, ending)) for method in METHODS)
            for ending in ("REACHED", "COLLIDED")
        ]
        rows.append([row["label"], *(_changes(row, metric) for metric in METRICS), *rates])
    return grid(header, rows)


def _changes(row: dict[str, Any], metric: str) -> str:
    """Mean change per map, and the change of the means in brackets."""
    compared = [case["metrics"][metric] for case in row["cases"]]
    per_map = [None if c is None else 100 * c["mean_change"]["value"] for c in compared]
    of_means = [None if c is None else 100 * c["change_of_means"] for c in compared]
    return f"{radii(per_map, sign=True)} ({radii(of_means, sign=True)})"


def _rates(row: dict[str, Any], method: str, ending: str) -> list[float | None]:
    return [100 * case["endings"][method][ending]["value"] for case in row["cases"]]


def _safety(found: dict[str, Any]) -> str:
    """Say how often the improved method collides more, and succeeds less."""
    shared = [row for row in found["paired"] if row["traditional"] == row["improved"]]
    cases = [case for row in shared for case in row["cases"]]
    old, new = ([case["endings"][m]["COLLIDED"]["value"] for case in cases] for m in METHODS)
    more = sum(b > a for a, b in zip(old, new, strict=True))
    lower = sum(case["success"]["difference"]["value"] < 0 for case in cases)
    return (
        f"**Collisions**, which the paper does not report: the improved method collides in up to "
        f"{100 * max(new):.1f} % of episodes, the traditional one in up to {100 * max(old):.1f} %; "
        f"it collides more in {more} and succeeds less often in {lower} of {len(cases)} "
        "comparisons (three readings, three radii)."
    )


def _nearest(found: dict[str, Any]) -> str:
    """Name the nearest reading and the nearest hybrid."""
    ranked = found["ranking"]
    if not ranked["single"]:
        return "Too few maps for a ranking of the readings."
    single = ranked["single"][0]
    text = (
        f"**Which reading explains Table 4**: of {ranked['readings']} readings the nearest is "
        f'"{single["traditional"]}", typically off by a factor of '
        f"{single['typical_factor']:.2f}, with {single['within']} of 18 averages within what "
        f"{TABLE4_MAPS} maps vary."
    )
    if ranked["hybrid"]:
        hybrid = ranked["hybrid"][0]
        text += (
            f' The nearest hybrid, traditional "{hybrid["traditional"]}" with improved '
            f'"{hybrid["improved"]}", is off by {hybrid["typical_factor"]:.2f}, with '
            f"{hybrid['within']} of 18."
        )
    return text + " The ranking is post hoc."


def _own_numbers(found: dict[str, Any]) -> str:
    against = sum(check["verdict"] == "contradicts" for check in found["arithmetic"])
    excluded = [bound for bound in found["cap_bounds"] if bound["excludes_demo_cap"]]
    where = ", ".join(f"Table {b['table']} at r = {b['radius']:g} m" for b in excluded)
    return (
        f"**The paper's own numbers** contradict each other in {against} of "
        f"{len(found['arithmetic'])} places. A cap of 2r, the demo's rule, is excluded for the "
        f"improved method by its own mean speeds and Eq. 4 in {where}."
    )


def why(found: dict[str, Any]) -> list[str]:
    """Give the measured reasons, each from rows of the tables below."""
    rows = _Rows(found["sensitivities"])
    lines = [
        _the_cap(rows),
        _density(rows),
        _eq_4(rows),
        _astern(rows),
        _abeam(rows),
        _along(rows),
        _head_on(rows),
        _selection(found),
    ]
    return [line for line in lines if line]


class _Rows:
    """The table of sensitivities, asked by reading; None where a quick run lacks it."""

    def __init__(self, rows: list[dict[str, Any]]) -> None:
        self._rows = {(row["reading"], row["radius"]): row for row in rows}

    def has(self, *labels: str) -> bool:
        return all((label, RADII[0]) in self._rows for label in labels)

    def mean(self, label: str, method: str, metric: str, digits: int = 1) -> str:
        """Mean where both succeed, radius by radius."""
        rows = [self._rows[label, radius] for radius in RADII]
        means = [None if r["means"] is None else r["means"][method][metric] for r in rows]
        return radii(means, digits)

    def ratio(self, label: str) -> str:
        """Time of the improved method over that of the traditional one, radius by radius."""
        return radii([self._rows[label, radius]["time_ratio"]["value"] for radius in RADII], 2)

    def rate(self, label: str, method: str, ending: str) -> str:
        """Rate of an ending in %, radius by radius."""
        rows = [self._rows[label, radius] for radius in RADII]
        return radii([100 * row["endings"][method][ending]["value"] for row in rows])


def _the_cap(rows: _Rows) -> str:
    none, demo = PRESET.label, DEMO.label
    capped = [
        f"the {method} method {rows.mean(demo, method, 'path_length')} m in "
        f"{rows.mean(demo, method, 'time')} s (published "
        f"{radii(TABLE4.values[method, 'path_length'])} m in "
        f"{radii(TABLE4.values[method, 'time'])} s)"
        for method in METHODS
    ]
    return (
        "**The cap decides the traditional method.** Without one the score pulls it to open "
        "water: it sails around the whole field, "
        f"{rows.mean(none, 'traditional', 'path_length')} m on average where both arrive, and "
        f"{rows.rate(none, 'traditional', 'TIMED_OUT')} % of its episodes time out. With the cap "
        f"at 2r, {capped[0]} and {capped[1]}."
    )


def _density(rows: _Rows) -> str:
    labels = [f"{PRESET.label}, rate {rate:g}" for rate in (0.1, 0.05)]
    count, area = f"{PRESET.label}, exact count", f"{PRESET.label}, share of area"
    if not rows.has(*labels, count, area):
        return ""
    speeds = [rows.mean(label, "improved", "mean_speed", 2) for label in (PRESET.label, *labels)]
    return (
        "**The improved method's published speeds are those of sparser maps.** Its mean speed "
        f"without a cap is {speeds[0]} m/s at the printed rates, {speeds[1]} m/s at rate 0.1 and "
        f"{speeds[2]} m/s at rate 0.05; published "
        f"{radii(TABLE4.values['improved', 'mean_speed'], 2)} m/s. With the rate as an exact count "
        f"it is {rows.mean(count, 'improved', 'mean_speed', 2)} m/s, as a share of the area "
        f"{rows.mean(area, 'improved', 'mean_speed', 2)} m/s (there the number of obstacles "
        "falls with the radius)."
    )


def _eq_4(rows: _Rows) -> str:
    pairs = [(base.label, f"{base.label}, without Eq. 4") for base in (DEMO, PRESET)]
    if not rows.has(*(label for pair in pairs for label in pair)):
        return ""
    parts = [
        f"{with_it}: {rows.ratio(with_it)} with it and {rows.ratio(without)} without"
        for with_it, without in pairs
    ]
    return (
        "**Eq. 4 is not what the two methods differ by**, although the paper explains the gain in "
        "speed by it: ratio of times, improved to traditional, "
        f"{'; '.join(parts)}."
    )


def _astern(rows: _Rows) -> str:
    forward = "v_min 0, no cap"
    if not rows.has(forward):
        return ""
    return (
        "**Sailing astern costs the improved method time.** Backing off turns its sector towards "
        "water already passed. Without a cap it takes "
        f"{rows.mean(PRESET.label, 'improved', 'time')} s with Table 1's v_min = -1 m/s and "
        f"{rows.mean(forward, 'improved', 'time')} s with v_min = 0."
    )


def _abeam(rows: _Rows) -> str:
    labels = [f"{DEMO.label}, phi 30 deg", DEMO.label, f"{DEMO.label}, phi 90 deg"]
    if not rows.has(*labels):
        return ""
    parts = [rows.rate(label, "improved", "COLLIDED") for label in labels]
    return (
        "**Ignoring obstacles abeam costs collisions.** With cap 2r the improved method collides "
        f"in {parts[0]} % of episodes at phi = 30 deg, {parts[1]} % at 60 and {parts[2]} % at "
        f"90; the traditional one in {rows.rate(DEMO.label, 'traditional', 'COLLIDED')} %."
    )


def _along(rows: _Rows) -> str:
    label = f"{DEMO.label}, dist along the trajectory"
    if not rows.has(label):
        return ""
    return (
        "**dist along the whole trajectory** instead of at its end keeps the traditional method "
        f"from colliding ({rows.rate(label, 'traditional', 'COLLIDED')} %), but not the improved "
        f"one ({rows.rate(label, 'improved', 'COLLIDED')} %, cap 2r): it still ignores what lies "
        "behind the end of the prediction, though the vessel is not there yet."
    )


def _head_on(rows: _Rows) -> str:
    if not rows.has(DEMO_START.label):
        return ""
    ahead, north = (
        [rows.rate(label, method, "REACHED") for method in METHODS]
        for label in (DEMO.label, DEMO_START.label)
    )
    return (
        "**An obstacle dead ahead is a trap.** The straight course runs along the lattice's "
        "diagonal, and a vessel that meets an obstacle head-on can stop before it for good: both "
        f"sides score alike. With cap 2r {ahead[0]} % (traditional) and {ahead[1]} % (improved) "
        "succeed from a start towards the goal, "
        f"{north[0]} % and {north[1]} % from one facing north."
    )


def _selection(found: dict[str, Any]) -> str:
    parts = []
    for row in found["paired"]:
        shares = [
            None if case["as_much_as_published"] is None else case["as_much_as_published"]["time"]
            for case in row["cases"]
        ]
        scaled = [None if share is None else 100 * share for share in shares]
        parts.append(f"{row['label']}: {radii(scaled)} %")
    return (
        "**The published saving of time is rare.** Of the maps where both succeed, the improved "
        "method saves at least as much time as Table 4 says on average on this share: "
        f"{'; '.join(parts)}."
    )
