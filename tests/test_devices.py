"""Devices, the compilation cache and sharing work out."""

import os
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import jax
import jax.numpy as jnp
import pytest

from usvjax.devices import ONE_THREAD, chosen_devices, share_out, usable_cores


def run_python(code: str, **variables: str) -> str:
    """What a fresh interpreter prints; variables set to "" are removed."""
    env = {**os.environ, **variables}
    env = {name: value for name, value in env.items() if value or name not in variables}
    done = subprocess.run(
        [sys.executable, "-c", code], env=env, capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


COUNT = "import usvjax, jax; print(jax.device_count())"


@pytest.mark.parametrize(
    ("code", "variable", "count"),
    [
        (COUNT, "", usable_cores()),
        (COUNT, "3", 3),
        ("import jax, usvjax; print(jax.device_count())", "", usable_cores()),
        (
            "from usvjax import use_all_cores as u; u(5); import jax; print(jax.device_count())",
            "3",
            5,
        ),
        # JAX runs already: its devices stay.
        ("import jax; jax.devices(); import usvjax; print(jax.device_count())", "", 1),
    ],
    ids=["by itself", "as set", "jax first", "as asked", "too late"],
)
def test_number_of_host_devices(code: str, variable: str, count: int) -> None:
    assert run_python(code, JAX_NUM_CPU_DEVICES=variable, XLA_FLAGS="") == str(count)


def test_number_of_host_devices_by_a_flag() -> None:
    flags = "--xla_force_host_platform_device_count=4"
    assert run_python(COUNT, JAX_NUM_CPU_DEVICES="", XLA_FLAGS=flags) == "4"


def test_usable_cores_follow_the_affinity() -> None:
    assert 1 <= usable_cores() <= (os.cpu_count() or 1)
    if hasattr(os, "sched_setaffinity"):
        code = (
            "import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\n"
            "from usvjax.devices import usable_cores; print(usable_cores())"
        )
        assert run_python(code) == "1"


UNSET = {"JAX_COMPILATION_CACHE_DIR": "", "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": ""}
"""Of the variables that the tests themselves run with."""


def test_compilation_cache_is_used(tmp_path: Path) -> None:
    code = (
        "import jax, jax.numpy as jnp\n"
        "from usvjax.devices import use_compilation_cache\n"
        "print(use_compilation_cache())\n"
        "jax.config.update('jax_persistent_cache_min_compile_time_secs', 0)\n"
        "jax.jit(lambda x: jnp.sin(x) @ jnp.cos(x).T)(jnp.ones((8, 8)))\n"
    )
    folder = run_python(code, XDG_CACHE_HOME=str(tmp_path), **UNSET)
    assert Path(folder) == tmp_path / "usvjax" / "compiled"
    assert list(Path(folder).iterdir())
    home = run_python(
        "from usvjax.devices import use_compilation_cache as u; print(u())",
        XDG_CACHE_HOME="",
        HOME=str(tmp_path),
        **UNSET,
    )
    assert Path(home) == tmp_path / ".cache" / "usvjax" / "compiled"


SETTINGS = (
    "from usvjax.devices import use_compilation_cache as u; u()\n"
    "import jax; print(jax.config.jax_compilation_cache_dir)\n"
    "print(jax.config.jax_persistent_cache_min_compile_time_secs)\n"
)


@pytest.mark.parametrize(
    ("before", "variables", "folder", "seconds"),
    [
        ("", {}, "{}/usvjax/compiled", 0.1),
        ("", {"JAX_COMPILATION_CACHE_DIR": "{}/mine"}, "{}/mine", 0.1),
        (
            "import jax; jax.config.update('jax_compilation_cache_dir', '{}/mine')\n",
            {},
            "{}/mine",
            0.1,
        ),
        ("", {"JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "1"}, "{}/usvjax/compiled", 1.0),
        (
            "import jax; jax.config.update('jax_persistent_cache_min_compile_time_secs', 7.0)\n",
            {},
            "{}/usvjax/compiled",
            7.0,
        ),
    ],
    ids=["ours", "variable", "config", "seconds by variable", "seconds by config"],
)
def test_what_the_user_has_set_of_the_cache_stays(
    tmp_path: Path, before: str, variables: dict[str, str], folder: str, seconds: float
) -> None:
    place = str(tmp_path)
    given = {name: value.format(place) for name, value in variables.items()}
    found = run_python(before.format(place) + SETTINGS, XDG_CACHE_HOME=place, **(UNSET | given))
    assert found.split() == [folder.format(place), str(float(seconds))]


def test_a_forked_child_of_a_running_jax_is_told_and_does_not_hang() -> None:
    code = (
        "import os, warnings, jax, usvjax as uj\n"
        "from usvjax.devices import chosen_devices\n"
        "warnings.simplefilter('ignore')\n"
        "def child():\n"
        "    if os.fork() == 0:\n"
        "        try:\n"
        "            chosen_devices()\n"
        "        except uj.BadInputError as error:\n"
        "            print('refused', 'spawn' in str(error), flush=True)\n"
        "        os._exit(0)\n"
        "    os.wait()\n"
        "chosen_devices()\n"
        "child()\n"
    )
    assert run_python(code) == "refused True"
    early = code.replace("chosen_devices()\nchild", "child").replace(
        "            chosen_devices()", "            print(len(chosen_devices()) > 0, flush=True)"
    )
    assert run_python(early) == "True"


@pytest.mark.parametrize("platform", ["cuda", "nonsense"])
def test_a_platform_that_is_not_there_is_one_line(platform: str) -> None:
    code = (
        "import numpy as np, usvjax as uj\n"
        "try:\n    uj.astar(np.zeros((3, 3), bool), [0, 0], [2, 2])\n"
        "except uj.BadInputError as error:\n    print(error)"
    )
    said = run_python(code, JAX_PLATFORMS=platform)
    assert said.startswith(f"JAX cannot start on this machine with JAX_PLATFORMS={platform}; ")
    assert "\n" not in said


def test_chosen_devices() -> None:
    every = jax.local_devices()
    assert chosen_devices() == every
    with jax.default_device(every[-1]):
        assert chosen_devices() == [every[-1]]
    with jax.default_device("cpu"):
        assert chosen_devices() == jax.local_devices(backend="cpu")
    assert chosen_devices() == every


# --- sharing work out; any objects will do for devices ----------------------------------------

THREE = ["a", "b", "c"]


def share(work: Callable[[int, str], object], items: range) -> list[object]:
    return list(share_out(work, items, THREE))  # type: ignore[arg-type]


def test_results_come_in_the_order_of_the_items() -> None:
    def work(item: int, _: str) -> int:
        time.sleep(0.03 if item % 3 == 0 else 0.0)  # the first of each three ends last
        return item * item

    assert share(work, range(12)) == [item * item for item in range(12)]
    assert share(work, range(0)) == []


def test_a_device_runs_one_item_at_a_time_and_takes_the_next_when_free() -> None:
    lock, others_are_done = threading.Lock(), threading.Event()
    busy, most, done = Counter[str](), Counter[str](), Counter[str]()

    def work(item: int, device: str) -> None:
        with lock:
            busy[device] += 1
            most[device] = max(most[device], busy[device])
            done[device] += 1
        if item == 0:
            assert others_are_done.wait(timeout=30), "the others waited for the first device"
        elif item == 19:
            others_are_done.set()
        time.sleep(0.005)
        with lock:
            busy[device] -= 1

    share(work, range(20))
    assert most == dict.fromkeys(THREE, 1)
    assert min(done.values()) == 1
    assert sum(done.values()) == 20


def test_devices_work_at_the_same_time() -> None:
    together = threading.Barrier(3, timeout=10)

    def work(item: int, device: str) -> str:
        together.wait()  # passes only when all three are at work
        return device

    assert set(share(work, range(3))) == set(THREE)


def test_one_thread_splits_no_operation() -> None:
    def compiled(options: dict[str, str]) -> str:
        wave = jax.jit(lambda x: jnp.sin(x) * jnp.cos(x), compiler_options=options)
        return wave.lower(jnp.zeros(1_000_000)).compile().as_text() or ""

    split = "outer_dimension_partitions"
    assert split not in compiled(ONE_THREAD)
    if usable_cores() > 1:
        assert split in compiled({}), "XLA calls it something else now"


def test_an_exception_comes_through() -> None:
    ran = []

    def work(item: int, _: str) -> int:
        ran.append(item)
        time.sleep(0.01)
        if item == 3:
            raise KeyError("item 3")
        return item

    results = share_out(work, range(200), THREE)  # type: ignore[arg-type]
    assert [next(results) for _ in range(3)] == [0, 1, 2]
    with pytest.raises(KeyError, match="item 3"):
        next(results)
    assert len(ran) < 200, "what nobody waits for any more still ran"
