"""Episodes that the benchmarks of the dynamic window approach share."""

from dataclasses import dataclass, replace

import numpy as np

from usvjax.missions.dwa.params import DwaParams, DwaStatic
from usvjax.missions.dwa.run import NavigateResult, navigate_dwa
from usvjax.missions.dwa.scenes import LatticeTable
from usvkernels.status import Status

SEED = 2022
FIXED_STEPS = 128  # a multiple of the steps between two refills of the lanes, so none idles
OBSTACLES = 40


@dataclass(frozen=True)
class Workload:
    """Arguments of `navigate_dwa`."""

    obstacles: np.ndarray  # float32[B, K, 2], m
    valid: np.ndarray  # bool[B, K]
    starts: np.ndarray  # float64[B, 3]
    goals: np.ndarray  # float64[B, 2], m
    params: DwaParams
    static: DwaStatic

    def __len__(self) -> int:
        return len(self.starts)

    def rows(self, index: slice | np.ndarray) -> "Workload":
        """Some of the episodes."""
        return replace(
            self,
            obstacles=self.obstacles[index],
            valid=self.valid[index],
            starts=self.starts[index],
            goals=self.goals[index],
        )

    def sail(self, max_lanes: int = 256) -> NavigateResult:
        """Run the episodes as a user does; returns once the results are on the host."""
        return navigate_dwa(
            self.obstacles,
            self.starts,
            self.goals,
            valid=self.valid,
            params=self.params,
            static=self.static,
            max_lanes=max_lanes,
        )


def fixed_length(episodes: int, methods: tuple[str, ...]) -> Workload:
    """Episodes on Tan's lattice, 40 obstacles each, that all last FIXED_STEPS decisions.

    Parameters are those of the paper's Table 1. In 12.8 s nobody reaches a goal 14.1 m away, or
    can be stuck for 20 s; maps on which one of `methods` hits something sooner are left out.
    """
    maps = LatticeTable(rate=OBSTACLES / 119, rate_meaning="count")  # 119 points may be obstacles
    found: list[Workload] = []
    while sum(map(len, found)) < episodes:
        jobs = len(found) * episodes + np.arange(episodes)
        block = _drawn(maps, jobs, DwaParams(), DwaStatic(max_steps=FIXED_STEPS))
        # Rows past the obstacles are masked padding, which only ours could pass over.
        shown = (block.obstacles[:, :OBSTACLES], block.valid[:, :OBSTACLES])
        block = replace(block, obstacles=shown[0], valid=shown[1])
        lasting = np.full(episodes, True)
        for method in methods:
            lasting &= of_method(block, method).sail().status == int(Status.TIMED_OUT)
        found.append(block.rows(lasting))
    return _joined(found).rows(slice(episodes))


def heavy_tailed(episodes: int) -> Workload:
    """Whole episodes of the improved method, 120 to 600 decisions long.

    A lattice of 5 m with 10 % obstacles of 0.3 m: three in four arrive, most after 12 to 13 s;
    others collide, are stuck after up to 45 s, or wander until the bound of 60 s.
    """
    maps = LatticeTable(rate=0.1, hi=5, goal=(5.0, 5.0))
    params = DwaParams(radius=0.3, clearance_cap=2.0)
    return _drawn(maps, np.arange(episodes), params, DwaStatic(method="improved", max_steps=600))


def of_method(work: Workload, method: str) -> Workload:
    """The same episodes for one of the two methods."""
    return replace(work, static=replace(work.static, method=method))


def _joined(parts: list[Workload]) -> Workload:
    return replace(
        parts[0],
        obstacles=np.concatenate([part.obstacles for part in parts]),
        valid=np.concatenate([part.valid for part in parts]),
        starts=np.concatenate([part.starts for part in parts]),
        goals=np.concatenate([part.goals for part in parts]),
    )


def _drawn(maps: LatticeTable, jobs: np.ndarray, params: DwaParams, static: DwaStatic) -> Workload:
    drawn = maps.draw(SEED, jobs, float(params.radius))
    assert drawn.valid is not None
    assert isinstance(drawn.obstacles, np.ndarray)
    return Workload(drawn.obstacles, drawn.valid, drawn.starts, drawn.goals, params, static)
