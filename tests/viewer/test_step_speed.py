"""The speed on the page is that of a whole step, and can be compared with a command."""

import pytest

from neuralgaits.viewer.step_speed import StepSpeed


def test_it_is_the_mean_between_two_touchdowns():
    pace = StepSpeed()
    for tick in range(1, 1201):
        # 0.3 m a step of 0.4 s, three times as fast in its first half as in its second.
        steps, along = divmod(tick, 400)
        share = 1.5 * along / 400 if along <= 200 else 0.75 + 0.5 * (along - 200) / 400
        pace.see(steps, 1e-3 * tick, 0.3 * (steps + share))
        if tick < 800:
            assert pace.mean is None
        else:
            assert pace.mean == pytest.approx(0.75)


def test_a_robot_that_is_put_back_keeps_the_last_step():
    pace = StepSpeed()
    for steps, time, place in ((1, 0.4, 0.3), (2, 0.8, 0.6), (3, 1.2, -5.0), (4, 1.6, -4.8)):
        pace.see(steps, time, place)
        assert steps < 2 or pace.mean == pytest.approx(0.5 if steps == 4 else 0.75)
