"""Encounters drawn: Figs. 13 to 18 on layouts of ours, and where each strategy begins to fail."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import usvjax.missions.fleet.looks  # noqa: F401
from experiments.claims import Numbers
from experiments.paper import Drawing
from experiments.runs import Found
from experiments.wei2023.bars import draw_bars
from experiments.wei2023.encounters.report import WORDS
from experiments.wei2023.encounters.runs import DUEL_SCENES, FIGURES, label, reading
from usvjax.missions.fleet.figures import plot_fleets
from usvjax.missions.fleet.params import STRATEGIES
from usvjax.plots import style

SHOWN = reading("first", 0.5)
"""The reading of the figures that draw an encounter, the default of the library."""
HULL, JOB = "hulls 50 m", 0


def figures(found: Found, numbers: Numbers) -> Iterator[Drawing]:
    """Draw them all."""
    for kind, (before, after) in FIGURES.items():
        scene = next(name for name in DUEL_SCENES if name.startswith(f"{kind}, {HULL}, 10"))
        drawn = {
            "none": found.studies["duels"].replay(scene, "none", [JOB]),
            "wei2023": found.studies["readings"].replay(label(scene, SHOWN), "wei2023", [JOB]),
        }
        drawn |= {n: found.studies["duels"].replay(scene, n, [JOB]) for n in ("rules", "orca")}
        yield Drawing(
            f"duel_{kind.replace('-', '_')}",
            f"As {before} and {after}, on a layout of ours ({scene}, encounter {JOB}), by every "
            f"strategy; Wei & Zhang: {SHOWN}.",
            plot_fleets(drawn, f"{scene}, encounter {JOB}"),
        )
    first = next(iter(numbers["sights"].values()))
    yield Drawing(
        "closer_sights",
        f"Share of {first['none']['n']:,} random encounters that collides, by the least time from "
        "first sight to the closest point; bars are Wilson's intervals.",
        sights_figure(numbers["sights"]),
    )
    each = next(iter(numbers["kinds"].values()))["none"]["n"]
    yield Drawing(
        "encounter_kinds",
        f"{each:,} random encounters of each type: the share that collides, and what those that "
        "arrive take beyond sailing alone; bars are 95 % intervals.",
        kinds_figure(numbers["kinds"]),
    )


@style.styled
def sights_figure(sights: Mapping[str, Any]) -> Figure:
    """Where each strategy begins to fail."""
    fig = style.new_figure(style.DOUBLE_MM, 85)
    ax = fig.subplots()
    looks = style.method_looks(STRATEGIES)
    at = np.array([float(least.split()[0]) for least in sights])
    for k, (name, look) in enumerate(looks.items()):
        collided = [own[name]["collided"] for own in sights.values()]
        # Side by side, that intervals do not hide each other.
        draw_bars(ax, at * 1.03 ** (k - 1.5), collided, look, 100.0)
    ax.set_xscale("log")
    ax.set_xticks(at, [f"{one:g}" for one in at])
    ax.minorticks_off()
    ax.set(
        xlabel="least time from first sight to the closest point (s)",
        ylabel="collided (%)",
        ylim=(-1.0, None),
    )
    handles = [style.method_handle(look, WORDS[name]) for name, look in looks.items()]
    style.outside_legend(fig, handles, columns=4)
    return style.settle(fig)


@style.styled
def kinds_figure(kinds: Mapping[str, Any]) -> Figure:
    """Collisions, extra distance and delay by type and strategy."""
    fig = style.new_figure(style.DOUBLE_MM, 75)
    looks = style.method_looks(STRATEGIES)
    panels = (
        ("collided", "collided (%)", 100.0),
        ("extra_distance", "extra distance (%)", 1.0),
        ("delay", "delay (s)", 1.0),
    )
    at = np.arange(len(kinds))
    for ax, (measure, words, scale) in zip(fig.subplots(1, 3), panels, strict=True):
        for k, (name, look) in enumerate(looks.items()):
            found = [own[name][measure] for own in kinds.values()]
            draw_bars(ax, at + 0.15 * (k - 1.5), found, look, scale, joined=False)
        ax.set_xticks(at, list(kinds))
        ax.set(ylabel=words, xlim=(-0.5, len(kinds) - 0.5))
    handles = [style.method_handle(look, WORDS[name], joined=False) for name, look in looks.items()]
    style.outside_legend(fig, handles, columns=4)
    return style.settle(fig)
