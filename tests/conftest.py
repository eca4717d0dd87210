"""Strict numerics for every test, and one core each: pytest-xdist already uses them all."""

import os
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

from hypothesis import settings  # noqa: E402

# Compilation makes the first example slow; a derandomised run fails the same way for everyone.
settings.register_profile("neuralgaits", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("neuralgaits")
