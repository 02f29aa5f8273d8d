"""What can be asked of the experiments of Yu et al. 2022."""

from dataclasses import dataclass
from typing import Annotated

import tyro

from experiments.paper import Options
from usvjax.errors import BadInputError

SEED = 2022
"""Of maps, changes and swarms."""

_WHAT = {"maps": "map of each kind", "runs": "run", "swarm_runs": "run"}


@dataclass(frozen=True)
class YuOptions(Options):
    """Regenerate the tables and figures of Yu et al. 2022 beside the published values.

    Attributes:
        maps: Random maps of each kind for the heuristic; 1,000, or 100 with --quick.
        runs: Cruises of a case by D* Lite, 200, and runs on each test function, 1,000; 24 of each
            with --quick.
        swarm_runs: Cruises of Case 1 by Algorithms 1 to 3, which are slow; 50, or 1 with --quick.
    """

    maps: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    runs: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    swarm_runs: Annotated[int | None, tyro.conf.arg(metavar="N")] = None

    def size(self, name: str, full: int, quick: int) -> int:
        """A size that was asked for, else the full one, or that of a quick look.

        Raises:
            BadInputError: it is below 1.
        """
        asked: int | None = getattr(self, name)
        if asked is not None and asked < 1:
            option = name.replace("_", "-")
            raise BadInputError(f"--{option}: got {asked}; wanted at least 1 {_WHAT[name]}")
        return asked or (quick if self.quick else full)
