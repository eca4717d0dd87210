"""Premises of level 5 as their Python functions compute them, and by the C++ checker."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pytest

from neuralgaits.barriers import Gait
from neuralgaits.certificate.levels.disturbed.margins import FORCES
from neuralgaits.certificate.levels.disturbed.theorem import (
    DisturbedBarrier,
    DisturbedConstants,
    slope_output,
)
from neuralgaits.certificate.levels.level_search import LevelSets
from neuralgaits.gait.scheduled_gains import ScheduledGains
from support.checker_case import bounds
from support.full_case import NARROW, WIDE, FullCase, in_the_ball

pytestmark = pytest.mark.slow
PUSH = (8.0, 20.0)
"""Of the errors [rad/s^2, rad/s^2 per rad of the bound on sqrt(V)]."""
HELD = ("disturbed/jerk", "disturbed/jerk-push")
LAW = ("disturbed/decay", "disturbed/rest")
KICKS = tuple(f"disturbed/kick{end}" for end in ("", "-slope", "-push", "-contact"))


@dataclass(frozen=True)
class PushedCase(FullCase):
    """The outputs of level 5 beside those of level 4.

    Attributes:
        scheduled: whether the law is scheduled PD, with gains that are somewhat off.
    """

    scheduled: bool = False

    @cached_property
    def sets(self) -> LevelSets:
        draw = np.random.default_rng(11)
        names = self.full_model.names
        rows = tuple(DisturbedBarrier(n, *draw.uniform(0.5, 2.0, size=3).tolist()) for n in names)
        jerk, kick = (1.0, 1e5, 3.0), (50.0, 1.0, 2.0, 30.0, 0.05)
        shape = DisturbedConstants(PUSH, PUSH, 1e-3, 0.0, *jerk, rows, *kick)
        if self.scheduled:
            assert isinstance(self.gait, Gait)
            gains = ScheduledGains.of(self.robot, self.gait)
            torque = tuple(float(x) for x in 1.02 * np.ravel(gains.torque))
            inertia = tuple(float(x) for x in 0.95 * np.ravel(gains.inertia))
            law = {"torque_gains": torque, "inertia_gains": inertia, "decay": 20.0, "rest": 2.0}
            shape = replace(shape, **law)
        return LevelSets({4: self.shape, 5: shape})


@pytest.mark.parametrize("scheduled", [False, True])
def test_its_own_formulas_are_those_of_the_premises(proofcheck, tmp_path, scheduled):
    """At points and next to no outputs: what a push takes counts."""
    case = PushedCase("amber3m", radius=NARROW, scheduled=scheduled)
    file = case.write(tmp_path / "proof.json")
    u = np.random.default_rng(1).uniform((0.0, 0.2), (1.0, 0.8), size=(6, 2))
    values = case.values(u)
    held = *HELD, slope_output(not scheduled)
    own = {"disturbed/contact", "disturbed/torque", *held, *KICKS, *(LAW if scheduled else ())}
    assert own < set(values) and slope_output(scheduled) not in values
    for name in values:
        if not name.startswith("disturbed/"):
            continue
        enclosed = np.stack([one[name] for one in bounds(proofcheck, file, u, u)])
        scale = np.maximum(1.0, np.abs(values[name]).max())
        np.testing.assert_allclose(
            enclosed.mean(axis=-1) / scale, values[name] / scale, atol=1e-5, rtol=0, err_msg=name
        )
    for name in () if scheduled else FORCES:
        taken = values[f"full/{name}"] - values[f"disturbed/{name}"]
        assert np.all(taken > 0.0) and taken.max() > 0.05


@pytest.mark.parametrize("scheduled", [False, True])
def test_what_it_derives_over_a_box_is_below_every_point(proofcheck, tmp_path, scheduled):
    case, draw = (
        PushedCase("amber3m", radius=WIDE, scheduled=scheduled),
        np.random.default_rng(2),
    )
    file = case.write(tmp_path / "proof.json")
    size = 0.5 ** draw.uniform(5.0, 9.0, size=(6, 1)) * np.ones(2)
    low = draw.uniform(size=(6, 2)) * (1.0 - size)
    seen = 0
    for box, enclosed in enumerate(bounds(proofcheck, file, low, low + size)):
        u = low[box] + size[box] * draw.uniform(size=(40, 2))
        values = case.values(u, in_the_ball(draw, 40, case.full_model.size))
        names = *(f"disturbed/{force}" for force in FORCES), *HELD, *KICKS
        names = *names, slope_output(not scheduled)
        for name in (*names, *LAW) if scheduled else names:
            if enclosed[name] is not None:
                seen += 1
                assert np.all(enclosed[name][:, 0] <= values[name].min(axis=0) + 1e-9), name
    assert seen > 12
