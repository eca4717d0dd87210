"""The compiled rules of Taylor models: compiled once for each number of axes, kept in the cache.

The Python rules in `algebras.taylor` are the reference, and the fallback where no C++ compiler is
at hand. NEURALGAITS_ENGINE=numpy selects them.
"""

import contextlib
import ctypes
import hashlib
import os
import platform
import shutil
import subprocess
import tempfile
from functools import cache
from importlib import resources
from pathlib import Path

from neuralgaits._cache import cache_folder

SOURCE = "bounder.cpp"
FLAGS = (
    *("-std=c++17", "-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math"),
    *("-fPIC", "-shared", "-pthread"),
)
COMPILERS = ("g++", "clang++", "c++")
COMPILE_S = 300.0
ENGINE = "NEURALGAITS_ENGINE"


@cache
def library(axes: int) -> ctypes.CDLL | None:
    """Return the rules in so many axes; None where they cannot be compiled or are not wanted."""
    compiler = next(filter(None, map(shutil.which, COMPILERS)), None)
    if compiler is None or os.environ.get(ENGINE) == "numpy":
        return None
    folder = resources.files("neuralgaits.programs.native")
    source = folder.joinpath(SOURCE).read_text(encoding="utf-8")
    text = "\n".join([source, *FLAGS, compiler, platform.machine(), platform.node(), str(axes)])
    name = f"bounder-{hashlib.sha256(text.encode()).hexdigest()[:24]}.so"
    with contextlib.suppress(OSError, subprocess.SubprocessError):
        file = cache_folder() / name
        if not file.is_file():
            file.parent.mkdir(parents=True, exist_ok=True)
            _compile(compiler, source, axes, file)
        return _declared(ctypes.CDLL(str(file)))
    return None


def _compile(compiler: str, source: str, axes: int, file: Path) -> None:
    """Compile the rules. Raises: OSError or SubprocessError if it does not work."""
    with tempfile.TemporaryDirectory(dir=file.parent) as folder:
        text, made = Path(folder) / SOURCE, Path(folder) / file.name
        text.write_text(source, encoding="utf-8")
        command = [compiler, *FLAGS, f"-DNG_AXES={axes}", str(text), "-o", str(made)]
        subprocess.run(command, check=True, capture_output=True, timeout=COMPILE_S)
        made.replace(file)


def _declared(found: ctypes.CDLL) -> ctypes.CDLL:
    whole, pointer = ctypes.c_int64, ctypes.c_void_p
    found.ng_bounder.restype = pointer
    found.ng_bounder.argtypes = [
        *(whole, pointer, whole, pointer, whole, pointer, whole, pointer, whole, whole)
    ]
    found.ng_bounds.argtypes = [pointer, pointer, pointer, whole, ctypes.c_int, pointer, pointer]
    found.ng_bounds.restype = None
    found.ng_forget.argtypes = [pointer]
    found.ng_forget.restype = None
    return found
