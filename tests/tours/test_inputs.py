"""What solve_tour, tour_length and optimal_tour refuse, and how they say it."""

import itertools
from typing import Any

import numpy as np
import pytest

from usvjax import memory, swarms, tours
from usvjax.errors import BadInputError, BadTypeError
from usvjax.swarms.ranges import RANGES
from usvjax.tours import optimal_tour, solve_tour, tour_length
from usvjax.tours.algorithms import ALGORITHMS
from usvkernels.swarms.cmpso import CmpsoStatic
from usvkernels.swarms.gwo import GwoStatic
from usvkernels.tours.ga import GaParams
from usvkernels.tours.ils import IlsParams

NAN, INF = float("nan"), float("inf")
POINTS = np.array([[0.0, 0.0], [4.0, 1.0], [2.0, 3.0], [1.0, 5.0]])
TABLE = np.abs(np.subtract.outer(np.arange(4.0), np.arange(4.0)))


def changed(array: np.ndarray, index: tuple[int, ...], value: float) -> np.ndarray:
    array = array.copy()
    array[index] = value
    return array


def refuse(error: type[Exception], message: str, *args: Any, **options: Any) -> None:
    with pytest.raises(error, match=message):
        solve_tour(*args, **options)


@pytest.mark.parametrize(
    ("points", "error", "message"),
    [
        (POINTS[:1], BadInputError, "points: got 1 station; wanted 2 to 1000"),
        (POINTS[:0], BadInputError, r"points: got shape \(0, 2\)"),
        (POINTS[0], BadInputError, r"points: got shape \(2,\); wanted float \[B, d, 2\] or"),
        (POINTS.T, BadInputError, r"points: got shape \(2, 4\)"),
        (POINTS[None, None], BadInputError, r"points: got shape \(1, 1, 4, 2\)"),
        (changed(POINTS, (2, 1), NAN), BadInputError, r"points: nan at index \[2, 1\]"),
        (changed(POINTS, (2, 1), INF), BadInputError, r"points: inf at index \[2, 1\]"),
        (POINTS[[0, 1, 2, 1]], BadInputError, r"points: stations 1 and 3 are both at \(4, 1\)"),
        (
            np.stack([POINTS, POINTS[[0, 1, 2, 2]]]),
            BadInputError,
            r"points: stations 2 and 3 of tour 1 are both at \(2, 3\)",
        ),
        ([[0.0, 0.0], [1.0]], BadInputError, "points: rows of unequal length"),
        ([["0", "1"], ["2", "3"]], BadTypeError, "points: got dtype <U1"),
        (POINTS > 1, BadTypeError, "points: got dtype bool"),
    ],
)
def test_bad_points(points: Any, error: type[Exception], message: str) -> None:
    refuse(error, f"^{message}", points)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (TABLE[:3], r"distances: got shape \(3, 4\), not square"),
        (TABLE[:1, :1], "distances: got 1 station"),
        (changed(TABLE, (1, 2), -1.0), r"distances: -1 at index \[1, 2\]; wanted 0 or more"),
        (changed(TABLE, (1, 2), NAN), r"distances: nan at index \[1, 2\]"),
        (changed(TABLE, (3, 3), 2.0), r"distances: 2 from a station to itself at index \[3, 3\]"),
        (changed(TABLE[None], (0, 3, 3), INF), r"distances: inf .* at index \[0, 3, 3\]; wanted 0"),
    ],
)
def test_bad_distances(table: np.ndarray, message: str) -> None:
    refuse(BadInputError, f"^{message}", distances=table)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"algorithm": "igow"}, BadInputError, "algorithm: got 'igow'; did you mean 'igwo'"),
        ({"algorithm": "recomended"}, BadInputError, "algorithm: .* mean 'recommended'"),
        ({"distances": TABLE}, BadInputError, "points, distances: got both; wanted one"),
        ({"closed": 1}, BadTypeError, "closed: got 1; wanted True or False"),
        ({"key": 1.5}, BadTypeError, "key: got 1.5"),
        ({"runs": 0}, BadInputError, "runs: got 0; wanted 1 or more"),
        ({"runs": 2.0}, BadTypeError, "runs: got 2.0; wanted a whole number"),
        ({"algorithm": "gwo", "iterations": 0}, BadInputError, "iterations: got 0"),
        ({"algorithm": "igwo", "population": 0}, BadInputError, "population: got 0; wanted 3"),
        ({"algorithm": "gwo_swap", "population": 2}, BadInputError, "population: got 2; wanted 3"),
        ({"algorithm": "cmpso", "population": 7}, BadInputError, "population: got 7; wanted a mul"),
        (
            {"algorithm": "ils", "population": 5},
            BadInputError,
            "population: got 5; algorithm 'ils'",
        ),
        ({"iterations": 5}, BadInputError, "iterations: got 5; exact tours"),
        ({"static": GwoStatic()}, BadInputError, "static: got GwoStatic.*; exact tours"),
        ({"first": -1}, BadInputError, "first: got -1; wanted 0 or more"),
        ({"first": 1.0}, BadTypeError, "first: got 1.0; wanted a whole number"),
        (
            {"algorithm": "gwo", "first": 2**31 - 1, "runs": 2},
            BadInputError,
            r"first \+ runs: got 2147483647 \+ 2; wanted at most 2\*\*31",
        ),
        ({"first": 2**31}, BadInputError, r"first \+ runs: got 2147483648 \+ 1; wanted"),
        (
            {"algorithm": "ga", "params": IlsParams()},
            BadTypeError,
            "params: got .*IlsParams; .*GaP",
        ),
        ({"algorithm": "ga", "params": GaParams(mutation=1.5)}, BadInputError, "params.mutation: "),
        ({"algorithm": "ga", "params": GaParams(mutation=NAN)}, BadInputError, "params.mutation: "),
        (
            {"algorithm": "ga", "runs": 3, "params": GaParams(crossing=np.ones(2))},
            BadInputError,
            r"params.crossing: got shape \(2,\); wanted a number or one for each of 3 runs",
        ),
        ({"algorithm": "ils", "params": IlsParams(patience=0.5)}, BadTypeError, "params.patience"),
        ({"algorithm": "ils", "params": IlsParams(patience=-2)}, BadInputError, "params.patience"),
    ],
)
def test_bad_options(options: dict[str, Any], error: type[Exception], message: str) -> None:
    refuse(error, f"^{message}", POINTS, **options)


