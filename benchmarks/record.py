"""The result page RESULTS.md and the raw numbers beside it."""

import importlib
import json
import os
import platform
import time
from datetime import date
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import usvjax  # noqa: F401, before anything starts JAX: gives it a device per core

HERE = Path(__file__).parent
PACKAGES = ("usvjax", "jax", "jaxlib", "numpy", "numba", "polars")

_INTRODUCTION = """# Results

Written by `python -m benchmarks` (`make bench`); the raw numbers are in `results/`. Timings are
medians of contestants that took turns, compile time apart."""


def run(name: str, quick: bool) -> dict[str, Any]:
    """Run one benchmark in this process.

    Args:
        name: its module in this package.
        quick: tiny sizes, to see that it works; the numbers mean nothing.

    Returns:
        "name", "section" (Markdown), "found" (raw numbers), "seconds", "load", "quick".
    """
    module = importlib.import_module(f"benchmarks.{name}")
    load, began = os.getloadavg()[0], time.perf_counter()
    found = module.measure(quick)
    seconds = round(time.perf_counter() - began, 1)
    note = f"{date.today()}, {seconds:.0f} s on {_devices()}, load average {load:.1f} before it."
    section = f"## {name}: {module.TITLE}\n\n{module.report(found)}\n\n{note}\n"
    found = {"name": name, "section": section, "found": found, "seconds": seconds, "load": load}
    return found | {"quick": quick}


def write(result: dict[str, Any], order: tuple[str, ...], folder: Path = HERE) -> Path:
    """Put one benchmark's section in RESULTS.md, in place of its last, and its numbers beside.

    Args:
        result: of `run`.
        order: all benchmarks, in the order of the page.
        folder: of the page. A page from another machine or other versions is begun anew.

    Returns:
        The page.
    """
    page = folder / "RESULTS.md"
    header = f"{_INTRODUCTION}\n\n{machine()}\n"
    old = page.read_text(encoding="utf-8") if page.exists() else ""
    sections = _sections(old) if old.startswith(header) else {}
    sections[result["name"]] = result["section"]
    kept = [sections[name] for name in order if name in sections]
    raw = {"machine": machine().splitlines(), **result}
    del raw["section"]
    (folder / "results").mkdir(parents=True, exist_ok=True)
    (folder / "results" / f"{result['name']}.json").write_text(
        json.dumps(raw, indent=1) + "\n", encoding="utf-8"
    )
    page.write_text("\n".join([header, *kept]), encoding="utf-8")
    return page


def _sections(page: str) -> dict[str, str]:
    parts = page.split("\n## ")[1:]
    return {part.partition(":")[0]: f"## {part.rstrip()}\n" for part in parts}


def machine() -> str:
    """What the results were measured on, as Markdown lines."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    versions = ", ".join(f"{name} {_version(name)}" for name in PACKAGES)
    return "\n".join(
        [
            f"- Machine: {_processor()}, {cores} cores, {memory:.0f} GiB",
            f"- System: {_system()}, {platform.machine()}",
            f"- Software: Python {platform.python_version()}, {versions}",
        ]
    )


def _devices() -> str:
    """What JAX computes on, as "2 cpu devices"."""
    import jax

    found = jax.devices()
    return f"{len(found)} {found[0].device_kind} device{'s' if len(found) > 1 else ''}"


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "absent"


def _system() -> str:
    try:
        return platform.freedesktop_os_release()["PRETTY_NAME"]
    except (OSError, KeyError):
        return f"{platform.system()} {platform.release()}"


def _processor() -> str:
    """The processor's model, family and model number included where the name says little."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").partition("\n\n")[0].splitlines()
        facts = {k.strip(): v.strip() for k, _, v in (line.partition(":") for line in lines)}
        numbers = f"family {facts['cpu family']} model {facts['model']}"
        widest = "AVX-512" if "avx512f" in facts["flags"] else "no AVX-512"
        return f"{facts['model name']} ({numbers}, {widest})"
    except (OSError, KeyError):
        return platform.processor() or platform.machine()
