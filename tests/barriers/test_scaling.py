"""The default spec means the same for a robot of another size: Froude scaling.

All lengths times s, masses times s^3, so times times sqrt(s), torques times s^4, inertias times
s^5. At equal points of the chart every margin over its scale is then the same number.
"""

import re

import jax
import numpy as np
import pytest

from neuralgaits.barriers import specs
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.gaits import Gait
from neuralgaits.robots.mjcf.loader import robot_from_text

POINTS = np.random.default_rng(2).uniform(size=(12, 2))
POWER = {
    "pos": 1,
    "fromto": 1,
    "size": 1,
    "mass": 3,
    "diaginertia": 5,
    "armature": 5,
    "ctrlrange": 4,
}


def scaled(robot, size):
    """The robot file with every dimensional number multiplied by its power of `size`."""
    xml = re.sub(r"<!--.*?-->", "", robot.layout.xml, flags=re.DOTALL)
    xml = re.sub(r"<(key|camera|light|visual|global|quality|statistic)\b[^>]*/>", "", xml)

    def grown(match):
        name, numbers = match.groups()
        factor = size ** POWER[name]
        return f'{name}="{" ".join(repr(factor * float(n)) for n in numbers.split())}"'

    xml = re.sub(rf'\b({"|".join(POWER)})="([-0-9. e]+)"', grown, xml)
    return robot_from_text(xml, f"{robot.name}-{size}")


def relative_margins(robot, name):
    """Margins over scales at POINTS of a gait of that spec, by condition."""
    spec = specs.load(name, robot)
    gait = spec.new_gait(jax.random.key(3), "random", (6,))
    assert isinstance(gait, Gait)
    zd = ZeroDynamics(robot, gait.policy)
    margins = jax.jit(jax.vmap(lambda u: spec.margins(gait, zd, u)))(POINTS)
    return {c.name: np.asarray(margins[c.name]) / c.scale for c in spec.conditions}


@pytest.mark.parametrize("spec", ["walking", "walking-mlp", "rugged"])
def test_margins_do_not_depend_on_size(amber, spec):
    small = relative_margins(scaled(amber, 0.37), spec)
    for name, expected in relative_margins(amber, spec).items():
        size = max(1.0, float(np.max(np.abs(expected))))
        np.testing.assert_allclose(small[name], expected, rtol=0, atol=1e-8 * size, err_msg=name)


def test_the_copy_is_scaled(amber):
    """Masses, torques and the natural frequency of the leg as a pendulum."""
    copy = scaled(amber, 0.5)
    assert float(copy.mass) == pytest.approx(float(amber.mass) / 8.0)
    np.testing.assert_allclose(copy.torque_limit, amber.torque_limit / 16.0)
    q = np.array([-0.1, 0.3, -0.2, -0.3, 0.4])
    np.testing.assert_allclose(copy.mass_matrix(q), amber.mass_matrix(q) / 32.0, rtol=1e-12)
    np.testing.assert_allclose(
        copy.bias(q, np.zeros(5)), amber.bias(q, np.zeros(5)) / 16.0, rtol=1e-12
    )
