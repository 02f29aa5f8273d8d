"""Reciprocal velocities: agent-steps per second against the C++ library RVO2.

RVO2 comes by its Python package pyrvo, which asks for a simulator that nobody needs here: install
it without its dependencies (`pip install --no-deps pyrvo`), in this environment or in another, of
which the environment variable RVO_PYTHON then names the interpreter.
"""

import os
import statistics
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.markdown import table, verdict
from benchmarks.peers import orca_rvo
from benchmarks.peers.orca_rvo import Crowd
from benchmarks.processes import FreshProcess
from benchmarks.timing import seconds_of, spread
from usvjax.devices import COMPILER_OPTIONS, ONE_THREAD, chosen_devices, usable_cores
from usvkernels.fleet import orca
from usvkernels.fleet.params import Encounters
from usvkernels.fleet.sight import Obstacles, Vessels

TITLE = "Reciprocal velocities, agent-steps per second"

OPTIONS = COMPILER_OPTIONS | ONE_THREAD
CROWD = Crowd()
RING = 1500.0  # m, radius of the ring that fleets cross
SIZES = (10, 20)
AGENTS_AT_ONCE = 256
"""Of a call; more fleets go one batch after the other."""
STEPS = 200
SITUATIONS = 2000
REPETITIONS = 5
LEAST = 1.0
EQUAL = 1e-3
"""m/s by which velocities may differ that single precision finds by other sums."""


def measure(quick: bool) -> dict[str, Any]:
    """Time both in turns on all cores, and compare the velocities that they choose."""
    with _peers() as peers:
        return {str(n): _size(n, peers, quick) for n in SIZES}


@contextmanager
def _peers() -> Iterator[list[FreshProcess]]:
    """A process per core in which pyrvo works; none where it is not installed."""
    python = os.environ.get("RVO_PYTHON", sys.executable)
    with ExitStack() as stack:
        found = [stack.enter_context(FreshProcess(python=python)) for _ in range(usable_cores())]
        yield found if all(process.call(orca_rvo.available) for process in found) else []


def _size(n: int, peers: list[FreshProcess], quick: bool) -> dict[str, Any]:
    rng = np.random.default_rng(n)
    devices = chosen_devices()
    fleets, steps = AGENTS_AT_ONCE // n, 10 if quick else STEPS
    places, wanted = ring(rng, fleets * len(devices), n)
    ours: list[float] = []
    theirs: list[float] = []
    first = seconds_of(partial(_ours, places, wanted, steps))
    for _ in range(1 if quick else REPETITIONS):
        ours.append(seconds_of(partial(_ours, places, wanted, steps)))
        if peers:
            theirs.append(_theirs(peers, places, wanted, steps))
    agents = places.shape[0] * n * steps
    found = {"agent_steps": agents, "first": first, "ours": ours, "theirs": theirs}
    return found | (_compared(n, rng, peers[0], 50 if quick else SITUATIONS) if peers else {})


