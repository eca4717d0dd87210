"""How XLA compiles what is called often and runs for microseconds.

The passes switched off cost seconds of compiling and gain such kernels nothing.
"""

from collections.abc import Callable
from typing import Any, TypeVar

import equinox as eqx
import jax

Function = TypeVar("Function", bound=Callable[..., Any])
QUICK: dict[str, bool | int] = {"xla_backend_optimization_level": 1}
if jax.__version_info__ < (0, 11):
    # Later compilers know no such option, and refuse what they do not know.
    QUICK["xla_cpu_use_fusion_emitters"] = False


def quick_jit(function: Function) -> Function:
    """`jax.jit` with these options."""
    return jax.jit(function, compiler_options=QUICK)  # pyright: ignore[reportReturnType]


def quick_filter_jit(function: Function) -> Function:
    """`equinox.filter_jit` with these options: arrays are arguments, all else is constant."""
    # The options go on to jax.jit; equinox's overloads leave them out.
    return eqx.filter_jit(function, compiler_options=QUICK)  # pyright: ignore[reportCallIssue]
