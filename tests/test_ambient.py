"""What usvjax computes does not depend on how JAX was set up."""

import os
import subprocess
import sys
from pathlib import Path

import jax
import numpy as np
import pytest

import usvjax as uj
from usvjax.errors import BadInputError
from usvjax.keys import seed_key

ROOT = Path(__file__).parents[1]
CHILD = ROOT / "tests" / "oracles" / "ambient_child.py"
FUZZ = "USVJAX_FUZZ" in os.environ

SETTINGS = {
    "rbg": {"JAX_DEFAULT_PRNG_IMPL": "rbg"},
    "unpartitioned": {"JAX_THREEFRY_PARTITIONABLE": "0"},
    "x64": {"JAX_ENABLE_X64": "1"},
    "strict promotion": {"JAX_NUMPY_DTYPE_PROMOTION": "strict"},
    "debug_nans": {"JAX_DEBUG_NANS": "1"},
    "all others": {
        "JAX_RANDOM_SEED_OFFSET": "5",
        "JAX_NUMPY_RANK_PROMOTION": "raise",
        "JAX_DEBUG_INFS": "1",
        "JAX_DEBUG_KEY_REUSE": "1",
        "JAX_LEGACY_PRNG_KEY": "error",
        "JAX_DEFAULT_MATMUL_PRECISION": "bfloat16",
        "JAX_TRANSFER_GUARD": "disallow",
    },
}


@pytest.fixture(scope="module")
def printed(tmp_path_factory):
    """A function from what to run and settings to what it printed."""
    # Programs are kept between the processes: that they fit shows that settings changed none.
    compiled = tmp_path_factory.mktemp("compiled")
    done = {}

    def run(which, settings):
        if (which, settings) not in done:
            folder = tmp_path_factory.mktemp("maps")
            path = os.pathsep.join(map(str, (ROOT, ROOT / "kernels", CHILD.parent)))
            env = {name: value for name, value in os.environ.items() if not name.startswith("JAX_")}
            env |= {"PYTHONPATH": path, "JAX_COMPILATION_CACHE_DIR": str(compiled)}
            env |= {"JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0"}
            child = subprocess.run(
                [sys.executable, str(CHILD), which, str(folder)],
                env=env | SETTINGS.get(settings, {}),
                capture_output=True,
                text=True,
                check=False,
            )
            assert child.returncode == 0, child.stderr[-2000:]
            done[which, settings] = child.stdout.splitlines()
        return done[which, settings]

    return run


@pytest.mark.parametrize("settings", SETTINGS if FUZZ else ["x64", "all others"])
def test_ten_calls_give_the_same_numbers(printed, settings):
    usual = printed("few", "")
    assert len(usual) == 10
    assert printed("few", settings) == usual


@pytest.mark.skipif(not FUZZ, reason="by `make fuzz`: minutes")
@pytest.mark.parametrize("which", ["calls", "studies"])
@pytest.mark.parametrize("settings", SETTINGS)
def test_everything_gives_the_same_numbers(printed, which, settings):
    assert printed(which, settings) == printed(which, "")


def test_a_seed_is_the_key_that_jax_makes_of_it():
    for seed in (0, 1, 7, 2**31, 2**32 - 1):
        key = jax.random.key(seed, impl="threefry2x32")
        np.testing.assert_array_equal(jax.random.key_data(seed_key(seed)), jax.random.key_data(key))


def test_a_key_is_worth_its_seed():
    want = uj.random_maps(3, 2, shape=(4, 5), density=0.5)
    for key in (jax.random.key(3, impl="threefry2x32"), jax.random.PRNGKey(3, impl="threefry2x32")):
        np.testing.assert_array_equal(uj.random_maps(key, 2, shape=(4, 5), density=0.5), want)


@pytest.mark.parametrize("impl", ["rbg", "unsafe_rbg"])
def test_a_key_of_another_kind_is_refused(impl):
    with pytest.raises(BadInputError, match=f"key: got a '{impl}' key; wanted 'threefry2x32'"):
        uj.random_maps(jax.random.key(3, impl=impl), 2)
    with pytest.raises(BadInputError, match=r"key: got shape \(4,\); wanted one threefry key"):
        uj.random_maps(jax.random.PRNGKey(3, impl=impl), 2)


def test_settings_of_the_caller_are_left_as_they_were():
    with jax.enable_x64(True), jax.numpy_dtype_promotion("strict"):
        uj.random_maps(3, 2)
        assert jax.numpy.ones(2).dtype == np.float64
        assert jax.config.jax_numpy_dtype_promotion == "strict"