@pytest.mark.parametrize(
    ("algorithm", "static", "error", "message"),
    [
        ("ils", GwoStatic(), BadInputError, "static: got GwoStatic.*; algorithm 'ils' has no ch"),
        ("aco", CmpsoStatic(), BadInputError, "static: got CmpsoStatic.*; algorithm 'aco' has no"),
        ("gwo", CmpsoStatic(), BadTypeError, "static: got .*CmpsoStatic; .* 'gwo' takes .*GwoSt"),
        ("gwo_swap", "linear", BadTypeError, "static: got .*; algorithm 'gwo_swap' takes .*GwoSt"),
        ("gwo", GwoStatic("cosin"), BadInputError, "static.law: got 'cosin'; .* 'cosine'"),
        ("igwo", GwoStatic("cosin"), BadInputError, "static.law: got 'cosin'; .* 'cosine'"),
        ("gwo", GwoStatic(leaders="packs"), BadInputError, "static.leaders: got 'packs'; .* 'pack"),
        ("gwo_swap", GwoStatic(greedy=1), BadTypeError, "static.greedy: got 1; wanted True or"),  # type: ignore[arg-type]
        ("igwo", GwoStatic(), BadInputError, "static.law: got 'linear'; 'igwo' is 'gwo' with"),
        (
            "igwo_swap",
            GwoStatic("cosine"),
            BadInputError,
            "static.law: got 'cosine'; 'igwo_swap' is 'gwo_swap' .* algorithm='gwo_swap' for",
        ),
        ("cmpso", CmpsoStatic(swarms=0), BadInputError, "static.swarms: got 0; wanted 1 or more"),
        ("cmpso", CmpsoStatic(exchange=0), BadInputError, "static.exchange: got 0; wanted 1"),
        ("cmpso", CmpsoStatic(swarms=3), BadInputError, "population: got 20; wanted a multiple"),
    ],
)
def test_bad_choices(algorithm: str, static: Any, error: type[Exception], message: str) -> None:
    refuse(error, f"^{message}", POINTS, algorithm=algorithm, static=static)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"runs": 10**9}, "runs: 1000000000 of 1 iterations on 4 stations needs"),
        ({"algorithm": "ils", "runs": 10**9}, "runs: 1000000000 of 100 iterations on 4 stations"),
        (
            {"algorithm": "gwo", "iterations": 10**9},
            "runs: 1 of 1000000000 iterations with 20 memb",
        ),
        (
            {"algorithm": "aco", "population": 10**8},
            "runs: 1 of 100 iterations with 100000000 members on 4 stations needs .* memory",
        ),
    ],
)
def test_more_than_memory_holds(
    options: dict[str, Any], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(memory, "free_memory", lambda: 2**34)
    refuse(BadInputError, f"^{message}", POINTS, **options)


def test_more_problems_than_memory_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "free_memory", lambda: 2**34)
    many = np.broadcast_to(POINTS, (10**8, 4, 2))
    refuse(BadInputError, "^points: 100000000 problems of 4 stations needs", many)
    tables = np.broadcast_to(TABLE, (10**8, 4, 4))
    refuse(BadInputError, "^distances: 100000000 problems of 4 stations", distances=tables)


