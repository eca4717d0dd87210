import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.control.touchdown import TouchdownThresholds, advance_stance, start_stance

CONFIG = TouchdownThresholds()
DT = 1e-3
LOAD = np.array([0.0, 50.0])


@pytest.fixture
def ahead(amber):
    """Coordinates with the swing foot 0.3 m ahead of the stance foot."""
    q = np.array([0.0, 0.0, 0.1, -0.25, 0.0])
    assert amber.swing_foot(q)[0] > 0.25
    return q


def go(amber, state, q, force=LOAD, ticks=1):
    touchdown = False
    for _ in range(ticks):
        state, touchdown = advance_stance(CONFIG, amber, state, q, force, DT)
    return state, bool(touchdown)


def test_a_loaded_swing_foot_ahead_takes_over(amber, ahead):
    state, touchdown = go(amber, start_stance(0), ahead)
    assert touchdown
    assert (int(state.leg), float(state.since_touchdown)) == (1, 0.0)


def test_there_is_no_lockout_before_the_first_touchdown(amber, ahead):
    assert np.isinf(start_stance().since_touchdown)
    assert go(amber, start_stance(), ahead)[1]


def test_after_a_touchdown_contacts_do_not_count_for_a_while(amber, ahead):
    state, _ = go(amber, start_stance(0), ahead)
    both = np.array([50.0, 50.0])
    locked = round(CONFIG.lockout_s / DT)
    state, _ = go(amber, state, ahead, both, locked - 1)
    assert int(state.leg) == 1
    state, touchdown = go(amber, state, ahead, both, 2)
    assert touchdown or int(state.leg) == 0


def test_a_scuff_behind_the_stance_foot_ends_no_step(amber, ahead):
    behind = amber.relabel @ ahead
    assert amber.swing_foot(behind)[0] < 0.0
    assert not go(amber, start_stance(0), behind)[1]


def test_a_touch_without_load_and_a_load_on_the_stance_foot_end_no_step(amber, ahead):
    light = 0.5 * CONFIG.force_share * float(amber.mass * amber.gravity)
    assert not go(amber, start_stance(0), ahead, np.array([0.0, light]))[1]
    assert not go(amber, start_stance(0), ahead, np.array([200.0, 0.0]))[1]
    assert go(amber, start_stance(jnp.asarray(1)), ahead, np.array([50.0, 0.0]))[1]
