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
import traceback
import warnings
from pathlib import Path

from neuralgaits._cache import cache_folder
from neuralgaits._inputs import refuse_unreadable
from neuralgaits._printable import printable
from neuralgaits.errors import InputError

OFF_SCREEN = {"egl": "libEGL.so.1", "osmesa": "libOSMesa.so"}
"""Values of MUJOCO_GL that need no window, best first, and the library that each one needs."""
THREADS = "NEURALGAITS_THREADS"
"""Environment variable: number of threads of a computation; all cores if it is not set."""
PLAYER, COMPLETING = PAGE_THREADS = "player", "completing"
"""Names of the threads of a live page that may be in compiled code when the process ends."""
_USUAL = {
    # Many small programs: their compile times add up to more than reading them back.
    "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
    "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
    # The C++ side reports cache hits and CPU features as if they were errors.
    "TF_CPP_MIN_LOG_LEVEL": "2",
}
"""Variables of libraries where the user has set none, beside those of `prepare` itself."""


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
    # Matrices are small: threads of NumPy that wait for work take five times the time of the work.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Figures go to files. Jupyter sets this for every process, to one that is only in notebooks.
    os.environ["MPLBACKEND"] = "agg"
    defaults = {"JAX_COMPILATION_CACHE_DIR": str(cache_folder() / "jax"), **_USUAL}
    for name, value in defaults.items():
        os.environ.setdefault(name, value)
    # XLA takes no other path than one in UTF-8: without a cache it works, too.
    folder = os.environ["JAX_COMPILATION_CACHE_DIR"]
    if printable(folder) != folder:
        del os.environ["JAX_COMPILATION_CACHE_DIR"]


def refuse_settings_without_end() -> None:
    """Refuse a `matplotlibrc` that Matplotlib would wait for, or never finish: a FIFO, a device.

    Raises: InputError in one line.
    """
    own = os.environ.get("XDG_CONFIG_HOME") or os.path.expanduser("~/.config")
    folders = ["", os.path.join(own, "matplotlib")]
    settings = ("MPLCONFIGDIR", "MATPLOTLIBRC")
    folders += [os.environ[name] for name in settings if os.environ.get(name)]
    files = [os.path.join(folder, "matplotlibrc") for folder in folders]
    for file in (*files, os.environ.get("MATPLOTLIBRC") or os.devnull):
        # What cannot be looked at, or is no path, is left to Matplotlib.
        with contextlib.suppress(OSError, ValueError):
            if not os.path.samefile(file, os.devnull):
                refuse_unreadable(Path(file))


def why_jax_failed(error: BaseException) -> str | None:
    """Explain an unexpected error by the user's variables for JAX: its platform, or others.

    JAX takes its own frames out of tracebacks, and some of its messages are empty. So it is asked
    again for the platform. Any other variable that changes how it computes may be the reason.

    Returns: one line; None if JAX is not in use, or if no such variable is set.
    """
    # Not imported here: without it nothing was computed, and checkers need none.
    if "jax" not in sys.modules:
        return None
    return _no_platform(error) or _unusual(error)


def _no_platform(error: BaseException) -> str | None:
    """Explain an error by a platform that the environment names and JAX does not find here."""
    name = next(filter(os.environ.get, ("JAX_PLATFORMS", "JAX_PLATFORM_NAME")), None)
    if name is None:
        return None
    if not re.match("(Unable to initialize|Unknown) backend ", str(error)):
        with contextlib.suppress(Exception):
            sys.modules["jax"].devices()
            return None
    return (
        f"expected a platform that JAX finds here, found {name}={os.environ[name]}: unset it or "
        "set it to cpu"
    )


def _unusual(error: BaseException) -> str | None:
    """Explain an error by variables that change how JAX computes."""
    # Beginnings of variables that change nothing that JAX computes.
    harmless = (
        "JAX_(PLATFORM|LOG|TRACEBACK|ENABLE_COMPILATION_CACHE|COMPILATION_CACHE|PERSISTENT_CACHE"
        "|CUDA_VISIBLE|ROCM_VISIBLE)"
    )
    unusual = [one for one in variables_of_jax() if not re.match(harmless, one)]
    if not unusual or not _is_of_jax(error):
        return None
    characters = 120
    message = next(iter(str(error).splitlines()), "")[:characters]
    what = f"{type(error).__name__} ({message})" if message else type(error).__name__
    return (
        f"expected JAX to compute as it does without settings, found {', '.join(unusual)} and then "
        f"{what}: unset it, and report the error if it stays"
    )


def _is_of_jax(error: BaseException) -> bool:
    """Return whether JAX raised an error, and not what it was tracing.

    Its own frames may be left out of the traceback, so its messages are looked at, too.
    """
    frames = [str(f.f_globals.get("__name__")) for f, _ in traceback.walk_tb(error.__traceback__)]
    modules = [type(one).__module__ for one in (error, error.__cause__)] + frames[-1:]
    packages = ("jax", "jaxlib", "equinox", "jaxtyping")
    named = any(one.partition(".")[0] in packages for one in modules)
    match = re.search("jax|Leaked trac", str(error), re.IGNORECASE)
    # That is what it raises where NaN is looked for.
    return named or match is not None or isinstance(error, FloatingPointError)


def variables_of_jax() -> list[str]:
    """Return NAME=VALUE of the user's variables for JAX and the libraries beside it."""
    # Variables of JAX that a command sets for itself.
    own = frozenset(("JAX_ENABLE_X64", "JAX_COMPILATION_CACHE_DIR", *_USUAL))
    return [
        f"{name}={value}"
        for name, value in os.environ.items()
        if name not in own and name.startswith(("JAX_", "EQX_", "JAXTYPING_"))
    ]


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
    """Return the number of threads of a computation: all cores of this process, or `THREADS`.

    Raises: InputError if the variable is no such number.
    """
    value = os.environ.get(THREADS, "")
    if value:
        if not re.fullmatch("[0-9]{1,4}", value) or int(value) == 0:
            raise InputError(
                f"expected {THREADS} as a number of threads from 1 to 9999, found "
                f"{value[:20]!r}: unset it, or write one"
            )
        return int(value)
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
