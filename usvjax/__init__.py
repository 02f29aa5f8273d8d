"""usvjax: thousands of USV planning and navigation episodes at once, in JAX.

Importing it before the first use of JAX gives JAX one host device per core. What it exports is
loaded on first use, so that the command line starts quickly.
"""

import importlib
from typing import TYPE_CHECKING, Any

from usvjax.devices import use_all_cores

if TYPE_CHECKING:
    from usvjax.errors import BadInputError, BadTypeError
    from usvjax.maps import (
        GridMap,
        expand_obstacles,
        hongze_lake,
        load_map,
        obstacle_table,
        random_maps,
        save_map,
    )
    from usvjax.navigate import DwaCandidates, NavigateResult, dwa_candidates, navigate_dwa
    from usvjax.presets import PRESETS, DwaPreset, fit_window, preset
    from usvjax.study import load_run, run_study
    from usvkernels.dwa import DwaParams, DwaStatic
    from usvkernels.status import Status

__version__ = "0.1.0"

__all__ = [
    "PRESETS",
    "BadInputError",
    "BadTypeError",
    "DwaCandidates",
    "DwaParams",
    "DwaPreset",
    "DwaStatic",
    "GridMap",
    "NavigateResult",
    "Status",
    "dwa_candidates",
    "expand_obstacles",
    "fit_window",
    "hongze_lake",
    "load_map",
    "load_run",
    "navigate_dwa",
    "obstacle_table",
    "preset",
    "random_maps",
    "run_study",
    "save_map",
    "use_all_cores",
]

_HOME = {
    "usvjax.errors": ("BadInputError", "BadTypeError"),
    "usvjax.maps": (
        "GridMap",
        "expand_obstacles",
        "hongze_lake",
        "load_map",
        "obstacle_table",
        "random_maps",
        "save_map",
    ),
    "usvjax.navigate": ("DwaCandidates", "NavigateResult", "dwa_candidates", "navigate_dwa"),
    "usvjax.presets": ("PRESETS", "DwaPreset", "fit_window", "preset"),
    "usvjax.study": ("load_run", "run_study"),
    "usvkernels.dwa": ("DwaParams", "DwaStatic"),
    "usvkernels.status": ("Status",),
}

use_all_cores()


def __getattr__(name: str) -> Any:
    for module, names in _HOME.items():
        if name in names:
            value = getattr(importlib.import_module(module), name)
            globals()[name] = value
            return value
    raise AttributeError(f"module 'usvjax' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
