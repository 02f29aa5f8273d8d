"""Zhang et al. 2019: Figs. 9 and 10, Tables 3 and 4, then the same on thousands of maps.

Run it with ``usvjax reproduce zhang2019`` or ``python -m experiments.zhang2019``; ``--help``
lists the options.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import monotonic
from typing import Annotated, Any

import numpy as np
import tyro

import usvjax as uj
from experiments.files import progress
from experiments.program import begin, conclude
from experiments.zhang2019.compare import (
    against,
    excess,
    nearest,
    on_maps_alike,
    slowdown,
    spread_of_all,
)
from experiments.zhang2019.figures import draw as draw_figures
from experiments.zhang2019.published import TRADITIONAL, arithmetic, steps_of
from experiments.zhang2019.report import markdown
from experiments.zhang2019.runs import (
    BATCHED,
    DENSITIES,
    EXACT_DIAGONAL,
    SHOWN_DENSITY,
    TIMED,
    Batch,
    Paths,
    Plan,
    Textbook,
    batched,
    draw,
    sizes,
    textbook_runs,
    timed,
)
from experiments.zhang2019.verdicts import judge
from usvjax.errors import BadInputError

QUICK = Plan(maps=400, textbook_maps=150, size_maps=15, repeats=2)


@dataclass(frozen=True)
class Options:
    """Regenerate the tables and figures of Zhang et al. 2019 beside the published values.

    Attributes:
        quick: A look in half a minute, on few maps.
        out: Folder for README.md, results.json and figures/. By default the checkout's
            experiments/results/zhang2019, or runs/zhang2019_quick with --quick or --maps.
        maps: Random maps per density; 10,000, or 400 with --quick.
    """

    quick: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    out: Annotated[Path | None, tyro.conf.arg(metavar="FOLDER")] = None
    maps: Annotated[int | None, tyro.conf.arg(metavar="N")] = None


def main(argv: Sequence[str] | None = None) -> int:
    """Run the experiments.

    Args:
        argv: options; those of the process when None.

    Returns:
        The exit code: 2, after one line on stderr, for a user's mistake.
    """
    ready = begin("zhang2019", Options, argv, _plan)
    if ready is None:
        return 2
    _, plan, folder = ready
    begun = monotonic()
    grids = draw(plan)
    with progress("batches", len(DENSITIES) * (len(BATCHED) + 1)) as advance:
        batches = batched(grids, advance)
        seconds = timed(grids[SHOWN_DENSITY], plan.repeats)
        books = textbook_runs(grids, plan.textbook_maps, advance)
    old = batches["traditional"][SHOWN_DENSITY].paths
    job = nearest(old)
    found: dict[str, Any] = {
        "format": 1,
        "settings": {"usvjax": uj.__version__, **asdict(plan)},
        "batched": _batched(batches, seconds),
        "textbook": _textbook(books),
        "shown": _shown(batches, job),
        "sizes": [asdict(row) for row in sizes(plan)],
        "steps": [{**asdict(row), "side": row.side} for row in steps_of(TRADITIONAL.length)],
        "arithmetic": [asdict(check) for check in arithmetic()],
    }
    verdicts = judge(found)
    found["verdicts"] = [asdict(verdict) for verdict in verdicts]
    took = monotonic() - begun
    conclude(
        folder,
        found,
        markdown(found),
        lambda into: draw_figures(grids[SHOWN_DENSITY][job], job, batches, into),
        ("Zhang et al. 2019", verdicts),
        f"{plan.maps:,} maps per density in {took:,.0f} s",
    )
    return 0


def _plan(options: Options) -> Plan:
    """Turn options into a plan.

    Raises:
        BadInputError: fewer than one map.
    """
    base = QUICK if options.quick else Plan()
    if options.maps is None:
        return base
    if options.maps < 1:
        raise BadInputError(f"--maps: got {options.maps}; wanted at least 1 map per density")
    few = min(base.textbook_maps, options.maps)
    return Plan(base.seed, options.maps, few, base.size_maps, base.repeats)


def _batched(
    batches: Mapping[str, Mapping[float, Batch]], seconds: Mapping[str, list[float]]
) -> dict[str, Any]:
    """Everything about the batched search."""
    paths = {
        str(density): {method: found[density].paths for method, found in batches.items()}
        for density in DENSITIES
    }
    table = _compared(paths)
    table["excess"] = {
        density: {method: excess(own, methods["exact"]) for method, own in methods.items()}
        for density, methods in paths.items()
    }
    table["time"] = {m: slowdown(seconds[m], seconds["traditional"]) for m in TIMED}
    return table


def _textbook(books: Mapping[float, Textbook]) -> dict[str, Any]:
    """Everything about the textbook program."""
    table = _compared({str(density): book.paths for density, book in books.items()})
    book = books[SHOWN_DENSITY]
    count = len(book.paths["traditional"].found)
    each = {label: [total / count] for label, total in book.seconds.items()}
    table["time"] = {
        label: slowdown(each[label], each["traditional"])
        for label in ("traditional", "ties only", "printed", "accumulated")
    }
    return table


def _compared(paths: Mapping[str, Mapping[str, Paths]]) -> dict[str, Any]:
    """Compare every method with the traditional one; density to method to paths."""
    shown = paths[str(SHOWN_DENSITY)]
    others = [method for method in shown if method != "traditional"]
    return {
        "traditional": spread_of_all(shown["traditional"]),
        "alike": {m: on_maps_alike(shown[m], shown["traditional"]) for m in others},
        "against": {
            density: {m: against(own[m], own["traditional"]) for m in others}
            for density, own in paths.items()
        },
    }


def _shown(batches: Mapping[str, Mapping[float, Batch]], job: int) -> dict[str, Any]:
    """The paths on the map that is shown."""
    table = {}
    for method, found in batches.items():
        own = found[SHOWN_DENSITY].paths.some(np.array([job]))
        table[method] = {
            "total": float(own.total()[0]),
            "turning": float(own.turning[0]),
            "length": float(own.length()[0]),
            "total_sqrt2": float(own.total(EXACT_DIAGONAL)[0]),
            "expanded": int(own.expanded[0]),
        }
    return {"map": job, "paths": table}


if __name__ == "__main__":
    from usvjax.devices import use_compilation_cache

    use_compilation_cache()
    sys.exit(main())
