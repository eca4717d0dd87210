"""Level 5 by force: the rigid model under torques that are held between ticks."""

import pytest

from neuralgaits.certificate.levels.disturbed.find import find_disturbed
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants
from neuralgaits.certificate.levels.full_order.sample_evaluators import (
    looks_in,
    looks_of,
    set_of,
)
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from support.full_order_check import model_of
from support.held_walk import ticker, walk_held

pytestmark = pytest.mark.slow
W, WALKS = 50.0, 100


def test_no_walk_leaves_the_set_while_torques_are_held(trained):
    model = model_of(trained, W)
    looks = looks_of(model)
    shape = set_of(model, pushed=True, widest=True, looks=looks)
    assert isinstance(shape, FullOrderConstants), shape
    found = find_disturbed(looks_in(model, shape, looks), shape)
    assert isinstance(found, DisturbedConstants), found
    assert found.hold > 1e-3
    ticks, ticked = round(0.8 / found.hold), ticker(trained, shape)
    walked = walk_held(trained, shape, found.hold, ticked, walks=WALKS, ticks=ticks)
    assert walked.left == 0.0 and walked.touchdowns > 0 and walked.slack > 0.0
    assert walked.error <= found.peak[0] + found.peak[1] * shape.radius
    # Far longer holds do throw walks out: the walk could tell.
    assert walk_held(trained, shape, 0.012, ticked, walks=WALKS, ticks=70).left > 0.1
