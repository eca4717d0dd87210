"""The compiled rules of Taylor models: compiled once for each number of coefficients, and kept.

The Python rules in `algebras.taylor_algebra` are the reference, and the fallback where no C++
compiler is at hand. NEURALGAITS_ENGINE=numpy selects them.
"""

import contextlib
import ctypes
import math
import os
import platform
from functools import cache
from importlib import resources

from neuralgaits._cache import cache_folder
from neuralgaits._compiler import Compiler, CompilerError, SharedLibrary
from neuralgaits.programs.program import Program

ENGINE = "NEURALGAITS_ENGINE"


@cache
def library(axes: int, symbols: int, ball: int = 0) -> ctypes.CDLL | None:
    """Return the rules in so many axes, with so many symbols at most.

    A second input of `ball` elements is in the unit ball. None where they cannot be compiled or are
    not wanted.
    """
    compiler = Compiler.first_of(("g++", "clang++", "c++"))
    if compiler is None or os.environ.get(ENGINE) == "numpy":
        return None
    folder = resources.files("neuralgaits.programs.native")
    source, header = "bounder.cpp", "symbol_choice.hpp"
    flags = (
        *("-std=c++17", "-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math"),
        *("-fPIC", "-shared", "-pthread"),
    )
    rules = SharedLibrary(
        "bounder",
        {name: folder.joinpath(name).read_text(encoding="utf-8") for name in (source, header)},
        (source,),
        (*flags, f"-DNG_AXES={axes}", f"-DNG_SYMBOLS={symbols}", f"-DNG_BALL={ball}"),
        # Code for this processor need not run on another machine that has the same cache.
        depends_on=(platform.node(),),
    )
    with contextlib.suppress(OSError, CompilerError):
        return _declared(ctypes.CDLL(str(compiler.cached(rules, cache_folder()))))
    return None


def rules_of(program: Program, symbols: int) -> ctypes.CDLL | None:
    """Return the rules for a Program, with so many symbols at most; None as `library`."""
    axes, *ball = (math.prod(item.shape) for item in program.inputs)
    return library(axes, symbols, sum(ball))


def _declared(library: ctypes.CDLL) -> ctypes.CDLL:
    whole, pointer = ctypes.c_int64, ctypes.c_void_p
    library.ng_bounder.restype = pointer
    code = [pointer, whole, pointer, whole, pointer, whole, pointer, whole, whole]
    library.ng_bounder.argtypes = code
    library.ng_choose_symbols.restype = whole
    library.ng_choose_symbols.argtypes = [*code, pointer, pointer, ctypes.c_double, pointer]
    library.ng_bounds.argtypes = [pointer, pointer, pointer, whole, ctypes.c_int, pointer, pointer]
    library.ng_bounds.restype = None
    library.ng_forget.argtypes = [pointer]
    library.ng_forget.restype = None
    return library
