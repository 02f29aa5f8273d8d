"""A mission of one's own: a vessel in a current steers by a potential field among round rocks."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from usvjax.errors import BadInputError
from usvjax.mission import Case, Files, Ground, Metric, Outcome, Recording, Replay, Replayed, Track
from usvjax.sections import Table
from usvjax.tables import read_table
from usvkernels.status import Status


@dataclass(frozen=True)
class Waters:
    """The `[drift]` table of a study.

    Attributes:
        size: edge of the square, from whose south-west corner to the opposite one vessels sail; m.
        rocks: how many; a whole number, 0 or more.
        radius: of a rock and the vessel together; m, above 0.
        current: speed of the current, whose direction is drawn for each job; m/s, 0 or more.
        gain: of the repulsion against the attraction, which is 1; 0 or more.
        reach: how far from its centre a rock repels; m, above 0.
        speed: through the water; m/s, above that of the current.
    """

    size: float = 100.0
    rocks: int = 12
    radius: float = 5.0
    current: float = 0.5
    gain: float = 3.0
    reach: float = 15.0
    speed: float = 2.0


class Scene(NamedTuple):
    """Where J vessels sail: rocks float[J, K, 2] (m), the current float[J, 2] (m/s)."""

    waters: Waters
    rocks: np.ndarray
    current: np.ndarray


DT, STEPS, ARRIVED = 0.5, 400, 3.0  # s; periods of an episode at most; m from the goal
BLOCK = 64  # jobs in a call: in one shape a job is rounded as it is among any others


@jax.jit
@partial(jax.vmap, in_axes=(0, 0, None, None))
def sail(rocks, current, known, numbers):  # one vessel; vmap makes it J of them
    """Places float[STEPS, 2] (m) and status int[STEPS] after each step, kept once it has ended."""
    gain, reach, speed, r, size = numbers

    def step(state, _):
        place, status = state
        away = place - rocks
        gap = jnp.sqrt((away**2).sum(axis=-1, keepdims=True))
        push = gain * (away / gap * jnp.maximum(1.0 - gap / reach, 0.0)).sum(axis=0)
        wanted = (size - place) / jnp.linalg.norm(size - place) + push
        through = speed * wanted / jnp.linalg.norm(wanted) - known * current
        after = place + DT * (through + current)
        end = jnp.where(jnp.linalg.norm(size - after) < ARRIVED, Status.REACHED, 0)
        now = jnp.where((jnp.linalg.norm(after - rocks, axis=-1) < r).any(), Status.COLLIDED, end)
        return (state := (jnp.where(status, place, after), jnp.where(status, status, now))), state

    return jax.lax.scan(step, (jnp.zeros(2), jnp.int32(0)), None, length=STEPS)[1]


class Drift:
    """The mission; see `usvjax.mission.Mission`."""

    tables = {"drift": Table("where and how a vessel sails", {"": Waters})}
    methods = {"field": "steers by the field alone", "allowed": "allows for the current as well"}
    metrics = (Metric("time", "s", "Time"), Metric("path_length", "m", "Path length"))
    endings = (Status.REACHED, Status.COLLIDED, Status.TIMED_OUT)

    def case(self, tables: Mapping[str, Mapping[str, Any]], files: Files) -> Case:
        """Read the table, and refuse what cannot be meant."""
        waters = read_table(Waters, tables["drift"], files.table("drift"))
        least = {"rocks": 0, "current": 0, "gain": 0, "size": 1e-3, "radius": 1e-3, "reach": 1e-3}
        least["speed"] = waters.current + 1e-3
        for name, low in least.items():
            if not low <= getattr(waters, name) < np.inf:
                raise BadInputError(f"{files.table('drift')}: {name!r} must be at least {low:g}")
        return Case({"drift": asdict(waters)}, {}, waters)

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> Scene:
        """Draw rocks and currents: job j from its own key, whatever the other jobs are."""
        waters: Waters = case.given
        key, shape = jax.random.key(seed, impl="threefry2x32"), (waters.rocks + 1, 2)
        draw = lambda job: jax.random.uniform(jax.random.fold_in(key, job), shape, jnp.float32)
        drawn = np.asarray(jax.vmap(draw)(jnp.asarray(jobs, jnp.uint32)))
        angle = 2.0 * np.pi * drawn[:, 0, 0]
        current = waters.current * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        return Scene(waters, waters.size * (0.15 + 0.7 * drawn[:, 1:]), current)

    def run(self, scene: Scene, method: str, record: bool = False) -> Outcome:
        """Sail, and measure."""
        w = scene.waters
        numbers = np.float32([w.gain, w.reach, w.speed, w.radius, w.size])
        known, jobs = np.float32(method == "allowed"), len(scene.rocks)
        rows = np.minimum(np.arange(-(-jobs // BLOCK) * BLOCK), jobs - 1).reshape(-1, BLOCK)
        found = [sail(scene.rocks[r], scene.current[r], known, numbers) for r in rows]
        places, status = (np.concatenate(part)[:jobs] for part in zip(*found, strict=True))
        places = np.pad(places.astype(float), ((0, 0), (1, 0), (0, 0)))  # all start at (0, 0)
        steps = np.where(status[:, -1] > 0, (status > 0).argmax(axis=1) + 1, STEPS)
        length = np.hypot(*np.moveaxis(np.diff(places, axis=1), -1, 0)).sum(axis=1)
        status = np.where(status[:, -1] > 0, status[:, -1], Status.TIMED_OUT).astype(np.int32)
        columns = {"status": status, "time": DT * steps, "path_length": length}
        return Outcome(columns, self._recorded(scene, places, steps) if record else None)

    def _recorded(self, scene: Scene, places: np.ndarray, steps: np.ndarray) -> Recording:
        marks = {"start": np.zeros((1, 2)), "goal": np.full((1, 2), scene.waters.size)}
        grounds = [Ground(None, rocks, scene.waters.radius, marks) for rocks in scene.rocks]
        told = zip(steps + 1, places, strict=True)
        tracks = [Track(DT * np.arange(n), "s", place[:n, None]) for n, place in told]
        return Recording(tuple(grounds), tuple(tracks), None)

    def example(self, rows: Any, methods: list[str]) -> tuple[int, str]:
        """The first episode."""
        return int(rows["job"].min()), "the first"

    def figures(self, run: Any, replay: Replay) -> Iterator[tuple[str, Any]]:
        """How episodes ended, and one of the last condition under all methods."""
        from usvjax.plots import plot_paths, plot_success

        given = {"labels": run.labels, "endings": self.endings, "methods": run.methods}
        yield "success", plot_success(run.table(), title=run.name, **given)
        job, _ = replay.example(last := run.table()["condition"].max())
        found = {m: replay(last, m, [job]).recording for m in run.methods}
        tracks = {method: recording.tracks[0].places[:, 0] for method, recording in found.items()}
        g = found[run.methods[0]].grounds[0]
        ends, title = (point for (point,) in g.marks.values()), f"{run.labels[last]}, job {job}"
        yield "paths", plot_paths(g.circles, g.radius, tracks, *ends, title=title)

    def film(self, replayed: Replayed, row: int) -> Any:
        """The vessel on its way."""
        from usvjax.plots.tracks import film_of

        return film_of(replayed, row)


MISSIONS = {"drift": Drift()}
