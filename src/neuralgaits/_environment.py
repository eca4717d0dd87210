"""Settings for a process that belongs to this program: the command line's, or a worker's.

Those of JAX are environment variables, so they reach processes that this one starts and need no
import of it. What the user has set stays.
"""

import gc
import os

from neuralgaits._cache import cache_folder
from neuralgaits._printable import printable

THREADS = "NEURALGAITS_THREADS"
"""Variable: how many threads a computation of this program may use; all cores if not set."""


def prepare() -> None:
    """Double precision, and compilations kept from one call to the next."""
    # Imports and tracing make millions of objects that stay: looking for rubbish among them
    # every 700 takes a fourteenth of a command's time.
    gc.set_threshold(100_000, 50, 100)
    os.environ["JAX_ENABLE_X64"] = "1"
    defaults = {
        "JAX_COMPILATION_CACHE_DIR": str(cache_folder() / "jax"),
        # Many small programs: their compile times add up to more than reading them back.
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
        "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
        # The C++ side reports cache hits and CPU features as if they were errors.
        "TF_CPP_MIN_LOG_LEVEL": "2",
    }
    for name, value in defaults.items():
        os.environ.setdefault(name, value)
    # XLA takes no other path than one in UTF-8: without a cache it works, too.
    folder = os.environ["JAX_COMPILATION_CACHE_DIR"]
    if printable(folder) != folder:
        del os.environ["JAX_COMPILATION_CACHE_DIR"]


def one_thread() -> None:
    """One thread for all that this process computes from now on: others work beside it.

    Sums are then added in one order, whatever the machine has cores.
    """
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", THREADS):
        os.environ[name] = "1"
    # The pool of XLA: its size, and whether single operations are cut up for it.
    os.environ["NPROC"] = "1"
    flag = "--xla_cpu_multi_thread_eigen=false"
    flags = os.environ.get("XLA_FLAGS", "")
    if flag not in flags:
        os.environ["XLA_FLAGS"] = f"{flags} {flag}".strip()


def cores() -> int:
    """Threads that a computation may use: all cores of this process, or what `THREADS` says."""
    said = os.environ.get(THREADS, "")
    if said.isdecimal() and int(said) > 0:
        return int(said)
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
