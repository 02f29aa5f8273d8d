"""What a run was made with: versions, device, and the very code."""

import platform
from importlib.metadata import version
from typing import Any

import jax

from usvjax.version import __version__

COMPARED = {
    "usvjax": "usvjax version",
    "code": "code",
    "jax": "jax version",
    "jaxlib": "jaxlib version",
    "device": "device kind",
}
"""Entries of `environment` that decide results, with words for them; runs may not mix them."""


def environment(code: str) -> dict[str, Any]:
    """Versions and device, for a manifest.

    Args:
        code: digest of the code that decides the results; see `usvjax.study.code`.

    Returns:
        JSON-able entries; those in `COMPARED` must be equal for a run to be continued.
    """
    device = jax.local_devices()[0]
    packages = ("jax", "jaxlib", "numpy", "scipy", "polars")
    return {
        "usvjax": __version__,
        "code": code,
        "python": platform.python_version(),
        **{name: version(name) for name in packages},
        "device": f"{device.platform} {device.device_kind}",
    }
