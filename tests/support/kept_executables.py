"""Executables of JAX, kept in a process for functions that are made anew.

JAX keeps an executable only as long as the function that it was compiled for.
"""

from typing import Any

import pytest

MOST = 500
"""Executables that are kept at once."""


def keep(patch: pytest.MonkeyPatch) -> None:
    """Have JAX look here before it reads its cache of files, and put here what it compiles.

    Nothing is kept with a version of JAX that has other functions there: they are no part of its
    interface.
    """
    try:
        from jax._src import compiler

        read, compiled = compiler._cache_read, compiler._compile_and_write_cache
    except (ImportError, AttributeError):
        return
    kept: dict[str, tuple] = {}

    def put(key: str, found: tuple) -> None:
        kept[key] = found
        if len(kept) > MOST:
            del kept[next(iter(kept))]

    def read_once(name: str, key: str, *given: Any) -> tuple:
        found = kept.get(key) or read(name, key, *given)
        if found[0] is not None:
            put(key, found)
        return found

    def compiled_once(
        backend: Any, module: Any, devices: Any, options: Any, callbacks: Any, name: str, key: str
    ) -> Any:
        executable = compiled(backend, module, devices, options, callbacks, name, key)
        if not callbacks:  # They are part of an executable and of no key.
            put(key, (executable, 0))
        return executable

    patch.setattr(compiler, "_cache_read", read_once)
    patch.setattr(compiler, "_compile_and_write_cache", compiled_once)
