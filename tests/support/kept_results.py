"""Results of slow functions, kept by the content of what they are given.

Tests trace the same gait again and again: each opens, certifies or exports a copy of a run that
others have opened before. What a function of the package finds is a function of its arguments, as
long as nobody has changed the package: so it is computed once in a process for equal arguments, or
once in a test run where what is found can be copied.

An argument may be a function. Two of them are equal that have the same code and close over equal
values, so that a function which is made anew is neither traced nor compiled anew.
"""

import functools
import os
import pickle
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from neuralgaits.programs import Program
from support.argument_content import PACKAGE, content_of, room_of

MOST = 300
"""Results of a process that are kept at once."""
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
    f"{PACKAGE}.systems.proof_model": ("trace_conditions",),
}
"""Functions whose results nobody can change."""
PROGRAMS = {f"{PACKAGE}.programs.tracing.tracer": ("trace",)}
"""Functions whose results are Programs, which nobody can change and any process can read."""
HARMLESS = frozenset(("os", "shutil", "signal", "socket", "subprocess", "tempfile", "time"))
"""Modules that no function above looks at."""
EVERYWHERE = "_printable"
"""Room from which all others may import."""
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
        self._patching: dict[int, set[str]] = {}

    def of(
        self, function: Callable[..., Any], copied: bool, program: bool = False
    ) -> Callable[..., Any]:
        """Return a function that keeps what another one finds.

        Args:
            function: the other one.
            copied: whether callers get copies, which all processes share.
            program: whether it returns a Program, which all processes share.
        """
        name = f"{function.__module__}.{function.__qualname__}"

        @functools.wraps(function)
        def kept(*given: Any, **named: Any) -> Any:
            content, rooms = content_of((given, named)) if _in_float64() else (None, set())
            if content is None or self._is_patched(rooms | {room_of(function.__module__)}):
                self.computed += 1
                return function(*given, **named)
            key = name, content
            if key not in self._kept:
                found = functools.partial(self._computed, function, given, named)
                if copied:
                    self._kept[key] = self._in_file(key, lambda: pickle.dumps(found()))
                elif program:
                    text = self._in_file(key, lambda: found().to_json().encode())
                    self._kept[key] = Program.from_json(text.decode())
                else:
                    self._kept[key] = found()
                if len(self._kept) > MOST:
                    del self._kept[next(iter(self._kept))]
            return pickle.loads(self._kept[key]) if copied else self._kept[key]

        return kept

    def _is_patched(self, rooms: set[str]) -> bool:
        """Return whether code of these rooms may do something else now than it was written to."""
        changed = set().union(*self._patching.values())
        return any(room in rooms or max(map(_level, rooms)) > _level(room) for room in changed)

    def _computed(self, function: Callable[..., Any], given: tuple, named: dict) -> Any:
        self.computed += 1
        return function(*given, **named)

    def _in_file(self, key: tuple[str, bytes], compute: Callable[[], bytes]) -> bytes:
        """Return a result that another process has put into the folder, or a new one."""
        if self._shared is None:
            return compute()
        file = self._shared / f"kept-{key[0]}-{key[1].hex()}"
        if file.exists():
            return file.read_bytes()
        found = compute()
        # Whole or not there, whoever else writes the same.
        written = file.with_name(f"{file.name}.{os.getpid()}")
        written.write_bytes(found)
        written.rename(file)
        return found

    def patch(self, patch: pytest.MonkeyPatch) -> None:
        """Keep results of the functions above wherever the package and its helpers call them.

        Test files call the functions themselves. What nobody has imported yet stays as it is.
        """
        for places in (COPIED, SHARED, PROGRAMS):
            for place, names in places.items():
                for name in names if place in sys.modules else ():
                    function = getattr(sys.modules[place], name)
                    kept = self.of(function, places is COPIED, places is PROGRAMS)
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
                self._patching.setdefault(id(patch), set()).add(_patched_room(*given[:2]))
            change(patch, *given, **how)

        return changed

    def _undone(self) -> Callable[[pytest.MonkeyPatch], None]:
        undo = pytest.MonkeyPatch.undo

        @functools.wraps(undo)
        def undone(patch: pytest.MonkeyPatch) -> None:
            undo(patch)
            self._patching.pop(id(patch), None)

        return undone


@functools.cache
def _levels() -> dict[str, int]:
    """Return the place of each room in the list in which a room imports only from those below."""
    text = (Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8")
    first = tomllib.loads(text)["tool"]["importlinter"]["contracts"][0]
    levels = reversed(first["layers"])
    return {room: place for place, rooms in enumerate(levels) for room in rooms.split(" | ")}


def _level(room: str) -> int:
    """Return the place of a room in the list; what is in none may import from all."""
    return _levels().get(room, len(_levels()))


def _patched_room(target: Any, name: Any = None) -> str:
    """Return the room of the module that a patch changes; that of all if it changes another."""
    del name
    place = target if isinstance(target, str) else getattr(target, "__name__", "")
    of_package = isinstance(target, str | ModuleType) and place.startswith(f"{PACKAGE}.")
    return room_of(place) if of_package else EVERYWHERE


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
