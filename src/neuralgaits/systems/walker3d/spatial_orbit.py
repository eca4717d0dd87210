"""Find a periodic gait: the policy's numbers and the start of a step, by least squares.

A residual of 1 is a miss that counts like any other such miss: each line divides by the size of
such a miss. Levenberg's and Marquardt's method with forward differences; all is evaluated for many
sets of numbers at once, so that one small function is compiled.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.flatten_util import ravel_pytree

from neuralgaits._types import Array, Float
from neuralgaits.systems.walker3d.spatial_dynamics import flow, loads
from neuralgaits.systems.walker3d.spatial_impact import impact
from neuralgaits.systems.walker3d.spatial_motion import jacobians_of
from neuralgaits.systems.walker3d.spatial_policy import SpatialPolicy, StepNumbers, step_between
from neuralgaits.systems.walker3d.spatial_start import FirstGuess, section_scale
from neuralgaits.systems.walker3d.spatial_step import PHASES, SpatialStep, step_from
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker

NEIGHBOURS = 0.3
"""Deviations whose steps give the section's derivatives, in those of `section_scale`."""
DIFFERENCE = 1e-6
"""Step of the forward differences, in the numbers' own units."""


class OrbitAims(NamedTuple):
    """Aims of the search for a gait; each is met as well as all others allow.

    Attributes:
        speed: mean speed forward [m/s].
        speed_weight: how much a miss of 1 m/s counts.
        duration: duration of a step [s].
        side: where the stance hip starts, to the left of the stance foot [m].
        normal: least normal force, as a share of the weight.
        friction: largest ratio of the contact's forces.
        torque: largest share of the motors' limits.
        stretch: longest leg, as a share of its links' lengths.
        clearance: height of the swing foot half-way [m].
        touchdown: least speed down at which it lands [m/s].
        leaving: least speed up at which the old stance foot leaves [m/s].
        sagittal: largest multiplier of the momentum forward.
        lateral: product of the two lateral multipliers, with its sign reversed. The swing foot
            starts where the state after a touchdown says that it is: the less the state before
            is forgotten, the flatter the function that tells.
    """

    speed: float
    speed_weight: float
    duration: float
    side: float
    normal: float = 0.6
    friction: float = 0.3
    torque: float = 0.69
    stretch: float = 0.97
    clearance: float = 0.045
    touchdown: float = 0.15
    leaving: float = 0.06
    sagittal: float = 0.75
    lateral: float = 0.33

    @classmethod
    def of(cls, robot: SpatialWalker, speed: float | None = None) -> "OrbitAims":
        """Return the aims for a robot, at a speed that goes with the length of its legs if None.

        A speed that was asked for counts more than other aims; the usual one is a start.
        """
        size = (robot.thigh.length + robot.shin.length) / 0.8
        return cls(
            speed=0.7 * float(np.sqrt(size)) if speed is None else speed,
            speed_weight=10.0 if speed is None else 100.0,
            duration=0.36 * float(np.sqrt(size)),
            side=0.0625 * robot.hip_width,
            clearance=0.045 * size,
        )


class SpatialOrbit(NamedTuple):
    """A gait and what was found of it.

    Attributes:
        policy: outputs of a state.
        start: (y, L_y, n) where a step starts. [3]
        section: derivatives of the start of the next step, in scaled coordinates. [3, 3]
        cost: sum of the squared residuals.
        numbers: of its steps.
    """

    policy: SpatialPolicy
    start: Float[np.ndarray, "3"]
    section: Float[np.ndarray, "3 3"]
    cost: float
    numbers: StepNumbers


