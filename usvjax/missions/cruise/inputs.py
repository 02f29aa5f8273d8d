"""Checks of what a cruise takes, before anything is computed."""

from dataclasses import dataclass, replace
from typing import Any

import jax
import numpy as np

from usvjax.checks import fraction, one_of, positive, whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps.grid_map import GridMap
from usvjax.memory import check_memory
from usvjax.search.inputs import search_maps
from usvjax.search.replan_inputs import check_method, clipped_window
from usvkernels.cruise.flips import BITS
from usvkernels.cruise.sailing import SCOPES
from usvkernels.search.dstar_layout import INFINITE, NONE
from usvkernels.search.replan_heuristics import LONGEST_EQ_17, largest_guide
from usvkernels.search.steps import DIAGONAL

WALLED_IN = ("wait", "skip", "fail")
CELL_SIZE = 10.0  # m; Yu et al. 2022, section 5.1, and so the speed
SPEED = 10.0  # m/s
STEPS_PER_SIDE = 8  # of a leg at most, times height plus width of the map
MOST_STEPS = 2**29  # of a cruise; its moves are counted in int32

# Of results: a track of one step with its measures, and a leg with its place in the order.
_BYTES_OF_CRUISE, _BYTES_OF_LEG = 128, 24

_STATIONS = "int [B, d, 2] or [d, 2], cells (x, y), d >= 2, row 0 is home"
_ORDER = "int [B, d] or [d], each of 0 .. d - 1 once, beginning with 0"


@dataclass(frozen=True)
class Mission:
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
      cell_size: m.
      speed: m/s.
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
    cell_size: float
    speed: float

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

    def part(self, rows: np.ndarray) -> "Mission":
        """Those of the cruises, int[n]."""
        shared = len(self.blocked) == 1
        return replace(
            self,
            blocked=self.blocked if shared else self.blocked[rows],
            stations=self.stations[rows],
            rate=self.rate[rows],
        )


def check_mission(
    blocked: Any,
    stations: Any,
    *,
    runs: Any,
    flip_rate: Any,
    flip_scope: Any,
    sensing: Any,
    corner_cutting: Any,
    walled_in: Any,
    max_wait: Any,
    max_steps: Any,
    cell_size: Any,
    speed: Any,
) -> Mission:
    """Check the arguments that every method has.

    Raises:
      BadTypeError: an argument of the wrong type or dtype.
      BadInputError: a wrong shape or size, or an impossible value; the message names the argument
        and the first bad row.
    """
    one_of("flip_scope", flip_scope, SCOPES)
    one_of("walled_in", walled_in, WALLED_IN)
    if sensing is None:
        raise BadInputError("sensing: got None; wanted (h, w), two odd whole numbers of 3 or more")
    window = check_method("octile", None, corner_cutting, sensing)
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
    max_wait = whole_number("max_wait", max_wait, 0)
    height, width = grids.shape[1:]
    return Mission(
        blocked=grids,
        stations=np.broadcast_to(places, (count, legs, 2)),
        rate=_rates(flip_rate, count),
        scope=flip_scope,
        window=clipped_window(window, (height, width)),
        corner_cutting=bool(corner_cutting),
        max_wait=min(max_wait, 2**30) if walled_in == "wait" else 0,
        gives_up=walled_in == "fail",
        max_steps=_max_steps(max_steps, STEPS_PER_SIDE * (height + width), legs),
        own_steps=max_steps is not None,
        cell_size=_cell_size(blocked, cell_size),
        speed=positive("speed", speed),
    )


def check_heuristic(mission: Mission, heuristic: Any, weight: Any) -> Mission:
    """Refuse a heuristic that does not exist, or for which keys would not fit their integers.

    Returns:
      The cruises, with as many steps of a leg as the keys allow where the default is more.

    Raises:
      BadTypeError, BadInputError: as `dstar_lite`.
    """
    check_method(heuristic, weight, mission.corner_cutting, None)
    height, width = mission.shape
    eq_17 = heuristic.startswith("weighted") and weight is None
    if eq_17 and height**2 + width**2 > LONGEST_EQ_17**2:
        raise BadInputError(
            f"blocked: got maps of {width} x {height} cells; wanted a diagonal of at most "
            f"{LONGEST_EQ_17} cells with heuristic={heuristic!r}"
        )
    left = NONE - INFINITE - largest_guide(heuristic, weight, height, width) - 4 * DIAGONAL
    most = max(left // DIAGONAL, 0)
    # With fewer steps than these, a default would leave vessels adrift in open water.
    if most < (1 if mission.own_steps else height + width):
        raise BadInputError(
            f"blocked: got maps of {width} x {height} cells, on which a leg can have at most "
            f"{most} steps with heuristic={heuristic!r}; wanted smaller maps"
            + (f", or max_steps up to {most}" if most else "")
        )
    if mission.own_steps and mission.max_steps > most:
        raise BadInputError(
            f"max_steps: got {mission.max_steps} on maps of {width} x {height} cells; wanted at "
            f"most {most} with heuristic={heuristic!r}"
        )
    return replace(mission, max_steps=min(mission.max_steps, most))


def check_order(order: Any, mission: Mission) -> np.ndarray:
    """A given order of the stations, int32[B, d].

    Raises:
      BadTypeError: not whole numbers.
      BadInputError: another shape, or no permutation that begins with 0.
    """
    try:
        rows = np.asarray(order)
    except ValueError:
        raise BadInputError(f"order: rows of unequal length; wanted {_ORDER}") from None
    if rows.dtype.kind not in "iu":
        raise BadTypeError(f"order: got dtype {rows.dtype}; wanted {_ORDER}")
    count, legs = len(mission), mission.legs
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
    try:
        places = np.asarray(stations)
    except ValueError:
        raise BadInputError(f"stations: rows of unequal length; wanted {_STATIONS}") from None
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


def _max_steps(given: Any, default: int, legs: int) -> int:
    most = MOST_STEPS // legs
    if given is None:
        return min(default, most)
    given = whole_number("max_steps", given, 1)
    if given > most:
        raise BadInputError(
            f"max_steps: got {given} for cruises of {legs} stations; wanted at most {most}"
        )
    return given


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


def _rates(flip_rate: Any, count: int) -> np.ndarray:
    """Probabilities as multiples of 2^-BITS, int32[B]."""
    if isinstance(flip_rate, np.ndarray | list | tuple | jax.Array) and np.ndim(flip_rate) == 1:
        values = np.array([fraction(f"flip_rate[{i}]", v) for i, v in enumerate(flip_rate)])
        if len(values) != count:
            raise BadInputError(f"flip_rate: got {len(values)} numbers; wanted one, or {count}")
    else:
        values = np.full(count, fraction("flip_rate", flip_rate))
    return np.round(values * 2**BITS).astype(np.int32)


def _cell_size(blocked: Any, cell_size: Any) -> float:
    if isinstance(blocked, GridMap):
        if cell_size is not None:
            raise BadInputError(f"cell_size: got {cell_size!r} with a GridMap, which has its own")
        return blocked.cell_size
    return CELL_SIZE if cell_size is None else positive("cell_size", cell_size)
