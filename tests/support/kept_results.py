"""Results of slow functions, kept by the content of what they are given.

Tests trace the same gait again and again: each opens, certifies or exports a copy of a run that
others have opened before. What a function of the package finds is a function of its arguments, as
long as nobody has changed the package: so it is computed once in a process for equal arguments, or
once in a test run where what is found can be copied.

An argument may be a function. Two of them are equal that have the same code and close over equal
values, so that a function which is made anew is neither traced nor compiled anew.
"""

import functools
import hashlib
import io
import os
import pickle
import sys
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
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
    f"{PACKAGE}._quick_jit": ("quick_jit", "quick_filter_jit"),
    f"{PACKAGE}.certificate.levels.full_order.sample_evaluators": ("evaluators_of",),
    f"{PACKAGE}.certificate.levels.level_search": ("evaluator_at",),
    f"{PACKAGE}.certificate.levels.problems": ("trace_certificate",),
    f"{PACKAGE}.certificate.traced": ("trace_spec",),
    f"{PACKAGE}.programs.tracing.tracer": ("trace",),
    f"{PACKAGE}.systems.proof_model": ("trace_conditions",),
}
"""Functions whose results nobody can change."""
KNOWN = frozenset(
    (PACKAGE, *"builtins collections copyreg equinox functools jax jaxlib numpy optax".split())
)
"""Packages whose functions are what their names say, and their closures what is in them."""
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
    """Pickles data, and functions and classes by their names if these say what they do.

    A function without such a name is its code, and what it closes over.
    """

    def reducer_override(self, given: Any) -> Any:
        if isinstance(given, RunFolder):
            return str, ()  # Where a run is changes nothing of what is computed of its parts.
        if callable(given) and hasattr(given, "__qualname__"):
            _refuse_unknown(given.__module__)
            if isinstance(given, FunctionType) and not _has_its_name(given):
                if _checks_shapes(given):
                    # It does what the function does that it checks.
                    return str, (), (given.__wrapped__,)
                _refuse_unknown(given.__globals__.get("__name__"))
                # A text stands for the function: nothing is ever unpickled.
                return str, (_code(given.__code__),), _closed_over(given)
        elif known := _known_of_itself(given):
            kind = type(given)
            own = {name: value for name, value in vars(given).items() if name not in known}
            return str, (), (kind, own)
        return NotImplemented


def _known_of_itself(given: Any) -> set[str]:
    """Return the names of an object's properties that it keeps once they are computed."""
    kept = getattr(given, "__dict__", {})
    kind = type(given)
    return {name for name in kept if isinstance(getattr(kind, name, None), cached_property)}


def _refuse_unknown(module: Any) -> None:
    """Raise PicklingError if functions of a module may do anything."""
    if str(module).partition(".")[0] not in KNOWN:
        raise pickle.PicklingError(f"code of {module}")


def _has_its_name(function: FunctionType) -> bool:
    """Return whether a function is what its module has under its name."""
    found: Any = sys.modules.get(function.__module__)
    for part in function.__qualname__.split("."):
        found = getattr(found, part, None)
    return found is function


def _checks_shapes(function: FunctionType) -> bool:
    """Return whether a function is another one, with checks of what it is given and returns."""
    checker = function.__globals__.get("__name__") == "jaxtyping._decorator"
    return (checker or function.__code__.co_filename.startswith("<@beartype(")) and hasattr(
        function, "__wrapped__"
    )


@functools.lru_cache(maxsize=4096)
def _code(code: CodeType) -> str:
    """Return a text that is another one for code that does anything else."""
    constants = [_code(one) if isinstance(one, CodeType) else repr(one) for one in code.co_consts]
    place = code.co_filename, code.co_firstlineno, code.co_qualname
    return repr((place, code.co_code, code.co_names, code.co_freevars, constants))


def _closed_over(function: FunctionType) -> tuple:
    """Return the values that a function without a name has beside its arguments.

    Raises: PicklingError if it is the package's and could change one of them: then it may be called
        for that, too.
    """
    cells = [cell.cell_contents for cell in function.__closure__ or ()]
    values = (*cells, *(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).values())
    own = function.__globals__["__name__"].startswith(PACKAGE)
    if own and any(isinstance(value, dict | list | set) for value in values):
        raise pickle.PicklingError("a function that can change what it has")
    return tuple(cells), function.__defaults__, function.__kwdefaults__


def _content(given: Any) -> bytes | None:
    """Return a hash of all that arguments are; None where they hold code of other packages."""
    text = io.BytesIO()
    pickler = _Content(text, pickle.HIGHEST_PROTOCOL)
    # Whether two parts are one object, or equal, changes no result.
    pickler.fast = True
    try:
        pickler.dump(given)
    except (pickle.PicklingError, AttributeError, RecursionError, TypeError, ValueError):
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
