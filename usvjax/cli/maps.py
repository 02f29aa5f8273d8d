"""``usvjax maps``: list, show, convert and draw maps."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import tyro
from rich.text import Text

from usvjax.cli.console import console, room, show, show_line
from usvjax.cli.figures import Dpi
from usvjax.maps import GridMap, find_map, load_map, packaged_names, save_map
from usvjax.maps.hongze import is_packaged_name
from usvjax.pictures import DPI, check_dpi, check_suffix
from usvjax.report.sheets import Sheet

MapName = Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="MAP")]
InFile = Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="IN")]
OutFile = Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="OUT")]
CellSize = Annotated[float | None, tyro.conf.arg(metavar="METRES")]
AsJson = Annotated[bool, tyro.conf.FlagCreatePairsOff, tyro.conf.arg(name="json")]
Force = Annotated[bool, tyro.conf.FlagCreatePairsOff]

# Rows of a terminal that the table and the prompt take beside the sketch.
_OTHER_ROWS = 9
_COLUMNS_IN_A_PIPE, _ROWS_IN_A_PIPE = 80, 40
_IMAGES = (".png", ".pgm")


def list_maps(as_json: AsJson = False) -> None:
    """List the packaged maps.

    Example: usvjax maps list

    Args:
        as_json: Print JSON for scripts.
    """
    rows = [{"map": name, **_summary(find_map(name))} for name in packaged_names()]
    if as_json:
        print(json.dumps(rows, indent=2))
        return
    cells = [
        (
            row["map"],
            row["name"],
            f"{row['width']} x {row['height']}",
            f"{row['cell_size_m']:g} m",
            f"{row['free_share']:.1%}",
        )
        for row in rows
    ]
    table = Sheet("", ("map", "what", "cells", "cell size", "free"), cells, words=2)
    show(table, "hongze-125, hongze-50, ... are interpolated from hongze-250.")


def show_map(map_name: MapName, cell_size: CellSize = None, as_json: AsJson = False) -> None:
    """Describe a map and sketch it in the terminal, north up.

    Example: usvjax maps show hongze-1000

    Args:
        map_name: A packaged map such as hongze-250, or a map file.
        cell_size: Edge of a cell, m; needed for a plain image.
        as_json: Print JSON for scripts, without the sketch.
    """
    grid = find_map(map_name, cell_size=cell_size)
    summary = _summary(grid)
    if as_json:
        print(json.dumps(summary, indent=2))
        return
    show(Sheet("", (), _described(summary), words=2))
    out = console()
    rows = max(out.height - _OTHER_ROWS, 8) if out.is_terminal else _ROWS_IN_A_PIPE
    out.print(sketch(grid.blocked, room() or _COLUMNS_IN_A_PIPE, rows))


def convert_map(
    source: InFile,
    out: OutFile,
    cell_size: CellSize = None,
    unknown: Literal["blocked", "free"] = "blocked",
    threshold: float = 0.5,
    force: Force = False,
) -> None:
    """Convert a map to another format; the suffix of OUT (.map, .yaml, .png, .pgm) chooses it.

    Example: usvjax maps convert hongze-250 lake.yaml

    Args:
        source: A packaged map such as hongze-250, or a map file.
        out: The file to write.
        cell_size: Edge of a cell, m; needed for a plain image, otherwise overrides the file's.
        unknown: What the unknown cells of a ROS map become.
        threshold: Brightness, 0 to 1, below which a pixel of a plain image is blocked.
        force: Replace files that exist; a .json or .pgm that is not OUT's own is spared.
    """
    # A name such as hongze-62.5 seems to have a suffix.
    if Path(source).suffix and not is_packaged_name(source):
        grid = load_map(source, cell_size=cell_size, unknown=unknown, threshold=threshold)
    else:
        grid = find_map(source, cell_size=cell_size)
    written = save_map(grid, out, replace=force)
    show_line(f"wrote {', '.join(str(path) for path in written)}")
    if out.suffix.lower() in _IMAGES:
        show(f"an image holds no scale: load it with --cell-size {grid.cell_size:g}")


def draw_map(map_name: MapName, out: OutFile, cell_size: CellSize = None, dpi: Dpi = DPI) -> None:
    """Draw a map as a figure (.png, .pdf or .svg) with axes, scale and source.

    Example: usvjax maps draw hongze-250 lake.png

    Args:
        map_name: A packaged map such as hongze-250, or a map file.
        out: The figure to write.
        cell_size: Edge of a cell, m; needed for a plain image.
        dpi: Dots per inch of a PNG, 20 to 1200.
    """
    from usvjax.plots import style
    from usvjax.plots.map_sheet import plot_map

    check_suffix(out)
    check_dpi("--dpi", dpi)
    figure = plot_map(find_map(map_name, cell_size=cell_size))
    written = style.save(figure, out, dpi=dpi)
    show_line(f"wrote {written}")


MAPS_COMMANDS: dict[str, Callable[..., None]] = {
    "list": list_maps,
    "show": show_map,
    "convert": convert_map,
    "draw": draw_map,
}


def sketch(blocked: np.ndarray, columns: int, rows: int) -> Text:
    """Sketch a map in half blocks, north up; land is drawn, water left blue or empty.

    Args:
        blocked: bool[H, W].
        columns: Characters across that may be used; each shows two samples, one above the other.
        rows: Lines that may be used.

    Returns:
        One line per two samples; a sample is land if at least half of its cells are blocked.
    """
    height, width = blocked.shape
    scale = max(width / columns, height / (2 * rows), 1.0)
    land = _shrink(_shrink(blocked.astype(float), scale).T, scale).T >= 0.5
    if land.shape[0] % 2:
        land = np.pad(land, ((1, 0), (0, 0)), mode="edge")
    north_up = land[::-1]
    marks = np.array(list(" ▄▀█"))[2 * north_up[::2] + north_up[1::2]]
    text = "\n".join("".join(line) for line in marks)
    return Text(text, style="wheat1 on dodger_blue3", no_wrap=True, end="\n")


def _shrink(values: np.ndarray, scale: float) -> np.ndarray:
    """Average groups of about ``scale`` rows."""
    count = values.shape[0]
    starts = np.unique((np.arange(int(np.ceil(count / scale))) * scale).astype(int))
    sizes = np.diff(np.append(starts, count))
    return np.add.reduceat(values, starts, axis=0) / sizes[:, None]


def _summary(grid: GridMap) -> dict[str, Any]:
    height, width = grid.shape
    bodies = grid.components()
    free = int((~grid.blocked).sum())
    return {
        "name": grid.name,
        "width": width,
        "height": height,
        "cell_size_m": grid.cell_size,
        "origin_m": list(grid.origin),
        "free_share": grid.free_share,
        "free_area_m2": free * grid.cell_size**2,
        "water_bodies": int(bodies.max()),
        "largest_body_share": float((bodies == 1).sum() / free) if free else 0.0,
        "attribution": grid.attribution,
    }


def _described(summary: dict[str, Any]) -> list[tuple[str, str]]:
    size = summary["cell_size_m"]
    width, height = (summary[side] * size for side in ("width", "height"))
    x, y = summary["origin_m"]
    return [
        ("map", summary["name"]),
        ("cells", f"{summary['width']} x {summary['height']} of {size:g} m"),
        ("size", f"{_length(width)} x {_length(height)}, south-west corner ({x:g}, {y:g}) m"),
        ("free", f"{summary['free_share']:.1%}, {_area(summary['free_area_m2'])}"),
        ("connected", _bodies(summary)),
        *([("source", summary["attribution"])] if summary["attribution"] else []),
    ]


def _bodies(summary: dict[str, Any]) -> str:
    count = summary["water_bodies"]
    if count < 2:
        return "all of the free cells" if count else "no free cell"
    return f"{count} bodies, the largest {summary['largest_body_share']:.1%} of the free cells"


def _length(metres: float) -> str:
    return f"{metres / 1000:g} km" if metres >= 5000 else f"{metres:g} m"


def _area(square_metres: float) -> str:
    in_km = square_metres / 1e6
    return f"{in_km:,.1f} km2" if in_km >= 1 else f"{square_metres:,.0f} m2"
