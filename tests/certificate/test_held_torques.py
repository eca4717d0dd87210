"""Level 5 by force: the rigid model under torques that are held between ticks."""

from dataclasses import replace

import pytest

from neuralgaits.certificate.level_target import ControlAssumption
from neuralgaits.certificate.levels.disturbed.find import find_disturbed
from neuralgaits.certificate.levels.disturbed.push_inequalities import inequalities
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants
from neuralgaits.certificate.levels.full_order.sample_evaluators import (
    evaluators_in_norm,
    evaluators_of,
    set_of,
)
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from support.full_order_check import model_of
from support.held_walk import ticker, walk_held

pytestmark = pytest.mark.slow
W, WALKS = 50.0, 100
ERROR = 0.03
"""|S e| of torques when they are set [rad/s^2]."""


@pytest.mark.parametrize(("free_clock", "least"), [(False, 2e-3), (True, 1.2e-3)])
def test_no_walk_leaves_the_set_while_torques_are_held(trained, free_clock, least):
    """With a tick at each touchdown; and on a clock that runs on through touchdowns."""
    model = model_of(trained, W)
    looks = evaluators_of(model)
    control = ControlAssumption(free_clock=free_clock)
    shape = set_of(model, pushed=True, widest=True, control=control, evaluators=looks)
    assert isinstance(shape, FullOrderConstants), shape
    found = find_disturbed(evaluators_in_norm(model, shape, looks), shape, control)
    assert isinstance(found, DisturbedConstants), found
    assert found.hold > least
    # The set shrinks nearly as fast as pushed outputs do: the strip behind phase 1 is narrow.
    (shrinks,) = (s for s in inequalities(shape, found) if "the slope of N" in s.claim)
    assert float(shrinks.left) > 0.9 * float(shrinks.right)
    # A torque that is off when it is set may be held for less long, and still fits.
    off = replace(control, error=ERROR)
    erring = find_disturbed(evaluators_in_norm(model, shape, looks), shape, off)
    assert isinstance(erring, DisturbedConstants), erring
    assert erring.error == ERROR and 0.3 * found.hold < erring.hold < found.hold
    assert all(step.holds for step in inequalities(shape, erring))
    ticks, ticked = round(0.8 / found.hold), ticker(trained, shape, free_clock=free_clock)
    walked = walk_held(trained, shape, found.hold, ticked, walks=WALKS, ticks=ticks)
    assert walked.left == 0.0 and walked.touchdowns > 0 and walked.slack > 0.0
    peak = found.peak[0] + found.peak[1] * shape.radius
    # A torque of the old step errs by tens of rad/s^2 in the new one.
    assert walked.error <= (found.kick_peak if free_clock else peak)
    assert (walked.error > 5.0 * peak) == free_clock
    # Far longer holds do throw walks out: the walk could tell.
    assert walk_held(trained, shape, 0.012, ticked, walks=WALKS, ticks=70).left > 0.1
