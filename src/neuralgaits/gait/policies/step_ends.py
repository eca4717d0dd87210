"""Both ends of a step: the posture at a guard, the state after its impact, and the cubic between.

The swing foot is put on its foothold by a fixed number of Newton steps, or in closed form, so that
all of it is one formula of the guard's outputs and slopes. Hybrid invariance as in Westervelt,
Grizzle and Koditschek (2003).
"""

from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Actuated, Array, Coordinates, Float, Planar, Scalar
from neuralgaits.gait.posture import hip_indices
from neuralgaits.gait.reset_residual import ResetCorrection, rates_after
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.gait.zero_coordinates import ZeroCoordinates
from neuralgaits.robots.state_after_impact import Impact

# How far inside the output bounds the end points are kept, as a share of the bounds' width:
# on the bound the logit is infinite and a warm start would turn to NaN.
END_POINT_MARGIN = 1e-3
# Newton steps that put the swing foot on the ground at the guard: quadratic convergence from
# a posture within a few centimetres leaves rounding error only.
FOOT_NEWTON_STEPS = 6


def with_hip_at(robot: SteppingRobot, z1: Scalar | float, actuated: Actuated) -> Coordinates:
    """Coordinates with hip position z1 and these actuated joints, or rates alike. [n] (rad)."""
    return ZeroCoordinates(robot).lift(jnp.reshape(z1, 1), actuated)


class Guard(NamedTuple):
    """The end of a step, with the swing foot on its foothold."""

    z1: Scalar
    """Value of z1 at the guard [m]."""
    outputs: Actuated
    """Desired outputs at the guard [rad]. [m]"""
    slopes: Actuated
    """Slopes d y_d / d z1 at the guard [rad/m]. [m]"""


class Start(NamedTuple):
    """The beginning of a step: the state after the impact at a guard."""

    z1: Scalar
    """Value of z1 at the start [m]."""
    outputs: Actuated
    """Desired outputs at the start [rad]. [m]"""
    slopes: Actuated
    """Slopes d y_d / d z1 at the start [rad/m]. [m]"""
    momentum_ratio: Scalar
    """z2 after the impact / z2 before."""


class Foothold(NamedTuple):
    """Required place of the swing foot at a guard, relative to the stance foot."""

    length: Scalar | None = None
    """Distance ahead of the stance foot [m]; None leaves it to the posture."""
    height: Scalar | float = 0.0
    """Height above the stance foot [m]."""
    rise: Scalar | float = 0.0
    """Further height per metre of length [m/m]."""


def on_foothold(
    robot: SteppingRobot,
    z_guard: Scalar,
    outputs: Actuated,
    foothold: Foothold,
    steps: int = FOOT_NEWTON_STEPS,
) -> Actuated:
    """Move the swing hip until the swing foot is on its foothold, and the knee for the length.

    Args:
        robot: the robot.
        z_guard: z1 there (m).
        outputs: near them, [m] (rad).
        foothold: place where the foot has to be.
        steps: number of Newton's steps.
    """
    hip = hip_indices(robot)[-1]
    free_joints = [hip] if foothold.length is None else [hip, robot.n - 2]
    directions = np.eye(robot.n - 1, dtype=outputs.dtype)[free_joints]

    def miss(shift: Float[Array, " k"]) -> Float[Array, " k"]:
        along, up = robot.swing_foot(with_hip_at(robot, z_guard, outputs + shift @ directions))
        high = up - (foothold.height + foothold.rise * along)
        return high[None] if foothold.length is None else jnp.stack([high, along - foothold.length])

    # Traced once for all steps; inlined, it is the same formula as without `jit`.
    @partial(jax.jit, inline=True)
    def newton(shift: Float[Array, " k"]) -> Float[Array, " k"]:
        value, derivative = jax.linearize(miss, shift)
        columns = [derivative(row) for row in np.eye(len(free_joints), dtype=outputs.dtype)]
        return shift - _solved(columns, value)

    shift = jnp.zeros(len(free_joints), outputs.dtype)
    for _ in range(steps):
        shift = newton(shift)
    return outputs + shift @ directions


def level_at(robot: SteppingRobot, guard: Guard) -> Guard:
    """Return the guard with a flat swing foot level and not turning; itself on point feet.

    The swing ankle is the last joint, and moves nothing but the foot.
    """
    if robot.feet is None:
        return guard
    ankle = np.eye(robot.n - 1, dtype=guard.outputs.dtype)[-1]
    q = with_hip_at(robot, guard.z1, guard.outputs)
    dq = with_hip_at(robot, jnp.ones_like(q[0]), guard.slopes)
    foot = robot.link_angles[-1]
    return guard._replace(
        outputs=guard.outputs + (foot @ q) * ankle, slopes=guard.slopes + (foot @ dq) * ankle
    )


