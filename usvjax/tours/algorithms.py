"""The algorithms by name, their defaults, and the checks of their options."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from usvjax.checks import default_or, shown, whole_number
from usvjax.errors import BadInputError
from usvjax.swarms import algorithms as swarms
from usvjax.swarms.ranges import checked_numbers
from usvkernels.swarms.cmpso import CmpsoParams, CmpsoStatic
from usvkernels.swarms.gwo import LEADERS, GwoStatic
from usvkernels.swarms.laws import GwoParams
from usvkernels.tours import aco, ga, ils, keys, swaps

Run = Callable[..., Any]
"""(distances, seed, params, *, static, iterations, population, symmetric) -> orders, history."""

Static = GwoStatic | CmpsoStatic


@dataclass(frozen=True)
class Algorithm:
    """One way to search for a tour.

    Attributes:
        run: the kernel.
        params: default numbers.
        population: default members; None where there are none.
        least: members at least.
        iterations: default number, by the number of stations.
        static: default choices of method; None where there are none.
    """

    run: Run
    params: Any
    population: int | None
    least: int
    iterations: Callable[[int], int]
    static: Static | None = None


def _without(run: Run, *names: str) -> Run:
    """A kernel that does not take some of the options."""

    def called(*args: Any, **options: Any) -> Any:
        return run(*args, **{name: options[name] for name in options if name not in names})

    return called


def _by_keys(law: str) -> Algorithm:
    return _wolves(keys.run_gwo, GwoStatic(law))


def _by_swaps(law: str) -> Algorithm:
    return _wolves(swaps.run, GwoStatic(law, leaders="pack", greedy=True))


def _wolves(run: Run, static: GwoStatic) -> Algorithm:
    run = _without(run, "symmetric")
    return Algorithm(run, GwoParams(), 20, LEADERS, lambda d: 200, static)


_ils = _without(ils.run, "static", "population")
_aco = _without(aco.run, "static")
_ga = _without(ga.run, "static", "symmetric")
_cmpso = _without(keys.run_cmpso, "symmetric")

ALGORITHMS: dict[str, Algorithm] = {
    "ils": Algorithm(_ils, ils.IlsParams(), None, 0, lambda d: max(100, 20 * d)),
    "igwo": _by_keys("beta"),
    "gwo": _by_keys("linear"),
    "igwo_swap": _by_swaps("beta"),
    "gwo_swap": _by_swaps("linear"),
    "aco": Algorithm(_aco, aco.AcoParams(), 200, 1, lambda d: 100),
    # Populations of these two are not printed; theirs make as many evaluations as the wolves'.
    "ga": Algorithm(_ga, ga.GaParams(), 80, 2, lambda d: 50),
    "cmpso": Algorithm(_cmpso, CmpsoParams(), 20, 2, lambda d: 200, CmpsoStatic()),
}
"""Yu et al. 2022, section 5.1 and Table 2; "ils" is not theirs."""

NAMES = ("recommended", "exact", *ALGORITHMS)


def checked_population(name: str, given: Any) -> int | None:
    """Members, those given or the default."""
    method = ALGORITHMS[name]
    if method.population is None:
        if given is not None:
            raise BadInputError(f"population: got {shown(given)}; algorithm {name!r} has none")
        return None
    if given is None:
        return method.population
    return whole_number("population", given, method.least)


def checked_static(name: str, given: Any, population: int | None) -> Static | None:
    """Choices of method of an algorithm, those given or its defaults.

    Raises:
        BadTypeError: choices of another algorithm, or of a wrong type.
        BadInputError: an unknown or impossible choice, too small a population, or an algorithm
            without choices.
    """
    default = ALGORITHMS[name].static
    if default is None or population is None:
        if given is not None:
            raise BadInputError(f"static: got {shown(given)}; algorithm {name!r} has no choices")
        return None
    given = default_or("static", given, default, name)
    if isinstance(given, CmpsoStatic):
        swarms.checked_static("cmpso", given, population)
        return given
    swarms.checked_static("gwo", given, population)
    if name in ("igwo", "igwo_swap") and given.law != "beta":
        raise BadInputError(
            f"static.law: got {shown(given.law)}; {name!r} is {name[1:]!r} with the law 'beta', "
            f"choose algorithm={name[1:]!r} for another"
        )
    return given


def checked_iterations(name: str, given: Any, stations: int) -> int:
    """Iterations, those given or the default."""
    if given is None:
        return ALGORITHMS[name].iterations(stations)
    return whole_number("iterations", given, 1)


def checked_params(name: str, given: Any, runs: int) -> Any:
    """Numbers of an algorithm, those given or its defaults, each leaf as [runs].

    Raises:
        BadTypeError: parameters of another algorithm, or no numbers.
        BadInputError: a wrong shape, not finite, or out of range.
    """
    return checked_numbers(name, given, ALGORITHMS[name].params, runs)


def refuse_options(**given: Any) -> None:
    """The exact algorithm takes none."""
    for name, value in given.items():
        if value is not None:
            raise BadInputError(
                f"{name}: got {shown(value)}; exact tours, taken for few stations, take none"
            )
