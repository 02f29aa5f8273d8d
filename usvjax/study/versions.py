"""What a run was made with: versions, device, and the very code."""

import hashlib
import platform
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import jax

import usvjax
import usvkernels

COMPARED = {
    "usvjax": "usvjax version",
    "code": "usvjax code",
    "jax": "jax version",
    "jaxlib": "jaxlib version",
    "device": "device kind",
    "x64": "64-bit mode",
}
"""Entries of `environment` that decide results, with words for them; runs may not mix them."""


def environment() -> dict[str, Any]:
    """Versions and device, for a manifest.

    Returns:
        JSON-able entries; those in `COMPARED` must be equal for a run to be continued.
    """
    device = jax.local_devices()[0]
    packages = ("jax", "jaxlib", "numpy", "scipy", "polars")
    return {
        "usvjax": usvjax.__version__,
        "code": code_digest(),
        "python": platform.python_version(),
        **{name: version(name) for name in packages},
        "device": f"{device.platform} {device.device_kind}",
        "x64": bool(jax.config.read("jax_enable_x64")),
    }


@cache
def code_digest() -> str:
    """Digest of the code that produces results: kernels, and usvjax without plots and commands.

    A source checkout changes without its version changing; this keeps a study from being
    continued by code other than its own.
    """
    digest = hashlib.sha256()
    for package in (usvkernels, usvjax):
        root = Path(str(package.__file__)).parent
        for path in sorted(root.rglob("*.py")):
            inner = path.relative_to(root).parts
            if inner[0] not in ("plots", "cli"):
                digest.update("/".join(inner).encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]