def on_foothold_exactly(
    robot: SteppingRobot, z_guard: Scalar, outputs: Actuated, foothold: Foothold
) -> Actuated:
    """`on_foothold` in closed form, from outputs with the foot some centimetres off.

    Bounds over boxes grow each time that a formula uses what it has computed, as every Newton step
    does; here each angle is used about once. The hip turns the leg to a height, and the last joint
    what hangs from it to a distance from the hip: what is turned by s has a coordinate, or a square
    of a length, that obeys a sin s + b (1 - cos s) + miss = 0, quadratic in tan(s / 2).
    """
    q = with_hip_at(robot, z_guard, outputs)
    hip, foot = robot.hip_position(q), robot.swing_foot(q)
    leg = foot - hip
    joints = np.eye(robot.n - 1, dtype=outputs.dtype)[[hip_indices(robot)[-1], robot.n - 2]]
    if foothold.length is None:

        def up(place: Planar) -> Scalar:
            return place[1] - foothold.rise * place[0]

        tangent = _half_tangent(up(foot) - foothold.height, -up(_quarter_turn(leg)), -up(leg))
        return outputs + _twice_arctan(tangent)[None] @ joints[:1]
    height = foothold.height + foothold.rise * foothold.length
    place = jnp.stack([foothold.length, height]) - hip
    angle = (robot.link_angles @ q)[-1]
    last = robot.foot[-1] * jnp.stack([-jnp.sin(angle), jnp.cos(angle)])
    upper, far = leg - last, place @ place
    tangent = _half_tangent(
        leg @ leg - far, -2.0 * (upper @ _quarter_turn(last)), -2.0 * (upper @ last)
    )
    leg = upper + _turned_back(last, tangent)
    across = leg[1] * place[0] - leg[0] * place[1]
    turns = jnp.stack([_twice_arctan(across / (far + leg @ place)), _twice_arctan(tangent)])
    return outputs + turns @ joints


def _quarter_turn(vector: Planar) -> Planar:
    """Turn a vector counter-clockwise by a right angle. [2]."""
    return jnp.stack([-vector[1], vector[0]])


def _turned_back(vector: Planar, tangent: Scalar) -> Planar:
    """Turn a vector clockwise by the angle whose half has this tangent. [2]."""
    square = tangent * tangent
    return vector - (2.0 / (1.0 + square)) * (square * vector + tangent * _quarter_turn(vector))


def _half_tangent(miss: Scalar, a: Scalar, b: Scalar) -> Scalar:
    """Return tan(s / 2) of the smaller s at which a sin s + b (1 - cos s) + miss is zero."""
    miss, bend = miss / a, b / a
    return -miss / (1.0 + jnp.sqrt(1.0 - miss * (miss + 2.0 * bend)))


def _twice_arctan(x: Scalar) -> Scalar:
    """Return 2 arctan x within 1e-9 for |x| <= 0.6: two halvings of the angle, then its series."""
    for _ in range(2):
        x = x / (1.0 + jnp.sqrt(1.0 + x * x))
    square = x * x
    series = 1.0 / 3.0 - square * (0.2 - square * (1.0 / 7.0 - square / 9.0))
    return 8.0 * x * (1.0 - square * series)


def start_after(robot: SteppingRobot, guard: Guard, reset_residual: ResetCorrection) -> Start:
    """Return the start of the step that follows a guard, by the real impact, legs relabelled."""
    q = with_hip_at(robot, guard.z1, guard.outputs)
    dq = with_hip_at(robot, jnp.ones_like(q[0]), guard.slopes)
    after = _after_impact(robot, q, dq, reset_residual)
    speed = robot.position_rows[0] @ after.dq
    ratio = robot.momentum(after.q, after.dq)[0] / robot.momentum(q, dq)[0]
    return Start(robot.position_rows[0] @ after.q, after.q[1:], after.dq[1:] / speed, ratio)


def logit_ends(start: Start, guard: Guard, lower: Actuated, upper: Actuated) -> Float[Array, "4 m"]:
    """Return value and slope by the phase of a path in logit space, at phases 0 and 1. [4, m]."""
    width, span = upper - lower, guard.z1 - start.z1
    logits, logit_slopes = [], []
    for end in (start, guard):
        share = (end.outputs - lower) / width
        logits.append(jnp.log1p((2.0 * share - 1.0) / (1.0 - share)))
        logit_slopes.append(end.slopes * span / (width * share * (1.0 - share)))
    return jnp.stack([logits[0], logit_slopes[0], logits[1], logit_slopes[1]])


def cubic_between(ends: Float[Array, "4 m"]) -> Float[Array, "4 m"]:
    """Return the cubic with these ends, of `logit_ends`: coefficients in powers of the phase."""
    p0, d0, p1, d1 = ends
    return jnp.stack([p0, d0, 3.0 * (p1 - p0) - 2.0 * d0 - d1, 2.0 * (p0 - p1) + d0 + d1])


def inside(outputs: Actuated, lower: Actuated, upper: Actuated) -> Actuated:
    """Clip outputs to END_POINT_MARGIN inside their bounds."""
    margin = END_POINT_MARGIN * (upper - lower)
    return jnp.clip(outputs, lower + margin, upper - margin)


def _solved(columns: list[Float[Array, " k"]], right: Float[Array, " k"]) -> Float[Array, " k"]:
    """Solve for one or two unknowns by Cramer's rule, columns of the matrix given."""
    if len(columns) == 1:
        return right / columns[0]
    (a, c), (b, d) = columns
    u, v = right
    return jnp.stack([u * d - b * v, a * v - c * u]) / (a * d - b * c)


def _after_impact(
    robot: SteppingRobot, q: Coordinates, dq: Coordinates, reset_residual: ResetCorrection
) -> Impact:
    after = robot.impact(q, dq)
    if reset_residual is None:
        return after
    # The rates are those of dz1 = 1 m/s: any z2 gives the same ratios.
    correction = reset_residual(reset_residual.centre)
    z2 = robot.momentum(q, dq)[0]
    return after._replace(dq=rates_after(robot, after.q, after.dq, correction, z2))
