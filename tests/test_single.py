"""Functions compiled as one piece."""

import jax
import jax.numpy as jnp
import numpy as np

from usvkernels.xla.single import single

LANES = 16


def test_arguments_that_nothing_comes_of_are_left_out() -> None:
    # XLA ends the process on them, inside two loops and a branch as in the lanes.
    def move(given: dict[str, jax.Array], rows: jax.Array) -> dict[str, jax.Array]:
        return {"sum": rows[0] + given["used"] * rows[1], "product": rows[0] * rows[1]}

    @jax.jit
    def run(given: dict[str, jax.Array], rows: jax.Array) -> jax.Array:
        def step(_: int, rows: jax.Array) -> jax.Array:
            moved = jax.lax.cond(
                given["used"] > 0.0, lambda: single(move, given, rows), lambda: move(given, rows)
            )
            return jnp.stack([moved["sum"], moved["product"]])

        return jax.lax.fori_loop(0, 3, lambda _, rows: jax.lax.fori_loop(0, 2, step, rows), rows)

    rows = np.linspace(0.1, 0.9, 2 * LANES, dtype=np.float32).reshape(2, LANES)
    want = rows
    for _ in range(6):
        want = np.stack([want[0] + np.float32(0.5) * want[1], want[0] * want[1]])
    given = {"unused": jnp.float32(3.0), "used": jnp.float32(0.5), "idle": jnp.ones(LANES)}
    np.testing.assert_allclose(run(given, jnp.asarray(rows)), want, rtol=1e-6)


def test_results_keep_their_structure() -> None:
    def parts(a: jax.Array, b: jax.Array) -> tuple[jax.Array, list[jax.Array]]:
        return a + b, [a - b, b]

    total, (difference, same) = jax.jit(lambda a, b: single(parts, a, b))(
        jnp.arange(LANES), jnp.ones(LANES, int)
    )
    np.testing.assert_array_equal(total, np.arange(LANES) + 1)
    np.testing.assert_array_equal(difference, np.arange(LANES) - 1)
    np.testing.assert_array_equal(same, np.ones(LANES))
