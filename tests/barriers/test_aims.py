"""Aims of training: the speed they aim at is that of the orbit, not of the middle of the tube."""

import shutil

import equinox as eqx
import numpy as np
import pytest

from neuralgaits.analysis.poincare_map import poincare
from neuralgaits.analysis.run import open_run
from neuralgaits.barriers.aims import LEVEL, middle_of
from support.shipped_run import SHIPPED


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The shipped gait that takes speeds from 0.55 to 0.90 m/s."""
    place = tmp_path_factory.mktemp("aims") / "run"
    return open_run(shutil.copytree(SHIPPED.with_name("demo_speed_run"), place))


@eqx.filter_jit
def orbit_speed(zero_dynamics, gait):
    return middle_of(zero_dynamics.point(gait.z(np.array([0.5, LEVEL]))), gait).orbit_speed


@pytest.mark.parametrize("speed", [0.55, 0.7, 0.9])
def test_the_speed_that_is_aimed_at_is_that_of_the_orbit(run, speed):
    one = run.at(speed=speed)
    orbit = poincare(one.zero_dynamics, one.gait.z(np.array([0.5, LEVEL])))
    aimed = float(orbit_speed(one.zero_dynamics, one.gait))
    assert aimed == pytest.approx(orbit.speed_m_s, rel=0.01)
