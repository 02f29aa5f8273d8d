"""The multi-target cruise: stations, an order, and the way through water that changes."""

from usvjax.cruises.mission import METHODS, cruise
from usvjax.cruises.result import CruiseResult

__all__ = ["METHODS", "CruiseResult", "cruise"]