def ring(rng: np.random.Generator, fleets: int, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Fleets on a ring, each agent on its way to the other side; m, m/s, float64[fleets, n, 2]."""
    angle = 2 * np.pi * (np.arange(n) + rng.uniform(-0.2, 0.2, (fleets, n))) / n
    out = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return RING * out, -CROWD.speed * out


def _ours(places: np.ndarray, wanted: np.ndarray, steps: int) -> None:
    """Fleets step by step, a share on each device."""
    devices = chosen_devices()
    pairs = _shares(places, wanted, len(devices))
    begun = [
        _sail(*(jax.device_put(_lanes_last(part), device) for part in pair), np.int32(steps))
        for pair, device in zip(pairs, devices, strict=True)
    ]
    jax.block_until_ready(begun)


def _shares(places: np.ndarray, wanted: np.ndarray, count: int) -> list[tuple[np.ndarray, ...]]:
    parts = np.array_split(places, count), np.array_split(wanted, count)
    return list(zip(*parts, strict=True))


def _lanes_last(part: np.ndarray) -> np.ndarray:
    """[fleets, n, 2] as float32[2, n, fleets]."""
    return np.ascontiguousarray(part.T.astype(np.float32))


@partial(jax.jit, compiler_options=OPTIONS)
def _sail(place: jax.Array, wanted: jax.Array, steps: jax.Array) -> jax.Array:
    def step(_: jax.Array, carry: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        place, velocity = carry
        velocity = _choose(place, velocity, wanted)
        return place + velocity * CROWD.dt, velocity

    return jax.lax.fori_loop(0, steps, step, (place, jnp.zeros_like(place)))[0]


def _choose(place: jax.Array, velocity: jax.Array, wanted: jax.Array) -> jax.Array:
    """The velocities that agents take, float[2, n, lanes], in open water."""
    c = CROWD
    how = Encounters(0.0, 0.0, c.horizon, 0.0, strategy="orca", equal="first", ring="all_yield")
    still = jnp.zeros_like(place[0])
    everyone = jnp.ones(still.shape, bool)
    course = wanted / c.speed
    vessels = Vessels(
        place=(place[0], place[1]),
        bow=(course[0], course[1]),
        velocity=(velocity[0], velocity[1]),
        drift=None,
        course=(course[0], course[1]),
        guide=(still, still),
        led=~everyone,
        goal=(still, still),
        speed=still + c.speed,
        made_good=still + c.speed,
        hull=still + c.radius,
        arrival=still,
        under_way=everyone,
        present=everyone,
    )
    none = Obstacles(jnp.zeros((2, 0, 1, place.shape[2]), place.dtype), None)
    return jnp.stack(orca.meet(how, vessels, none, still + c.radius, c.dt))


def _theirs(peers: list[FreshProcess], places: np.ndarray, wanted: np.ndarray, steps: int) -> float:
    """As `_ours`, a share in each process; seconds of the slowest."""
    shares = _shares(places, wanted, len(peers))

    def run(pair: tuple[FreshProcess, tuple[np.ndarray, np.ndarray]]) -> float:
        process, share = pair
        return process.call(orca_rvo.seconds, CROWD, *share, steps)

    with ThreadPoolExecutor(len(peers)) as pool:
        return max(pool.map(run, zip(peers, shares, strict=True)))


def _compared(n: int, rng: np.random.Generator, peer: FreshProcess, count: int) -> dict[str, Any]:
    """How far apart the velocities are that both choose in random situations (m/s)."""
    places = _apart(rng, count, n)
    angle = rng.uniform(-np.pi, np.pi, (2, count, n))
    aims = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    now = CROWD.speed * aims[0] * rng.uniform(0.0, 1.0, (count, n, 1))
    wanted = CROWD.speed * aims[1]
    given = [jnp.asarray(_lanes_last(part)) for part in (places, now, wanted)]
    ours = np.asarray(jax.jit(_choose)(*given), np.float64).T
    theirs = peer.call(orca_rvo.chosen, CROWD, places, now, wanted)
    off = np.linalg.norm(ours - theirs, axis=2).reshape(-1)
    return {
        "situations": len(off),
        "largest": float(off.max()),
        "equal": float(np.mean(off < EQUAL)),
        "p999": float(np.quantile(off, 0.999)),
    }


def _apart(rng: np.random.Generator, count: int, n: int) -> np.ndarray:
    """Places of agents that do not touch, in a square that they make crowded; float64[., n, 2]."""
    side = 10 * CROWD.radius * np.sqrt(n)
    found = np.empty((count, n, 2))
    for row in found:
        for i in range(n):
            row[i] = rng.uniform(0, side, 2)
            while i and np.linalg.norm(row[:i] - row[i], axis=1).min() < 2.2 * CROWD.radius:
                row[i] = rng.uniform(0, side, 2)
    return found


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    rows, verdicts = [], []
    for n, size in found.items():
        for name, key in (("usvjax, float32", "ours"), ("RVO2 by pyrvo", "theirs")):
            if size[key]:
                rate = size["agent_steps"] / statistics.median(size[key])
                rows.append((f"{n} agents, {name}", f"{rate:,.0f}", spread(size[key])))
        if not size["theirs"]:
            verdicts.append(verdict("pyrvo is not installed: no comparison with it", False))
            continue
        ratio = statistics.median(size["theirs"]) / statistics.median(size["ours"])
        verdicts.append(verdict(f"{n} agents, at least RVO2's speed: {ratio:.2f}x", ratio >= LEAST))
        verdicts.append(
            f"- {n} agents, velocities of {size['situations']:,} agents in random situations: "
            f"{size['equal']:.2%} within {EQUAL:g} m/s, 99.9 % within {size['p999']:.1e}, the "
            f"largest difference {size['largest']:.1e} m/s."
        )
    c = CROWD
    return "\n\n".join(
        [
            f"Fleets that cross a ring of {RING:g} m radius at {c.speed:g} m/s, hulls of "
            f"{c.radius:g} m, horizon {c.horizon:g} s, the {c.neighbours} nearest neighbours, no "
            f"obstacles, {STEPS} steps, all cores, in turns. Of RVO2 only `doStep` is timed, the "
            "wanted velocities set beforehand, with a process per core.",
            table(("fleets of", "agent-steps/s", "timings"), rows),
            "\n".join(verdicts),
        ]
    )
