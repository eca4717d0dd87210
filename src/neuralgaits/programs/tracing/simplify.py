"""Arithmetic on elements, without the parts that are exact.

x + 0, x - 0, x * 1, x / 1, x - x, x * 0 and 0 - x need no operation. They are exact for every
finite x, which is assumed: a spec whose intermediate values are infinite or NaN inside its
region is wrong anyway, and no interpreter proves a condition whose other values are not finite.
Signs of zero are not kept. Sums and products of two constants are *not* evaluated: rounding them
here would put an unproved error into a proof, so they stay operations, which an interpreter
folds in its own arithmetic.
"""

import numpy as np

from neuralgaits.programs.tracing.builder import Builder, Elements

_UNSET = np.iinfo(np.int64).max
"""Mark in a result for elements that still need an operation."""


def unary(build: Builder, kind: str, a: Elements) -> Elements:
    """Apply a function of one operand, once for each distinct element."""
    flat = a.reshape(-1)
    if flat.size == 0:
        return a
    if kind == "neg" and np.all(flat < 0):
        # All are constants without a name, and a change of sign rounds nothing.
        return build.constant(-build.values(a))
    exact = _exact_unary(build, kind, flat)
    todo = exact == _UNSET
    if np.any(todo):
        distinct, inverse = np.unique(flat[todo], return_inverse=True)
        exact[todo] = build.apply(kind, [distinct], distinct.size)[inverse]
    return exact.reshape(a.shape)


def _exact_unary(build: Builder, kind: str, flat: Elements) -> Elements:
    """Elements that need no operation: functions of a constant 0, where their value is exact."""
    result = np.full(flat.size, _UNSET)
    at_zero = {"sin": 0.0, "tanh": 0.0, "square": 0.0, "sqrt": 0.0, "log1p": 0.0, "logistic": 0.5}
    at_zero |= {"cos": 1.0, "exp": 1.0, "neg": 0.0}
    result[build.values(flat) == 0.0] = build.constant(np.array([at_zero[kind]]))[0]
    return result


def binary(build: Builder, kind: str, a: Elements, b: Elements) -> Elements:
    """Add, subtract, multiply or divide element by element, with broadcasting."""
    a, b = np.broadcast_arrays(a, b)
    shape, a, b = a.shape, a.reshape(-1), b.reshape(-1)
    result = _exact_binary(build, kind, a, b)
    todo = result == _UNSET
    if np.mean(todo) > 0.5:
        # Taking a few elements out of a vector costs more moves than it saves arithmetic.
        todo[:] = True
    if np.any(todo):
        result[todo] = _once(build, kind, a[todo], b[todo])
    return result.reshape(shape)


def _exact_binary(build: Builder, kind: str, a: Elements, b: Elements) -> Elements:
    """Elements that are an operand, its negative, its square or a constant; the rest unset.

    Values are NaN except for constants, so comparisons pick constants only; where several rules
    fit, the last one wins.
    """
    result = np.full(a.size, _UNSET)
    left, right = build.values(a), build.values(b)
    zero = build.constant(np.zeros(1))[0]
    if kind == "add":
        result[right == 0.0] = a[right == 0.0]
        result[left == 0.0] = b[left == 0.0]
    elif kind == "sub":
        negated = (left == 0.0) & (b != a)
        if np.any(negated):
            result[negated] = unary(build, "neg", b[negated])
        result[right == 0.0] = a[right == 0.0]
        result[a == b] = zero
    elif kind == "mul":
        for factor, other in ((left, b), (right, a)):
            result[factor == 1.0] = other[factor == 1.0]
            if np.any(factor == -1.0):
                result[factor == -1.0] = unary(build, "neg", other[factor == -1.0])
        result[(left == 0.0) | (right == 0.0)] = zero
        same = (a == b) & (result == _UNSET)
        if np.any(same):
            result[same] = unary(build, "square", a[same])
    else:
        result[right == 1.0] = a[right == 1.0]
    return result


def _once(build: Builder, kind: str, a: Elements, b: Elements) -> Elements:
    """Apply one operation to the distinct pairs, in an order that leaves an operand unmoved.

    The order of elements inside a vector is free, since results are handed out as elements. A good
    order needs no `move` to put the operands together.
    """
    if a.size == 1:
        return build.apply(kind, [a, b], 1)
    # x + y and y + x are one pair.
    one, other = (np.minimum(a, b), np.maximum(a, b)) if kind in ("add", "mul") else (a, b)
    # A pair as one number: sorting numbers is many times faster than sorting columns.
    least = other.min()
    keys = one * (other.max() - least + 1) + (other - least)
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    a, b = a[first], b[first]
    # As they first came, or sorted by one operand: a transposed array then costs nothing.
    order, unmoved = np.zeros(0, dtype=np.int64), -1
    for sort in (lambda: np.argsort(first), lambda: np.lexsort((b, a)), lambda: np.lexsort((a, b))):
        tried = sort()
        score = build.unmoved(a[tried]) + build.unmoved(b[tried])
        if score > unmoved:
            order, unmoved = tried, score
        if unmoved == 2:
            break
    # Where each pair went, to give every element the result of its pair.
    place = np.empty(order.size, dtype=np.int64)
    place[order] = np.arange(order.size)
    return build.apply(kind, [a[order], b[order]], order.size)[place[inverse]]