@dataclass(frozen=True)
class OrbitProblem:
    """Residuals of a gait. Attributes: robot: the model; guess: where it starts; aims: of it."""

    robot: SpatialWalker
    guess: FirstGuess
    aims: OrbitAims

    @property
    def scale(self) -> Float[np.ndarray, "3"]:
        """Size of a deviation of (y, L_y, n) where a step starts."""
        return section_scale(self.robot, self.guess.pendulum)

    def parts(self) -> tuple[Float[np.ndarray, " p"], Callable[[Any], Any]]:
        """Return the numbers to be found, and the function back to a step's numbers and start."""
        numbers, back = ravel_pytree((self.guess.numbers, self.guess.start))
        return np.asarray(numbers), lambda row: back(jnp.asarray(row))

    def policy(self, numbers: StepNumbers) -> SpatialPolicy:
        """Return the policy of steps with these numbers."""
        guess = self.guess
        return step_between(numbers, numbers, numbers.bumps, guess.centre, guess.pendulum)

    def residuals(self, numbers: StepNumbers, start: Array) -> Array:
        """Return what must vanish on the orbit: of return map, touchdown and way, in this order."""
        policy = self.policy(numbers)
        around = NEIGHBOURS * np.diag(self.scale)
        near = jnp.asarray(np.vstack([np.zeros(3), around, -around]))
        steps = jax.vmap(lambda one: step_from(self.robot, policy, one))(start[None] + near)
        orbit = jax.tree.map(lambda rows: rows[0], steps)
        return jnp.concatenate(
            [
                self._return_map(policy, start, steps),
                self._touchdown(policy, orbit),
                self._way(policy, start, orbit),
            ]
        )

    def _return_map(self, policy: SpatialPolicy, start: Array, steps: SpatialStep) -> Array:
        """Return residuals of the period, of its neighbours, and of where the swing foot starts."""
        apart = steps.landed[1:4, 1:] - steps.landed[4:, 1:]
        section = apart.T / (2.0 * NEIGHBOURS) / self.scale[:, None]
        # Where the swing foot is after the touchdown, less where the policy starts it.
        missed = jax.vmap(lambda z: policy(z).aside)(steps.landed) - steps.states[:, -1, 1]
        (a, p, b), forward, (c, q, d) = section
        lateral = jnp.stack([(a + d) * 5.0, (a * d - b * c + self.aims.lateral) * 10.0, b, c])
        own = forward[1]
        shift = jnp.stack([(own - d) * p + b * q, c * p + (own - a) * q])
        return jnp.concatenate(
            [
                100.0 * (steps.landed[0, 1:] - start) / self.scale,
                missed[:1] / 5e-4,
                (missed[1:4] - missed[4:]) / (4e-3 * NEIGHBOURS),
                lateral * jnp.array([1.0, 1.0, 0.5, 0.5]),
                forward * 0.5,
                shift * 10.0,
                15.0 * _above(forward[1:2], self.aims.sagittal),
            ]
        )

    def _touchdown(self, policy: SpatialPolicy, orbit: SpatialStep) -> Array:
        """Return residuals of a cheap impact: no motion of the foot along the floor, no jump."""
        last = orbit.last
        struck = impact(self.robot, last.pose, last.motion, last.joints)
        after = flow(self.robot, policy, orbit.landed)
        foot = jacobians_of(last.links, last.pose).foot @ last.joints
        down = -policy.lift[1] / orbit.duration
        return jnp.concatenate(
            [
                3.0 * (struck.rates - after.joints),
                4.0 * foot[:2],
                0.05 * struck.impulse[:2],
                30.0 * _above(-struck.leaving[2:], -self.aims.leaving),
                20.0 * _above(-down[None], -self.aims.touchdown),
            ]
        )

    def _way(self, policy: SpatialPolicy, start: Array, orbit: SpatialStep) -> Array:
        """Return residuals of the step itself: speed, forces, torques, clearance, slopes."""
        aims, robot = self.aims, self.robot
        states, shares = orbit.states[::2], np.linspace(0.0, 1.0, PHASES + 1)
        now, needed = jax.vmap(lambda z: loads(robot, policy, z))(states)
        weight = robot.mass * robot.gravity
        normal = needed.ground[:, 2] / weight
        sideways = jnp.sqrt(jnp.sum(needed.ground[:, :2] ** 2, axis=1) + 1e-9)
        torques = needed.torques / robot.limits[None]
        legs = jnp.linalg.norm(now.pose.hips - now.pose.feet, axis=2)
        longest = aims.stretch * (robot.thigh.length + robot.shin.length)
        slopes = jax.vmap(jax.grad(lambda z: policy(z).aside))(states)[:, 1:]
        lift = jax.vmap(lambda z: policy(z).lift)(orbit.states)
        room = aims.clearance * 4.0 * shares * (1.0 - shares)
        size = self.scale / self.scale[0] * np.array([1.0, 0.1, 0.05])
        return jnp.concatenate(
            [
                aims.speed_weight
                * jnp.stack([(policy.ends[1] - policy.ends[0]) / orbit.duration - aims.speed]),
                20.0 * jnp.stack([orbit.duration - aims.duration]),
                100.0 * (start[:1] - aims.side),
                10.0 * _above(-normal, -aims.normal),
                20.0 * _above(sideways / needed.ground[:, 2], aims.friction),
                0.25 * torques.ravel(),
                8.0 / aims.torque * _above(jnp.abs(torques), aims.torque).ravel(),
                2.0 * needed.yaw / (0.4 * weight * robot.hip_width),
                60.0 * _above(room, lift),
                100.0 * _above(legs, longest).ravel(),
                0.15 * (slopes * size[None]).ravel(),
                10.0 * (policy.lift[2:] - 2.0 * aims.clearance),
                0.3 * (policy.landing[1:] - self.guess.numbers.landing[1:]),
                policy.sway,
                10.0 * (policy.height[:1] - self.guess.numbers.height[:1]),
            ]
        )


def _above(found: Array, limit: Array | float) -> Array:
    """Return by how much numbers are above a limit; 0 where they are not."""
    return jnp.maximum(found - limit, 0.0)
