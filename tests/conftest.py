"""What holds for all tests: the same cases in every run, and no terminal."""

import os
import shutil
import signal
import tempfile

import jax
import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers
from property_draws import FUZZ

from usvjax.programs import make_room

# No verdict depends on the clock: the first case of a test may compile for seconds.
TIMELESS = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("same", derandomize=True, **TIMELESS)
settings.register_profile("fuzz", derandomize=False, max_examples=1000, print_blob=True, **TIMELESS)
settings.load_profile("fuzz" if FUZZ else "same")

if not FUZZ:
    # Hypothesis also draws constants of the modules imported so far: those differ with the tests
    # that ran before in the same process. There is no setting for it, so its version is pinned.
    providers._get_local_constants = lambda: providers._local_constants


def pytest_configure(config):
    """Processes of one run share what they compile, and nothing with the user's other runs."""
    if hasattr(config, "workerinput"):  # a worker has it from the process that started it
        return
    folder = tempfile.mkdtemp(prefix="usvjax-compiled-")
    os.environ["JAX_COMPILATION_CACHE_DIR"] = folder
    os.environ["JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"] = "0.2"
    config.add_cleanup(lambda: shutil.rmtree(folder, ignore_errors=True))


@pytest.fixture(scope="module")
def one_device():
    """Each device compiles for itself: for tests of what does not depend on devices."""
    with jax.default_device(jax.devices()[0]):
        yield


@pytest.fixture(autouse=True, scope="module")
def room():
    """A worker compiles more programs than a process has room for."""
    make_room()


@pytest.fixture(autouse=True, scope="session")
def heeding_interrupts():
    """In a shell's background the tests, and what they start, would ignore Ctrl-C."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(autouse=True)
def no_terminal(monkeypatch):
    """Whoever runs the tests may have set how wide and colourful output is to be."""
    for name in ("COLUMNS", "LINES", "NO_COLOR", "FORCE_COLOR", "TTY_COMPATIBLE"):
        monkeypatch.delenv(name, raising=False)
