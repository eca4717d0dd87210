"""The speed on the page is that of a whole step, and can be compared with a command."""

import pytest

from neuralgaits.viewer.step_speed import StepSpeed


def test_it_is_the_mean_between_two_touchdowns():
    pace = StepSpeed()
    pace.touch_down(1, 0.4, 0.3)
    assert (pace.steps, pace.mean) == (1, None)
    pace.touch_down(2, 0.9, 0.55)
    assert pace.mean == pytest.approx(0.5)


def test_a_robot_that_is_put_back_keeps_the_last_step():
    pace = StepSpeed()
    for steps, time, place in ((1, 0.4, 0.3), (2, 0.8, 0.6), (3, 1.2, -5.0), (4, 1.6, -4.8)):
        pace.touch_down(steps, time, place)
        assert steps < 2 or pace.mean == pytest.approx(0.5 if steps == 4 else 0.75)