def row_sums(build: Builder, a: Elements) -> Elements:
    """Sums over the last axis; constant zeros are left out."""
    shape, rows = a.shape[:-1], a.reshape(_count(a), a.shape[-1])
    (rows,) = _without(build, build.values(rows) == 0.0, rows)
    if rows.shape[1] <= 1:
        return rows.reshape(shape)
    rows, inverse = _distinct(rows)
    return build.apply("sum", [rows.reshape(-1)], rows.shape[0])[inverse].reshape(shape)


def inner(build: Builder, a: Elements, b: Elements) -> Elements:
    """Inner products over the last axis; products with a constant zero are left out."""
    a, b = np.broadcast_arrays(a, b)
    shape, length = a.shape[:-1], a.shape[-1]
    a, b = a.reshape(_count(a), length), b.reshape(_count(b), length)
    vanishing = (build.values(a) == 0.0) | (build.values(b) == 0.0)
    a, b = _without(build, vanishing, a, b)
    if a.shape[1] <= 1:
        return binary(build, "mul", a, b).reshape(shape)
    length = a.shape[1]
    rows, inverse = _distinct(np.concatenate([a, b], axis=1))
    pair = [rows[:, :length].reshape(-1), rows[:, length:].reshape(-1)]
    return build.apply("inner", pair, rows.shape[0])[inverse].reshape(shape)


def product(build: Builder, a: Elements, b: Elements) -> Elements:
    """Matrix product of a [rows, inner] and the transpose of b [columns, inner].

    A constant matrix gives `affine`; one whose rows are unit vectors or zero moves data only.
    """
    # Either side may be the matrix: a b' is the transpose of b a'.
    for left, right, swapped in ((a, b, False), (b, a, True)):
        selection = _selection(build, left)
        if selection is not None:
            # A column of zeros more, for the rows that choose none.
            wide = np.concatenate([right, np.full((right.shape[0], 1), _zero(build))], axis=1)
            result = wide[:, selection].T
            return result.T if swapped else result
    for left, right, swapped in ((a, b, False), (b, a, True)):
        if build.is_constant(left):
            result = _affine(build, left, right)
            return result.T if swapped else result
    return inner(build, a[:, None, :], b[None, :, :])


def _affine(build: Builder, matrix: Elements, right: Elements) -> Elements:
    """Product of a constant matrix [rows, inner] and right [columns, inner] transposed."""
    rows, columns = matrix.shape[0], right.shape[0]
    flat = build.apply("affine", [matrix.reshape(-1), right.T.reshape(-1)], rows * columns, columns)
    return flat.reshape(rows, columns)


def _selection(build: Builder, matrix: Elements) -> Elements | None:
    """Return, for each row that is a unit vector, its position; the width for a row of zeros."""
    values = build.values(matrix)
    ones = values == 1.0
    if not np.all(ones | (values == 0.0)) or np.any(ones.sum(axis=1) > 1):
        return None
    return np.where(ones.any(axis=1), ones.argmax(axis=1), matrix.shape[1])


def _without(build: Builder, vanishing: np.ndarray, *tables: Elements) -> list[Elements]:
    """Drop vanishing terms from rows [rows, terms], filling up with zeros at the end.

    All tables lose the same terms, and what is left keeps its order: every row gets as wide as
    the row with the most terms left, and at least one wide.
    """
    keep = np.argsort(vanishing, axis=1, kind="stable")
    width = max(int(np.max(np.sum(~vanishing, axis=1), initial=0)), 1)
    if vanishing.shape[1] == 0:
        return [np.full((len(vanishing), 1), _zero(build)) for _ in tables]
    result = []
    for table in tables:
        cleared = np.where(vanishing, _zero(build), table)
        result.append(np.take_along_axis(cleared, keep, axis=1)[:, :width])
    return result


def _distinct(rows: Elements) -> tuple[Elements, Elements]:
    """Distinct rows in order of first appearance, and where each row went."""
    _, first, inverse = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    return rows[first[order]], np.argsort(order)[inverse.reshape(-1)]


def _count(rows: Elements) -> int:
    """Number of rows along all axes but the last."""
    return int(np.prod(rows.shape[:-1]))


def _zero(build: Builder) -> int:
    return int(build.constant(np.zeros(1))[0])
