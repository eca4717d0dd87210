"""Steps from random starts of the inlet: what they need, and where they lead. Samples, no proof."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.systems.walker3d.spatial_dynamics import loads
from neuralgaits.systems.walker3d.spatial_gait import SpatialGait
from neuralgaits.systems.walker3d.spatial_impact import impact
from neuralgaits.systems.walker3d.spatial_motion import jacobians_of
from neuralgaits.systems.walker3d.spatial_step import step_from
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker

NORMAL, FRICTION = 0.3, 0.6
"""Least normal force, as a share of the weight, and largest ratio of the contact's forces."""
BATCH = 64
"""Steps that are evaluated together."""


class StepSamples(NamedTuple):
    """Results of sampled steps.

    Attributes:
        margins: smallest of each condition, none of them negative if it held.
        friction, torque, yaw, missed: largest, see `SpatialTrained`.
    """

    margins: dict[str, float]
    friction: float
    torque: float
    yaw: float
    missed: float


def sampled_steps(
    robot: SpatialWalker, gait: SpatialGait, key: PRNGKeyArray, count: int
) -> StepSamples:
    """Return what steps from random starts need, half of them from the inlet's face."""
    first, second = jax.random.split(key)
    inside = jax.random.normal(first, (count, 3))
    inside = inside / jnp.linalg.norm(inside, axis=1, keepdims=True)
    size = jax.random.uniform(second, (count,)) ** (1.0 / 3.0)
    inside = inside * jnp.where(jnp.arange(count) % 2 == 0, 1.0, size)[:, None]
    rows = quick_jit(jax.vmap(lambda one: _of_step(robot, gait, one)))
    parts = [
        jax.tree.map(np.asarray, rows(inside[begin : begin + BATCH]))
        for begin in range(0, count, BATCH)
    ]
    margins = {name: float(min(part[0][name].min() for part in parts)) for name in parts[0][0]}
    largest = [float(max(part[1][k].max() for part in parts)) for k in range(4)]
    return StepSamples(margins, *largest)


def _of_step(
    robot: SpatialWalker, gait: SpatialGait, inside: Float[Array, "3"]
) -> tuple[dict[str, Array], tuple[Array, Array, Array, Array]]:
    """Return smallest margins and largest figures of the step from a point of the inlet."""
    policy, inlet = gait.policy, jnp.asarray(gait.inlet)
    step = step_from(robot, policy, jnp.asarray(gait.start) + inlet @ inside)
    now, needed = jax.vmap(lambda z: loads(robot, policy, z))(step.states[::2])
    last = step.last
    struck = impact(robot, last.pose, last.motion, last.joints)
    foot = jacobians_of(last.links, last.pose).foot @ last.joints
    weight = robot.mass * robot.gravity
    normal = needed.ground[:, 2]
    sideways = jnp.sqrt(jnp.sum(needed.ground[:, :2] ** 2, axis=1))
    shares = jnp.abs(needed.torques) / robot.limits[None]
    deviation = step.landed[1:] - gait.start
    after = _solved(inlet, deviation)
    margins = {
        "inlet": 1.0 - jnp.sum(after * after),
        "forward": now.rates[:, 0],
        "normal force": normal / weight - NORMAL,
        "friction": FRICTION - sideways / normal,
        "torque": 1.0 - jnp.max(shares, axis=1),
        "impulse": FRICTION
        - jnp.sqrt(jnp.sum(struck.impulse[:2] ** 2)) / jnp.abs(struck.impulse[2]),
        "leaving": struck.leaving[2],
        "touchdown": -foot[2],
    }
    missed = jnp.abs(policy(step.landed).aside - step.states[-1, 1])
    figures = (
        jnp.max(sideways / normal),
        jnp.max(jnp.abs(needed.torques)),
        jnp.max(jnp.abs(needed.yaw)),
        missed,
    )
    return {name: jnp.min(rows) for name, rows in margins.items()}, figures


def _solved(upper: Float[Array, "3 3"], right: Float[Array, "3"]) -> Float[Array, "3"]:
    """Solve with an upper triangular matrix, from its last row."""
    found: list[Array] = []
    for row in (2, 1, 0):
        known = sum((upper[row, 2 - k] * value for k, value in enumerate(found)), jnp.zeros(()))
        found.append((right[row] - known) / upper[row, row])
    return jnp.stack(found[::-1])
