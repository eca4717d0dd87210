"""The leg that stands, from contacts that chatter, glitch, scuff and overlap."""

import numpy as np
import pytest

from neuralgaits.control.touchdown import TouchdownThresholds
from neuralgaits.logs.contacts import UNKNOWN, loaded, stance_legs

ROWS = 1000
T = 1e-3 * np.arange(ROWS)
TOUCHDOWNS = (300, 700)


@pytest.fixture
def walked():
    """Contacts and the distance of the feet: leg 0 stands, then 1 from row 300, 0 from 700."""
    contact = np.zeros((ROWS, 2), dtype=bool)
    contact[:300, 0] = contact[300:700, 1] = contact[700:, 0] = True
    ahead = np.interp(T, [0.0, 0.3, 0.7, 1.0], [-0.3, 0.3, -0.3, 0.3])
    return contact, ahead


def changes(legs):
    return tuple(np.flatnonzero(np.diff(legs)) + 1)


def test_legs_take_turns(amber, walked):
    legs = stance_legs(amber.leg_length, T, *walked)
    assert changes(legs) == TOUCHDOWNS
    assert legs[0] == 0


def test_double_support_belongs_to_the_foot_that_has_landed(amber, walked):
    contact, ahead = walked
    contact[300:330, 0] = contact[700:720, 1] = True
    assert changes(stance_legs(amber.leg_length, T, contact, ahead)) == TOUCHDOWNS


def test_a_switch_that_chatters_ends_one_step(amber, walked):
    contact, ahead = walked
    contact[303:309:2, 1] = False
    contact[303:309, 0] = True
    assert changes(stance_legs(amber.leg_length, T, contact, ahead)) == TOUCHDOWNS


def test_one_row_is_no_touchdown_and_a_scuff_behind_is_none(amber, walked):
    contact, ahead = walked
    contact[250, 1] = True  # In front, for one row.
    contact[20:60, 1] = True  # Behind.
    assert changes(stance_legs(amber.leg_length, T, contact, ahead)) == TOUCHDOWNS


def test_rows_before_one_foot_alone_stands_have_no_leg(amber, walked):
    contact, ahead = walked
    contact[:50] = True
    legs = stance_legs(amber.leg_length, T, contact, ahead)
    # The last row of both is the first of one that stays.
    assert np.all(legs[:49] == UNKNOWN) and np.all(legs[49:300] == 0)
    contact[:] = True
    assert np.all(stance_legs(amber.leg_length, T, contact, ahead) == UNKNOWN)


def test_a_force_is_compared_with_the_weight(amber):
    least = TouchdownThresholds().force_share * float(amber.mass * amber.gravity)
    assert list(
        loaded(float(amber.mass * amber.gravity), np.array([0.9 * least, 1.1 * least]))
    ) == [False, True]
