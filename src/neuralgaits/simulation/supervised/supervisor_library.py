"""Compile the supervisor of a run's export into a library of this process."""

import ctypes
from ctypes import c_double, c_int, c_size_t, c_uint32, c_void_p
from importlib import resources

from neuralgaits._cache import cache_folder
from neuralgaits._compiler import Compiler, SharedLibrary
from neuralgaits.errors import InputError
from neuralgaits.export import build, output_folder
from neuralgaits.export.facts import Design
from neuralgaits.export.source import gait_files

_HOST = "supervisor_host.c"
_FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared")


def supervisor_library(design: Design, precision: str = "double") -> ctypes.CDLL:
    """Return the compiled supervisor of a controller.

    Args:
        design: design of the controller.
        precision: `double` or `float`, of the arithmetic in C.

    Raises: InputError without a C compiler, SpecError for a policy that C cannot express.
    """
    compiler = Compiler.for_c()
    if compiler is None:
        raise InputError("expected a C compiler for the supervisor, found none: install gcc")
    folder = resources.files("neuralgaits.simulation.supervised") / "c"
    files = output_folder.shipped() | gait_files(design)
    files[_HOST] = (folder / _HOST).read_text(encoding="utf-8")
    flags = (*_FLAGS, *build.PRECISIONS[precision])
    wanted = SharedLibrary("supervisor", files, (*build.CORE, "supervisor.c", _HOST), flags)
    library = ctypes.CDLL(str(compiler.kept(wanted, cache_folder())))
    library.ng_host_bytes.restype = c_size_t
    library.ng_host_start.argtypes = [c_void_p, c_int, c_int]
    library.ng_host_tell.argtypes = [c_void_p, c_void_p]
    library.ng_host_tick.argtypes = [
        *(c_void_p, c_uint32, c_void_p, c_int),
        *(c_void_p, c_void_p, c_void_p),
    ]
    assert ctypes.sizeof(c_double) == 8
    return library
