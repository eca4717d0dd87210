"""Compiler options of XLA for functions that are called often and run for microseconds.

The passes switched off cost seconds of compiling and gain such kernels nothing. An option that the
environment's XLA_FLAGS sets takes precedence over its value here.
"""

import os
from collections.abc import Callable
from typing import Any, TypeVar

import equinox as eqx
import jax

Function = TypeVar("Function", bound=Callable[..., Any])


Options = dict[str, bool | int | str]


def _quick() -> Options:
    options: Options = {"xla_backend_optimization_level": 1}
    if jax.__version_info__ < (0, 11):
        # Later compilers may know no such options, and refuse what they do not know.
        options["xla_cpu_use_fusion_emitters"] = False
        # Its matrix products are for large ones: of many of 5 by 5 they take twice as long.
        options["xla_cpu_experimental_ynn_fusion_type"] = ""
    flags = os.environ.get("XLA_FLAGS", "").split()
    given_flags = {flag.lstrip("-").partition("=")[0] for flag in flags}
    return {name: value for name, value in options.items() if name not in given_flags}


QUICK = _quick()


def quick_jit(function: Function) -> Function:
    """Compile a function with `jax.jit` and the options of this module."""
    return jax.jit(function, compiler_options=QUICK)  # pyright: ignore[reportReturnType]


def quick_filter_jit(function: Function) -> Function:
    """`equinox.filter_jit` with these options: arrays are arguments, all else is constant."""
    # The options go on to jax.jit; equinox's overloads leave them out.
    return eqx.filter_jit(function, compiler_options=QUICK)  # pyright: ignore[reportCallIssue]
