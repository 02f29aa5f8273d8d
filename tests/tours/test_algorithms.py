"""The searches: tours, histories, independence of the batch, a replay in NumPy, distributions."""

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from tour_cases import plain_length, shortest, straight

from usvjax.tours import solve_tour, tour_length
from usvkernels import draws
from usvkernels.swarms.cmpso import CmpsoStatic
from usvkernels.swarms.gwo import GwoStatic
from usvkernels.swarms.laws import GwoParams
from usvkernels.tours import swaps
from usvkernels.tours.ils import IlsParams

COUNT = 7
PROBLEMS = np.random.default_rng(3).random((5, COUNT, 2))
SMALL: dict[str, dict[str, Any]] = {
    "ils": {"iterations": 60},
    "gwo": {"iterations": 8, "population": 6},
    "igwo_swap": {"iterations": 8, "population": 6},
    "aco": {"iterations": 8, "population": 6},
    "ga": {"iterations": 8, "population": 6},
    "cmpso": {"iterations": 8, "population": 6},
}
"""One algorithm of each kernel, with few evaluations."""


@pytest.mark.parametrize("algorithm", SMALL)
def test_tours_histories_and_batches(algorithm: str) -> None:
    options = {"algorithm": algorithm, **SMALL[algorithm]}
    found = solve_tour(PROBLEMS, 5, **options)
    assert found.order.dtype == np.int32
    assert (found.order[:, 0] == 0).all()
    assert (np.sort(found.order, axis=1) == np.arange(COUNT)).all()
    np.testing.assert_array_equal(found.length, tour_length(found.order, PROBLEMS))
    assert found.history.shape == (5, SMALL[algorithm]["iterations"])
    assert (np.diff(found.history, axis=1) <= 0).all()
    assert (found.history[:, -1] == found.length).all()
    best = np.array([shortest(straight(points)) for points in PROBLEMS])
    assert (found.length > best * (1 - 1e-6)).all()
    assert (found.length < 1.5 * best).all()
    assert (found.history[:, 0] > found.length).any()
    # Run j is the same alone with those before it, and with any others behind it.
    again = solve_tour(PROBLEMS[[0, 1, 2, 0]], 5, **options)
    for name in ("order", "length", "history"):
        np.testing.assert_array_equal(getattr(again, name)[:3], getattr(found, name)[:3])
    other = solve_tour(PROBLEMS, 6, **options)
    assert (other.history != found.history).any()


def test_a_run_does_not_depend_on_whether_others_are_symmetric() -> None:
    count = 12
    tables = np.random.default_rng(1).random((4, count, count))
    tables += tables.transpose(0, 2, 1)
    tables[:, range(count), range(count)] = 0
    mixed = tables.copy()
    mixed[[0, 2], 0, 1] += 1e-9
    options = {"key": 3, "algorithm": "aco", "iterations": 20, "population": 8}
    found = solve_tour(distances=mixed, **options)
    alike = solve_tour(distances=tables, **options)
    for name in ("order", "length", "history"):
        wanted = getattr(alike, name)[[1, 3]]
        np.testing.assert_array_equal(getattr(found, name)[[1, 3]], wanted)
    # What is not symmetric is searched as such: as it is alone, and not as the others are.
    assert (abs(found.history[2] - alike.history[2]) > 1e-6).any()
    alone = solve_tour(distances=mixed[2], first=2, **options)
    np.testing.assert_array_equal(alone.history[0], found.history[2])
    np.testing.assert_array_equal(alone.order[0], found.order[2])


def test_seeds_of_one_problem() -> None:
    options = {"algorithm": "gwo", **SMALL["gwo"]}
    many = solve_tour(PROBLEMS[0], 5, runs=130, **options)
    few = solve_tour(PROBLEMS[0], 5, runs=70, **options)
    np.testing.assert_array_equal(many.order[:70], few.order)
    np.testing.assert_array_equal(many.history[:70], few.history)
    assert len(np.unique(many.history[:, 0])) > 60  # no two draw alike but by chance
    with jax.default_device(jax.devices()[0]):
        np.testing.assert_array_equal(
            solve_tour(PROBLEMS[0], 5, runs=70, **options).order, few.order
        )


