"""Strict numerics for every test, and one core each: pytest-xdist already uses them all."""

import functools
import gc
import os
import shutil
import sys
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

gc.set_threshold(100_000, 50, 100)  # As the command line does.
for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_variable] = "1"
os.environ["NPROC"] = "1"  # The size of XLA's pool of threads.
# What is compiled of the package and of the tests is kept, for child processes too.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
# XLA reads no further than the first word that does not begin with a dash.
_flags = "--xla_cpu_multi_thread_eigen=false"
# Tests compile more than they compute: what makes code fast would take longer than it saves.
_flags += " --xla_backend_optimization_level=0 --xla_cpu_parallel_codegen_split_count=1"
if tuple(map(int, version("jax").split(".")[:2])) < (0, 11):
    # Later compilers refuse what they do not know, as in `neuralgaits._quick_jit`.
    _flags += " --xla_cpu_use_fusion_emitters=false --xla_cpu_experimental_ynn_fusion_type="
os.environ["XLA_FLAGS"] = f"{os.environ.get('XLA_FLAGS', '')} {_flags}".strip()
os.environ["JAX_ENABLE_X64"] = "1"
os.environ["JAX_NUMPY_RANK_PROMOTION"] = "raise"
os.environ["JAX_PLATFORMS"] = "cpu"

# Compiling is most of what the tests do: workers share what is compiled. With a largest size, JAX
# locks its cache; without the last setting, its place would be part of every key.
_cache = Path(__file__).parents[1] / ".cache"
os.environ["JAX_COMPILATION_CACHE_DIR"] = str(_cache / "jax")
os.environ["JAX_COMPILATION_CACHE_MAX_SIZE"] = str(2**32)
os.environ["JAX_PERSISTENT_CACHE_ENABLE_XLA_CACHES"] = "none"
os.environ["JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"] = "0.1"
# Compiled walks are put there whole.
os.environ["XDG_CACHE_HOME"] = str(_cache)

import pytest  # noqa: E402
from hypothesis import settings  # noqa: E402

# Compilation makes the first example slow; a derandomised run fails the same way for everyone.
settings.register_profile("neuralgaits", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("neuralgaits")
Maker = Callable[[Path], object]


_MAKERS = "certified_5", "proofcheck", "speed_run"
"""Fixtures that take longest to make, which one worker makes and others wait for."""
_SHARED = {*_MAKERS, "trained", "certified"}
_QUICK_FOLDERS = {"barriers", "control", "gait", "logs", "programs", "records", "robots", "runs"}
"""Folders of short files."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Sort files, which the workers are given in this order, so that no worker waits for another.

    First comes a file for each of `_MAKERS`, so that workers make them at the same time; then
    files with slow tests, those that share nothing before the others; last come short files.
    """
    # No set: each worker must come to the same order.
    shared = {item.path: set[str]() for item in items if item.get_closest_marker("slow")}
    for item in items:
        if item.path in shared:
            shared[item.path] |= _SHARED & set(getattr(item, "fixturenames", ()))
    makers = []
    for name in _MAKERS:
        able = (path for path, asked in shared.items() if asked & set(_MAKERS) == {name})
        makers += [path for path in able if path not in makers][:1]

    def rank(item: pytest.Item) -> int:
        if item.path in makers:
            return makers.index(item.path)
        if item.path in shared:
            return len(makers) + bool(shared[item.path])
        return len(makers) + (3 if item.path.parent.name in _QUICK_FOLDERS else 2)

    items.sort(key=rank)


@pytest.fixture(scope="session", autouse=True)
def cache_is_measured_once():
    """JAX adds up its whole cache before it writes an entry: a process does that once.

    Among a thousand entries it takes as long as the compilation that is kept.
    """
    measured = []
    try:
        from jax._src.lru_cache import LRUCache

        evict = LRUCache._evict_if_needed
    except (ImportError, AttributeError):
        yield  # No part of JAX's interface: another version may have none.
        return

    def once(cache: LRUCache, *, additional_size: int = 0) -> None:
        if not measured:
            measured.append(True)
            evict(cache, additional_size=additional_size)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(LRUCache, "_evict_if_needed", once)
        yield


@pytest.fixture(scope="session", autouse=True)
def dialects_are_loaded_once():
    """JAX loads all dialects of its compiler for each function that it compiles: once is enough.

    For most functions that takes a tenth of the time.
    """
    try:
        from jax._src.interpreters import mlir

        context = functools.cache(mlir.make_ir_context)
    except (ImportError, AttributeError):
        yield  # As above.
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(mlir, "make_ir_context", context)
        yield


@pytest.fixture(scope="session", autouse=True)
def executables_are_at_hand():
    """What a worker compiled, or read from the cache, it has when the same is asked for again."""
    from support.kept_executables import keep

    with pytest.MonkeyPatch.context() as patch:
        keep(patch)
        yield


@pytest.fixture(scope="session")
def runs_traced_once(tmp_path_factory: pytest.TempPathFactory):
    """What proofs are compared with, of each run once for all tests that read the same bytes."""
    from neuralgaits.certificate.run_certificate import run_comparison
    from support.traced_once import TracedOnce

    traced = TracedOnce(_of_all_workers(tmp_path_factory))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run_comparison, "retrace", traced)
        for name in ("setattr", "delattr", "setitem", "delitem"):
            patch.setattr(pytest.MonkeyPatch, name, traced.distrusting(name))
        yield traced


