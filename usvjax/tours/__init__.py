"""The order in which to visit stations: tours, their lengths, exact ones."""

from usvjax.tours.exact import optimal_tour
from usvjax.tours.lengths import tour_length
from usvjax.tours.solve import TourResult, solve_tour

__all__ = ["TourResult", "optimal_tour", "solve_tour", "tour_length"]
