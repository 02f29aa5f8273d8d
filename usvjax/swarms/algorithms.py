"""The algorithms by name, their defaults, and the checks of their options."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from usvjax.checks import default_or, one_of, shown, whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvjax.swarms.ranges import checked_numbers
from usvkernels.swarms import aco, cmpso, ga, gwo
from usvkernels.swarms.laws import LAWS, GwoParams

Params = GwoParams | aco.AcoParams | ga.GaParams | cmpso.CmpsoParams
Static = gwo.GwoStatic | aco.AcoStatic | ga.GaStatic | cmpso.CmpsoStatic


@dataclass(frozen=True)
class Algorithm:
    """A swarm and the paper's settings of it.

    Attributes:
        run: the kernel.
        params: default numbers.
        static: default choices of method.
        population: default members.
        iterations: default number.
    """

    run: Callable[..., Any]
    params: Params
    static: Static
    population: int
    iterations: int


ALGORITHMS = {
    "igwo": Algorithm(gwo.run, GwoParams(), gwo.GwoStatic(law="beta"), 20, 200),
    "gwo": Algorithm(gwo.run, GwoParams(), gwo.GwoStatic(), 20, 200),
    "aco": Algorithm(aco.run, aco.AcoParams(), aco.AcoStatic(), 200, 100),
    # Populations of these two are not printed; theirs make as many evaluations as the wolves'.
    "ga": Algorithm(ga.run, ga.GaParams(), ga.GaStatic(), 80, 50),
    "cmpso": Algorithm(cmpso.run, cmpso.CmpsoParams(), cmpso.CmpsoStatic(), 20, 200),
}
"""Yu et al. 2022, section 5.1 and Table 2."""


def checked_params(name: str, given: Any, runs: int) -> Params:
    """Numbers of an algorithm, those given or its defaults, each leaf as [runs].

    Raises:
        BadTypeError: parameters of another algorithm, or no numbers.
        BadInputError: a wrong shape, not finite, or out of range.
    """
    numbers: Params = checked_numbers(name, given, ALGORITHMS[name].params, runs)
    return numbers


def checked_static(name: str, given: Any, population: int) -> Static:
    """Choices of method of an algorithm, those given or its defaults.

    Raises:
        BadTypeError: choices of another algorithm, or of a wrong type.
        BadInputError: an unknown or impossible choice, or too small a population.
    """
    default = ALGORITHMS[name].static
    given = default_or("static", given, default, name)
    if isinstance(given, gwo.GwoStatic):
        _check_wolves(name, given, population)
    elif isinstance(given, aco.AcoStatic):
        whole_number("static.archive", given.archive, 2)
    elif isinstance(given, cmpso.CmpsoStatic):
        _check_particles(given, population)
    elif not isinstance(given.elitism, bool):
        raise BadTypeError(f"static.elitism: got {shown(given.elitism)}; wanted True or False")
    return given


def _check_wolves(name: str, given: gwo.GwoStatic, population: int) -> None:
    one_of("static.law", given.law, LAWS)
    one_of("static.leaders", given.leaders, ("kept", "pack"))
    if not isinstance(given.greedy, bool):
        raise BadTypeError(f"static.greedy: got {shown(given.greedy)}; wanted True or False")
    if name == "igwo" and given.law != "beta":
        raise BadInputError(
            f"static.law: got {shown(given.law)}; 'igwo' is 'gwo' with the law 'beta', "
            "choose algorithm='gwo' for another"
        )
    if population < gwo.LEADERS:
        raise BadInputError(
            f"population: got {population}; wanted {gwo.LEADERS} or more wolves, as many as lead"
        )


def _check_particles(given: cmpso.CmpsoStatic, population: int) -> None:
    swarms = whole_number("static.swarms", given.swarms, 1)
    if whole_number("static.exchange", given.exchange, 1) >= 2**31:
        raise BadInputError(f"static.exchange: got {shown(given.exchange)}; wanted less than 2**31")
    if population % swarms or population < 2 * swarms:
        raise BadInputError(
            f"population: got {population}; wanted a multiple of static.swarms = {swarms}, "
            "with 2 particles or more in each"
        )
