"""The trail on the chart: where the state was, whatever is drawn how often."""

import numpy as np

from neuralgaits.viewer.live_gait import LiveGait
from neuralgaits.viewer.trail import SAMPLES, TICKS, Trail


def test_it_samples_by_ticks_and_has_a_gap_at_a_touchdown():
    trail = Trail()
    assert trail.states.shape == (0, 2)
    for tick in range(2 * TICKS):
        trail.add(np.array([tick, 0.0]), 0)
    for tick in range(TICKS):
        trail.add(np.array([-1.0 - tick, 0.0]), 1)
    np.testing.assert_array_equal(trail.states[:, 0], [0.0, TICKS, np.nan, -1.0])


def test_it_keeps_what_came_last_and_takes_finite_states_only():
    trail = Trail()
    for tick in range((SAMPLES + 5) * TICKS):
        trail.add(np.array([tick, 0.0]), 0)
    assert len(trail.states) == SAMPLES
    assert trail.states[0, 0] == 5 * TICKS
    for _ in range(TICKS):
        trail.add(np.full(2, np.nan), 0)
    assert np.all(np.isfinite(trail.states))


def test_a_live_gait_leaves_one_and_begins_anew(shipped):
    gait = LiveGait(shipped)
    while gait.steps < 2 and gait.tick():
        pass
    states = gait.shown().trail
    assert np.isnan(states).any(axis=1).sum() == 2
    between = states[np.isfinite(states).all(axis=1)]
    start, guard = gait.chart.start, gait.chart.guard
    assert len(between) > 30 and np.all(between[:, 0] > start - 0.02)
    assert np.all(between[:, 0] < guard + 0.02)
    gait.reset()
    assert len(gait.shown().trail) == 0
