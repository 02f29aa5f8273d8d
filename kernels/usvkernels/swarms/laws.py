"""Laws of the convergence factor a(t) of grey wolves: wide search at 2, none at 0."""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array
from jax.scipy.special import betaln
from jax.typing import DTypeLike

LAWS = ("linear", "beta", "quadratic", "cosine", "exponential")


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class GwoParams:
    """Numbers of the law "beta", Yu et al. 2022, Eq. 14; each a number or float[R], one per run.

    Attributes:
        mu1: position adjustment factor, scale of the Beta function.
        mu2: position adjustment factor, its first argument, above 0.
        lambda1: speed adjustment factor (iterations), above 0.
        lambda2: speed adjustment factor, added to a.
    """

    mu1: float | Array = 0.01  # Table 2
    mu2: float | Array = 0.1  # Table 2
    lambda1: float | Array = 1.0  # Table 2
    lambda2: float | Array = 0.1  # Table 2


def convergence(
    law: str, iterations: int, params: GwoParams, dtype: DTypeLike = jnp.float32
) -> Array:
    """The factor a(t) for t = 0 .. iterations - 1.

    Args:
        law: "linear": 2 - 2 t / T (Yu et al. 2022, Eq. 2; Mirjalili et al. 2014).
            "beta": mu1 B(mu2, (t + lambda1) / T) + lambda2 (Eq. 14 as printed). With the printed
            factors it falls from 2.2 to 0.5 within five iterations and ends near 0.2, not 0.
            "quadratic": 2 (1 - t**2 / T**2) (Mittal et al. 2016). "cosine": 1 + cos(pi t / T).
            "exponential": 2 (e - exp(t / T)) / (e - 1).
        iterations: T.
        params: of "beta"; leaves float or float[R].
        dtype: of the result.

    Returns:
        float[T, 1], or float[T, R] where a leaf of `params` has an axis.
    """
    step = jnp.arange(iterations, dtype=dtype)[:, None]
    share = step / iterations
    if law == "linear":
        return 2 - 2 * share
    if law == "quadratic":
        return 2 * (1 - share**2)
    if law == "cosine":
        return 1 + jnp.cos(jnp.pi * share)
    if law == "exponential":
        return 2 * (jnp.e - jnp.exp(share)) / (jnp.e - 1)
    if law != "beta":
        raise ValueError(f"law: got {law!r}; wanted one of {LAWS}")
    mu1, mu2, lambda1, lambda2 = (
        jnp.asarray(leaf, dtype)
        for leaf in (params.mu1, params.mu2, params.lambda1, params.lambda2)
    )
    return mu1 * jnp.exp(betaln(mu2, (step + lambda1) / iterations)) + lambda2