def test_other_mistakes() -> None:
    refuse(BadInputError, "^points, distances: got neither")
    refuse(
        BadInputError, "^runs: got 3 with 2 problems of points", POINTS[[[0, 1], [2, 3]]], runs=3
    )
    apart = np.random.default_rng(0).random((14, 2))
    refuse(BadInputError, "^points: got 14 stations; wanted 13 or fewer", apart, algorithm="exact")
    with pytest.raises(BadInputError, match=r"^points: got 14 stations; wanted 13 or fewer"):
        optimal_tour(apart)


@pytest.mark.parametrize(
    ("order", "error", "message"),
    [
        ([0, 1, 2], BadInputError, r"order: got shape \(3,\); wanted int \[B, 4\] or \[4\]"),
        ([0, 1, 2, 2], BadInputError, r"order: tour 0 is \[0, 1, 2, 2\]; wanted each of 0 .. 3"),
        ([[0, 1, 2, 3], [0, 1, 2, 4]], BadInputError, r"order: tour 1 is \[0, 1, 2, 4\]"),
        ([0.0, 1.0, 2.0, 3.0], BadTypeError, "order: got dtype float64"),
        ([[0, 1], [1]], BadInputError, "order: rows of unequal length"),
    ],
)
def test_bad_orders(order: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^{message}"):
        tour_length(order, POINTS)


def test_as_many_orders_as_problems() -> None:
    problems = np.stack([POINTS, POINTS + 1])
    with pytest.raises(BadInputError, match=r"^order: got 3 tours for 2 problems of points"):
        tour_length([[0, 1, 2, 3]] * 3, problems)


@pytest.mark.parametrize(
    ("algorithm", "params", "error", "message"),
    [
        (
            "aco",
            swarms.AcoParams(),
            BadTypeError,
            r"params: got usvjax\.swarms\.AcoParams; .* 'aco' takes usvjax\.tours\.AcoParams",
        ),
        (
            "igwo",
            tours.GwoParams(mu1=1e37),
            BadInputError,
            r"params\.mu1: got 1e\+37; wanted a num",
        ),
        ("igwo", tours.GwoParams(lambda2=3e38), BadInputError, r"params\.lambda2: got 3e\+38; wan"),
        (
            "igwo_swap",
            tours.GwoParams(mu1=[1, [2]]),
            BadInputError,
            r"params\.mu1: rows of unequal length; wanted a number or float\[1\]",
        ),
        (
            "aco",
            tours.AcoParams(evaporation=2),
            BadInputError,
            r"params\.evaporation: got 2; wanted",
        ),
        (
            "cmpso",
            tours.CmpsoParams(social=1e38),
            BadInputError,
            r"params\.social: got 1e\+38; wan",
        ),
        ("ils", tours.IlsParams(patience=1e10), BadInputError, r"params\.patience: got 1000000"),
    ],
)
def test_bad_params(algorithm: str, params: Any, error: type[Exception], message: str) -> None:
    refuse(error, f"^{message}", POINTS, algorithm=algorithm, params=params)


@pytest.mark.parametrize("algorithm", ["igwo", "igwo_swap", "aco", "cmpso"])
def test_no_parameter_in_range_spoils_a_tour(algorithm: str) -> None:
    """All corners of the ranges at once, one for each run."""
    kind = type(ALGORITHMS[algorithm].params)
    corners = np.array(list(itertools.product(*RANGES[kind].values())))
    params = kind(**dict(zip(RANGES[kind], corners.T, strict=True)))
    options: dict[str, Any] = {"iterations": 10, "population": 4}
    found = solve_tour(POINTS, algorithm=algorithm, params=params, runs=len(corners), **options)
    np.testing.assert_array_equal(np.sort(found.order), np.arange(4)[None].repeat(len(corners), 0))
    assert np.isfinite(found.history).all()
