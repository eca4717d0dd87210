"""Reasons why JAX primitives cannot be traced, and what to write instead.

Keys are names of primitives; one ending in `*` covers every primitive that begins so.
"""

import os
import sys
import sysconfig
from pathlib import Path
from typing import Any

_TWO = "write two inequalities, each its own condition"
_BRANCH = (
    "a condition has one formula for every point: split the region and write one condition for"
    " each part"
)
_KINK = (
    "a condition has no kink: write two inequalities; a ReLU policy trains and walks but cannot be"
    " proved, use tanh or softplus from gait.activations"
)
_STATIC = "build the array with jnp.stack or jnp.concatenate"
_UNROLL = "write the terms out in a Python loop, which is unrolled"
_LINALG = "write the closed form, or robots.linear.solve for a positive definite system"
_SQUARES = "compare squares: jnp.sum(x * x) against a squared bound"
_RANDOM = "a condition is a function of its point: make random numbers outside, pass constants"
_ROUND = "a condition is smooth; round nothing"

ADVICE = {
    "abs": _TWO,
    "max": _KINK,
    "min": _KINK,
    "clamp": _KINK,
    "reduce_max": "write one inequality for each element: a condition may return a vector",
    "reduce_min": "write one inequality for each element: a condition may return a vector",
    "argmax": _BRANCH,
    "argmin": _BRANCH,
    "sort": _BRANCH,
    "sign": _KINK,
    "select_n": _BRANCH,
    "gt": _BRANCH,
    "ge": _BRANCH,
    "lt": _BRANCH,
    "le": _BRANCH,
    "eq": _BRANCH,
    "ne": _BRANCH,
    "is_finite": _BRANCH,
    "cond": _BRANCH,
    "while": _UNROLL,
    "scan": _UNROLL,
    "reduce_prod": "write the product out",
    "cumsum": "multiply by a constant lower-triangular matrix of ones",
    "cumprod": "write the products out",
    "pow": "use an integer power, jnp.sqrt, or exp of a product",
    "cbrt": "only square roots are on the list",
    "log": "write jnp.log1p(x - 1.0)",
    "expm1": "write jnp.exp(x) - 1.0",
    "exp2": "write jnp.exp(x * math.log(2.0))",
    "sinh": "write it with jnp.exp",
    "cosh": "write it with jnp.exp",
    "atan2": "compare sines and cosines, or products, instead of angles",
    "floor": _ROUND,
    "ceil": _ROUND,
    "round": _ROUND,
    "rem": _ROUND,
    "scatter*": _STATIC,
    "dynamic_update_slice": _STATIC,
    "gather": "index with constants",
    "dynamic_slice": "index with constants",
    "stop_gradient": "the rate of a condition needs the true derivative",
    "random*": _RANDOM,
    "threefry*": _RANDOM,
    "cholesky": _LINALG,
    "lu": _LINALG,
    "qr": _LINALG,
    "eigh": _LINALG,
    "svd": _LINALG,
    "triangular_solve": _LINALG,
    "custom_linear_solve": _LINALG,
    "pure_callback": "write it in JAX: no other program is part of a proof",
}

FLOAT32 = "enable x64 before any array is made: jax.config.update('jax_enable_x64', True)"
CAST = "every number of a condition is float64: remove the cast, make constants in float64"
OUTSIDE = "index inside the array: of one beyond it JAX takes the last element in silence"
EMPTY = "it sums no terms: leave it out, or give the arrays elements"
PYTHON = "a condition is traced with symbols: no `if`, float() or NumPy call on what depends on z"


def advice(primitive: str) -> str:
    """Return the advice on what to use instead of a primitive."""
    if primitive in ADVICE:
        return ADVICE[primitive]
    for key, text in ADVICE.items():
        if key.endswith("*") and primitive.startswith(key[:-1]):
            return text
    return "it is none of the operations on the page 'Conditions'; write it with those"


def linalg(function: str) -> str:
    """Return the advice on what to use instead of a function of jnp.linalg."""
    return _SQUARES if function == "norm" else _LINALG


def _library_folders() -> tuple[str, ...]:
    """Return the folders whose code is not the user's: a traceback need not show it."""
    folders = [str(Path(__file__).parent), sysconfig.get_paths()["stdlib"] + os.sep]
    for name in ("jax", "jaxlib", "equinox", "jaxtyping"):
        module = sys.modules.get(name)
        if module is not None and module.__file__:
            folders.append(str(Path(module.__file__).parent))
    return tuple(folders)


def source_line(frames: Any) -> str | None:
    """Return the innermost frame in the user's code as `file:line`, None if there is none.

    Args:
        frames: (file name, line) pairs, innermost first.
    """
    folders = _library_folders()
    site = sysconfig.get_paths()["purelib"]
    for file, line in frames:
        # The standard library's folder holds site-packages, where the user's robot may live.
        inside = file.startswith(folders) and not (
            file.startswith(site) and not file.startswith((*folders[:1], *folders[2:]))
        )
        if not inside and not file.startswith("<"):
            return f"{file}:{line}"
    return None
