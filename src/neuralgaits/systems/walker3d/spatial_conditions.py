"""The spec `periodic`: what must hold on the tube, as margins at one point of its chart.

A margin must not be negative anywhere in its region, see `spatial_levels.TABLE`.
"""

from collections.abc import Mapping
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.systems.walker3d.spatial_dynamics import Flow, Loads, flow, loads
from neuralgaits.systems.walker3d.spatial_gait import AbstractSpatialGait, SpatialGait, StepStart
from neuralgaits.systems.walker3d.spatial_impact import impact, reset
from neuralgaits.systems.walker3d.spatial_levels import RATE
from neuralgaits.systems.walker3d.spatial_pose import Links, SpatialPose, cross
from neuralgaits.systems.walker3d.spatial_tube import SlopedSection, TubeSection, in_ball
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker


class Limits(NamedTuple):
    """Numbers that the margins of `periodic` are measured from."""

    forward: float = 0.2
    """Least velocity of the stance hip forward [m/s]."""
    volume: float = 0.02
    """Least volume of a section, as a share of that where a step starts."""
    lift: float = 0.01
    """Least height of the swing foot over t (1 - t) [m]."""
    down: float = 0.05
    """Least velocity down of the swing foot at touchdown [m/s]."""
    normal: float = 0.3
    """Least normal force, as a share of the weight."""
    miss: float = 0.02
    """Largest distance aside between where the swing foot is after a touchdown and where the
    policy starts it [m]."""
    twist: float = 0.05
    """Largest moment about the vertical that holds the yaw, over the normal force [m]."""


LIMITS = Limits()


def spatial_margins(
    robot: SpatialWalker, gait: AbstractSpatialGait, u: Float[Array, " n"]
) -> Mapping[str, Array]:
    """Return the margins at a point (phase, cube, commands) of the chart, by condition."""
    step, following = gait.told(u[4:])
    t, w = u[0], in_ball(u[1:4])
    here, start = step.tube.section(t), step.tube.section(jnp.zeros_like(t))
    now, needed = loads(robot, step.policy, step.state(t, here.states(w)))
    begin, end, middle = step.policy.lift
    lift = begin * (1.0 - t) - end * t + 16.0 * middle * t * (1.0 - t)
    return {
        "inward": -(w @ here.inside(slope_by_phase(step, now) - _moved(here, w))),
        "forward": now.rates[0] - LIMITS.forward,
        "chart": here.volume / start.volume - LIMITS.volume,
        "clearance": lift - LIMITS.lift,
        **_force_margins(robot, needed),
        "range": joint_ranges(robot, now.pose, now.links),
        **_touchdown_margins(robot, step, now, here.states(w), following),
        **_contraction_margins(robot, step, following.section, t, w),
    }


def _moved(here: SlopedSection, w: Float[Array, "3"]) -> Float[Array, "3"]:
    """Return the derivative of (y, L_y, n) by phase that keeps a point of the ball."""
    return here.centre_slope + here.axes_slope @ w


def slope_by_phase(step: SpatialGait, now: Flow) -> Float[Array, "3"]:
    """Return the derivative of (y, L_y, n) by phase along the flow."""
    return now.rates[1:] / now.rates[0] * (step.policy.ends[1] - step.policy.ends[0])


def _force_margins(robot: SpatialWalker, needed: Loads) -> dict[str, Array]:
    """Return the margins of the floor's forces, as shares of the weight, and of torques."""
    weight = robot.mass * robot.gravity
    ahead, aside, normal = needed.ground / weight
    yaw, bound = needed.yaw / (LIMITS.twist * weight), robot.friction * normal
    return {
        "normal force": normal - LIMITS.normal,
        "friction": bound * bound - ahead * ahead - aside * aside,
        "yaw": normal * normal - yaw * yaw,
        "torque": 1.0 - (needed.torques / robot.limits) ** 2,
    }


