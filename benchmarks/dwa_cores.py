"""All cores against one: usvjax in a process bound to one core, and in one that has them all."""

from functools import cache, partial
from typing import Any

from benchmarks.markdown import table, verdict
from benchmarks.processes import FreshProcess
from benchmarks.timing import in_turns, spread
from benchmarks.workloads import Workload, fixed_length, heavy_tailed

TITLE = "all cores against one"
WORKLOADS = ("fixed length", "heavy-tailed")
BAR = 0.85  # of the number of cores: 1.7x on two


def measure(quick: bool) -> dict[str, Any]:
    """Time the same episodes in both processes in turns."""
    episodes = 64 if quick else 4096
    found: dict[str, Any] = {"episodes": episodes}
    with FreshProcess(cores=1) as one, FreshProcess() as every:
        found["devices"] = every.call(devices)
        if one.call(devices) != 1:
            raise RuntimeError("the process bound to one core has more than one device")
        for name in WORKLOADS:
            timed = in_turns(
                {
                    "one core": partial(one.call, sail, name, episodes),
                    "all cores": partial(every.call, sail, name, episodes),
                }
            )
            decisions = every.call(sail, name, episodes)
            for times in timed.values():
                times["decisions_per_second"] = decisions / times["median"]
            found[name] = timed
    return found


def devices() -> int:
    """How many devices JAX has in this process."""
    import jax

    import usvjax  # noqa: F401, gives JAX a device per core

    return len(jax.devices())


def sail(name: str, episodes: int) -> int:
    """Run a workload once and return how many decisions were made."""
    return int(_workload(name, episodes).sail().steps.sum())


@cache
def _workload(name: str, episodes: int) -> Workload:
    if name == "fixed length":
        return fixed_length(episodes, ("traditional",))
    return heavy_tailed(episodes)


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    rows, verdicts = [], []
    for name in WORKLOADS:
        rate = {cores: times["decisions_per_second"] for cores, times in found[name].items()}
        gain = rate["all cores"] / rate["one core"]
        timings = "; ".join(spread(times["seconds"]) for times in found[name].values())
        rows.append((name, *(f"{r:,.0f}" for r in rate.values()), f"{gain:.2f}", timings))
        bar = BAR * found["devices"]
        verdicts.append(verdict(f"{name}: {gain:.2f}x, at least {bar:.1f}x", gain >= bar))
    header = ("episodes", "decisions/s, 1 core", f"{found['devices']} cores", "gain", "timings")
    return (
        f"{found['episodes']:,} episodes through `navigate_dwa`; one process is bound to one core "
        f"and has one device, the other has {found['devices']}.\n\n"
        + table(header, rows)
        + "\n\n"
        + "\n".join(verdicts)
    )
