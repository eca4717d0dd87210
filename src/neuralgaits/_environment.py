"""Settings for a process that belongs to this program: the command line's, or a worker's.

Those of JAX are environment variables, so they reach processes that this one starts and need no
import of it. Variables that the user has set keep their values, but for double precision and the
back end of Matplotlib.
"""

import contextlib
import ctypes
import gc
import logging
import os
import re
import sys
import warnings

from neuralgaits._cache import cache_folder
from neuralgaits._printable import printable

OFF_SCREEN = {"egl": "libEGL.so.1", "osmesa": "libOSMesa.so"}
"""Values of MUJOCO_GL that need no window, best first, and the library that each one needs."""
THREADS = "NEURALGAITS_THREADS"
"""Environment variable: number of threads of a computation; all cores if it is not set."""
_USUAL = {
    # Many small programs: their compile times add up to more than reading them back.
    "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
    "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
    # The C++ side reports cache hits and CPU features as if they were errors.
    "TF_CPP_MIN_LOG_LEVEL": "2",
}
"""Variables of libraries where the user has set none, beside those of `prepare` itself."""
OURS = frozenset(("JAX_ENABLE_X64", "JAX_COMPILATION_CACHE_DIR", *_USUAL))
"""Variables of JAX that a command sets for itself."""
_PLATFORM = ("JAX_PLATFORMS", "JAX_PLATFORM_NAME")
"""Environment variables that name the platform that JAX computes on."""
_NO_PLATFORM = re.compile("^(Unable to initialize|Unknown) backend ")
"""Messages of JAX about one that is not there."""


def prepare() -> None:
    """Prepare a process: double precision in JAX, compilations kept between calls, no warnings.

    Warnings and log lines of libraries say nothing that a user can act on; -W and PYTHONWARNINGS
    show them.
    """
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
        # It prints the lines of loggers that nobody has given a handler.
        logging.lastResort = logging.NullHandler()
    # Imports and tracing make millions of objects that stay: looking for rubbish among them
    # every 700 takes a fourteenth of a command's time.
    gc.set_threshold(100_000, 50, 100)
    os.environ["JAX_ENABLE_X64"] = "1"
    # Figures go to files. Jupyter sets this for every process, to one that is only in notebooks.
    os.environ["MPLBACKEND"] = "agg"
    defaults = {"JAX_COMPILATION_CACHE_DIR": str(cache_folder() / "jax"), **_USUAL}
    for name, value in defaults.items():
        os.environ.setdefault(name, value)
    # XLA takes no other path than one in UTF-8: without a cache it works, too.
    folder = os.environ["JAX_COMPILATION_CACHE_DIR"]
    if printable(folder) != folder:
        del os.environ["JAX_COMPILATION_CACHE_DIR"]


def why_no_platform(error: BaseException) -> str | None:
    """Explain an error by a platform that the environment names and JAX does not find here.

    JAX takes its own frames out of tracebacks, and some of its messages are empty. So it is asked
    again.

    Returns: one line; None if that is not the reason.
    """
    name = next(filter(os.environ.get, _PLATFORM), None)
    # Not imported here: without it nothing was computed, and checkers need none.
    jax = sys.modules.get("jax")
    if name is None or jax is None:
        return None
    if not _NO_PLATFORM.match(str(error)):
        with contextlib.suppress(Exception):
            jax.devices()
            return None
    return (
        f"expected a platform that JAX finds here, found {name}={os.environ[name]}: unset it or "
        "set it to cpu"
    )


def render_without_screen() -> None:
    """Have MuJoCo render off the screen where there is none, if it has not been imported yet.

    Nothing changes if the user has set MUJOCO_GL, or if no library for it can be loaded:
    MuJoCo refuses to be imported with a back end that is not there.
    """
    screens = ("DISPLAY", "WAYLAND_DISPLAY", "MUJOCO_GL")
    if sys.platform != "linux" or "mujoco" in sys.modules or any(map(os.environ.get, screens)):
        return
    for backend, library in OFF_SCREEN.items():
        try:
            ctypes.CDLL(library)
        except OSError:
            continue
        os.environ["MUJOCO_GL"] = backend
        return


def one_thread() -> None:
    """Limit this process to one thread from now on, since other processes work beside it.

    Sums are then added in one order, however many cores the machine has.
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
    """Return the number of threads of a computation: all cores of this process, or `THREADS`."""
    said = os.environ.get(THREADS, "")
    if said.isdecimal() and int(said) > 0:
        return int(said)
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
