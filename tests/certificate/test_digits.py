"""Few digits of a bound never claim more than the bound."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from neuralgaits._digits import at_least, at_most

numbers = st.floats(-1e6, 1e6).filter(lambda value: abs(value) > 1e-6)


@given(numbers, st.integers(2, 8))
def test_a_bound_stays_on_its_side_and_near(value, digits):
    low, high = (Fraction(side(value, digits)) for side in (at_least, at_most))
    assert low <= Fraction(value) <= high
    assert high - low <= abs(Fraction(value)) / 10 ** (digits - 2)


@pytest.mark.parametrize(
    ("value", "low", "high"),
    [(0.7087335, "0.7087", "0.7088"), (-1.10643, "-1.107", "-1.106"), (0.25, "0.25", "0.25")],
)
def test_the_last_digit_goes_outwards(value, low, high):
    assert (at_least(value, 4), at_most(value, 4)) == (low, high)
