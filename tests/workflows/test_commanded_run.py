"""A run of a gait with commands: made, opened again, looked at where it was told to be."""

import shlex

import numpy as np
import pytest

from neuralgaits.analysis.run import PolicyOfSteps, open_run
from neuralgaits.cli.arguments import TrainOptions
from neuralgaits.cli.argv_parser import read
from neuralgaits.errors import InputError
from neuralgaits.report.page import repeat_commands
from neuralgaits.robots import load_robot
from neuralgaits.training import calibration
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.train import train

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    root = tmp_path_factory.mktemp("runs")
    with pytest.MonkeyPatch.context() as patch:
        # Nothing here depends on how well the speed is calibrated.
        patch.setattr(calibration, "KNOTS", 5)
        return train(load_robot("amber3m"), speed=(0.6, 0.8), steps=2, hidden=(4,), root=root)


def test_it_opens_as_it_was_made(made):
    opened = open_run(made.path)
    (told,) = opened.config.commands.values()
    assert (told.low, told.high) == (0.6, 0.8)
    assert told.largest_change == pytest.approx(0.024)
    assert set(opened.summary.aims) == {aim.name for aim in opened.spec.aims}
    assert set(opened.summary.conditions) == {c.name for c in opened.spec.conditions}
    steps = opened.policy
    assert isinstance(steps, PolicyOfSteps)
    here = steps.at(from_={"speed": 0.7}, to={"speed": 0.7})
    same = made.at(speed=0.7).gait.policy
    for name in ("z_start", "z_guard", "cubic"):
        np.testing.assert_allclose(getattr(here, name), getattr(same, name), rtol=1e-12)
    slow, fast = (opened.at(speed=v).gait.policy.z1_range for v in (0.6, 0.8))
    assert fast[1] > slow[1]


def test_what_it_is_not_told_is_refused(made):
    with pytest.raises(InputError, match=r"expected speed between 0.6 and 0.8 m/s, found 0.9"):
        made.at(speed=0.9)
    with pytest.raises(InputError, match=r"give --speed LOW:HIGH"):
        train(made.robot, speed=0.7, slope=(-0.05, 0.05))


def test_the_command_that_makes_it_again_tells_its_range(made):
    line = repeat_commands.training(made.folder)
    assert line is not None
    verb = read(shlex.split(line)[1:])
    assert isinstance(verb, TrainOptions) and verb.speed == (0.6, 0.8)


def test_level_4_is_refused(made):
    with pytest.raises(InputError, match=r"expected level 1, 2 or 3 for a gait with commands"):
        certify(made.path, level=4)
