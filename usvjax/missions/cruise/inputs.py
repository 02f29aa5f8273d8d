"""Checks of what a cruise takes, before anything is computed."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from usvjax.checks import any_array, positive, shown, whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps.grid_map import GridMap
from usvjax.memory import check_memory
from usvjax.missions.cruise.params import check_params, check_static
from usvjax.search.inputs import search_maps
from usvjax.search.replan_inputs import check_method, clipped_window
from usvkernels.cruise.flips import BITS
from usvkernels.search.dstar_layout import INFINITE, NONE
from usvkernels.search.replan_heuristics import LONGEST_EQ_17, largest_guide
from usvkernels.search.steps import DIAGONAL

CELL_SIZE = 10.0  # m; Yu et al. 2022, section 5.1
STEPS_PER_SIDE = 8  # of a leg at most, times height plus width of the map
MOST_STEPS = 2**29  # of a cruise; its moves are counted in int32
EXPANSIONS_PER_CELL = 16  # of one replanning; without overestimating it takes two at most
MOST_EXPANSIONS = 2**28

# Of results: a track of one step with its measures, and a leg with its place in the order.
_BYTES_OF_CRUISE, _BYTES_OF_LEG = 128, 24

_STATIONS = "int [B, d, 2] or [d, 2], cells (x, y), d >= 2, row 0 is home"
_ORDER = "int [B, d] or [d], each of 0 .. d - 1 once, beginning with 0"


@dataclass(frozen=True)
class Expedition:
    """The cruises, checked.

    Attributes:
        blocked: bool[1, H, W] shared by all cruises, or bool[B, H, W].
        stations: int32[B, d, 2], cells (x, y).
        rate: int32[B], probability of a flip times 2^BITS.
        scope: where cells flip.
        window: (h, w) of the vessel's view.
        corner_cutting: of moves and chords.
        max_wait: steps in a row that a vessel waits for a way to its stop.
        gives_up: whether a stop without a way ends the cruise.
        max_steps: of a leg.
        own_steps: whether max_steps was given; the default gives way to what a method can count.
        max_expansions: of D* Lite in one step.
        cell_size: m.
        speed: float64[B], m/s.
    """

    blocked: np.ndarray
    stations: np.ndarray
    rate: np.ndarray
    scope: str
    window: tuple[int, int]
    corner_cutting: bool
    max_wait: int
    gives_up: bool
    max_steps: int
    own_steps: bool
    max_expansions: int
    cell_size: float
    speed: np.ndarray

    def __len__(self) -> int:
        return len(self.stations)

    @property
    def shape(self) -> tuple[int, int]:
        """(H, W): rows and columns of the maps."""
        return self.blocked.shape[1], self.blocked.shape[2]

    @property
    def legs(self) -> int:
        """Of each cruise: one to each station but the first, and one home."""
        return self.stations.shape[1]

    def layers(self, rows: np.ndarray) -> np.ndarray:
        """int[len(rows)], which map each of these cruises is on."""
        return np.zeros_like(rows) if len(self.blocked) == 1 else rows

    def part(self, rows: np.ndarray) -> "Expedition":
        """Those of the cruises, int[n]."""
        shared = len(self.blocked) == 1
        return replace(
            self,
            blocked=self.blocked if shared else self.blocked[rows],
            stations=self.stations[rows],
            rate=self.rate[rows],
            speed=self.speed[rows],
        )


def check_expedition(
    blocked: Any,
    stations: Any,
    params: Any,
    static: Any,
    *,
    runs: Any = None,
    cell_size: Any = None,
) -> Expedition:
    """Check the arguments that every method has; see `cruise`.

    Raises:
        BadTypeError: an argument of the wrong type or dtype.
        BadInputError: a wrong shape or size, or an impossible value; the message names the argument
            and the first bad row.
    """
    static = check_static(static)
    grids = search_maps(blocked)
    places = _stations(stations)
    count = _count(len(grids), len(places), runs)
    places = _checked_places(grids, places)
    legs = places.shape[1]
    # However short the cruises are, and however few of them are under way at a time.
    check_memory(
        count * (_BYTES_OF_CRUISE + legs * _BYTES_OF_LEG),
        f"{'stations' if runs is None else 'runs'}: {count} cruises of {legs} stations",
    )
    params = check_params(params, count)
    height, width = grids.shape[1:]
    return Expedition(
        blocked=grids,
        stations=np.broadcast_to(places, (count, legs, 2)),
        rate=np.round(params.flip_rate * 2**BITS).astype(np.int32),
        scope=static.flip_scope,
        window=clipped_window(static.sensing, (height, width)),
        corner_cutting=static.corner_cutting,
        max_wait=min(params.max_wait, 2**30) if static.walled_in == "wait" else 0,
        gives_up=static.walled_in == "fail",
        max_steps=_max_steps(static.max_steps, STEPS_PER_SIDE * (height + width), legs),
        own_steps=static.max_steps is not None,
        max_expansions=_max_expansions(static.max_expansions, height * width),
        cell_size=_cell_size(blocked, cell_size),
        speed=params.speed,
    )


def check_heuristic(expedition: Expedition, heuristic: Any, weight: Any) -> Expedition:
    """Refuse a heuristic that does not exist, or for which keys would not fit their integers.

    Returns:
        The cruises, with as many steps of a leg as the keys allow where the default is more.

    Raises:
        BadTypeError, BadInputError: as `dstar_lite`.
    """
    check_method(heuristic, weight, None)
    height, width = expedition.shape
    eq_17 = heuristic.startswith("weighted") and weight is None
    if eq_17 and height**2 + width**2 > LONGEST_EQ_17**2:
        raise BadInputError(
            f"blocked: got maps of {width} x {height} cells; wanted a diagonal of at most "
            f"{LONGEST_EQ_17} cells with heuristic={heuristic!r}"
        )
    left = NONE - INFINITE - largest_guide(heuristic, weight, height, width) - 4 * DIAGONAL
    most = max(left // DIAGONAL, 0)
    # With fewer steps than these, a default would leave vessels adrift in open water.
    if most < (1 if expedition.own_steps else height + width):
        raise BadInputError(
            f"blocked: got maps of {width} x {height} cells, on which a leg can have at most "
            f"{most} steps with heuristic={heuristic!r}; wanted smaller maps"
            + (f", or static.max_steps up to {most}" if most else "")
        )
    if expedition.own_steps and expedition.max_steps > most:
        raise BadInputError(
            f"static.max_steps: got {expedition.max_steps} on maps of {width} x {height} cells; "
            f"wanted at most {most} with heuristic={heuristic!r}"
        )
    return replace(expedition, max_steps=min(expedition.max_steps, most))


def check_order(order: Any, expedition: Expedition) -> np.ndarray:
    """A given order of the stations, int32[B, d].

    Raises:
        BadTypeError: not whole numbers.
        BadInputError: another shape, or no permutation that begins with 0.
    """
    rows = any_array("order", order, _ORDER)
    if rows.dtype.kind not in "iu":
        raise BadTypeError(f"order: got dtype {rows.dtype}; wanted {_ORDER}")
    count, legs = len(expedition), expedition.legs
    if rows.ndim not in (1, 2) or rows.shape[-1] != legs or rows.size == 0:
        raise BadInputError(f"order: got shape {rows.shape} for d = {legs}; wanted {_ORDER}")
    rows = np.atleast_2d(rows)
    if len(rows) not in (1, count):
        raise BadInputError(f"order: got {len(rows)} rows; wanted {count}, or one for all")
    wrong = np.any(np.sort(rows, axis=1) != np.arange(legs), axis=1) | (rows[:, 0] != 0)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise BadInputError(f"order: got {rows[row].tolist()} in row {row}; wanted {_ORDER}")
    return np.broadcast_to(rows, (count, legs)).astype(np.int32)


def _stations(stations: Any) -> np.ndarray:
    places = any_array("stations", stations, _STATIONS)
    if places.ndim not in (2, 3) or places.shape[-1] != 2 or len(places) == 0:
        raise BadInputError(f"stations: got shape {places.shape}; wanted {_STATIONS}")
    if places.dtype.kind not in "iu":
        raise BadTypeError(f"stations: got dtype {places.dtype}; wanted {_STATIONS}")
    if places.shape[-2] < 2:
        raise BadInputError(
            f"stations: got {places.shape[-2]} of them; wanted two or more, home included"
        )
    return places if places.ndim == 3 else places[None]


def _count(maps: int, stations: int, runs: Any) -> int:
    """B, which arguments of one row follow."""
    sizes = {"blocked": maps, "stations": stations}
    if runs is not None:
        sizes["runs"] = whole_number("runs", runs, 1)
    count = sizes.get("runs", max(sizes.values()))
    for name in ("blocked", "stations"):
        if sizes[name] not in (1, count):
            wanted = f"{count}, as runs says" if runs is not None else f"{count}, or one for all"
            raise BadInputError(f"{name}: got {sizes[name]} rows; wanted {wanted}")
    return count


def _max_steps(given: int | None, default: int, legs: int) -> int:
    most = MOST_STEPS // legs
    if given is None:
        return min(default, most)
    if given > most:
        raise BadInputError(
            f"static.max_steps: got {given} for cruises of {legs} stations; wanted at most {most}"
        )
    return given


def _max_expansions(given: int | None, cells: int) -> int:
    return min(EXPANSIONS_PER_CELL * cells if given is None else given, MOST_EXPANSIONS)


def _checked_places(grids: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Stations as int32; refuses those outside the map, on land, or twice in a cruise."""
    height, width = grids.shape[1:]
    outside = np.any((places < 0) | (places >= [width, height]), axis=-1)
    _refuse(places, outside, f"lies outside the map; wanted 0 <= x < {width}, 0 <= y < {height}")
    places = places.astype(np.int32)
    layer = np.arange(len(grids))
    on_land = grids[layer[:, None], places[..., 1], places[..., 0]]
    _refuse(places, on_land, "is a blocked cell; wanted a free one")
    number = places[..., 1].astype(np.int64) * width + places[..., 0]
    order = np.argsort(number, axis=1, kind="stable")
    ordered = np.take_along_axis(number, order, axis=1)
    twice = np.zeros(number.shape, bool)
    np.put_along_axis(twice, order[:, 1:], ordered[:, 1:] == ordered[:, :-1], axis=1)
    _refuse(places, twice, "is there already; wanted distinct cells")
    return places


def _refuse(places: np.ndarray, bad: Any, why: str) -> None:
    if bad.any():
        row, station = (int(i) for i in np.argwhere(bad)[0])
        x, y = places[row if len(places) > 1 else 0, station].tolist()
        raise BadInputError(f"stations: ({x}, {y}), station {station} in row {row}, {why}")


def _cell_size(blocked: Any, cell_size: Any) -> float:
    if isinstance(blocked, GridMap):
        if cell_size is not None:
            got = shown(cell_size)
            raise BadInputError(f"cell_size: got {got} with a GridMap, which has its own")
        return blocked.cell_size
    return CELL_SIZE if cell_size is None else positive("cell_size", cell_size)
