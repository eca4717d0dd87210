"""Errors of held torques: bounds that satisfy the inequalities for which they are found."""

import numpy as np
import pytest

from neuralgaits.certificate.levels.full_order.held import (
    Jerk,
    feedback_slope,
    rest_bound,
    slope_bound,
)
from neuralgaits.certificate.levels.full_order.hold_map import (
    HoldErrors,
    face_matrix,
    hold_shares,
)

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


@pytest.mark.parametrize("hold", [1e-4, 1.5e-3, 4e-3])
@pytest.mark.parametrize("slope", [0.0, 60.0, 250.0])
def test_least_radii_and_shrinking_are_estimated_as_the_matrices_decide(hold, slope):
    """Of the best of many splits, at both ends of the hold."""
    shares = hold_shares(W, hold, slope)
    errors = 0.7
    splits = np.linspace(0.2, 3.0, 2801)

    def positive(radius, grown, shrink):
        ends = []
        for tau in (0.0, W * hold):
            a, b, c = face_matrix(tau, radius, HoldErrors(grown / W**2, 0.0), shrink / W, splits)
            ends.append((a > 0.0) & (a * c > b * b))
        return bool(np.any(ends[0] & ends[1]))

    for share, holds in ((1.01, True), (0.98, False)):
        floor = share * shares.floor * errors / W**2
        assert positive(floor, errors + slope * floor, 0.0) == holds
    for share, holds in ((0.98, True), (1.01, False)):
        assert positive(1.0, slope, share * shares.shrink) == holds


def test_a_slope_of_the_jerk_is_bounded_without_what_outputs_feed_back():
    """Slopes of S de/dt that are -w^3 (1, 1) alone have a jerk without slope."""
    own = -(W**3) * np.concatenate([np.eye(4), np.eye(4)], axis=1)[None]
    assert slope_bound(own, W, exact=True) == 0.0
    assert slope_bound(own, W, exact=False) == pytest.approx(feedback_slope(W))
    held = JERK.held(1e-3, 0.0, W), JERK._replace(feedback=1e5).held(1e-3, 0.0, W)
    assert held[1].peak[1] == pytest.approx(1.5 * held[0].peak[1])
    assert held[1].peak[0] == held[0].peak[0]
    kicks = [one.kicked(1.0, 1e-3, W, 5e-3).peak for one in (JERK, JERK._replace(feedback=1e5))]
    assert kicks[1] > kicks[0]
    # The jerk of outputs that feed themselves back does not have that part.
    assert JERK.halves(1e-3, held[0]) == JERK._replace(feedback=1e5).halves(1e-3, held[0])
