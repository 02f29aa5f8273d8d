"""Paths between two cells by ants, genes and particles: Algorithms 1 to 3 of Yu et al. 2022."""

from usvjax.planners.plans import ALGORITHMS, PlanResult, plan_paths
from usvkernels.planners.aco import AcoParams
from usvkernels.planners.cmpso import CmpsoParams
from usvkernels.planners.ga import GaParams

__all__ = ["ALGORITHMS", "AcoParams", "CmpsoParams", "GaParams", "PlanResult", "plan_paths"]
