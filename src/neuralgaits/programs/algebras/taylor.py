"""The algebra of Taylor models in two symbols: rigorous ranges over boxes, in NumPy batches.

A value is a polynomial of degree one or two in (e1, e2) in [-1, 1]^2 plus a remainder [-r, r].
Operations keep the polynomial part exact up to rounding and bound what they drop; a unary
function is expanded about the constant term with a bound on its next derivative over the
model's range. Source: Makino and Berz (2003).

Rounding: NumPy's + - x / sqrt are IEEE; sin, cos, tanh, exp, log1p are assumed within
4 ulp. After every operation the remainder grows by `SLACK` times the sum of all coefficient
magnitudes, which exceeds the rounding of the operation many times over; boxes are wide, so the
slack costs nothing. Whatever is NaN or infinite is not proved: test `low >= 0`, never its denial.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from neuralgaits._types import Float
from neuralgaits.errors import InputError
from neuralgaits.programs.algebras import expansions
from neuralgaits.programs.algebras.expansions import SLACK, Expansion
from neuralgaits.programs.program import Program

TINY = 1e-250
"""Absolute growth, for results that underflow."""

TERMS = {1: 3, 2: 6}
"""Coefficients by degree, in the order 1, e1, e2, e1^2, e1 e2, e2^2."""


@dataclass(frozen=True)
class Taylor:
    """A vector of Taylor models over a batch of boxes.

    Attributes:
        poly: coefficients. [terms, size, batch]
        radius: remainder bounds. [size, batch]
    """

    poly: Float[np.ndarray, "k n B"]
    radius: Float[np.ndarray, "n B"]

    @property
    def centre(self) -> Float[np.ndarray, "n B"]:
        """Constant terms."""
        return self.poly[0]

    def spread(self) -> Float[np.ndarray, "n B"]:
        """Bound on the distance of the value from its constant term."""
        return np.sum(np.abs(self.poly[1:]), axis=0) + self.radius

    def range(self) -> tuple[Float[np.ndarray, "n B"], Float[np.ndarray, "n B"]]:
        """Lower and upper bounds over each box."""
        quadratic = self.poly[3:]
        straight = np.sum(np.abs(self.poly[1:3]), axis=0) + self.radius
        low, high = self.centre - straight, self.centre + straight
        if len(quadratic):
            # A square is between 0 and 1, a mixed product between -1 and 1.
            squares, mixed = quadratic[[0, 2]], np.abs(quadratic[1])
            low = low + np.sum(np.minimum(squares, 0.0), axis=0) - mixed
            high = high + np.sum(np.maximum(squares, 0.0), axis=0) + mixed
        slack = SLACK * (np.abs(self.centre) + self.spread()) + TINY
        return low - slack, high + slack


@dataclass(frozen=True)
class TaylorAlgebra:
    """Rules for `walk.evaluate`. Inputs are boxes: (centre [B, size], half width [B, size]).

    The Program has one input of shape (2,); its elements move with the two symbols.

    Attributes:
        degree: 1, or 2 for conditions with second derivatives.
    """

    degree: int

    def enter(
        self, program: Program, inputs: Mapping[str, tuple[np.ndarray, np.ndarray]]
    ) -> dict[str, Taylor]:
        """Boxes to models. Raises: InputError on names or shapes."""
        names = [item.name for item in program.inputs]
        if sorted(inputs) != names or len(names) != 1 or program.inputs[0].shape != (2,):
            raise InputError(
                f"Taylor models take one input of shape (2,), found {names}: trace a function of u"
            )
        centre, half = (np.asarray(part, dtype=np.float64) for part in inputs[names[0]])
        poly = np.zeros((TERMS[self.degree], 2, len(centre)))
        poly[0] = centre.T
        poly[1, 0], poly[2, 1] = half.T
        return {names[0]: Taylor(poly, np.zeros((2, len(centre))))}

    def leave(
        self, program: Program, outputs: dict[str, Taylor], inputs: Mapping[str, object]
    ) -> dict[str, Taylor]:
        """The models themselves."""
        del program, inputs
        return outputs

    def constant(self, array: np.ndarray) -> Taylor:
        """Exactly these doubles on every box."""
        poly = np.zeros((TERMS[self.degree], array.size, 1))
        poly[0] = array[:, None]
        return Taylor(poly, np.zeros((array.size, 1)))

    def move(self, operands: Sequence[Taylor], index: np.ndarray) -> Taylor:
        """Gather elements: exact."""
        if len(operands) == 1:
            return Taylor(operands[0].poly[:, index], operands[0].radius[index])
        batch = max(part.radius.shape[1] for part in operands)
        polys = [np.broadcast_to(p.poly, (*p.poly.shape[:2], batch)) for p in operands]
        radii = [np.broadcast_to(p.radius, (p.radius.shape[0], batch)) for p in operands]
        return Taylor(np.concatenate(polys, axis=1)[:, index], np.concatenate(radii)[index])

    def affine(self, matrix: Taylor, right: Taylor, offset: Taylor | None, columns: int) -> Taylor:
        """Matrix of (nearly exact) constants times models; one product for all coefficients."""
        terms, size, batch = right.poly.shape
        inner = size // columns
        weights = matrix.centre.reshape(-1, inner)
        error = matrix.radius.reshape(-1, inner)
        stacked = right.poly.reshape(terms, inner, columns * batch)
        poly = np.einsum("ij,tjb->tib", weights, stacked, optimize=True)
        magnitude = (np.abs(right.poly).sum(axis=0) + right.radius).reshape(inner, -1)
        radius = np.abs(weights) @ right.radius.reshape(inner, -1)
        # Sums of `inner` products round at most `inner` times the last place each.
        radius = radius + (error + inner * SLACK / 16 * np.abs(weights)) @ magnitude
        result = Taylor(poly.reshape(terms, -1, batch), radius.reshape(-1, batch))
        if offset is not None:
            wide = np.repeat(np.arange(offset.radius.shape[0]), columns)
            result = self.add(result, self.move([offset], wide))
        return _rounded(result)

    def sum(self, a: Taylor, size: int) -> Taylor:
        """Row sums."""
        terms, _, batch = a.poly.shape
        poly = a.poly.reshape(terms, size, -1, batch)
        radius = a.radius.reshape(size, -1, batch)
        count = poly.shape[2]
        magnitude = np.sum(np.abs(poly), axis=(0, 2)) + radius.sum(axis=1)
        total = radius.sum(axis=1) + count * SLACK / 16 * magnitude
        return _rounded(Taylor(poly.sum(axis=2), total))

    def inner(self, a: Taylor, b: Taylor, size: int) -> Taylor:
        """Row-wise inner products."""
        return self.sum(self.mul(a, b), size)

    def add(self, a: Taylor, b: Taylor) -> Taylor:
        """Sum."""
        return _rounded(Taylor(a.poly + b.poly, a.radius + b.radius))

    def sub(self, a: Taylor, b: Taylor) -> Taylor:
        """Difference."""
        return _rounded(Taylor(a.poly - b.poly, a.radius + b.radius))

    def mul(self, a: Taylor, b: Taylor) -> Taylor:
        """Product; what exceeds the degree goes into the remainder."""
        p, q = a.poly, b.poly
        linear_a, linear_b = np.abs(p[1:3]).sum(axis=0), np.abs(q[1:3]).sum(axis=0)
        bound_a, bound_b = np.abs(p).sum(axis=0), np.abs(q).sum(axis=0)
        radius = a.radius * (bound_b + b.radius) + b.radius * bound_a
        terms = [p[0] * q[0], *(p[0] * q[k] + p[k] * q[0] for k in range(1, len(p)))]
        if self.degree == 1:
            radius = radius + linear_a * linear_b
        else:
            terms[3] = terms[3] + p[1] * q[1]
            terms[4] = terms[4] + p[1] * q[2] + p[2] * q[1]
            terms[5] = terms[5] + p[2] * q[2]
            square_a, square_b = np.abs(p[3:]).sum(axis=0), np.abs(q[3:]).sum(axis=0)
            radius = radius + linear_a * square_b + square_a * (linear_b + square_b)
        return _rounded(Taylor(np.stack(terms), radius), bound_a * bound_b)

    def div(self, a: Taylor, b: Taylor) -> Taylor:
        """Quotient, by the reciprocal."""
        return self.mul(a, self.unary(b, expansions.reciprocal))

    def neg(self, a: Taylor) -> Taylor:
        """Negative: exact."""
        return Taylor(-a.poly, a.radius)

    def square(self, a: Taylor) -> Taylor:
        """Square."""
        return self.mul(a, a)

    def sqrt(self, a: Taylor) -> Taylor:
        """Square root."""
        return self.unary(a, expansions.sqrt)

    def exp(self, a: Taylor) -> Taylor:
        """Exponential."""
        return self.unary(a, expansions.exp)

    def log1p(self, a: Taylor) -> Taylor:
        """Logarithm of 1 + a."""
        return self.unary(a, expansions.log1p)

    def sin(self, a: Taylor) -> Taylor:
        """Sine."""
        return self.unary(a, expansions.sin)

    def cos(self, a: Taylor) -> Taylor:
        """Cosine."""
        return self.unary(a, expansions.cos)

    def tanh(self, a: Taylor) -> Taylor:
        """Hyperbolic tangent."""
        return self.unary(a, expansions.tanh)

    def logistic(self, a: Taylor) -> Taylor:
        """1/2 + tanh(a/2)/2: halving is exact."""
        half = self.tanh(Taylor(0.5 * a.poly, 0.5 * a.radius))
        poly = 0.5 * half.poly
        poly[0] = poly[0] + 0.5
        return _rounded(Taylor(poly, 0.5 * half.radius))

    def unary(self, a: Taylor, function: Expansion) -> Taylor:
        """f(c) + f'(c) d + f''(c) d^2 / 2 + remainder, d the model without its constant."""
        # Rounded up: a singularity may lie just outside. No function of infinity is bounded.
        spread = np.where(np.isfinite(a.centre), a.spread() * (1.0 + SLACK), np.nan)
        with np.errstate(all="ignore"):
            (value, first, second), error, remainder = function(a.centre, spread, self.degree)
        shifted = Taylor(np.concatenate([np.zeros_like(a.poly[:1]), a.poly[1:]]), a.radius)
        poly = first * shifted.poly
        radius = np.abs(first) * shifted.radius + remainder
        if self.degree == 2:
            squared = self.mul(shifted, shifted)
            half = 0.5 * second
            poly = poly + half * squared.poly
            radius = radius + np.abs(half) * squared.radius
        poly[0] = poly[0] + value
        return _rounded(Taylor(poly, radius), error)


def _rounded(model: Taylor, more: np.ndarray | float = 0.0) -> Taylor:
    """Let the remainder grow by what the last operation may have rounded."""
    size = np.abs(model.poly).sum(axis=0) + model.radius + more
    return Taylor(model.poly, model.radius + SLACK * size + TINY)
