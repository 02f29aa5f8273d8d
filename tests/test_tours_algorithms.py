"""The searches: tours, histories, independence of the batch, a replay in NumPy, distributions."""

from typing import Any

import jax
import numpy as np
import pytest
from tour_cases import plain_length, shortest, straight

from usvjax.tours import solve_tour, tour_length
from usvkernels import draws
from usvkernels.swarms.laws import GwoParams
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


def test_wolves_by_random_keys_against_numpy() -> None:
    # Whole numbers up to a power of two: no rounding decides between tours of one length.
    tables = np.random.default_rng(8).integers(1, 64, (5, COUNT, COUNT)).astype(float)
    tables = np.triu(tables, 1) + np.triu(tables, 1).transpose(0, 2, 1)
    tables[:, 0, 1] = tables[:, 1, 0] = 64
    found = solve_tour(distances=tables, key=5, algorithm="gwo", **SMALL["gwo"])
    seeds = np.asarray(draws.seeds(jax.random.key(5), 5))
    law = [2 - 2 * t / 8 for t in range(8)]
    for run in range(5):
        wanted = replayed(tables[run], seeds[:, run], law, 6)
        assert found.history[run].tolist() == wanted
        assert wanted[-1] < wanted[0]


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