def joint_ranges(robot: SpatialWalker, pose: SpatialPose, links: Links) -> Float[Array, " k"]:
    """Return sin(q - low) and sin(high - q) of each joint whose range is below half a turn.

    Both are positive inside the range, and one of them is negative outside. The stance leg is the
    right one: its roll has the reflected range.
    """
    forward, left, up = pose.torso
    roll, pitch, knee = robot.ranges
    sines = []
    for side, rolled in enumerate(((-roll[1], -roll[0]), roll)):
        thigh, shin = links.frames[2 * side + 1], links.frames[2 * side + 2]
        normal = pose.normals[side]
        below = cross(forward, normal)
        angles = (
            (normal @ up, normal @ left, rolled),
            (thigh[2] @ forward, thigh[2] @ below, pitch),
            (shin[2] @ thigh[0], shin[2] @ thigh[2], knee),
        )
        for sine, cosine, (low, high) in angles:
            if high - low < np.pi:
                sines += [sine * np.cos(low) - cosine * np.sin(low)]
                sines += [cosine * np.sin(high) - sine * np.cos(high)]
    return jnp.stack(sines) if sines else jnp.ones(1)


def _touchdown_margins(
    robot: SpatialWalker,
    step: SpatialGait,
    now: Flow,
    before: Float[Array, "3"],
    following: StepStart,
) -> dict[str, Array]:
    """Return the margins of a touchdown from a state with this flow."""
    landed = reset(robot, now.pose, now.links, now.motion)
    struck = impact(robot, now.pose, now.motion, now.joints)
    section = following.section
    w = section.inside(landed[1:] - section.centre)
    # Impulses over the mass: velocities [m/s], in units of 0.1 m/s.
    ahead, aside, normal = 10.0 * struck.impulse / robot.mass
    bound = robot.friction * normal
    down = -step.policy.lift[1] * now.rates[0] / (step.policy.ends[1] - step.policy.ends[0])
    missed = (following.aside @ step.policy.inputs(landed) - before[0]) / LIMITS.miss
    return {
        "inlet": 1.0 - w @ w,
        "touchdown": down - LIMITS.down,
        "leaving": struck.leaving[2],
        "impulse": jnp.stack([normal, bound * bound - ahead * ahead - aside * aside]),
        "swing start": 1.0 - missed * missed,
    }


def _contraction_margins(
    robot: SpatialWalker,
    step: SpatialGait,
    following: TubeSection,
    t: Float[Array, ""],
    w: Float[Array, "3"],
) -> dict[str, Array]:
    """Return numbers that are positive only if two matrices are positive definite.

    With B = R^-1 (ds'/ds R - R'), s' the derivative of s = (y, L_y, n) by phase, a deviation R d
    has d' = B d: - (B + B^T) / 2 - RATE. With a touchdown's D = R+^-1 ds+/ds R, R+ of the section
    where the next step starts: 1 - D^T D. The former is nearly diagonal, as R follows the
    linearised flow; the latter is not.
    """
    here = step.tube.section(t)

    def both(state: Float[Array, "3"]) -> tuple[Array, Array]:
        now = flow(robot, step.policy, step.state(t, state))
        return slope_by_phase(step, now), reset(robot, now.pose, now.links, now.motion)[1:]

    _, push = jax.linearize(both, here.states(w))
    slopes, landed = jax.vmap(push)(here.axes.T)
    across = here.inside(slopes - here.axes_slope.T)
    after = following.inside(landed)
    unit = np.eye(3)
    return {
        "closer": _dominance(-0.5 * (across + across.T) - RATE * unit),
        "approach": _leading_minors(unit - after @ after.T),
    }


def _dominance(matrix: Float[Array, "3 3"]) -> Float[Array, "12"]:
    """Return each diagonal element with both others of its row added or subtracted.

    If all are positive, the diagonal dominates: a symmetric matrix is positive definite.
    """
    (a, b, c), (_, d, e), (_, _, f) = matrix
    rows = ((a, b, c), (d, b, e), (f, c, e))
    return jnp.stack([x + s * y + t * z for x, y, z in rows for s in (1, -1) for t in (1, -1)])


def _leading_minors(matrix: Float[Array, "3 3"]) -> Float[Array, "3"]:
    """Return the leading minors of a symmetric matrix: all positive if and only if it is."""
    (a, b, c), (_, d, e), (_, _, f) = matrix
    second = a * d - b * b
    return jnp.stack([a, second, second * f - a * e * e + 2.0 * b * c * e - c * c * d])
