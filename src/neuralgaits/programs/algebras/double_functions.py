"""Functions of a Program at points, in doubles, with errors that are proved and not assumed.

Only +, -, x, / and square roots of single numbers are trusted: IEEE 754 rounds each of them with a
relative error of at most UNIT = 2^-52, whatever the rounding mode. No value of a library function
is. `exp`, `sin` and `cos` are Taylor sums behind a reduction of the argument; `tanh` and the
logistic function follow from `exp`; `log1p` is a guess whose distance from the truth is computed.

Each function takes points c and a bound r on the distance from them, and gives f, f' and f''/2 at c
with one bound each on their errors, and a bound on |f'''| / 6 over [c - r, c + r]. Where that is
not known, the last is NaN, so that nothing follows. Needs no JAX.
Source: Higham, "Accuracy and Stability of Numerical Algorithms" (2002), chapters 3 and 5.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

UNIT = 2.0**-52
"""Bound on the relative error of one operation, in any rounding mode."""
ERROR = 2.0**-44
"""Bound on the errors of `exponential` (relative), `sine_cosine`, tanh and logistic (absolute):
256 UNIT. The functions below prove less than 160 UNIT each."""
LN2 = (float.fromhex("0x1.62e42fefa2000p-1"), float.fromhex("0x1.9ef35793c7673p-41"))
"""ln 2 as a sum, to within 2^-101; the first has 40 bits."""
HALF_PI = tuple(
    map(float.fromhex, ("0x1.921fb54400000p+0", "0x1.0b4611a600000p-34", "0x1.3198a2e037073p-69"))
)
"""pi / 2 as a sum, to within 2^-122; the first two have 33 bits each."""
MOST_EXPONENT = 700.0
"""Largest magnitude of an argument of exp."""
MOST_ANGLE = 2.0**20
"""Largest magnitude of an argument of sin and cos."""

Values = np.ndarray
"""A double for each element on each box. [size, batch]."""


class LocalExpansion(NamedTuple):
    """f, f' and f''/2 at points, bounds on their errors, and one on |f'''| / 6 about the points."""

    derivatives: tuple[Values, Values, Values]
    errors: tuple[Values | float, Values | float, Values | float]
    third: Values


def sums(z: Values, last: int, first: int, step: int, sign: float) -> Values:
    """Return the sum of sign^k z^k / (first + step k)! by Horner's rule, first + step k <= last.

    Its error is at most (2 n + 2) UNIT (1 + 2^-40) times the sum of magnitudes, n the number of
    terms: two roundings a term, and one of each coefficient (Higham, section 5.1).
    """
    value = np.zeros_like(z)
    for order in reversed(range(first, last + 1, step)):
        k = (order - first) // step
        value = value * z + sign**k / math.factorial(order)
    return value


def exponential(x: Values) -> Values:
    """Return exp(x) with a relative error of at most ERROR; NaN for |x| > MOST_EXPONENT.

    x = k ln 2 + r with a whole k, |k| < 2^10, so k LN2[0] is exact. k LN2[1], the two differences,
    and what LN2 lacks, move r by less than 3 UNIT. |r| <= 0.7, though k may have been rounded to
    the wrong side. The sum to r^17 / 17! lacks 0.7^18 / 18! e^0.7 < 2^-60. By `sums` with 18 terms,
    magnitudes adding up to e^0.7 < 2.02, it is off by 38 UNIT x 2.02 < 77 UNIT, which is less than
    155 UNIT of e^r >= 0.496. The product with 2^k, made from its bits, is a normal number: exact.
    """
    inside = np.abs(x) <= MOST_EXPONENT
    x = np.where(inside, x, 0.0)
    whole = np.rint(x * (1.0 / LN2[0])).astype(np.int64)
    k = whole.astype(np.float64)
    r = (x - k * LN2[0]) - k * LN2[1]
    power = ((whole + 1023) << 52).view(np.float64)
    value = sums(r, last=17, first=0, step=1, sign=1.0) * power
    return np.where(inside & (np.abs(r) <= 0.699), value, np.nan)


def sine_cosine(x: Values) -> tuple[Values, Values]:
    """Return sin x and cos x with errors of at most ERROR; NaN for |x| > MOST_ANGLE.

    x = k pi/2 + r with a whole k, |k| < 2^20, so k HALF_PI[0] and k HALF_PI[1] are exact. What the
    three differences and the third product round, and what HALF_PI lacks, move r by less than
    6 UNIT, as |r| <= 1.6 and k HALF_PI[1] < 2^-13. The sums to r^21 / 21! and r^22 / 22! lack less
    than 2^-58. By `sums` with twelve terms at most, r^2 rounded once more in each power, they are
    off by (26 + 12) UNIT cosh(1.6) < 98 UNIT.
    """
    inside = np.abs(x) <= MOST_ANGLE
    x = np.where(inside, x, 0.0)
    whole = np.rint(x * (1.0 / HALF_PI[0])).astype(np.int64)
    k = whole.astype(np.float64)
    r = ((x - k * HALF_PI[0]) - k * HALF_PI[1]) - k * HALF_PI[2]
    sine = r * sums(r * r, last=21, first=1, step=2, sign=-1.0)
    cosine = sums(r * r, last=22, first=0, step=2, sign=-1.0)
    inside &= np.abs(r) <= 1.599
    quarter = whole & 3
    swapped = quarter & 1 == 1
    first, second = np.where(swapped, cosine, sine), np.where(swapped, sine, cosine)
    first = np.where(quarter >= 2, -first, first)
    second = np.where((quarter == 1) | (quarter == 2), -second, second)
    return np.where(inside, first, np.nan), np.where(inside, second, np.nan)


def exp(c: Values, r: Values) -> LocalExpansion:
    """Expand the exponential: all derivatives are the value, which grows."""
    value = exponential(c)
    error = ERROR * value
    # c + r is rounded: 1e-12 is more than that for |c + r| <= MOST_EXPONENT.
    most = exponential(c + r + 1e-12) * (1.0 + 2.0 * ERROR)
    return LocalExpansion((value, value, 0.5 * value), (error, error, error), most / 6.0)


def sin(c: Values, r: Values) -> LocalExpansion:
    """Expand the sine (c in rad): |f'''| = |cos|, and that changes by r at most."""
    sine, cosine = sine_cosine(c)
    third = _limited(1.0, np.abs(cosine) + r)
    return LocalExpansion((sine, cosine, -0.5 * sine), (ERROR, ERROR, ERROR), third / 6.0)


def cos(c: Values, r: Values) -> LocalExpansion:
    """Expand the cosine (c in rad): |f'''| = |sin|, and that changes by r at most."""
    sine, cosine = sine_cosine(c)
    third = _limited(1.0, np.abs(sine) + r)
    return LocalExpansion((cosine, -sine, -0.5 * cosine), (ERROR, ERROR, ERROR), third / 6.0)


def tanh(c: Values, r: Values) -> LocalExpansion:
    """Expand the hyperbolic tangent, t = (e^2c - 1) / (e^2c + 1).

    Beyond 20, where 1 - |t| < 2^-56, t is taken at 20. An error of d in e^2c, relative, moves t by
    d/2 at most, three roundings by 4 UNIT: less than ERROR in all. With that,
    f' = 1 - t^2 is off by 2 ERROR and roundings, f''/2 = -t f' by |1 - 3 t^2| <= 2 times ERROR,
    f''' = f' (6 t^2 - 2) by 8 ERROR; |f'''| <= 2 and |f''''| = |16 t - 24 t^3| f' <= 4.086.
    """
    grown = exponential(2.0 * np.clip(c, -20.0, 20.0))
    t = (grown - 1.0) / (grown + 1.0)
    slope = 1.0 - t * t
    third = _limited(2.0, np.abs(slope * (6.0 * t * t - 2.0)) + 4.09 * r)
    error = 4.0 * ERROR
    return LocalExpansion((t, slope, -t * slope), (ERROR, error, error), third / 6.0)


def logistic(c: Values, r: Values) -> LocalExpansion:
    """Expand s = 1 / (1 + e^-c), which is 1/2 + tanh(c/2) / 2, so derivatives are those halved.

    Beyond 40, where it is within 2^-57 of 0 or 1, s is taken at 40. An error of d in e^-c,
    relative, moves s by d/4 at most. f' = s (1 - s) and f''/2 = f' (1 - 2 s) / 2 are off by no more
    than s is, and roundings. |f'''| <= 2/16, |f''''| <= 4.086/32.
    """
    s = 1.0 / (1.0 + exponential(-np.clip(c, -40.0, 40.0)))
    slope = s * (1.0 - s)
    third = _limited(0.125, np.abs(slope * (1.0 - 6.0 * slope)) + 0.128 * r)
    error = 2.0 * ERROR
    return LocalExpansion(
        (s, slope, 0.5 * slope * (1.0 - 2.0 * s)), (ERROR, error, error), third / 6.0
    )


def log1p(c: Values, r: Values) -> LocalExpansion:
    """Expand log(1 + c) about a guess y, for 1 + c - r > 0.

    log(1 + c) - y = log(1 + w), 1 + w = (1 + c) e^-y, whatever y is; and |log(1 + w)| <= 2 |w| for
    |w| <= 1/2. The product is known to within 2 ERROR of itself.
    """
    above = 1.0 + c
    nearest = (above - r) * (1.0 - 4.0 * UNIT) - 4.0 * UNIT * r
    guess = np.log1p(np.where(nearest > 0.0, c, 0.0))
    ratio = above * exponential(-guess)
    off = np.abs(ratio - 1.0) + 4.0 * ERROR * ratio
    slope = 1.0 / above
    half = -0.5 * slope * slope
    valid = (nearest >= 1e-50) & (above <= 1e50) & (off <= 0.25)
    third = np.where(valid, 1.0 / nearest, np.nan)
    third = third * third * third * ((1.0 + 16.0 * UNIT) / 3.0)
    errors = 2.0 * off + 1e-300, 8.0 * UNIT * slope, 16.0 * UNIT * np.abs(half)
    return LocalExpansion((guess, slope, half), errors, third)


POINT_FUNCTIONS: dict[str, Callable[[Values, Values], LocalExpansion]] = {
    "exp": exp,
    "log1p": log1p,
    "sin": sin,
    "cos": cos,
    "tanh": tanh,
    "logistic": logistic,
}
"""Functions by the kind of operation that they evaluate."""


def _limited(limit: float, size: Values) -> Values:
    """Return a bound of a derivative: no more than `limit`, nor than a size that is rounded."""
    return np.minimum(limit, size * (1.0 + 64.0 * UNIT) + 16.0 * ERROR)
