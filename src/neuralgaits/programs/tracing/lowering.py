"""Rules that lower arithmetic primitives of JAX to operations, by the primitive's name.

A rule takes the elements of the operands and the parameters of the primitive.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from neuralgaits.programs.tracing import simplify
from neuralgaits.programs.tracing.builder import Builder, Elements

Rule = Callable[[Builder, list[Elements], Mapping[str, Any]], Elements]


def _unary(kind: str) -> Rule:
    return lambda build, arrays, _: simplify.unary(build, kind, arrays[0])


def _binary(kind: str) -> Rule:
    return lambda build, arrays, _: simplify.binary(build, kind, arrays[0], arrays[1])


def integer_power(build: Builder, base: Elements, exponent: int) -> Elements:
    """Power by repeated squaring; one division at the end if the exponent is negative."""
    one = build.constant(np.ones(base.shape))
    result = one
    factor = base
    left = abs(exponent)
    while left:
        if left & 1:
            result = simplify.binary(build, "mul", result, factor)
        left >>= 1
        if left:
            factor = simplify.binary(build, "mul", factor, factor)
    return result if exponent >= 0 else simplify.binary(build, "div", one, result)


def reciprocal_root(build: Builder, a: Elements) -> Elements:
    """Lower 1 / sqrt(a) to a root and a quotient."""
    root = simplify.unary(build, "sqrt", a)
    return simplify.binary(build, "div", build.constant(np.ones(a.shape)), root)


def tangent(build: Builder, a: Elements) -> Elements:
    """Lower the tangent to the sine over the cosine."""
    sine, cosine = (simplify.unary(build, kind, a) for kind in ("sin", "cos"))
    return simplify.binary(build, "div", sine, cosine)


def reduce_sum(build: Builder, a: Elements, axes: tuple[int, ...]) -> Elements:
    """Lower a sum over some axes to row sums."""
    axes = tuple(int(axis) for axis in axes)
    reordered = np.moveaxis(a, axes, tuple(range(a.ndim - len(axes), a.ndim)))
    shape = reordered.shape[: a.ndim - len(axes)]
    terms = int(np.prod(reordered.shape[len(shape) :]))
    return simplify.row_sums(build, reordered.reshape(*shape, terms))


def dot_general(build: Builder, arrays: list[Elements], dimensions: Any) -> Elements:
    """Batched, contracted product in the sense of `jax.lax.dot_general`."""
    a, b = arrays
    (contract_a, contract_b), (batch_a, batch_b) = dimensions

    def arranged(array: Elements, batch, contract) -> tuple[Elements, tuple[int, ...]]:
        free = [i for i in range(array.ndim) if i not in (*batch, *contract)]
        transposed = np.transpose(array, [*batch, *free, *contract])
        batches = int(np.prod([array.shape[i] for i in batch]))
        terms = int(np.prod([array.shape[i] for i in contract]))
        free_shape = tuple(array.shape[i] for i in free)
        return transposed.reshape(batches, int(np.prod(free_shape)), terms), free_shape

    left, rows = arranged(a, batch_a, contract_a)
    right, columns = arranged(b, batch_b, contract_b)
    if left.shape[0] == 1:
        result = simplify.product(build, left[0], right[0])
    else:
        result = simplify.inner(build, left[:, :, None, :], right[:, None, :, :])
    batches = tuple(a.shape[i] for i in batch_a)
    return result.reshape((*batches, *rows, *columns))


ARITHMETIC: dict[str, Rule] = {
    "add": _binary("add"),
    "add_any": _binary("add"),
    "sub": _binary("sub"),
    "mul": _binary("mul"),
    "div": _binary("div"),
    "neg": _unary("neg"),
    "square": _unary("square"),
    "sqrt": _unary("sqrt"),
    "exp": _unary("exp"),
    "log1p": _unary("log1p"),
    "sin": _unary("sin"),
    "cos": _unary("cos"),
    "tanh": _unary("tanh"),
    "logistic": _unary("logistic"),
    "rsqrt": lambda build, arrays, _: reciprocal_root(build, arrays[0]),
    "tan": lambda build, arrays, _: tangent(build, arrays[0]),
    "integer_pow": lambda build, arrays, p: integer_power(build, arrays[0], p["y"]),
    "reduce_sum": lambda build, arrays, p: reduce_sum(build, arrays[0], p["axes"]),
    "dot_general": lambda build, arrays, p: dot_general(build, arrays, p["dimension_numbers"]),
}
