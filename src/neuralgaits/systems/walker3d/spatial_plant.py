"""Many bipeds in MuJoCo at once, seen by a law as robots on their right foot."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo ships no type stubs.

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.systems.walker3d.spatial_gait import SpatialGait
from neuralgaits.systems.walker3d.spatial_impact import SIGNS, SWAPPED
from neuralgaits.systems.walker3d.spatial_laws import Measured, exact_reading, hips_of
from neuralgaits.systems.walker3d.spatial_mjcf import SpatialRobot
from neuralgaits.systems.walker3d.spatial_motion import UP
from neuralgaits.systems.walker3d.spatial_pose import MIRROR

TICK_S = 0.001
"""Time between two ticks of the controller."""


@dataclass
class SpatialPlants:
    """Plants of many walks.

    Attributes:
        robot: the file.
        model: MuJoCo's.
        worlds: one a walk.
        left: whether each stands on its left foot.
        first: where the root's slide forward starts [m]. [N]
    """

    robot: SpatialRobot
    model: mujoco.MjModel
    worlds: list[mujoco.MjData]
    left: Array
    first: Array

    @classmethod
    def started(cls, robot: SpatialRobot, gait: SpatialGait, states: Array) -> "SpatialPlants":
        """Put robots on the floor in states of the zero dynamics, with exact outputs. [N, 4]."""
        model = compile_text(robot.text, robot.walker.name)

        def full(z: Array) -> tuple[Array, Array, Array, Array]:
            found = exact_reading(robot.walker, gait.policy, z)
            place = hips_of(robot.walker, found.joints)[1]
            return found.joints, found.rates, place, found.velocity

        found = quick_jit(jax.vmap(full))(jnp.asarray(states))
        plants = cls(robot, model, [], np.zeros(len(states), bool), np.zeros(0))
        rest = mujoco.MjData(model)
        rest.qpos[:] = 0.0
        mujoco.mj_kinematics(model, rest)
        hips = [rest.xanchor[leg[0]] for leg in robot.tree.joints]
        base = 0.5 * (hips[0] + hips[1])
        for q, dq, place, speed in zip(*map(np.asarray, found), strict=True):
            world = mujoco.MjData(model)
            world.qpos[:3], world.qpos[3:] = place - base + plants.radius * UP, q
            world.qvel[:3], world.qvel[3:] = speed, dq
            mujoco.mj_forward(model, world)
            plants.worlds.append(world)
        plants.first = np.array([world.qpos[0] for world in plants.worlds])
        return plants

    def times(self) -> Float[np.ndarray, " N"]:
        """Return the time of each world [s]."""
        return np.array([world.time for world in self.worlds])

    @property
    def ticks(self) -> int:
        """Steps of MuJoCo from one tick of the controller to the next."""
        return max(1, round(TICK_S / self.model.opt.timestep))

    def measured(self) -> Measured:
        """Return what the sensors say, reflected where a robot stands on its left foot."""
        q = np.array([world.qpos[3:] for world in self.worlds])
        dq = np.array([world.qvel[3:] for world in self.worlds])
        velocity = np.array([world.qvel[:3] for world in self.worlds])
        left = self.left[:, None]
        return Measured(
            jnp.asarray(np.where(left, SIGNS * q[:, SWAPPED], q)),
            jnp.asarray(np.where(left, SIGNS * dq[:, SWAPPED], dq)),
            jnp.asarray(np.where(left, velocity * MIRROR, velocity)),
        )

    def landed(self) -> Array:
        """Return whether the swing foot of each robot touches the floor. [N]."""
        feet = np.array(self.robot.tree.feet)
        swing = feet[1 - self.left.astype(int)]
        heights = [w.geom_xpos[foot, 2] for w, foot in zip(self.worlds, swing, strict=True)]
        return np.array(heights) <= self.radius

    @property
    def radius(self) -> float:
        """Radius of a foot [m]."""
        return float(self.model.geom_size[self.robot.tree.feet[0], 0])

    def touching(self, one: int) -> tuple[bool, bool]:
        """Return whether the right and the left foot of a robot touch the floor."""
        right, left = (self.worlds[one].geom_xpos[foot, 2] for foot in self.robot.tree.feet)
        return bool(right <= self.radius), bool(left <= self.radius)

    def hips(self, one: int) -> Float[np.ndarray, "3"]:
        """Return the middle of the hips [m]."""
        return np.mean([self.worlds[one].xanchor[leg[0]] for leg in self.robot.tree.joints], axis=0)

    def settle(self, one: int) -> None:
        """Compute what follows from positions and rates that were set."""
        mujoco.mj_forward(self.model, self.worlds[one])

    def apply(
        self, one: int, torques: Float[np.ndarray, "6"], push: Float[np.ndarray, "2"]
    ) -> None:
        """Hold torques, and a push on the torso, forward and to the left [N], for a tick."""
        self.drive(one, SIGNS[2:] * torques[SWAPPED[2:] - 2] if self.left[one] else torques, push)

    def drive(self, one: int, own: Float[np.ndarray, "6"], push: Float[np.ndarray, "2"]) -> None:
        """Hold torques of the motors, right leg first, and a push, for a tick."""
        world, model = self.worlds[one], self.model
        motors = np.concatenate(self.robot.tree.motors)
        gains = model.actuator_gear[motors, 0] * model.actuator_gainprm[motors, 0]
        world.ctrl[motors] = np.clip(
            own / gains, model.actuator_ctrlrange[motors, 0], model.actuator_ctrlrange[motors, 1]
        )
        world.xfrc_applied[self.robot.tree.bodies[0], :2] = push
        for _ in range(self.ticks):
            mujoco.mj_step(model, world)

    def fallen(self, one: int) -> bool:
        """Return whether a robot has fallen: low hips, or a torso that leans aside by half."""
        walker, world = self.robot.walker, self.worlds[one]
        heights = [world.xanchor[leg[0], 2] for leg in self.robot.tree.joints]
        low = 0.7 * (walker.thigh.length + walker.shin.length)
        upright = np.all(np.isfinite(world.qpos)) and np.abs(world.qpos[3:5]).max() < 0.5
        return not upright or min(heights) < low
