"""Rates of angles: exact for parabolas, at any times, up to the ends of a piece."""

import numpy as np
import pytest

from neuralgaits.logs.rates import HALF_WINDOWS_S, QUIET_RAD_S, half_window, noise
from neuralgaits.logs.rates import rates as rates_of


@pytest.fixture
def times():
    """Rows about 1 ms apart, some of them missing."""
    rng = np.random.default_rng(0)
    t = 1e-3 * np.arange(300) + rng.uniform(-2e-4, 2e-4, 300)
    return np.delete(t, [40, 41, 150])


REACH_S = 0.015


def rates(t, values, piece, spoilt, settled=None, reach_s=REACH_S):
    """All rows settled, if nothing is said."""
    settled = np.ones(t.size, dtype=bool) if settled is None else settled
    return rates_of(t, values, piece, settled, spoilt, reach_s)


def clean(values):
    return np.zeros(values.shape, dtype=bool)


def test_a_parabola_is_differentiated_exactly_up_to_its_ends(times):
    values = np.column_stack([1.0 + 2.0 * times - 3.0 * times**2, np.full(times.size, 5.0)])
    found = rates(times, values, np.zeros(times.size, dtype=int), clean(values))
    np.testing.assert_allclose(found[:, 0], 2.0 - 6.0 * times, atol=1e-9)
    np.testing.assert_allclose(found[:, 1], 0.0, atol=1e-9)


def test_nothing_is_shifted_in_time():
    """A sine's rate comes out smaller, and not later."""
    t = 1e-3 * np.arange(2000)
    values = np.sin(20.0 * t)[:, None]
    found = rates(t, values, np.zeros(t.size, dtype=int), clean(values))[100:-100, 0]
    t = t[100:-100]
    size = 20.0 * np.linalg.lstsq(np.column_stack([np.cos(20 * t), np.sin(20 * t)]), found)[0] / 20
    assert abs(size[1]) < 1e-6 * size[0]
    assert size[0] == pytest.approx(20.0, rel=0.1 * (20.0 * REACH_S) ** 2 * 1.2)


def test_a_kink_between_pieces_stays_sharp(times):
    piece = (times > 0.15).astype(int)
    values = np.where(piece, 3.0, -1.0)[:, None] * (times - 0.15)[:, None]
    found = rates(times, values, piece, clean(values))
    np.testing.assert_allclose(found[:, 0], np.where(piece, 3.0, -1.0), atol=1e-9)


def test_a_row_that_stands_out_counts_for_nothing(times):
    values = (2.0 * times)[:, None]
    values[100] += 0.3
    spoilt = clean(values)
    spoilt[100] = True
    found = rates(times, values, np.zeros(times.size, dtype=int), spoilt)
    np.testing.assert_allclose(found, 2.0, atol=1e-3)


def test_pieces_without_a_parabola_have_no_rate(times):
    piece = np.zeros(times.size, dtype=int)
    piece[10:12], piece[12:] = 1, 2
    values = times[:, None]
    found = rates(times, values, piece, clean(values))
    assert np.isnan(found[10:12]).all() and np.isfinite(found[:10]).all()
    assert np.isnan(rates(times[:1], values[:1], piece[:1], clean(values[:1]))).all()


def test_rows_that_settle_do_not_reach_into_others(times):
    """A jump of the rate within a piece: later rows know nothing of it, earlier ones do."""
    values = np.where(times < 0.1, 7.0, 2.0)[:, None] * (times - 0.1)[:, None]
    found = rates(times, values, np.zeros(times.size, int), clean(values), times >= 0.1)
    np.testing.assert_allclose(found[times >= 0.1, 0], 2.0, atol=1e-9)
    np.testing.assert_allclose(found[times < 0.08, 0], 7.0, atol=1e-9)


@pytest.mark.parametrize("sigma", [1e-4, 5e-4])
def test_windows_are_as_long_as_the_noise_asks_for(sigma):
    t = 1e-3 * np.arange(4000)
    rng = np.random.default_rng(1)
    motion = np.column_stack([0.4 * np.sin(6.0 * t), 0.3 * np.cos(9.0 * t)])
    noisy = motion + sigma * rng.normal(size=motion.shape)
    assert noise(noisy) == pytest.approx(sigma, rel=0.05)
    assert noise(motion) < 1e-7
    reach = half_window(1e-3, sigma)
    found = rates(t, noisy, np.zeros(t.size, int), clean(noisy), reach_s=reach)
    true = rates(t, motion, np.zeros(t.size, int), clean(noisy), reach_s=reach)
    left = np.std((found - true)[100:-100])
    shortest, longest = HALF_WINDOWS_S
    assert shortest <= reach <= longest
    assert left == pytest.approx(QUIET_RAD_S, rel=0.2) or reach in HALF_WINDOWS_S


def test_windows_stay_within_their_bounds():
    assert half_window(1e-3, 0.0) == HALF_WINDOWS_S[0]
    assert half_window(1e-3, 1.0) == HALF_WINDOWS_S[1]
    assert noise(np.zeros((3, 2))) == 0.0
