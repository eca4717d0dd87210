"""Strict numerics for every test, and one core each: pytest-xdist already uses them all."""

import os
import shutil
import time
from pathlib import Path

for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_variable] = "1"
_flags = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
os.environ["XLA_FLAGS"] = f"{os.environ.get('XLA_FLAGS', '')} {_flags}".strip()
os.environ["JAX_ENABLE_X64"] = "1"
os.environ["JAX_NUMPY_RANK_PROMOTION"] = "raise"
os.environ["JAX_PLATFORMS"] = "cpu"

# Compiling is most of what the tests do. Workers must not write into one another's cache.
_worker = os.environ.get("PYTEST_XDIST_WORKER", "main")
_cache = Path(__file__).parents[1] / ".cache" / "jax" / _worker
os.environ["JAX_COMPILATION_CACHE_DIR"] = str(_cache)
os.environ["JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"] = "0.1"

import pytest  # noqa: E402
from hypothesis import settings  # noqa: E402

# Compilation makes the first example slow; a derandomised run fails the same way for everyone.
settings.register_profile("neuralgaits", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("neuralgaits")


@pytest.fixture(scope="session")
def trained(tmp_path_factory: pytest.TempPathFactory):
    """A finished run of the default training on amber3m, shared by all workers."""
    from neuralgaits.robots import load_robot
    from neuralgaits.workflows.run import open_run
    from neuralgaits.workflows.train import train

    base = tmp_path_factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    folder, failed = shared / "trained", shared / "training-failed"
    try:
        (shared / "training").mkdir()  # The first to make it trains; the others wait.
    except FileExistsError:
        while not (folder / "summary.json").exists():
            assert not failed.exists(), "training failed in another worker"
            time.sleep(0.1)
    else:
        try:
            train(load_robot("amber3m"), out=folder, root=shared)
        except BaseException:
            failed.touch()
            raise
    return open_run(folder)


@pytest.fixture(scope="module")
def browser():
    """The machine's Chromium; one without a graphics card draws in software."""
    found = shutil.which("chromium") or shutil.which("chromium-browser")
    if found is None:
        pytest.skip("no Chromium on this machine: the page is not looked at")
    from playwright.sync_api import sync_playwright

    drawing = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    with sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=found, args=["--no-sandbox", *drawing])
        yield running
        running.close()
