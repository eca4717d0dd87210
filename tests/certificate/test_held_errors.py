"""Errors of held torques: bounds that satisfy the inequalities for which they are found."""

import numpy as np
import pytest

from neuralgaits.certificate.levels.full_order.held import Jerk, rest_bound

W, GAMMA = 50.0, 70.0
JERK = Jerk(still=800.0, slope=2e5, push=20.0)


@pytest.mark.parametrize("rest", [0.0, 0.1, 0.4, 2.0])
@pytest.mark.parametrize("hold", [2e-4, 7e-4])
@pytest.mark.parametrize("radius", [0.0, 1e-3, 6e-3])
def test_push_and_peak_bear_the_errors_that_they_let_grow(hold, rest, radius):
    """Of e' = j + l R + rho e, integrated: its end, and its mean with the law's own error."""
    error, rate = 0.05, 2.0 * W + JERK.push
    held = JERK.held(hold, error, W, GAMMA, rest)
    most = JERK.still + np.exp(0.5 * GAMMA * hold) * JERK.slope * radius
    since = np.linspace(0.0, hold, 20_001)
    errors = error + (most + rate * error) * np.expm1(rate * since) / rate
    np.testing.assert_allclose(np.diff(errors)[0] / since[1], most + rate * error, rtol=1e-4)
    peak, push = (first + second * radius for first, second in (held.peak, held.push))
    mean = np.trapezoid(errors, since) / hold
    assert held.push[0] <= held.peak[0] and held.push[1] <= held.peak[1]
    assert errors[-1] <= peak * (1.0 + 1e-9)
    # W - sqrt(V) costs more than the mean, a little.
    assert rest + mean < push < rest + error + 1.02 * (mean - error)
    if rest < 0.04:  # No more than it takes, unless the push is above it.
        assert errors[-1] == pytest.approx(peak, rel=1e-9)


def test_the_law_s_own_error_has_room_and_is_not_asked_to_be_nothing():
    """Bounds of 0.005 rad/s^2 were not proved of polynomials that are as good as that."""
    assert rest_bound(np.array([[0.3, 0.4], [0.0, 0.1]])) == pytest.approx(0.55)
    assert 0.01 < rest_bound(np.array([[3e-3, 4e-3]])) < 0.05
