"""What a call is given, as a hash: equal data, and functions that do the same."""

import functools
import hashlib
import io
import pickle
import sys
from functools import cached_property
from types import CodeType, FunctionType
from typing import Any

from neuralgaits.runs import RunFolder

PACKAGE = "neuralgaits"
KNOWN = frozenset(
    (PACKAGE, *"builtins collections copyreg equinox functools jax jaxlib numpy optax".split())
)
"""Packages whose functions are what their names say, and their closures what is in them."""


class _Content(pickle.Pickler):
    """Pickles data, and functions and classes by their names if these say what they do.

    A function without such a name is its code, and what it closes over.

    Attributes:
        rooms: of the package whose code is part of the data.
    """

    def __init__(self, file: io.BytesIO) -> None:
        super().__init__(file, pickle.HIGHEST_PROTOCOL)
        self.rooms: set[str] = set()
        # Whether two parts are one object, or equal, changes no result.
        self.fast = True

    def _note(self, module: Any) -> None:
        """Note the room of a module. Raises: PicklingError if its functions may do anything."""
        if str(module).partition(".")[0] not in KNOWN:
            raise pickle.PicklingError(f"code of {module}")
        if str(module).startswith(f"{PACKAGE}."):
            self.rooms.add(room_of(module))

    def reducer_override(self, given: Any) -> Any:
        if isinstance(given, RunFolder):
            return str, ()  # Where a run is changes nothing of what is computed of its parts.
        if callable(given) and hasattr(given, "__qualname__"):
            self._note(given.__module__)
            if isinstance(given, FunctionType) and not _has_its_name(given):
                if _checks_shapes(given):
                    # It does what the function does that it checks.
                    return str, (), (given.__wrapped__,)
                self._note(given.__globals__.get("__name__"))
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


def content_of(given: Any) -> tuple[bytes | None, set[str]]:
    """Return a hash of all that arguments are, and the rooms whose code is in them.

    The hash is None where they hold code of other packages.
    """
    text = io.BytesIO()
    pickler = _Content(text)
    try:
        pickler.dump(given)
    except (pickle.PicklingError, AttributeError, RecursionError, TypeError, ValueError):
        return None, set()
    return hashlib.sha256(text.getvalue()).digest(), pickler.rooms


def room_of(module: Any) -> str:
    """Return the room of a module of the package; no room for any other."""
    package, _, rest = str(module).partition(".")
    return rest.partition(".")[0] if package == PACKAGE else ""
