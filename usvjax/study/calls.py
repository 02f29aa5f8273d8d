"""Which units share a call: of conditions that a mission can join, as many as the time allows.

A call of one small unit leaves most lanes idle, and a study of many conditions is little else.
Units whose cases are of one kin are handed out together. How many, decides no result: it is what
keeps the devices busy to the end, and what a kill loses small.
"""

import threading
from collections import OrderedDict, deque
from collections.abc import Hashable, Iterable, Sequence

from usvjax.mission import Case, joining
from usvjax.study.shards import Unit
from usvjax.study.spec import StudySpec

SECONDS = 4.0
"""A call takes about this at most, if it is of more than one unit: so much is lost by a kill."""

LEAST = 1024
"""Episodes of a call towards the end, where there are as many: fewer leave lanes idle."""


class Kindred:
    """The conditions of a study by kin.

    Attributes:
        key: of each condition; equal ones can share calls.
        most: by key, episodes of a call of several units; 0 where they cannot be joined.
    """

    def __init__(self, spec: StudySpec) -> None:
        self._spec = spec
        self._mission = joining(spec.mission)
        self.key: list[Hashable] = []
        self.most: dict[Hashable, int] = {}
        self._cases: dict[Hashable, list[Case]] = {}
        for condition in spec.conditions:
            kin = None if self._mission is None else self._mission.kin(condition.case)
            key = ("alone", condition.index) if kin is None else ("kin", kin.key)
            self.key.append(key)
            self.most[key] = 0 if kin is None else kin.most
            self._cases.setdefault(key, []).append(condition.case)

    def pose(self, units: Sequence[Unit]) -> object:
        """The scenes of units of one kin as one, in their order."""
        spec = self._spec
        scenes = [
            spec.mission.pose(
                spec.conditions[unit.condition].case, spec.seed, spec.layout.jobs(unit)
            )
            for unit in units
        ]
        if len(scenes) == 1:
            return scenes[0]
        assert self._mission is not None
        return self._mission.join(scenes, self._cases[self.key[units[0].condition]])


class Calls:
    """Units that are to be run, handed out to devices that ask at the same time."""

    def __init__(self, spec: StudySpec, kindred: Kindred, devices: int) -> None:
        self._layout = spec.layout
        self._kindred = kindred
        self._devices = devices
        self._waiting: OrderedDict[Hashable, deque[Unit]] = OrderedDict()
        self._episodes = 0
        self._each: dict[Hashable, float] = {}  # seconds per episode of the last call of a kin
        self._lock = threading.Lock()

    def put(self, units: Iterable[Unit]) -> None:
        """Add units, to be run in this order, kins in turn."""
        for unit in units:
            self._waiting.setdefault(self._key(unit), deque()).append(unit)
            self._episodes += self._size(unit)

    def take(self) -> list[Unit]:
        """The units of the next call, all of one kin; none where no unit is left."""
        with self._lock:
            if not self._waiting:
                return []
            key, waiting = self._waiting.popitem(last=False)
            most = self._most(key)
            taken = [waiting.popleft()]
            size = self._size(taken[0])
            while waiting and size + self._size(waiting[0]) <= most:
                size += self._size(waiting[0])
                taken.append(waiting.popleft())
            if waiting:
                self._waiting[key] = waiting
            self._episodes -= size
            return taken

    def took(self, units: Sequence[Unit], seconds: float) -> None:
        """Note how long a call took, compilation included."""
        with self._lock:
            self._each[self._key(units[0])] = seconds / sum(map(self._size, units))

    def _most(self, key: Hashable) -> float:
        """Episodes of a call: the first of a kin is of one unit, for nobody knows how long it is.

        The last calls get ever smaller, so that no device waits long for another.
        """
        each = self._each.get(key)
        if each is None:
            return 0
        share = max(LEAST, self._episodes / (2 * self._devices))
        return min(self._kindred.most[key], share, SECONDS / each)

    def _key(self, unit: Unit) -> Hashable:
        return self._kindred.key[unit.condition]

    def _size(self, unit: Unit) -> int:
        return len(self._layout.jobs(unit))
