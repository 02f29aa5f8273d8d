"""The order in which to visit stations: tours, their lengths, exact ones."""

from usvjax.tours.exact import optimal_tour
from usvjax.tours.lengths import tour_length
from usvjax.tours.solve import TourResult, solve_tour
from usvkernels.swarms.cmpso import CmpsoParams, CmpsoStatic
from usvkernels.swarms.gwo import GwoStatic
from usvkernels.swarms.laws import GwoParams
from usvkernels.tours.aco import AcoParams
from usvkernels.tours.ga import GaParams
from usvkernels.tours.ils import IlsParams

__all__ = [
    "AcoParams",
    "CmpsoParams",
    "CmpsoStatic",
    "GaParams",
    "GwoParams",
    "GwoStatic",
    "IlsParams",
    "TourResult",
    "optimal_tour",
    "solve_tour",
    "tour_length",
]
