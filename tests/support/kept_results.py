"""Results of slow functions, kept by the content of what they are given.

Tests trace the same gait again and again: each opens, certifies or exports a copy of a run that
others have opened before. What a function of the package finds is a function of its arguments, as
long as nobody has changed the package: so it is computed once in a process for equal arguments, or
once in a test run where what is found can be copied.
"""

import functools
import hashlib
import io
import os
import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from neuralgaits.runs import RunFolder

MOST = 300
"""Results of a process that are kept at once."""
PACKAGE = "neuralgaits"
COPIED = {
    f"{PACKAGE}.analysis.poincare_map": ("poincare",),
    f"{PACKAGE}.certificate.traced": ("after_impact",),
    f"{PACKAGE}.export.programs": ("parts",),
    f"{PACKAGE}.export.robot_programs": ("ground",),
    f"{PACKAGE}.export.source": ("gait_files",),
}
"""Functions whose results a caller could change: each has a copy."""
SHARED = {
    f"{PACKAGE}.certificate.levels.full_order.sample_evaluators": ("evaluators_of",),
    f"{PACKAGE}.certificate.levels.level_search": ("evaluator_at",),
    f"{PACKAGE}.certificate.levels.problems": ("trace_certificate",),
    f"{PACKAGE}.certificate.traced": ("trace_spec",),
    f"{PACKAGE}.systems.proof_model": ("trace_conditions",),
}
"""Functions whose results nobody can change."""
KNOWN = frozenset(
    (PACKAGE, *"builtins collections copyreg equinox functools jax jaxlib numpy".split())
)
"""Packages whose functions are what their names say."""
HARMLESS = frozenset(("os", "shutil", "signal", "socket", "subprocess", "tempfile", "time"))
"""Modules that no function above looks at."""
SIZES = frozenset(("EPISODES", "HOPS", "SECONDS", "SHOWN_HOPS", "SHOWN_S"))
"""Constants of the families that say how much is simulated or drawn: no trace reads one."""


class KeptResults:
    """Results by function and content of arguments.

    Arguments with code of a user's own have no key, and what is called with them is never kept. As
    long as a test has patched the package, everything is computed.

    Attributes:
        computed: count of results that were computed.
    """

    def __init__(self, shared: Path | None = None) -> None:
        """Start with no result of this process; copies are shared by all that have the folder."""
        self.computed = 0
        self._shared = shared
        self._kept: dict[tuple[str, bytes], Any] = {}
        self._patching: set[int] = set()

    def of(self, function: Callable[..., Any], copied: bool) -> Callable[..., Any]:
        """Return a function that keeps what another one finds; callers get copies if `copied`."""
        name = f"{function.__module__}.{function.__qualname__}"

        @functools.wraps(function)
        def kept(*given: Any, **named: Any) -> Any:
            content = None if self._patching or not _in_float64() else _content((given, named))
            if content is None:
                self.computed += 1
                return function(*given, **named)
            key = name, content
            if key not in self._kept:
                found = functools.partial(self._computed, function, given, named)
                self._kept[key] = self._pickled(key, found) if copied else found()
                if len(self._kept) > MOST:
                    del self._kept[next(iter(self._kept))]
            return pickle.loads(self._kept[key]) if copied else self._kept[key]

        return kept

    def _computed(self, function: Callable[..., Any], given: tuple, named: dict) -> Any:
        self.computed += 1
        return function(*given, **named)

    def _pickled(self, key: tuple[str, bytes], compute: Callable[[], Any]) -> bytes:
        """Return a result that another process has put into the folder, or a new one."""
        if self._shared is None:
            return pickle.dumps(compute())
        file = self._shared / f"kept-{key[0]}-{key[1].hex()}"
        if file.exists():
            return file.read_bytes()
        found = pickle.dumps(compute())
        # Whole or not there, whoever else writes the same.
        written = file.with_name(f"{file.name}.{os.getpid()}")
        written.write_bytes(found)
        written.rename(file)
        return found

    def patch(self, patch: pytest.MonkeyPatch) -> None:
        """Keep results of the functions above wherever the package and its helpers call them.

        Test files call the functions themselves. What nobody has imported yet stays as it is.
        """
        for places, copied in ((COPIED, True), (SHARED, False)):
            for place, names in places.items():
                for name in names if place in sys.modules else ():
                    function = getattr(sys.modules[place], name)
                    kept = self.of(function, copied)
                    for module in list(sys.modules.values()):
                        inside = getattr(module, "__name__", "").startswith((PACKAGE, "support"))
                        if inside and vars(module).get(name) is function:
                            patch.setattr(module, name, kept)
        for name in ("setattr", "delattr", "setitem", "delitem"):
            patch.setattr(pytest.MonkeyPatch, name, self._noticed(name))
        patch.setattr(pytest.MonkeyPatch, "undo", self._undone())
        self._patching.clear()  # From here on.

    def _noticed(self, name: str) -> Callable[..., None]:
        """Return the method of `pytest.MonkeyPatch` of this name, with its patch noticed."""
        change = getattr(pytest.MonkeyPatch, name)

        @functools.wraps(change)
        def changed(patch: pytest.MonkeyPatch, *given: Any, **how: Any) -> None:
            if not _harmless(*given[:2]):
                self._patching.add(id(patch))
            change(patch, *given, **how)

        return changed

    def _undone(self) -> Callable[[pytest.MonkeyPatch], None]:
        undo = pytest.MonkeyPatch.undo

        @functools.wraps(undo)
        def undone(patch: pytest.MonkeyPatch) -> None:
            undo(patch)
            self._patching.discard(id(patch))

        return undone


class _Content(pickle.Pickler):
    """Pickles data, and functions and classes by their names if these say what they do."""

    def reducer_override(self, given: Any) -> Any:
        if isinstance(given, RunFolder):
            return str, ()  # Where a run is changes nothing of what is computed of its parts.
        if callable(given) and hasattr(given, "__qualname__"):
            root = str(given.__module__).partition(".")[0]
            if root not in KNOWN:
                raise pickle.PicklingError(f"code of {given.__module__}")
        return NotImplemented


def _content(given: Any) -> bytes | None:
    """Return a hash of all that arguments are; None where they hold code of other packages."""
    text = io.BytesIO()
    try:
        _Content(text, pickle.HIGHEST_PROTOCOL).dump(given)
    except (pickle.PicklingError, AttributeError, TypeError):
        return None
    return hashlib.sha256(text.getvalue()).digest()


def _in_float64() -> bool:
    import jax

    return bool(jax.config.jax_enable_x64)  # pyright: ignore[reportAttributeAccessIssue]


def _harmless(target: Any, name: Any = None) -> bool:
    """Return whether what a patch changes is nothing that a function of the package looks at."""
    if isinstance(target, str):
        place, _, last = target.rpartition(".")
        return target.partition(".")[0] in HARMLESS or is_a_size(place, last)
    if isinstance(target, ModuleType):
        return target.__name__.partition(".")[0] in HARMLESS or is_a_size(target.__name__, name)
    return target is os.environ


def is_a_size(module: str, name: Any) -> bool:
    """Return whether a module's constant is one of `SIZES`."""
    return module.startswith(f"{PACKAGE}.systems.") and name in SIZES
