"""Errors of held torques: bounds that satisfy the inequalities for which they are found."""

import pytest

from neuralgaits.certificate.levels.full_order.held import Jerk

W, RADIUS, GAMMA = 50.0, 6e-3, 70.0
JERK = Jerk(still=800.0, slope=2e5, push=20.0)


@pytest.mark.parametrize("rest", [0.0, 0.1, 0.4, 2.0])
@pytest.mark.parametrize("hold", [2e-4, 7e-4])
def test_push_and_peak_bear_the_errors_that_they_let_grow(hold, rest):
    """Inequality 3 of docs/level5.md, with the law's own error, which may be above the peak."""
    held = JERK.held(hold, 0.05, W, RADIUS, GAMMA, rest)
    assert held is not None
    peak = held.peak[0] + held.peak[1] * RADIUS
    still = JERK.still + (2.0 * W + JERK.push) * peak
    mean = 0.5 * hold * (1.0 + GAMMA * hold / 8.0)
    assert held.push[0] <= held.peak[0]
    assert rest + 0.05 + mean * still <= held.push[0] * (1.0 + 1e-12)
    assert 0.05 + hold * still <= held.peak[0] * (1.0 + 1e-12)
    # And no more than it takes.
    assert rest + 0.05 + mean * still == pytest.approx(held.push[0], rel=1e-12)
