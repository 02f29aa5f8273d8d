"""Functions compiled as one piece."""

import jax
import jax.numpy as jnp
import numpy as np

from usvkernels import lanes
from usvkernels.xla.single import single
from usvkernels.xla.stage import stage

JOBS, LANES = 100, 16

State = dict[str, jax.Array]


def test_arguments_that_nothing_comes_of_are_left_out() -> None:
    # In the lanes, XLA ends the process on a piece that takes them.
    def move(given: dict[str, jax.Array], place: jax.Array) -> jax.Array:
        return jnp.stack([place[0] + given["used"] * place[1], place[1]])

    @jax.jit
    def run(given: dict[str, jax.Array], go: jax.Array) -> jax.Array:
        def start(job: jax.Array) -> State:
            place = jnp.stack([jnp.zeros(job.shape), job.astype(float)])
            return {"place": place, "steps": jnp.zeros(job.shape, int)}

        def step(state: State) -> State:
            moved = stage(go, lambda *args: single(move, *args), given, state["place"])
            return {"place": moved, "steps": state["steps"] + 1}

        program = lanes.Program(
            start=start,
            step=step,
            done=lambda state: state["steps"] >= 3,
            result=lambda state: state["place"][0],
            taken=lambda state: state["steps"],
        )
        return lanes.run(program, JOBS, capacity=JOBS, lanes=2 * LANES, chunk=2, max_steps=3)[0]

    given = {"unused": jnp.array(3.0), "used": jnp.array(0.5), "idle": jnp.ones(LANES)}
    np.testing.assert_array_equal(run(given, jnp.array(True)), 1.5 * np.arange(JOBS))


def test_results_keep_their_structure() -> None:
    def parts(a: jax.Array, b: jax.Array) -> tuple[jax.Array, list[jax.Array]]:
        return a + b, [a - b, b]

    total, (difference, same) = jax.jit(lambda a, b: single(parts, a, b))(
        jnp.arange(LANES), jnp.ones(LANES, int)
    )
    np.testing.assert_array_equal(total, np.arange(LANES) + 1)
    np.testing.assert_array_equal(difference, np.arange(LANES) - 1)
    np.testing.assert_array_equal(same, np.ones(LANES))
