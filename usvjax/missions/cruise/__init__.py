"""The multi-target cruise: stations, an order, and the way through water that changes."""

from usvjax.missions.cruise.params import CruiseParams, CruiseStatic
from usvjax.missions.cruise.result import CruiseResult
from usvjax.missions.cruise.run import cruise

__all__ = ["CruiseParams", "CruiseResult", "CruiseStatic", "cruise"]
