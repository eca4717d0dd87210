"""Find the periodic orbit of a given gait, and the cost of walking on it."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Float
from neuralgaits.analysis.flow import Mesh, returns
from neuralgaits.analysis.poincare_map import cycle, motion_of, orbit_between
from neuralgaits.analysis.point_evaluator import PointEvaluator
from neuralgaits.gait import ZeroDynamics


class Steady(NamedTuple):
    """An orbit on the zero dynamics, from touchdown to touchdown."""

    z: Float[np.ndarray, "K 2"]
    """States of the orbit (m, kg m^2/s)."""
    speed_m_s: float
    multiplier: float
    """Slope of the Poincare map at the orbit."""
    cost_of_transport: float
    """Integral of sum |torque rate| over the actuated joints, over weight times distance [1]."""


def steady(zd: ZeroDynamics) -> Steady | str:
    """Return the attracting orbit of zero dynamics, or a sentence with the reason for none."""
    robot = zd.robot
    weight, leg = float(robot.mass * robot.gravity), robot.layout.leg_length
    pace = float(robot.mass) * leg * np.sqrt(float(robot.gravity) * leg)
    motion, mesh = motion_of(zd), Mesh.of_leg(robot.layout.leg_length)
    # Speeds at the section, in sqrt(g l). Slow orbits pass it barely faster than a walk that does
    # not get over the foot; a coarse grid misses them.
    z2 = pace * np.linspace(0.01, 2.0, 200)
    with np.errstate(all="ignore"):
        orbit = orbit_between(motion, z2, returns(motion, z2, mesh).z2, mesh)
    if orbit.result != "found":
        return orbit.result
    start, guard = float(motion.z_after(orbit.guard_state[None])[0, 0]), float(orbit.guard_state[0])
    # Number of intervals of z1 along a step; quadratures of curved functions are good to 1e-5.
    steps = 240
    one = cycle(motion, orbit, Mesh.of_gait(start, guard, steps))

    def power(z):
        point = zd.point(z)
        return {"power": jnp.sum(jnp.abs(point.torque * point.dq[1:]))}

    z, t = one.z[:, 0], one.t[:, 0]
    power_w = PointEvaluator(power)(z)["power"]
    work = float(np.trapezoid(power_w, t))
    return Steady(z, orbit.speed_m_s, orbit.multiplier, work / (weight * orbit.step_length_m))
