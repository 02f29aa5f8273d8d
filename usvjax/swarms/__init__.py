"""Swarms that minimise functions: grey wolves, ants, genes and particles."""

from usvjax.swarms.minimising import MinimiseResult, minimise
from usvkernels.swarms.aco import AcoParams, AcoStatic
from usvkernels.swarms.cmpso import CmpsoParams, CmpsoStatic
from usvkernels.swarms.ga import GaParams, GaStatic
from usvkernels.swarms.gwo import GwoStatic
from usvkernels.swarms.laws import GwoParams

__all__ = [
    "AcoParams",
    "AcoStatic",
    "CmpsoParams",
    "CmpsoStatic",
    "GaParams",
    "GaStatic",
    "GwoParams",
    "GwoStatic",
    "MinimiseResult",
    "minimise",
]