@pytest.fixture(scope="session", autouse=True)
def results_are_kept(runs_traced_once, tmp_path_factory: pytest.TempPathFactory):
    """Of functions that tests have computed for equal arguments, as long as nobody patches them."""
    from support.kept_results import KeptResults

    with pytest.MonkeyPatch.context() as patch:
        kept = KeptResults(_of_all_workers(tmp_path_factory))
        kept.patch(patch)
        yield kept


@pytest.fixture(autouse=True)
def trust_in_what_was_traced(runs_traced_once):
    """Until a test patches the program: from then on it traces its runs itself."""
    runs_traced_once.trusted = True


def _of_all_workers(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder of this test run, the same one for all of its workers."""
    base = tmp_path_factory.getbasetemp()
    return base.parent if "PYTEST_XDIST_WORKER" in os.environ else base


@pytest.fixture(scope="session")
def made_once(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, Maker], Path]:
    """A folder by its name, which the first worker to ask makes and the others wait for."""
    shared = _of_all_workers(tmp_path_factory)

    def once(name: str, make: Maker) -> Path:
        folder, done, failed = (shared / f"{name}{end}" for end in ("", "-done", "-failed"))
        try:
            (shared / f"{name}-begun").mkdir()
        except FileExistsError:
            while not done.exists():
                assert not failed.exists(), f"another worker could not make {name}"
                time.sleep(0.1)
        else:
            try:
                make(folder)
            except BaseException:
                failed.touch()
                raise
            done.touch()
        return folder

    return once


@pytest.fixture(scope="session")
def trained(made_once):
    """A finished run of the default training on amber3m, shared by all workers."""
    from neuralgaits.analysis.run import open_run
    from neuralgaits.robots import load_robot
    from neuralgaits.workflows.train import train

    def make(run: Path) -> None:
        train(load_robot("amber3m"), out=run, root=run.parent)

    return open_run(made_once("trained", make))


@pytest.fixture(scope="session")
def certified(trained, made_once):
    """A copy of it, proved to level 3, shared by all workers: nobody changes it."""
    return _proved(trained, made_once, 3)


@pytest.fixture(scope="session")
def certified_5(trained, made_once):
    """A copy of it, proved to level 5, shared by all workers: nobody changes it."""
    return _proved(trained, made_once, 5)


def _proved(trained, made_once: Callable[[str, Maker], Path], level: int):
    from neuralgaits.analysis.run import open_run
    from neuralgaits.workflows.certify import certify

    def make(run: Path) -> None:
        shutil.copytree(trained.path, run)
        done = certify(run, level=level)
        assert done.verdict == "proved", done.conclusions[-1].reason

    return open_run(made_once(f"certified-{level}", make))


@pytest.fixture(scope="session")
def small_run(made_once):
    """Two steps of tests/support/small_spec.py, shared by all workers: nobody changes it."""
    return _two_steps(made_once, "small")


@pytest.fixture(scope="session")
def relu_run(made_once):
    """The same with the paper's activation, which cannot be proved."""
    return _two_steps(made_once, "relu")


@pytest.fixture(scope="session")
def small_cartpole(made_once):
    """Folder of a cart-pole's run with a small set, near the linear start: nobody changes it."""
    from support import system_runs

    return made_once("small-cartpole", system_runs.small("cartpole", 20))


@pytest.fixture(scope="session")
def small_hopper(made_once):
    """Folder of the hopper's gait that a training starts from, which is proved as it is."""
    from support import system_runs

    return made_once("small-hopper", system_runs.small("hopper", 0))


@pytest.fixture(scope="session")
def feet_run(made_once):
    """A short training on flat feet, shared by all workers: nobody changes it."""
    from neuralgaits.analysis.run import open_run
    from support import system_runs

    return open_run(made_once("feet", system_runs.feet))


def _two_steps(made_once: Callable[[str, Maker], Path], name: str):
    from neuralgaits.analysis.run import open_run
    from neuralgaits.robots import load_robot
    from neuralgaits.workflows.train import train
    from support import small_spec

    def make(run: Path) -> None:
        spec = f"{small_spec.__file__}:{name}"
        train(load_robot("amber3m"), spec, hidden=(4,), steps=2, out=run, root=run.parent)

    return open_run(made_once(f"{name}-run", make))


@pytest.fixture(scope="module")
def browser():
    """The machine's Chromium; one without a graphics card draws in software."""
    names = "chromium", "chromium-browser", "chromium-headless-shell"
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None:
        pytest.skip("no Chromium on this machine: the page is not looked at")
    from playwright.sync_api import sync_playwright

    drawing = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    with sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=found, args=["--no-sandbox", *drawing])
        yield running
        running.close()
