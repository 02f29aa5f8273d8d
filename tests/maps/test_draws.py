"""Random numbers of jobs: what they may not depend on."""

import jax
import numpy as np
import pytest

from usvjax.maps.draws import (
    Stream,
    in_rounds,
    round_bits,
    round_uniforms,
    uniform_fields,
    uniform_points,
)

JOBS = np.arange(70)
SOME = np.asarray([69, 3, 40])


def test_the_field_is_that_of_folded_keys():
    key = jax.random.fold_in(jax.random.key(2**32 - 1), 11)
    expected = np.asarray(jax.random.uniform(key, (5,)), np.float64)
    assert (uniform_fields(2**32 - 1, np.asarray([3, 11]), 5)[1] == expected).all()


def test_rounds_are_those_of_keys_folded_further():
    key = jax.random.fold_in(jax.random.key(9), 40)
    expected = jax.random.uniform(jax.random.fold_in(key, 6), (5,))
    assert (round_uniforms(9, SOME, 6, 5, 3)[2] == np.asarray(expected)).all()
    key = jax.random.fold_in(jax.random.fold_in(key, int(Stream.STATIONS)), 6)
    expected = jax.random.bits(key, (5,), np.uint32).tolist()
    assert round_bits(9, SOME, Stream.STATIONS, 6, 5, 3)[2] == expected
    assert round_bits(9, SOME, Stream.ENDS, 6, 5, 3)[2] != expected


def test_the_first_points_are_the_same_whatever_their_number():
    few, many = (uniform_points(4, JOBS, count) for count in (10, 130))
    assert few.shape == (70, 10, 2)
    np.testing.assert_array_equal(few, many[:, :10])


@pytest.mark.parametrize("size", [1, 2, 64, 100])
def test_a_round_is_the_same_however_many_draw_at_once(size):
    among = round_uniforms(4, JOBS, 2, 3, 70)
    np.testing.assert_array_equal(round_uniforms(4, SOME, 2, 3, size), among[SOME])
    bits = round_bits(4, JOBS, Stream.ENDS, 2, 3, 70)
    assert round_bits(4, SOME, Stream.ENDS, 2, 3, size) == [bits[job] for job in SOME]


def test_who_went_empty_tries_again_until_the_last_round():
    seen = []

    def attempt(rows, number):
        seen.append((rows.tolist(), number))
        return rows < number

    assert in_rounds(4, 3, attempt).tolist() == [2, 3]
    assert seen == [([0, 1, 2, 3], 0), ([0, 1, 2, 3], 1), ([1, 2, 3], 2)]
    assert in_rounds(2, 9, lambda rows, _: rows >= 0).tolist() == []
    assert in_rounds(0, 9, lambda *_: pytest.fail("nobody tries")).tolist() == []