def rank(keys: np.ndarray) -> np.ndarray:
    return np.argsort(keys, axis=-1, kind="stable")


def replayed(distances: np.ndarray, seed: np.ndarray, law: list[float], wolves: int) -> list[float]:
    """Eqs. 1 to 6 on random keys in float64, one wolf and one leader at a time."""
    count = len(distances)

    def words(time: int, stream: int) -> np.ndarray:
        index = np.arange(stream * wolves * count, (stream + 1) * wolves * count)
        drawn = draws.words(seed, time, index)
        return np.stack([np.asarray(w) for w in drawn]).reshape(4, wolves, count)

    def signed(word: np.ndarray) -> np.ndarray:
        return word.astype(np.int64).astype(np.uint32).view(np.int32) / 2.0**31

    x = (words(0, 0)[0] >> 8) * 2.0**-24
    kept: list[tuple[float, np.ndarray]] = []
    history = []
    for time, a in enumerate(law):
        lengths = [plain_length(rank(row).tolist(), distances) for row in x]
        kept = sorted(kept + list(zip(lengths, x.copy(), strict=True)), key=lambda w: w[0])[:3]
        history.append(kept[0][0])
        drawn = signed(np.concatenate([words(time + 1, 0), words(time + 1, 1)[:2]]))
        pulls = [
            leader - a * drawn[2 * k] * np.abs((drawn[2 * k + 1] + 1) * leader - x)
            for k, (_, leader) in enumerate(kept)
        ]
        x = np.clip(sum(pulls) / 3, 0, 1)
    return history


@pytest.mark.parametrize("law", ["linear", "quadratic"])
def test_wolves_by_random_keys_against_numpy(law: str) -> None:
    # Whole numbers up to a power of two: no rounding decides between tours of one length.
    tables = np.random.default_rng(8).integers(1, 64, (5, COUNT, COUNT)).astype(float)
    tables = np.triu(tables, 1) + np.triu(tables, 1).transpose(0, 2, 1)
    tables[:, 0, 1] = tables[:, 1, 0] = 64
    static = None if law == "linear" else GwoStatic(law)
    found = solve_tour(distances=tables, key=5, algorithm="gwo", static=static, **SMALL["gwo"])
    seeds = np.asarray(draws.seeds(jax.random.key(5), 5))
    factors = [2 * (1 - (t / 8) ** (1 if law == "linear" else 2)) for t in range(8)]
    wanted = [replayed(tables[run], seeds[:, run], factors, 6) for run in range(5)]
    assert found.history.tolist() == wanted
    assert sum(history[-1] < history[0] for history in wanted) >= 3


def test_a_later_part_of_the_runs_is_that_part() -> None:
    options = {"algorithm": "gwo", **SMALL["gwo"]}
    whole = solve_tour(PROBLEMS[0], 5, runs=6, **options)
    part = solve_tour(PROBLEMS[0], 5, runs=2, first=4, **options)
    np.testing.assert_array_equal(part.history, whole.history[4:])
    np.testing.assert_array_equal(part.order, whole.order[4:])
    assert (whole.history[4:] != whole.history[:2]).any()


def test_one_parameter_for_each_run() -> None:
    options = {"algorithm": "igwo", "iterations": 8, "population": 6}
    swept = GwoParams(lambda2=np.array([0.1, 2.0, 0.1]))
    found = solve_tour(PROBLEMS[0], 5, runs=3, params=swept, **options)
    plain = solve_tour(PROBLEMS[0], 5, runs=3, **options)
    np.testing.assert_array_equal(found.history[[0, 2]], plain.history[[0, 2]])
    assert (found.history[1] != plain.history[1]).any()


SWAPPING = {"leaders": "pack", "greedy": True}


