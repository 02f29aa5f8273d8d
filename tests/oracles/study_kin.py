"""The toy mission once more, of which the scenes of several conditions can be run in one call."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from study_fake import ToyMission, ToyScene

from usvjax.mission import Case, Kin, Outcome
from usvjax.registry import register_mission

KIND = "kin toy"
MOST = 600


@dataclass(frozen=True)
class KinScene:
    parts: tuple[ToyScene, ...]


class KinMission(ToyMission):
    calls: list[int] = []  # noqa: RUF012, scenes of each call of `run`

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> Any:
        return KinScene((super().pose(case, seed, jobs),))

    def kin(self, case: Case) -> Kin | None:
        given = asdict(case.given)
        return None if given["unsensed"] else Kin(given["sleep"], MOST)

    def join(self, scenes: Sequence[KinScene], cases: Sequence[Case]) -> KinScene:
        parts = tuple(part for scene in scenes for part in scene.parts)
        assert {id(part.params) for part in parts} <= {id(case.given) for case in cases}
        assert sum(len(part.jobs) for part in parts) <= MOST
        return KinScene(parts)

    def run(self, scene: KinScene, method: str, record: bool = False) -> Outcome:
        self.calls.append(len(scene.parts))
        found = [super(KinMission, self).run(part, method) for part in scene.parts]
        return Outcome(
            {name: np.concatenate([f.columns[name] for f in found]) for name in found[0].columns}
        )


register_mission(KIND, KinMission())


def kin_study(**changes: Any) -> dict[str, Any]:
    """Nine conditions of 250 episodes in shards of 100."""
    axes = {"params.rate": [0.5, 0.7, 0.9], "params.radius": [0.4, 0.5, 0.6]}
    study = {"name": "kin", "kind": KIND, "episodes": 250, "shard": 100, "axes": axes}
    return study | {"methods": ["plain", "better"]} | changes
