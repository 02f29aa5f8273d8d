"""The mission "wei2023_encounters": fleets of two as in "fleet", and what an observer notes."""

from typing import Any

import numpy as np

from usvjax.mission import Metric, Outcome
from usvjax.missions.fleet.measures import NONE, meetings_of
from usvjax.missions.fleet.mission import FleetMission

_NOTED = (
    Metric("meets", "", "Would pass too close", summarised=False, counted=True),
    Metric("kept", "", "Rules kept by both", summarised=False, counted=True),
    Metric("turned", "deg", "Largest alteration of course", summarised=False),
    Metric("slowed", "", "Largest share of the speed lost", summarised=False),
)


class EncounterMission(FleetMission):
    """Sail fleets of two and watch them; see `usvjax.mission.Mission`."""

    metrics = (*FleetMission.metrics, *_NOTED)

    def run(self, scene: Any, method: str, record: bool = False) -> Outcome:
        """Sail fleets; see `Mission.run`."""
        found = super().run(scene, method, record=True)
        assert found.recording is not None
        met = meetings_of(found.recording.detail, scene.hulls, scene.params)
        turned = np.maximum(met.to_starboard, met.to_port)
        noted = {
            "meets": met.kind[:, 0, 1] != NONE,
            "kept": met.kept.all(axis=(1, 2)),
            "turned": np.degrees(np.maximum(turned[:, 0, 1], turned[:, 1, 0])),
            "slowed": 1.0 - np.minimum(met.slowest[:, 0, 1], met.slowest[:, 1, 0]),
        }
        columns = found.columns | {name: own.astype(np.float32) for name, own in noted.items()}
        return Outcome(columns, found.recording if record else None)


MISSION = EncounterMission()