@pytest.mark.parametrize(
    ("algorithm", "usual", "other"),
    [
        ("gwo", GwoStatic(), GwoStatic(law="cosine")),
        ("gwo", GwoStatic(), GwoStatic(leaders="pack")),
        ("gwo", GwoStatic(), GwoStatic(greedy=True)),
        ("gwo_swap", GwoStatic(**SWAPPING), GwoStatic("cosine", **SWAPPING)),
        ("gwo_swap", GwoStatic(**SWAPPING), GwoStatic(leaders="kept", greedy=True)),
        ("gwo_swap", GwoStatic(**SWAPPING), GwoStatic(leaders="pack", greedy=False)),
        ("cmpso", CmpsoStatic(), CmpsoStatic(swarms=3)),
        ("cmpso", CmpsoStatic(), CmpsoStatic(exchange=2)),
    ],
)
def test_choices_of_method(algorithm: str, usual: Any, other: Any) -> None:
    options = {"algorithm": algorithm, "iterations": 8, "population": 6, "runs": 16}
    plain = solve_tour(PROBLEMS[0], 5, **options)
    same = solve_tour(PROBLEMS[0], 5, static=usual, **options)
    np.testing.assert_array_equal(same.history, plain.history)
    np.testing.assert_array_equal(same.order, plain.order)
    found = solve_tour(PROBLEMS[0], 5, static=other, **options)
    assert (found.history != plain.history).any()
    assert (np.sort(found.order, axis=1) == np.arange(COUNT)).all()
    assert (np.diff(found.history, axis=1) <= 0).all()


@pytest.mark.parametrize("keys", [True, False])
def test_the_law_makes_the_improved_wolves(keys: bool) -> None:
    plain, improved = ("gwo", "igwo") if keys else ("gwo_swap", "igwo_swap")
    static = GwoStatic("beta") if keys else GwoStatic("beta", **SWAPPING)
    options = {"iterations": 8, "population": 6, "runs": 3}
    found = solve_tour(PROBLEMS[0], 5, algorithm=plain, static=static, **options)
    wanted = solve_tour(PROBLEMS[0], 5, algorithm=improved, **options)
    np.testing.assert_array_equal(found.history, wanted.history)
    np.testing.assert_array_equal(found.order, wanted.order)


@pytest.mark.parametrize("leaders", ["kept", "pack"])
@pytest.mark.parametrize("greedy", [True, False])
def test_swapping_wolves_return_the_shortest_tour_they_met(leaders: str, greedy: bool) -> None:
    distances = straight(PROBLEMS[0])
    seeds = draws.seeds(jax.random.key(5), 16)
    search = partial(
        swaps.run, static=GwoStatic("linear", leaders, greedy), iterations=12, population=6
    )
    order, history = jax.jit(search)(jnp.asarray(distances, jnp.float32), seeds, GwoParams())
    found = [plain_length(row, distances) for row in np.asarray(order).T.tolist()]
    np.testing.assert_allclose(history[-1], found, rtol=1e-5)
    assert (np.diff(history, axis=0) <= 0).all()
    assert (history[0] > history[-1]).sum() > 8


def test_patience_is_a_parameter() -> None:
    options = {"algorithm": "ils", "iterations": 60, "runs": 2}
    found = solve_tour(PROBLEMS[0], 5, params=IlsParams(patience=np.array([0, 1000])), **options)
    best = shortest(straight(PROBLEMS[0]))
    np.testing.assert_allclose(found.length, best, rtol=1e-6)


@pytest.mark.parametrize("algorithm", ["gwo", "aco"])
def test_an_open_tour_ends_anywhere(algorithm: str) -> None:
    found = solve_tour(PROBLEMS, 5, algorithm=algorithm, closed=False, **SMALL[algorithm])
    assert (found.order[:, 0] == 0).all()
    for run, points in enumerate(PROBLEMS):
        wanted = plain_length(found.order[run].tolist(), straight(points), closed=False)
        assert found.length[run] == pytest.approx(wanted)
        assert wanted < 1.6 * shortest(straight(points), closed=False)
