"""Settings for a process that belongs to the command line.

Those of JAX are environment variables, so they reach worker processes too and need no import of
it. What the user has set stays.
"""

import gc
import os

from neuralgaits._cache import cache_folder


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
