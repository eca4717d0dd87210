"""Ranges of commands that no robot with such legs can follow are refused before training."""

import math

import jax
import numpy as np
import pytest

from neuralgaits.barriers import specs
from neuralgaits.barriers.commanded_spec import commands_of
from neuralgaits.cli.main import main
from neuralgaits.errors import SpecError
from neuralgaits.gait.posture import hip_indices, walking_posture
from neuralgaits.gait.reach import FRICTION, refuse_unreachable, widest_step
from neuralgaits.robots import load_robot

STEEPEST = math.atan(FRICTION)


@pytest.fixture(scope="module")
def amber():
    return load_robot("amber3m")


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("--step-length 0:99", "lengths above 0 m, found 0:99"),
        ("--step-length 0:0.3", "lengths above 0 m, found 0:0.3"),
        ("--step-length=-0.1:0.3", "lengths above 0 m"),
        ("--step-length 0.3:1.8", "less than 1.52 m apart"),
        ("--step-length 0.3:1.4 --step-height=-0.6:0.6", "less than 1.52 m apart"),
        ("--step-length 0.2:1.6", "less than 1.52 m apart"),
        ("--step-height=-5:5", "heights below the legs' length of 0.87 m"),
        ("--lean 40cm", "leans below 0.282 m"),
        ("--lean 60cm", "command lean: expected a range between -0.5 and 0.5 m"),
        ("--lean 0mm", "command lean: expected a range LOW:HIGH with LOW < HIGH"),
        ("--lean 2", "--lean: expected LOW:HIGH in m, found '2'"),
        ("--lean 2km", "--lean: expected LOW:HIGH in m, found '2km'"),
        ("--lean nan:0.1", "--lean: expected LOW:HIGH in m"),
        ("--lean 1.2.3cm", "--lean: expected a length as in 2cm"),
        ("--lean 2cm --parameters mass=1%", "expected lean alone for a gait that takes lean"),
        ("--parameters lean=3mm", "expected a gait that takes lean as command"),
        ("--lean 2cm --speed 0.7 --slope=-1:1", "expected one speed, or a range of it"),
        ("--slope=-30:30", "slopes below 24.2 degrees"),
        ("--speed 50", "legs of 0.87 m keep to the floor, up to 2.9 m/s, found 50"),
        ("--speed 0.5:50", "keep to the floor, up to 2.9 m/s"),
        ("--speed 0:0.5", "a speed above 0 m/s, found 0"),
        ("--speed=-0.5:0.5", "a speed above 0 m/s"),
        ("--seeds 0:2 --step-length 0:99", "lengths above 0 m"),
    ],
)
def test_an_impossible_range_is_one_line(tmp_path, monkeypatch, capfd, words, found):
    monkeypatch.chdir(tmp_path)
    assert main(["train", "amber3m", *words.split()]) == 2
    [line] = capfd.readouterr().err.splitlines()
    assert found in line
    assert not (tmp_path / "runs").exists()


def test_limits_are_those_of_the_legs(amber):
    """A robot with shorter legs takes shorter steps."""
    far = commands_of(step_length=(0.3, 1.5))
    refuse_unreachable(amber, far)
    small = load_robot("rabbit")
    assert small.leg_length < amber.leg_length
    beyond = commands_of(step_length=(0.3, 1.8 * small.leg_length))
    with pytest.raises(SpecError, match="apart"):
        refuse_unreachable(small, beyond)
    refuse_unreachable(amber, beyond)


def test_usual_ranges_pass(amber):
    usual = {
        "speed": (0.55, 0.9),
        "step_length": (0.3, 0.4),
        "step_height": (-0.05, 0.05),
        "slope": (-0.9 * STEEPEST, 0.9 * STEEPEST),
    }
    refuse_unreachable(amber, commands_of(**usual))
    specs.commanded(amber, commands_of(speed=usual["speed"]))


def test_feet_part_as_far_as_the_outputs_let_them(amber):
    """Straight legs at both stops of the hips are 1.8 rad apart; a bent shin reaches further."""
    posture = walking_posture(amber)
    hips = hip_indices(amber)
    turned = posture.upper[hips[0]] - posture.lower[hips[-1]]
    straight = 2.0 * amber.leg_length * math.sin(0.5 * turned)
    assert straight < widest_step(amber) < 2.0 * amber.leg_length
    random = np.random.default_rng(0).uniform(posture.lower, posture.upper, (200, amber.n - 1))
    feet = jax.vmap(amber.swing_foot)(np.pad(random, ((0, 0), (1, 0))))
    assert np.linalg.norm(feet, axis=1).max() < widest_step(amber)
