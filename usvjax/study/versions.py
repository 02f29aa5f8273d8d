"""What a run was made with: versions, device, and the very code."""

import os
import platform
from importlib.metadata import version
from pathlib import Path
from typing import Any

import jax

from usvjax.devices import local_devices
from usvjax.version import __version__

COMPARED = {
    "usvjax": "usvjax version",
    "code": "code",
    "jax": "jax version",
    "jaxlib": "jaxlib version",
    "device": "device kind",
    "xla_flags": "XLA_FLAGS",
    "jax_settings": "settings of JAX",
}
"""Entries of `environment` that decide results, with words for them; runs may not mix them."""

_DECIDING = (
    "jax_disable_most_optimizations",
    "jax_exec_time_optimization_effort",
    "jax_memory_fitting_effort",
    "jax_memory_fitting_level",
    "jax_optimization_level",
)
"""Settings of JAX that how it compiles depends on; those in `usvjax.ambient` need no record."""

_IDLE_FLAGS = ("xla_force_host_platform_device_count", "xla_dump_", "xla_log_", "xla_hlo_profile")
"""Beginnings of flags that decide no result: how many devices there are, and what is told."""


def environment(code: str) -> dict[str, Any]:
    """Versions and device, for a manifest.

    Args:
        code: digest of the code that decides the results; see `usvjax.study.code`.

    Returns:
        JSON-able entries; those in `COMPARED` must be equal for a run to be continued.
    """
    device = local_devices()[0]
    packages = ("jax", "jaxlib", "numpy", "scipy", "polars")
    return {
        "usvjax": __version__,
        "code": code,
        "python": platform.python_version(),
        **{name: version(name) for name in packages},
        "device": f"{device.platform} {device.device_kind}",
        "xla_flags": xla_flags(os.environ.get("XLA_FLAGS", "")),
        "jax_settings": _settings(),
    }


def _settings() -> str:
    """Those of JAX that decide, as "name=value ..."; without those that this JAX lacks."""
    values = {name: jax.config.values.get(name) for name in _DECIDING}
    return " ".join(f"{name}={value}" for name, value in values.items() if value is not None)


def xla_flags(text: str) -> str:
    """The flags of XLA_FLAGS that may decide results, by name; of several of a name the last."""
    if text and not text.lstrip().startswith("-"):
        text = _content(text)
    flags = {word.lstrip("-").partition("=")[0]: word for word in text.split()}
    return " ".join(flags[name] for name in sorted(flags) if not name.startswith(_IDLE_FLAGS))


def _content(name: str) -> str:
    """What a file of flags holds, which XLA_FLAGS may name instead."""
    try:
        return Path(name).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return name
